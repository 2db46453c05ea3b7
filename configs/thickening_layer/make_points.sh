#!/usr/bin/env bash
# Makes starch.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A layer 1 mm high, half of its volume starch of 1600 kg/m3; its speed grows from the floor to 1 m/s.
# Cells of 0.125 mm with 2 points a direction.
pygen block --type 2 --min 0 0 --max 0.0005 0.001 --spacing 0.0000625 --density 800 \
  --velocity "1000*y" 0 -o starch.points
