#!/bin/sh
# Compares the values of exported rule sets in fuzzylite's Python library. Exits with 3 without Python.
set -eu
cd "$(dirname "$0")/../.."
venv=target/fuzzylite
if [ ! -x "$venv/bin/pip" ] && ! python3 -m venv "$venv"; then
  echo "the comparison with fuzzylite was skipped: it requires python3 with venv (Debian: apt-get install python3-venv)" >&2
  exit 3
fi
"$venv/bin/pip" install --quiet "numpy<2" "pyfuzzylite==8.0.6"
FLAGRED_PYTHON="$PWD/$venv/bin/python" cargo test -p flagred-tests --test peers pyfuzzylite -- --ignored
