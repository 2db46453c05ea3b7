#!/usr/bin/env bash
# Makes ramp.msh and disc.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A box whose floor falls by 0.5 m in each metre; squares of 0.05 m, sheared, each two triangles.
pygen box-mesh --min 0 0 --max 2 0.6 --cells 40 12 --map x "y + 1 - 0.5*x" -o ramp.msh >/dev/null
# The disc touches the floor: its centre is a radius away along the normal (0.4472, 0.8944).
pygen circle --type 2 --radius 0.15 --centre 0.36708 1.0006 --spacing 0.0125 --density 1000 -o disc.points
