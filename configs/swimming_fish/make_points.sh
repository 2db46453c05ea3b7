#!/usr/bin/env bash
# Makes fish.points and water.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A fish 0.4 m long in a box of 0.8 m by 0.4 m full of water. Cells of 0.025 m with 2 points a direction.
common=(--type 2 --spacing 0.0125 --density 1000)
fish="block((0.2, 0.175), (0.6, 0.225))"
pygen fill "$fish" "${common[@]}" -o fish.points
pygen fill "block((0, 0), (0.8, 0.4)) - $fish" "${common[@]}" -o water.points
