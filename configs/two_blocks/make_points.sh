#!/usr/bin/env bash
# Makes block_0.points and block_1.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction.
common=(--type 2 --spacing 0.025 --density 1000)
pygen block "${common[@]}" --min 0.35 0 --max 0.65 0.3 -o block_0.points
pygen block "${common[@]}" --min 0.1 0.5 --max 0.3 0.7 --velocity 1 0 -o block_1.points
