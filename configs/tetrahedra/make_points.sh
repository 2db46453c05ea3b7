#!/usr/bin/env bash
# Makes box.msh and ball.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# Cubes of 0.1 m, each six tetrahedra.
pygen box-mesh --min 0 0 0 --max 0.8 0.8 1 --cells 8 8 10 -o box.msh >/dev/null
pygen sphere --type 3 --centre 0.4 0.4 0.62 --radius 0.15 --spacing 0.05 --density 1000 --velocity 0 0 -2 -o ball.points
