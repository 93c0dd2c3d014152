//! The C interface for evaluating a rule set without a profile.

use flagred::board::{
    self, Evaluator, RuleMemory,
    table::{self, PartialConjunction, State, StrongestRule},
};

use crate::{array::Array, memory::Block, rules::Rules, status::Status};

/// An evaluator of a rule set: `struct flagred_evaluator` in C.
#[derive(Debug)]
pub(crate) struct CEvaluator(Evaluator<'static>);

/// The outcome of one output: `struct flagred_outcome` in C.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct COutcome {
    value: f64,
    low: f64,
    high: f64,
    coverage: f64,
    state: i32,
    dominant_rule: i32,
    clamped: i32,
}

impl COutcome {
    fn of(outcome: &table::Outcome) -> COutcome {
        let dominant = outcome.dominant_rule.map(|rule| i32::try_from(rule).ok());
        COutcome {
            value: outcome.value().unwrap_or(f64::NAN),
            low: outcome.low().unwrap_or(f64::NAN),
            high: outcome.high().unwrap_or(f64::NAN),
            coverage: outcome.coverage,
            state: match outcome.state {
                State::Defined(_) | State::Interval { .. } => 0,
                // `Previous` occurs only in sequences of evaluations.
                State::Default(_) | State::Previous(_) => 1,
                State::NoRuleFired => 2,
                State::InputNotFinite => 3,
            },
            dominant_rule: dominant.flatten().unwrap_or(-1),
            clamped: outcome.clamped.into(),
        }
    }
}

/// The size of an evaluator's memory in bytes; 0 for invalid rules.
///
/// # Safety
/// `rules` must be null or point to rules whose arrays have the stated lengths.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub(crate) unsafe extern "C" fn flagred_rules_memory_size(rules: *const Rules) -> usize {
    // SAFETY: the caller's promise; the arrays are used in this call only.
    let rules = unsafe { rules.as_ref().map(|rules| rules.read()) };
    let rules = rules.and_then(Result::ok);
    rules.map_or(0, |rules| rules.bytes())
}

/// Creates an evaluator of a rule set.
///
/// # Safety
/// `rules` must be null or point to rules whose arrays have the stated lengths; `memory` must be null or have `size`
/// bytes that nothing else uses; `evaluator` must be null or writable. The rules and the memory must outlive the
/// evaluator.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub(crate) unsafe extern "C" fn flagred_rules_start(
    rules: *const Rules,
    memory: *mut u8,
    size: usize,
    evaluator: *mut *mut CEvaluator,
) -> i32 {
    // SAFETY: the caller's promises, passed on.
    let started = unsafe { start(rules, memory, size) };
    if evaluator.is_null() {
        return Status::NullPointer as i32;
    }
    let (status, started) = match started {
        Ok(started) => (Status::Ok, started),
        Err(status) => (status, core::ptr::null_mut()),
    };
    // SAFETY: not null, and writable by the caller's promise.
    unsafe { evaluator.write(started) };
    status as i32
}

/// # Safety
/// As [`flagred_rules_start`].
#[allow(unsafe_code, reason = "foreign memory")]
unsafe fn start(
    rules: *const Rules,
    memory: *mut u8,
    size: usize,
) -> Result<*mut CEvaluator, Status> {
    // SAFETY: the caller's promises: the rules outlive the evaluator, and nothing else uses the memory.
    let (rules, mut block) = unsafe {
        let rules = rules.as_ref().ok_or(Status::NullPointer)?;
        (rules.read()?, Block::new(memory, size)?)
    };
    if size < rules.bytes() {
        return Err(Status::MemorySize);
    }
    rules.check().map_err(|_| Status::DamagedPlan)?;
    let rules: &'static board::Rules<'static> = block.store(rules)?;
    let outputs = rules.outputs();
    let memory = RuleMemory {
        numbers: block.fill(rules.numbers(), 0.0)?,
        partials: block.fill(rules.partials(), PartialConjunction::NONE)?,
        strongest: block.fill(rules.table.outputs.len(), StrongestRule::NONE)?,
        outcomes: block.fill(outputs, table::Outcome::UNDEFINED)?,
        own: block.fill(outputs, table::Outcome::UNDEFINED)?,
    };
    let evaluator = Evaluator::new(rules, memory).ok_or(Status::DamagedPlan)?;
    block.store(CEvaluator(evaluator)).map(core::ptr::from_mut)
}

/// Evaluates one value for each input, and writes one outcome for each output.
///
/// # Safety
/// `evaluator` must be null or from [`flagred_rules_start`]; `inputs` must be null or have `input_count` items;
/// `outcomes` must be null or have space for `output_count` items.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "foreign memory")]
pub(crate) unsafe extern "C" fn flagred_rules_evaluate(
    evaluator: *mut CEvaluator,
    inputs: *const f64,
    input_count: usize,
    outcomes: *mut COutcome,
    output_count: usize,
) -> i32 {
    let inputs = Array {
        items: inputs,
        count: input_count,
    };
    // SAFETY: the caller's promises; the inputs are used in this call only.
    let (evaluator, inputs) = unsafe { (evaluator.as_mut(), inputs.read()) };
    let (Some(evaluator), Ok(inputs), false) = (evaluator, inputs, outcomes.is_null()) else {
        return Status::NullPointer as i32;
    };
    let evaluated = evaluator.0.evaluate(inputs);
    let Some(evaluated) = evaluated.filter(|all| all.len() == output_count) else {
        return Status::WrongCount as i32;
    };
    for (i, outcome) in evaluated.iter().enumerate() {
        // SAFETY: the caller promises space for this number of outcomes.
        unsafe { outcomes.add(i).write(COutcome::of(outcome)) };
    }
    Status::Ok as i32
}
