#!/bin/sh
# Runs the tests with pymavlink as the peer, in a Python environment of their own under `target/`.
set -eu
cd "$(dirname "$0")/../.."
venv=target/pymavlink
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet "pymavlink>=2.4"
FLAGRED_PYTHON="$PWD/$venv/bin/python" cargo test -p flagred-tests --test pymavlink
