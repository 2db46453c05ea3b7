#!/usr/bin/env bash
# Makes wheel.points and ground.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.05 m with 2 points a direction; the wheel stands a cell above the ground.
common=(--type 2 --spacing 0.025 --density 1000)
pygen circle "${common[@]}" --radius 0.2 --centre 0.4 0.45 -o wheel.points
pygen block "${common[@]}" --min 0 0 --max 2 0.2 -o ground.points
