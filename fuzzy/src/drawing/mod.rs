//! Drawings of rule sets, as SVG and as text.
//!
//! All functions take plain data and return text. They open no files, and do not depend on a terminal or a graphics
//! library.
//!
//! | drawing | as SVG | as text |
//! |---|---|---|
//! | the terms of a variable | [`terms_svg`] | |
//! | the terms of all variables | [`variables_svg`] | [`variables_text`] |
//! | the differences between the terms of two models | [`moved_svg`] | |
//! | an explanation of an evaluation | [`explanation_svg`] | [`explanation_text`] |
//! | rules that do not fire, and the nearest changes | | [`silent_text`], [`what_if_text`] |
//! | a decision map, or a part of it ([`Slice`]) | [`map_svg`], [`surface_svg`] | [`map_text`], [`values_text`] |
//! | the dominant rule in each part of a map | [`rules_svg`] | [`rules_text`] |
//! | line plots ([`Plot`]) | [`plots_svg`] | |
//!
//! Names and texts in a drawing are escaped: they can neither add markup nor control a terminal ([`visible`]).
//!
//! # Example: the terms of a variable, with their degrees at 8
//! ```
//! use fuzzy::model::{MembershipFunction, Variable};
//!
//! let service = Variable::new("service", 0.0, 10.0)
//!     .term("poor", MembershipFunction::Triangle { left: 0.0, peak: 0.0, right: 5.0 })
//!     .term("good", MembershipFunction::Triangle { left: 0.0, peak: 5.0, right: 10.0 });
//! let svg = fuzzy::drawing::terms_svg(&service, Some(8.0));
//! assert!(svg.starts_with("<svg ") && svg.contains("good 0.4"));
//! ```

mod colour;
mod contour;
mod document;
mod explanation;
mod explanation_text;
mod heat;
mod map_text;
mod plot;
mod reasons_text;
mod regions;
mod scale;
mod slice;
mod surface;
mod text;
mod variables;

pub use colour::{Colour, distinct, distinct_line, output_colour, reds, viridis};
pub use document::{Anchor, Frame, SvgDocument};
pub use explanation::{explanation_svg, terms_svg};
pub use explanation_text::explanation_text;
pub use heat::{map_svg, runs};
pub use map_text::{map_text, rules_text, values_text};
pub use plot::{Plot, PlotLine, plots_svg};
pub use reasons_text::{silent_text, what_if_text};
pub use regions::rules_svg;
pub use scale::Scale;
pub use slice::{Axis, Cell, Slice};
pub use surface::surface_svg;
pub use text::{EscapedText, bar, block, number, short, visible, visible_lines};
pub use variables::{moved_svg, variables_svg, variables_text};
