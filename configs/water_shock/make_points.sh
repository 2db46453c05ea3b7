#!/usr/bin/env bash
# Makes water.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Two columns that touch in the middle of the grid and fly at each other.
pygen fill "block((0.1,), (0.9,))" --type 1 --spacing 0.005 --density 998 \
  --velocity "500 if x < 0.5 else -500" -o water.points
