//! The exported rule set as C data.

use flagred::board::{
    self,
    table::{
        self, Action, AntecedentStep, Axis, Base, Block, Coefficient, Conjunction, Conjunctions,
        Consequent, Curve, Dimension, Disjunction, Edge, Flank, FuzzySet, Hedge, Input, Knot,
        LayeredSet, Layers, Line, Moment, Node, Output, Pair, Point, Program, Section, SetTerm,
        Sizes, Stage, Strand, Table,
    },
};

use crate::{array::Array, status::Status};

/// The version of the exported data that this library supports.
pub(crate) const FORMAT: u32 = 11;

macro_rules! define {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        /// An exported rule set: `struct flagred_rules` in C.
        #[derive(Debug)]
        #[repr(C)]
        pub(crate) struct Rules {
            pub(crate) format: u32,
            pub(crate) and: u32,
            pub(crate) or: u32,
            pub(crate) conjunctions: u32,
            pub(crate) actions_per_cell: u32,
            pub(crate) first_action: u32,
            pub(crate) sums: u32,
            pub(crate) sizes: Sizes,
            pub(crate) least_strength: f64,
            $(pub(crate) $array: Array<define!(@item $item)>,)*
            pub(crate) stages: Array<Stage>,
            pub(crate) indices: Array<u32>,
        }

        impl Rules {
            /// # Safety
            /// The arrays must have the stated lengths, and must not change.
            #[allow(unsafe_code, reason = "foreign memory")]
            pub(crate) unsafe fn read<'a>(&self) -> Result<board::Rules<'a>, Status> {
                if self.format != FORMAT {
                    return Err(Status::OtherFormat);
                }
                // SAFETY: the caller's promise about all arrays.
                unsafe {
                    Ok(board::Rules {
                        table: Table {
                            and: conjunction(self.and)?,
                            or: disjunction(self.or)?,
                            conjunctions: self.conjunctions()?,
                            least_strength: self.least_strength,
                            sizes: self.sizes,
                            $($array: define!(@read $item self.$array),)*
                        },
                        stages: self.stages.read()?,
                        indices: self.indices.read()?,
                    })
                }
            }
        }
    };
    // The codes of hedges are verified before they are reinterpreted as `Hedge`, which is an enumeration. For all
    // other items every bit pattern is valid.
    (@item Hedge) => { u32 };
    (@item $item:ident) => { $item };
    (@read Hedge $array:expr) => { hedges($array.read()?)? };
    (@read $item:ident $array:expr) => { $array.read()? };
}
table::arrays!(define!);

impl Rules {
    fn conjunctions(&self) -> Result<Conjunctions, Status> {
        let code = [
            self.conjunctions,
            self.actions_per_cell,
            self.first_action,
            self.sums,
        ];
        Conjunctions::from_code(code).ok_or(Status::DamagedPlan)
    }
}

/// Converts codes to hedges, if all codes are valid.
#[allow(unsafe_code, reason = "foreign memory")]
fn hedges(codes: &[u32]) -> Result<&[Hedge], Status> {
    if codes.iter().any(|code| *code as usize >= Hedge::ALL.len()) {
        return Err(Status::DamagedPlan);
    }
    // SAFETY: a `Hedge` has the size of a `u32`, and all codes are below the number of hedges, so each is a valid
    // `Hedge`.
    Ok(unsafe { core::slice::from_raw_parts(codes.as_ptr().cast(), codes.len()) })
}

pub(crate) fn conjunction(code: u32) -> Result<Conjunction, Status> {
    let found = Conjunction::ALL.get(code as usize).copied();
    found.ok_or(Status::DamagedPlan)
}

pub(crate) fn disjunction(code: u32) -> Result<Disjunction, Status> {
    let found = Disjunction::ALL.get(code as usize).copied();
    found.ok_or(Status::DamagedPlan)
}
