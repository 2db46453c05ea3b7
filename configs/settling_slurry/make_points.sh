#!/usr/bin/env bash
# Makes sand.points and water.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Both fill the box; cells of 0.01 m with 2 points a direction. Sand has 0.3 of the volume, with
# 2500 kg/m3, and the liquid the rest, with 1000 kg/m3.
common=(--type 2 --min 0 0 --max 0.04 0.2 --spacing 0.005)
pygen block "${common[@]}" --density 750 -o sand.points
pygen block "${common[@]}" --density 700 -o water.points
