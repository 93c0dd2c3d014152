//! Helpers shared by the tests that cross packages; the tests themselves are in `tests/tests/`.
