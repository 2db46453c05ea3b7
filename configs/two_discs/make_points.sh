#!/usr/bin/env bash
# Makes disc_0.points and disc_1.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction.
common=(--type 2 --radius 0.2 --spacing 0.025 --density 1000)
pygen circle "${common[@]}" --centre 0.2 0.2 --velocity 0.1 0.1 -o disc_0.points
pygen circle "${common[@]}" --centre 0.8 0.8 --velocity -0.1 -0.1 -o disc_1.points
