#!/usr/bin/env bash
# The language server with a real editor: Neovim opens a rule set with a mistake, requests completion, renames a term.
# Exits with 3 without Neovim.
set -euo pipefail
cd "$(dirname "$0")/../.."

command -v nvim > /dev/null || { echo "no nvim: not tried" >&2; exit 3; }
cargo build --quiet --package flagred-cli
PATH="$PWD/target/debug:$PATH"
export PATH

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed 's/IS slow/IS slwo/' > "$work/fan.yaml" << 'RULES'
fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 100], partition: [low, high]}
outputs:
  speed: {range: [0, 9], partition: [slow, fast]}
rules:
  - IF heat IS low THEN speed IS slow
  - IF heat IS high THEN speed IS fast
RULES
timeout 60 nvim --headless --clean -S tests/peer/neovim.lua "$work/fan.yaml"
