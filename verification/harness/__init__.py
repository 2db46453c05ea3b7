"""The harness of the verification cases: scenes, runs, norms, checks and reports."""
