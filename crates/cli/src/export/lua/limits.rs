//! Limits of ArduPilot that a large profile may exceed. They are checked before a script is written, so that it does
//! not fail on the vehicle. The tests compare the constant parts of the script with these limits.

use super::UnsupportedFeature;

/// Maximum number of local variables of a function. ArduPilot's Lua allows 100.
const LOCALS: usize = 90;
/// Maximum number of conditions of a rule: a call may take a register for each, and a function has 250.
const CONDITIONS: usize = 100;
/// Maximum number of instructions of a call. `SCR_VM_I_COUNT` is 10,000 by default.
const INSTRUCTIONS: usize = 9_900;
/// Maximum memory of a script in bytes. `SCR_HEAP_SIZE` is 204,800 bytes by default on boards with much memory. With 64-bit
/// pointers, as in the simulator, ArduPilot itself takes 25,000 bytes of it, and loading a script temporarily takes 11,000
/// bytes more.
const HEAP_BYTES: usize = 166_000;

/// The sizes of the parts of a script that depend on the profile.
#[derive(Debug, Default)]
pub(super) struct Size {
    /// The number of local variables of the function that processes a sample.
    pub(super) locals: usize,
    /// The largest number of conditions in a rule.
    pub(super) conditions: usize,
    pub(super) windows: usize,
    /// The number of window statistics.
    pub(super) rows: usize,
    /// The number of values that windows store.
    pub(super) numbers: usize,
    pub(super) rules: usize,
    /// The number of terms of inputs.
    pub(super) terms: usize,
    /// The number of values at the knots of filled gaps.
    pub(super) filled: usize,
    /// The number of characters of code that stays in memory, without comments and indentation.
    pub(super) code: usize,
}

impl Size {
    /// Adds the size of the code of a part.
    pub(super) fn add_code(&mut self, part: &str) {
        let code = part
            .lines()
            .map(|line| line.split("--").next().unwrap_or_default().trim());
        self.code += code.map(|code| code.len() + 1).sum::<usize>();
    }

    /// Estimates the maximum number of instructions of a call.
    fn instructions(&self) -> usize {
        2_600 + 330 * self.windows + 250 * self.rows + 28 * self.rules + 25 * self.terms
    }

    /// Estimates the bytes that the script keeps in memory with 64-bit pointers.
    fn bytes(&self) -> usize {
        let (code, number, window, row) = (3.2, 16, 1_600, 420);
        (self.code as f64 * code) as usize
            + number * (self.numbers + self.filled)
            + window * self.windows
            + row * self.rows
    }

    /// Returns an error if a limit is exceeded.
    pub(super) fn check(&self) -> Result<(), UnsupportedFeature> {
        let Size {
            locals, conditions, ..
        } = self;
        let (instructions, bytes) = (self.instructions(), self.bytes());
        let too_many = |what: String, help| Err(UnsupportedFeature::new(what, help));
        if *locals > LOCALS {
            return too_many(
                format!(
                    "the script would have {locals} local variables in a function, but ArduPilot's Lua allows {LOCALS}"
                ),
                "use fewer inputs, or inputs with the same signal",
            );
        }
        if *conditions > CONDITIONS {
            return too_many(
                format!(
                    "a rule has {conditions} conditions, but ArduPilot's Lua has registers for {CONDITIONS}"
                ),
                "split the rule into rules with the same consequent",
            );
        }
        if instructions > INSTRUCTIONS {
            return too_many(
                format!(
                    "the script would take about {instructions} instructions per call, but ArduPilot allows {INSTRUCTIONS} \
                     (`SCR_VM_I_COUNT`)"
                ),
                "use fewer inputs, or inputs with the same window",
            );
        }
        if bytes > HEAP_BYTES {
            return too_many(
                format!(
                    "the script would take about {bytes} bytes, but ArduPilot has {HEAP_BYTES} for it (`SCR_HEAP_SIZE`)"
                ),
                "use fewer inputs or rules, or shorter windows",
            );
        }
        Ok(())
    }
}
