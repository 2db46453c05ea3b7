"""Speed of mpm3d: whole runs of fixed scenes, a bare kernel, and counts of instructions."""
