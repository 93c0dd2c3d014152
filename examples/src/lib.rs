//! The numbered examples; each one is a page and a test.
