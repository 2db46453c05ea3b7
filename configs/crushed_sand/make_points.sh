#!/usr/bin/env bash
# Makes sand.points and piston.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Sand of porosity 0.4 under a piston, in a box of 0.04 m. Cells of 0.01 m with 2 points a direction.
common=(--type 2 --spacing 0.005 --density 1590)
pygen block "${common[@]}" --min 0 0 --max 0.04 0.08 -o sand.points
pygen block "${common[@]}" --min 0 0.08 --max 0.04 0.1 -o piston.points
