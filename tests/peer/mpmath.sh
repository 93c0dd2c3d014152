#!/bin/sh
# Computes the values of random rule sets with numbers of 80 digits, in Python. Exits with 3 without Python.
set -eu
cd "$(dirname "$0")/../.."
venv=target/mpmath
if [ ! -x "$venv/bin/pip" ] && ! python3 -m venv "$venv"; then
  echo "the comparison with mpmath was skipped: it requires python3 with venv (Debian: apt-get install python3-venv)" >&2
  exit 3
fi
"$venv/bin/pip" install --quiet "mpmath==1.4.1" "gmpy2==2.3.2"
FLAGRED_PYTHON="$PWD/$venv/bin/python" cargo test -p flagred-tests --test oracle -- --ignored mpmath
