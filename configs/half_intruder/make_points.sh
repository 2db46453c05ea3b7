#!/usr/bin/env bash
# Makes half.points, sand.points and water.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# The left third of the scene two_intruders.
common=(--type 2 --spacing 0.005)
pygen fill "half_circle((0, 0.14), 0.03)" "${common[@]}" --density 5000 -o half.points
pygen block "${common[@]}" --min 0 0 --max 0.06 0.1 --density 1500 -o sand.points
pygen block "${common[@]}" --min 0 0 --max 0.06 0.1 --density 400 -o water.points
