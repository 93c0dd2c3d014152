//! The list of a table's arrays, and access to single arrays.

use super::{
    Action, AntecedentStep, Axis, Base, Block, Coefficient, Conjunction, Conjunctions, Consequent,
    Curve, Dimension, Disjunction, Edge, Flank, FuzzySet, Hedge, Input, Knot, LayeredSet, Layers,
    Line, Moment, Node, Output, Pair, Point, Program, Section, SetTerm, Sizes, Strand,
};

/// Invokes `$then!` with the given tokens and the arrays of a table, each as `name: Item,` with its documentation.
///
/// [`Table`], the engine's own copy, the exports and the C interface are generated from this list. Adding an array
/// takes a line here, a line in the C header (a test compares the two), and the code that uses it. `Item` names a type
/// of this module: plain data with the memory layout of C. Every bit pattern is a valid `Item`, except for `Hedge`.
#[doc(hidden)] // Public for the exports and the C interface, which are in other packages.
#[macro_export]
macro_rules! table_arrays {
    ($then:ident! $($given:tt)*) => {
        $then! {
            $($given)*
            /// The inputs.
            inputs: Input,
            /// The limits between the intervals of inputs and axes.
            cuts: f64,
            /// The index in `lines` of the first line of each interval.
            starts: u32,
            /// The terms of inputs, as straight lines on intervals.
            lines: Line,
            /// The terms of inputs that are curved or hedged.
            curves: Curve,
            /// The corners of piecewise linear curves, and the code of formulas.
            points: Point,
            /// The hedges of curves.
            hedges: Hedge,
            /// The inputs of a uniform table, in the order of its axes.
            axes: Axis,
            /// The inputs of a dense table, in the order of its dimensions.
            dimensions: Dimension,
            /// The index in `actions` of the first action of each cell of a dense table, followed by the end of the
            /// last cell's actions.
            cells: u32,
            /// The nodes of a trie.
            nodes: Node,
            /// The edges of a trie.
            edges: Edge,
            /// The actions of rules.
            actions: Action,
            /// The rules that no table or trie contains.
            programs: Program,
            /// The steps of programs.
            steps: AntecedentStep,
            /// The rule blocks, if they have activation methods or different operators. In that case all rules are
            /// programs.
            blocks: Block,
            /// The outputs.
            outputs: Output,
            /// The closed forms of partitions.
            pairs: Pair,
            /// The closed forms of sets of straight terms that are cut.
            layered_sets: LayeredSet,
            /// The bases from which the layers of layered sets start.
            bases: Base,
            /// The layers of layered sets.
            layers: Layers,
            /// The closed forms of sums of products.
            moments: Moment,
            /// The Takagi-Sugeno consequents.
            consequents: Consequent,
            /// The coefficients of consequents.
            coefficients: Coefficient,
            /// The prepared fuzzy sets.
            sets: FuzzySet,
            /// The terms of sets, one for each firing strength.
            set_terms: SetTerm,
            /// The sections into which the ranges of sets are divided.
            sections: Section,
            /// The strands: terms on sections.
            strands: Strand,
            /// The flanks of the terms of sets.
            flanks: Flank,
            /// The knots, which tabulate the tails of flanks.
            knots: Knot,
        }
    };
}
pub use table_arrays as arrays;

macro_rules! define {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        /// A compiled rule set. See the [module documentation](super).
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Table<'a> {
            /// The conjunction for AND.
            pub and: Conjunction,
            /// The disjunction for OR.
            pub or: Disjunction,
            /// The data structure that finds the firing rules among plain ANDs.
            pub conjunctions: Conjunctions,
            /// The least firing strength: smaller ones count as 0.
            pub least_strength: f64,
            /// The sizes of the scratch memory.
            pub sizes: Sizes,
            $($(#[$doc])* pub $array: &'a [$item],)*
        }

        /// Access to single arrays of a table. The engine evaluates through its own vectors; collecting all of them
        /// into a [`Table`] would copy the pointer and the length of each array in every evaluation.
        pub(crate) trait Arrays {
            fn and(&self) -> Conjunction;
            fn or(&self) -> Disjunction;
            fn conjunctions(&self) -> Conjunctions;
            fn least_strength(&self) -> f64;
            $(fn $array(&self) -> &[$item];)*
        }
    };
}
arrays!(define!);

/// Implements [`Arrays`] for a struct that has fields of these names.
macro_rules! arrays_from_fields {
    ($owner:ty; $($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        impl $crate::table::Arrays for $owner {
            #[inline(always)]
            fn and(&self) -> $crate::table::Conjunction {
                self.and
            }
            #[inline(always)]
            fn or(&self) -> $crate::table::Disjunction {
                self.or
            }
            #[inline(always)]
            fn conjunctions(&self) -> $crate::table::Conjunctions {
                self.conjunctions
            }
            #[inline(always)]
            fn least_strength(&self) -> f64 {
                self.least_strength
            }
            $(
                #[inline(always)]
                fn $array(&self) -> &[$item] {
                    &self.$array
                }
            )*
        }
    };
}
pub(crate) use arrays_from_fields;

arrays!(arrays_from_fields! Table<'_>;);
