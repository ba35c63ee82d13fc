#!/usr/bin/env python3
"""Decodes answers of the compact encoding with their corrections, from idl/README.md alone.

Turns are those of decode_submap.py. Reads lines of JSON {"sample": hex,
"answer": ...} and says whether it decodes each sample to the same answer, bit by bit.
"""

import json
import math
import struct
import sys

from compact_coder import Models, RangeDecoder
from decode_submap import Turns, normalized, with_numbers

LOCALIZED = 0
EIGHTHS = [
    1.0,
    1.0905077326652577,
    1.1892071150027210,
    1.2968395546510096,
    1.4142135623730951,
    1.5422108254079407,
    1.6817928305074290,
    1.8340080864093424,
]


def squared(size, scales, levels, unit):
    """Upper triangle of R^T R; `levels` are those of R's upper triangle, row by row."""
    R = [[0.0] * size for _ in range(size)]
    values = iter(levels)
    for row in range(size):
        for column in range(row, size):
            code = scales[column // 3]
            scale = math.ldexp(EIGHTHS[code % 8], code // 8)
            R[row][column] = next(values) * unit / 127.0 * scale
    out = []
    for i in range(size):
        for j in range(i, size):
            product = 0.0
            for row in range(i + 1):
                product = product + R[row][i] * R[row][j]
            out.append(product)
    return out


class Root:
    """Models of roots; each group of three columns has its scale and its own models."""

    def __init__(self, models, names):
        parts = ("scale", "diagonal", "other")
        self.groups = [[models.integer(f"{name}.{part}") for part in parts] for name in names]
        self.scales = [0] * len(names)

    def decode(self, coder):
        for i, (change, _, _) in enumerate(self.groups):
            self.scales[i] += change.signed(coder)
        size, levels = 3 * len(self.groups), []
        for row in range(size):
            for column in range(row, size):
                _, diagonal, other = self.groups[column // 3]
                levels.append((diagonal if row == column else other).signed(coder))
        return squared(size, self.scales, levels, 4)


def decode_poses(coder, models, anchor):
    poses, newest_gap = models.integer("poses"), models.integer("newest_gap")
    gap, span = models.integer("gap"), models.integer("span")
    turns, translation = Turns(models, 65536.0), models.integer("translation")
    root = Root(models, ["pose_root.0", "pose_root.1"])
    out, bound = [], anchor
    for i in range(poses.unsigned(coder)):
        to = bound - (gap if i else newest_gap).unsigned(coder)
        one = {"to": to, "from": to - 1 - span.unsigned(coder)}
        bound = to - 1
        one["rotation"] = normalized(turns.decode(coder))
        one["translation"] = [translation.signed(coder) * 0.5e-3 for _ in range(3)]
        one["information"] = root.decode(coder)
        out.insert(0, one)
    return out


def decode_landmarks(coder, models):
    landmarks, gap = models.integer("landmarks"), models.integer("landmark_gap")
    position, root = models.integers("position", 3), Root(models, ["landmark_root"])
    out, following = [], 0
    for i in range(landmarks.unsigned(coder)):
        one = {"id": following + (gap.unsigned(coder) if i else coder.raw(32))}
        following = one["id"] + 1
        one["p_anchor"] = [model.signed(coder) * 2e-3 for model in position]
        one["information"] = root.decode(coder)
        out.append(one)
    return out


def decode_corrections(block, anchor):
    coder, models = RangeDecoder(block), Models("correction")
    if coder.raw(4) != 2:
        raise ValueError("another version")
    out = {
        "relative_poses": decode_poses(coder, models, anchor),
        "landmarks": decode_landmarks(coder, models),
    }
    if coder.raw(8) != 0xA5:
        raise ValueError("garbled")
    return out


def decode_answer(data):
    body, at = data[4:], 0

    def take(kind, count=1):
        nonlocal at
        size = struct.calcsize(kind)
        at += -at % size
        values = list(struct.unpack_from(f"<{count}{kind}", body, at))
        at += size * count
        return values if count > 1 else values[0]

    def string():
        nonlocal at
        length = take("I")
        at += length
        return body[at - length : at - 1].decode()

    sample = {"robot": string(), "localizer": string()}
    take("I", 2)  # session, incarnation
    sample["number"], sample["acknowledged_base"] = take("I", 2)
    sample["acknowledged_bitmap"] = take("Q")
    sample["status"], sample["keyframe"], _ = take("I", 3)
    sample["stamp_ns"] = take("q")
    sample["window_ms"], _ = take("I", 2)
    take("B", 16)  # map
    p_map, rotation = take("d", 3), take("i", 4)
    scales, entries = take("B", 2), take("B", 21)
    sample["places"] = take("B")
    if sample["status"] == LOCALIZED:
        information = squared(6, scales, [entry - 128 for entry in entries], 1)
        sample.update(p_map=p_map, rotation=rotation, information=information)
    length = take("I")
    if length > 0:
        sample["corrections"] = decode_corrections(body[at : at + length], sample["keyframe"])
    return sample


def main():
    samples = 0
    with open(sys.argv[1], encoding="utf-8") as lines:
        for line in lines:
            vector = with_numbers(json.loads(line))
            decoded = decode_answer(bytes.fromhex(vector["sample"]))
            if decoded != vector["answer"]:
                print(f"sample {samples} differs:\n{decoded}\n{vector['answer']}")
                return 1
            samples += 1
    if Models.unused("correction"):
        print("rows of no model:", *Models.unused("correction"))
        return 1
    print(f"{samples} samples decoded to the same answers")
    return 0 if samples > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
