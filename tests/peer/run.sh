#!/bin/sh
# Runs the tests with pymavlink as the peer, in a separate Python environment under `target/`. Arguments: names of tests.
# Exits with 3 without Python.
set -eu
cd "$(dirname "$0")/../.."
venv=target/pymavlink
if [ ! -x "$venv/bin/pip" ] && ! python3 -m venv "$venv"; then
  echo "the comparison with pymavlink was skipped: it requires python3 with venv (Debian: apt-get install python3-venv)" >&2
  exit 3
fi
"$venv/bin/pip" install --quiet "pymavlink>=2.4"
FLAGRED_PYTHON="$PWD/$venv/bin/python" cargo test --workspace --test pymavlink -- --ignored "$@"
