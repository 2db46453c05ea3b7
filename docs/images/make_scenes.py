#!/usr/bin/env python3
"""Draw the pictures of the scenes, each with the command that the README of its scene shows.

usage: make_scenes.py OUTPUT [SCENE ...], the folder that has a folder of frames for each scene.
Needs what mpm_pygen needs for pictures; PYTHONPATH has mpm_pygen/src.
"""

import re
import shlex
import sys
from pathlib import Path

from mpm_pygen.cli import main as mpm_pygen

IMAGES = Path(__file__).resolve().parent
CONFIGS = IMAGES.parents[1] / "configs"
COMMAND = re.compile(r"^    mpm-pygen (view output/(\w+) .*)$", re.MULTILINE)


def main() -> None:
    """Draw the pictures beside this script."""
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    output, *wanted = sys.argv[1:]
    for readme in sorted(CONFIGS.glob("*/README.md")):
        command = COMMAND.search(readme.read_text("utf-8"))
        if command is None or (wanted and command[2] not in wanted):
            continue
        words = shlex.split(command[1])
        words[1] = str(Path(output) / command[2])
        picture = str(IMAGES / f"{command[2]}.png")
        if mpm_pygen([*words, "--few-colours", "255", "-o", picture]) != 0:
            sys.exit(1)


if __name__ == "__main__":
    main()
