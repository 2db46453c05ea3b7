#!/usr/bin/env bash
# Makes tight.points and slack.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Two rings around the axis, 0.05 m wide and high, that turn at 10 rad/s. Cells of 0.0125 m with 2
# points a direction.
common=(--type 4 --spacing 0.00625 --density 1000 --velocity 0 0 "10*r")
pygen block "${common[@]}" --min 0.475 0.025 --max 0.525 0.075 -o tight.points
pygen block "${common[@]}" --min 0.475 0.175 --max 0.525 0.225 -o slack.points
