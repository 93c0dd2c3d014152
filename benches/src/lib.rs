//! Systems and data shared by the benches.
