#!/usr/bin/env bash
# Makes half.points, whole.points, sand.points and water.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Half a cylinder at the wall and a whole one above a bed of wet sand, 0.1 m high; 0.6 of its volume are
# grains. Cells of 0.01 m with 2 points a direction. 5000, 2500 and 1000 kg/m3.
common=(--type 2 --spacing 0.005)
pygen fill "half_circle((0, 0.14), 0.03)" "${common[@]}" --density 5000 -o half.points
pygen circle "${common[@]}" --centre 0.12 0.14 --radius 0.03 --density 5000 -o whole.points
pygen block "${common[@]}" --min 0 0 --max 0.18 0.1 --density 1500 -o sand.points
pygen block "${common[@]}" --min 0 0 --max 0.18 0.1 --density 400 -o water.points
