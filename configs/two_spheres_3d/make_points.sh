#!/usr/bin/env bash
# Makes sphere_0.points and sphere_1.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction.
common=(--type 3 --radius 0.15 --spacing 0.025 --density 1000)
pygen sphere "${common[@]}" --centre 0.3 0.45 0.5 --velocity 0.5 0 0 -o sphere_0.points
pygen sphere "${common[@]}" --centre 0.7 0.55 0.5 --velocity -0.5 0 0 -o sphere_1.points
