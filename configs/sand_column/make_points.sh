#!/usr/bin/env bash
# Makes sand.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Half of a column, 0.1 m wide and 0.2 m high. Cells of 0.01 m with 2 points a direction.
pygen block --type 2 --min 0 0 --max 0.1 0.2 --spacing 0.005 --density 1500 -o sand.points
