#!/usr/bin/env bash
# Makes block.points and slider.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction.
common=(--type 5 --spacing 0.025 --density 1000)
pygen block "${common[@]}" --min 0.1 0 --max 0.9 0.2 -o block.points
pygen block "${common[@]}" --min 0.3 0.2 --max 0.7 0.4 --velocity 0 0 1 -o slider.points
