#!/usr/bin/env bash
# Makes bar_0.points and bar_1.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.02 m with 2 points.
common=(--type 1 --spacing 0.01 --density 1000)
pygen block "${common[@]}" --min 0.1 --max 0.4 --velocity 1 -o bar_0.points
pygen block "${common[@]}" --min 0.5 --max 0.8 -o bar_1.points
