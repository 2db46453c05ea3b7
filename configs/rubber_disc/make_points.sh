#!/usr/bin/env bash
# Makes disc.points beside this script. PYTHON names the interpreter (default python3).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root="$(cd ../.. && pwd)"
export PYTHONPATH="$root/mpm_pygen/src${PYTHONPATH:+:$PYTHONPATH}"
pygen() { "${PYTHON:-python3}" -m mpm_pygen "$@"; }

# A disc of radius 0.1 m. Cells of 0.025 m with 2 points a direction.
pygen circle --type 2 --centre 0.2 0.4 --radius 0.1 --spacing 0.0125 --density 1000 -o disc.points
