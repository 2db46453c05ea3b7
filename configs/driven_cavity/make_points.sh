#!/usr/bin/env bash
# Makes glycerine.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A square of 0.1 m. Cells of 0.005 m with 2 points a direction.
pygen block --type 2 --min 0 0 --max 0.1 0.1 --spacing 0.0025 --density 1260 -o glycerine.points
