#!/usr/bin/env bash
# Makes sand.points and water.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Half a column of sand, 0.06 m wide and high, loosely packed (0.56) in a tank of water 0.3 m by 0.08 m.
# Cells of 0.01 m with 2 points a direction. 2500 kg/m3 for grains, 1000 kg/m3 for water.
pygen block --type 2 --min 0 0 --max 0.06 0.06 --spacing 0.005 --density 1400 -o sand.points
pygen block --type 2 --min 0 0 --max 0.3 0.08 --spacing 0.005 \
  --density "440 if x < 0.06 and y < 0.06 else 1000" -o water.points
