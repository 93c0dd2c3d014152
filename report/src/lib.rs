//! What people read of rule sets and flights, whatever program shows it.
//!
//! Findings drawn in their text ([`findings`]). It gives text and opens no file.

pub mod findings;
