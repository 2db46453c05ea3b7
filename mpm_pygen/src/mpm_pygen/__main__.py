"""`python -m mpm_pygen`: the command `mpm-pygen`."""

import sys

from mpm_pygen.cli import main

sys.exit(main())
