#!/bin/sh
# Compares the values of exported rule sets in Octave's fuzzy-logic-toolkit. Exits with 3 without Octave
# (Debian: apt-get install octave octave-fuzzy-logic-toolkit, 126 MB).
set -eu
cd "$(dirname "$0")/../.."
if ! octave-cli --quiet --eval 'pkg load fuzzy-logic-toolkit' > /dev/null 2>&1; then
  echo "the comparison with Octave was skipped: it requires octave with the fuzzy-logic-toolkit" >&2
  exit 3
fi
cargo test -p flagred-tests --test peers octave -- --ignored
