#!/usr/bin/env bash
# Makes fish.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A fish 0.4 m long. Cells of 0.025 m with 2 points a direction.
pygen block --type 2 --min 0.2 0.175 --max 0.6 0.225 --spacing 0.0125 --density 1000 -o fish.points
