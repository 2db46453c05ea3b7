#!/usr/bin/env bash
# Makes left.points and right.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction; the blocks meet over half of their sides.
common=(--type 2 --spacing 0.025 --density 1000)
pygen block "${common[@]}" --min 0.2 0.6 --max 0.6 1.0 --velocity 1 0 -o left.points
pygen block "${common[@]}" --min 0.75 0.8 --max 1.15 1.2 -o right.points
