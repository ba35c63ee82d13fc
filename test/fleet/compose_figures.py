#!/usr/bin/env python3
"""compose_figures.py [SECURITY RUN FOLDER]: a line for each robot of a run of deploy/docker/up.sh, and
one for its localizers. Without words the line above them.

chosen:   since its log began, when the robot had its localizer [s]
answer:   since its first frame, when it had the first answer [s]
ate:      median error of what was localized [m]; covered: see deploy/README.md
up, down: on the wire, of the whole run [KB/s]
cpu:      processor time [s], of a second of the run [%]
"""

import json
import re
import sys
from datetime import datetime
from pathlib import Path

HEADER = "security run who chosen answer ate covered up down cpu load".split()
STAMP = re.compile(r"\[?(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d+)\]?")


def line(*cells):
    print("".join(f"{cell:>12}" if i == 2 else f"{cell:>9}" for i, cell in enumerate(cells)))


def chosen_after_s(log):
    """Throws ValueError if no localizer was ever chosen."""
    begin = None
    for text in log.read_text().splitlines():
        match = STAMP.search(text)
        if not match:
            continue
        stamp = datetime.fromisoformat(match[1])
        begin = begin or stamp
        if re.search(r": localizer \S+, started as", text):
            return (stamp - begin).total_seconds()
    raise ValueError(f"{log}: no localizer was chosen")


def robot(security, run, folder):
    name = folder.name
    summary = json.loads((folder / "summary.json").read_text())
    evaluation = json.loads((folder / "evaluation.json").read_text())
    wall_s = summary["wall_s"]
    line(
        security,
        run,
        name,
        f"{chosen_after_s(folder.parent / f'{name}.log'):.1f}",
        f"{summary['first_answer_s']:.1f}",
        f"{evaluation['ate']['median']:.3f}",
        f"{evaluation['covered']:.2f}",
        f"{summary['uplink_wire_bytes'] / wall_s / 1e3:.2f}",
        f"{summary['downlink_wire_bytes'] / wall_s / 1e3:.2f}",
        f"{summary['cpu_s']:.1f}",
        f"{100 * summary['cpu_s'] / wall_s:.0f}",
    )


def main():
    if len(sys.argv) == 1:
        line(*HEADER)
        return
    security, run, out = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    robots = sorted(p.parent for p in out.glob("*/evaluation.json"))
    for folder in robots:
        robot(security, run, folder)
    for file in sorted(out.glob("localizer_*.cpu_s")):
        line(security, run, file.stem, *["-"] * 6, file.read_text().strip(), "-")


main()
