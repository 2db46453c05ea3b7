#!/usr/bin/env bash
# Makes block.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction.
pygen block --type 2 --spacing 0.025 --density 1000 --min 0.1 0 --max 0.4 0.15 --velocity 1 0 \
  -o block.points
