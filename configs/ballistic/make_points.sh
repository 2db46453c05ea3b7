#!/usr/bin/env bash
# Makes wall.points and projectile.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cells of 0.025 m with 2 points a direction.
common=(--type 2 --spacing 0.0125 --density 1000)
pygen block "${common[@]}" --min 0.6 0 --max 0.8 0.5 -o wall.points
pygen circle "${common[@]}" --centre 0.15 0.35 --radius 0.075 -o projectile.points
