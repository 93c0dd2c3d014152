//! Settings of rule blocks and of single outputs. In a rule set, a setting applies to all blocks or outputs, or each
//! block or output has its own.

use fuzzy::model::{Activation, Aggregation, Block, Model, Operators, Rule};

use crate::model_draft::ModelDraft;

/// Sets the blocks from which the rules of a model were read. The settings of a single block become those of the rule
/// set.
pub(crate) fn set_blocks(model: &mut Model, mut blocks: Vec<Block>) {
    if let [block] = &blocks[..]
        && block.enabled
    {
        model.operators.and = block.and;
        model.operators.or = block.or;
        model.operators.implication = block.implication;
        model.activation = block.activation;
        return;
    }
    for index in 0..blocks.len() {
        let taken = |name: &str| blocks.iter().take(index).any(|block| block.name == name);
        let Some(name) = blocks.get(index).map(|block| block.name.clone()) else {
            continue;
        };
        if name.is_empty() || taken(&name) {
            let free = (index + 1..).map(|number| format!("block {number}"));
            let free = free.into_iter().find(|name| !taken(name));
            if let (Some(block), Some(free)) = (blocks.get_mut(index), free) {
                block.name = free;
            }
        }
    }
    model.blocks = blocks;
}

/// Sets the aggregation of each output. The aggregation of the first output becomes the default of the rule set; an
/// aggregation that differs from the default is stored with its output.
pub(crate) fn aggregate(model: &mut Model, found: &[Option<Aggregation>]) {
    let common = found.iter().flatten().next().copied().unwrap_or_default();
    model.operators.aggregation = common;
    for (output, found) in model.outputs.iter_mut().zip(found) {
        output.aggregation = found.filter(|found| *found != common);
    }
}

/// Reports a loss if several rules conclude the same term of an output with computed values and the aggregation of the
/// file combines these rules. In a rule set, each rule has its own weight.
pub(crate) fn joined(draft: &mut ModelDraft<'_>, output: &str, part: &str, help: &str) {
    let rules = draft.model.rules.iter();
    let consequents = rules.flat_map(|rule| &rule.rule.consequents);
    let mut terms: Vec<&str> = consequents
        .filter(|consequent| consequent.output.text == output)
        .map(|consequent| consequent.term.text.as_str())
        .collect();
    terms.sort_unstable();
    if terms
        .windows(2)
        .any(|pair| matches!(pair, [a, b] if a == b))
    {
        let message = format!(
            "several rules conclude the same term of `{output}`, and the aggregation of the file combines them, but a rule set weights each rule separately"
        );
        draft.loss("joined", part, message, help);
    }
}

/// Rules that share operators.
pub(crate) struct Rules<'m> {
    pub(crate) name: &'m str,
    pub(crate) enabled: bool,
    pub(crate) operators: Operators,
    pub(crate) activation: Activation,
    /// The rules with their numbers, from 1.
    pub(crate) rules: Vec<(usize, &'m Rule)>,
}

/// All rules of a model, by block.
pub(crate) fn of(model: &Model) -> Vec<Rules<'_>> {
    let rules = |of: usize| {
        let numbered = model
            .rules
            .iter()
            .enumerate()
            .map(|(index, rule)| (index + 1, rule));
        numbered
            .filter(|(_, rule)| model.blocks.is_empty() || rule.block == of)
            .collect()
    };
    if model.blocks.is_empty() {
        return vec![Rules {
            name: "rules",
            enabled: true,
            operators: model.operators,
            activation: model.activation,
            rules: rules(0),
        }];
    }
    let of_block = |(index, block)| {
        let Block {
            name,
            enabled,
            and,
            or,
            implication,
            activation,
            ..
        }: &Block = block;
        Rules {
            name,
            enabled: *enabled,
            operators: Operators {
                and: *and,
                or: *or,
                implication: *implication,
                aggregation: model.operators.aggregation,
            },
            activation: *activation,
            rules: rules(index),
        }
    };
    model.blocks.iter().enumerate().map(of_block).collect()
}
