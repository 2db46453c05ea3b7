#!/usr/bin/env bash
# Makes sand.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A piece of the bed, 0.01 m long and 0.05 m high. Cells of 0.005 m with 2 points a direction.
pygen block --type 2 --min 0 0 --max 0.01 0.05 --spacing 0.0025 --density 1500 -o sand.points
