//! Single values without allocation: the caller writes the point into the memory of the module.

use fuzzy::engine::{Outcome, Scratch};
use wasm_bindgen::prelude::wasm_bindgen;

use super::set::RuleSet;

/// The values that an evaluation reads and writes.
pub(super) struct Memory {
    point: Vec<f64>,
    scratch: Scratch,
    outcomes: Vec<Outcome>,
}

#[wasm_bindgen(js_class = RuleSet)]
impl RuleSet {
    /// The address of the point that `value` reads: one number for each input. It is valid until `free`.
    pub fn point(&mut self) -> *const f64 {
        let engine = &self.engine;
        let memory = self.memory.get_or_insert_with(|| Memory {
            point: vec![f64::NAN; engine.input_names().len()],
            scratch: engine.scratch(),
            outcomes: vec![Outcome::default(); engine.output_names().len()],
        });
        memory.point.as_ptr()
    }

    /// The value of an output at the point; NaN if it has none.
    pub fn value(&mut self, output: usize) -> f64 {
        let Some(memory) = &mut self.memory else {
            return f64::NAN;
        };
        let (scratch, outcomes) = (&mut memory.scratch, &mut memory.outcomes);
        // This fails if no rule fires and `when_no_rule_fires` of an output is `error`.
        let evaluated = self.engine.evaluate_with(scratch, &memory.point, outcomes);
        let outcome = evaluated.ok().and_then(|()| memory.outcomes.get(output));
        outcome.and_then(Outcome::value).unwrap_or(f64::NAN)
    }
}
