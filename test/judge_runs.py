#!/usr/bin/env python3
"""judge_runs.py MIN_COVERED FOLDER...: fails if one of the run folders, which fleetloc-eval has looked
at, is covered for a smaller share of its frames, or was ever wrong and sure of it."""

import json
import sys
from pathlib import Path


def main():
    least = float(sys.argv[1])
    failures = 0
    for folder in sys.argv[2:]:
        errors = json.loads((Path(folder) / "evaluation.json").read_text())
        wrong = errors["confidence"]["confidently_wrong"]
        said = f"{folder}: covered {errors['covered']:.2f}, wrong and sure in {wrong} frames"
        is_good = errors["covered"] >= least and wrong == 0
        print(said if is_good else f"FAILED: {said}")
        failures += not is_good
    return 1 if failures else 0


if len(sys.argv) < 3:
    sys.exit(__doc__)
sys.exit(main())
