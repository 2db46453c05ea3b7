#!/usr/bin/env bash
# Makes plate.points and block.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction; the plate stands on the floor and is higher than the block.
common=(--type 2 --spacing 0.025 --density 1000)
pygen block "${common[@]}" --min 0.1 0 --max 0.2 0.35 -o plate.points
pygen block "${common[@]}" --min 0.25 0 --max 0.55 0.2 -o block.points
