#!/usr/bin/env bash
# Makes ball.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.025 m with 2 points a direction; in TYPE 4 a sphere is the half circle r > 0.
pygen sphere --type 4 --centre 0 0.3 --radius 0.2 --spacing 0.0125 --density 1000 -o ball.points
