#!/bin/sh
# Compares the values of exported FCL in PyIT2FLS, and its intervals of type-2 rule sets. Exits with 3 without Python.
set -eu
cd "$(dirname "$0")/../.."
venv=target/pyit2fls
if [ ! -x "$venv/bin/pip" ] && ! python3 -m venv "$venv"; then
  echo "the comparison with PyIT2FLS was skipped: it requires python3 with venv (Debian: apt-get install python3-venv)" >&2
  exit 3
fi
"$venv/bin/pip" install --quiet "pyit2fls==0.9.0"
FLAGRED_PYTHON="$PWD/$venv/bin/python" cargo test -p flagred-tests --test peers pyit2fls -- --ignored
