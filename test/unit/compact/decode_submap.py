#!/usr/bin/env python3
"""Decodes samples of the compact encoding, from idl/README.md alone.

A second implementation of the specification: it shares nothing with the C++ one. Reads lines of
JSON {"stereo": ..., "sample": hex, "submap": ...} and says whether it decodes each sample to the
same submap, bit by bit. Doubles are written in hexadecimal, so nothing is rounded.
"""

import json
import math
import struct
import sys

from compact_coder import Models, RangeDecoder


# Rotations are w, x, y, z; matrices are rows. The order of the operations is part of the format.


def normalized(q):
    n = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return [c / n for c in q]


def times(a, b):
    return [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]


def conjugate(q):
    return [q[0], -q[1], -q[2], -q[3]]


def matrix(q):
    w, x, y, z = q
    return [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]


def apply(R, v):
    return [row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in R]


def apply_transposed(R, v):
    return [R[0][c] * v[0] + R[1][c] * v[1] + R[2][c] * v[2] for c in range(3)]


def compose(A, B):
    return [
        [A[r][0] * B[0][c] + A[r][1] * B[1][c] + A[r][2] * B[2][c] for c in range(3)]
        for r in range(3)
    ]


def plus(a, b):
    return [a[i] + b[i] for i in range(3)]


def minus(a, b):
    return [a[i] - b[i] for i in range(3)]


def rounded(value, low, high):
    if not value > low:
        return low
    return high if value >= high else math.floor(value + 0.5)


def sigma_of(code):
    eighth = [1.0, 0.84089641525371454, 0.70710678118654752, 0.59460355750136053]
    return math.ldexp(16.0 * eighth[(code - 1) % 4], -((code - 1) // 4))


class Turns:
    def __init__(self, models, units):
        self.units = units
        self.is_far = models.bit("turn.is_far")
        self.others = models.integers("turn.others", 3)

    def decode(self, coder):
        largest = coder.raw(2) if coder.bit(self.is_far) else 0
        others = [model.signed(coder) for model in self.others]
        q, rest = [0.0] * 4, 1.0
        for i in range(4):
            if i != largest:
                q[i] = others.pop(0) / self.units
                rest = rest - q[i] * q[i]
        q[largest] = math.sqrt(rest)
        return q


class Predictor:
    def __init__(self, stereo, step_bits, poses):
        scale = float(1 << step_bits)
        self.focal = stereo["focal_px"] * scale
        self.cu, self.cv = (c * scale for c in stereo["center_px"])
        self.baseline = stereo["baseline_m"]
        self.max_steps = int(2048.0 * scale) - 1
        self.center = [rounded(c, 0, self.max_steps) for c in (self.cu, self.cv)]
        R, p = matrix(normalized(stereo["rotation"])), stereo["translation"]
        self.cameras = [(compose(A, R), plus(a, apply(A, p))) for A, a in poses]

    def predict(self, track, index):
        (R_from, p_from), (R_to, p_to) = self.cameras[track["keyframe"]], self.cameras[index]
        u, v, _ = track["last"]
        ray = [(u - self.cu) / self.focal, (v - self.cv) / self.focal, 1.0]
        if track["disparity"] > 0.0:
            depth = self.focal * self.baseline / track["disparity"]
            p_odom = plus(p_from, apply(R_from, [c * depth for c in ray]))
            p = apply_transposed(R_to, minus(p_odom, p_to))
        else:
            p = apply_transposed(R_to, apply(R_from, ray))
        if not p[2] > 0.05:
            return u, v, track["disparity"]
        return (
            rounded(self.cu + self.focal * p[0] / p[2], 0, self.max_steps),
            rounded(self.cv + self.focal * p[1] / p[2], 0, self.max_steps),
            self.focal * self.baseline / p[2] if track["disparity"] > 0.0 else 0.0,
        )


def remember(track, observation, index, expected):
    n, observed = float(min(track["seen"], 7)), float(observation[2])
    if observation[2] == 0:
        track["disparity"] = expected
    elif expected > 0.0:
        track["disparity"] = (n * expected + observed) / (n + 1.0)
    else:
        track["disparity"] = observed
    track.update(last=observation, keyframe=index, seen=track["seen"] + 1, misses=0)


class Observations:
    def __init__(self, coder, models, predictor, stride, offset, first):
        self.coder, self.predictor, self.first = coder, predictor, first
        self.stride, self.offset = stride, offset
        self.tracks = {}
        self.observed = [models.bits(f"observed.{kind}", 3) for kind in range(3)]
        self.u, self.v = models.integers("u", 3), models.integers("v", 3)
        self.disparity = models.integers("disparity", 3)
        self.in_right = models.bits("in_right", 2)
        self.new_landmarks = models.integer("new_landmarks")
        self.first_landmark = models.integer("first_landmark")
        self.gap = models.integer("landmark_gap")
        self.new_u, self.new_v = models.integer("new_u"), models.integer("new_v")
        self.new_disparity = models.integer("new_disparity")

    def keyframe(self, index, keyframe_id):
        def is_due(landmark):
            return (landmark + keyframe_id) % self.stride == self.offset

        found = {}
        for landmark in sorted(self.tracks):
            track = self.tracks[landmark]
            if not is_due(landmark):
                continue
            kind = min(track["seen"], 3) - 1
            if self.coder.bit(self.observed[kind][track["misses"]]):
                found[landmark] = self.seen(track, kind, index)
            else:
                track["misses"] += 1
                if track["misses"] == 3:
                    del self.tracks[landmark]
        landmark = self.first
        while not is_due(landmark):
            landmark += 1
        for i in range(self.new_landmarks.unsigned(self.coder)):
            model = self.gap if i else self.first_landmark
            landmark += model.unsigned(self.coder) * self.stride
            u = self.predictor.center[0] + self.new_u.signed(self.coder)
            v = self.predictor.center[1] + self.new_v.signed(self.coder)
            in_right = self.coder.bit(self.in_right[1])
            d = 1 + self.new_disparity.unsigned(self.coder) if in_right else 0
            track = {"seen": 0, "misses": 0}
            remember(track, (u, v, d), index, 0.0)
            self.tracks[landmark] = track
            found[landmark] = (u, v, d)
            landmark += self.stride
        return [[landmark, *found[landmark]] for landmark in sorted(found)]

    def seen(self, track, kind, index):
        eu, ev, ed = self.predictor.predict(track, index)
        u = eu + self.u[kind].signed(self.coder)
        v = ev + self.v[kind].signed(self.coder)
        d = 0
        if self.coder.bit(self.in_right[1 if track["last"][2] > 0 else 0]):
            if ed > 0.0:
                near = rounded(ed, 1, self.predictor.max_steps)
                d = near + self.disparity[kind].signed(self.coder)
            else:
                d = 1 + self.new_disparity.unsigned(self.coder)
        remember(track, (u, v, d), index, ed)
        return u, v, d


def decode_poses(coder, models, keyframes):
    id_gap = models.integer("id_gap")
    interval, change = models.integer("interval"), models.integer("interval_change")
    first = models.integers("displacement", 2)
    later = models.integers("displacement_change", 2)
    turns = Turns(models, 4096.0)
    for i in range(len(keyframes) - 2, -1, -1):
        newer = keyframes[i + 1]
        is_first = i + 2 == len(keyframes)
        second = newer if is_first else keyframes[i + 2]
        one = keyframes[i]
        one["id"] = newer["id"] - id_gap.unsigned(coder) - 1
        before = newer["age"] - second["age"]
        step = before + (interval if is_first else change).signed(coder)
        one["age"] = newer["age"] + step
        one["position"] = []
        for axis in range(3):
            expected = newer["position"][axis]
            if not is_first:
                moved = newer["position"][axis] - second["position"][axis]
                expected += (2 * moved * step + before) // (2 * before)
            model = (first if is_first else later)[axis // 2]
            one["position"].append(expected + model.signed(coder))
        one["q"] = normalized(times(newer["q"], turns.decode(coder)))


def decode_tilts(coder, models, keyframes):
    has_observations, tilt = models.bit("has_observations"), 0
    first, change = models.integer("tilt"), models.integer("tilt_change")
    for one in reversed(keyframes):
        one["observed"] = coder.bit(has_observations)
        if one["observed"]:
            tilt += (change if tilt else first).signed(coder)
            one["tilt"] = tilt


def decode_edges(coder, models, count):
    follows, edges = models.bit("follows"), []
    others = models.integer("other_edges")
    edge_to, edge_from = models.integer("edge_to"), models.integer("edge_from")
    sigmas = [models.integers(f"sigma.{kind}", 3) for kind in range(2)]
    deviations = [models.integers(f"deviation.{kind}", 2) for kind in range(2)]

    def edge(a, b, kind, sigma):
        for i in range(3):
            sigma[i] += sigmas[kind][i].signed(coder)
        deviation = [deviations[kind][i // 3].signed(coder) for i in range(6)]
        edges.append((b, a, list(sigma), deviation))

    sigma = [0, 0, 0]
    for b in range(1, count):
        if coder.bit(follows):
            edge(b - 1, b, 0, sigma)
    sigma = [0, 0, 0]
    for _ in range(others.unsigned(coder)):
        b = count - 1 - edge_to.unsigned(coder)
        edge(b - 1 - edge_from.unsigned(coder), b, 1, sigma)
    return sorted(edges, key=lambda e: (e[0], e[1]))


def edge_of(edge, keyframes, poses):
    b, a, codes, deviation = edge
    sigma = [sigma_of(code) for code in codes]
    rotation = [deviation[i] * (sigma[0] / 4.0) for i in range(3)]
    translation = [deviation[i + 3] * (sigma[1 if i < 2 else 2] / 4.0) for i in range(3)]
    (R_a, p_a), (R_b, p_b) = poses[a], poses[b]
    half = [c * 0.5 for c in apply_transposed(R_b, rotation)]
    turned = times(conjugate(keyframes[a]["q"]), keyframes[b]["q"])
    q = normalized(times(turned, [1.0, *half]))
    p = apply_transposed(R_a, plus(minus(p_b, p_a), translation))
    horizontal = 1.0 / (sigma[1] * sigma[1])
    vertical = 1.0 / (sigma[2] * sigma[2]) - horizontal
    up = R_b[2]
    block = [
        [vertical * (up[r] * up[c]) + (horizontal if r == c else 0.0) for c in range(3)]
        for r in range(3)
    ]
    return {
        "from": keyframes[a]["id"],
        "to": keyframes[b]["id"],
        "rotation": q,
        "translation": p,
        "rotational": 1.0 / (sigma[0] * sigma[0]),
        "translational": [value for row in block for value in row],
    }


def decode_block(block, stereo, newest):
    coder, models = RangeDecoder(block), Models("submap")
    if coder.raw(4) != 2:
        raise ValueError("another version")
    step_bits, stride = coder.raw(3), 1 + coder.raw(1)
    offset = coder.raw(1) if stride > 1 else 0
    count = 1 + models.integer("keyframes").unsigned(coder)
    keyframes = [{} for _ in range(count)]
    keyframes[-1].update(id=newest["keyframe"], age=0, position=[0, 0, 0], q=newest["q"])
    decode_poses(coder, models, keyframes)
    decode_tilts(coder, models, keyframes)
    poses = [(matrix(k["q"]), [c * 1e-3 for c in k["position"]]) for k in keyframes]
    first = coder.raw(32)
    predictor = Predictor(stereo, step_bits, poses)
    observations = Observations(coder, models, predictor, stride, offset, first)
    for i, one in enumerate(keyframes):
        if one["observed"]:
            one["observations"] = observations.keyframe(i, one["id"])
    edges = decode_edges(coder, models, count)
    if coder.raw(8) != 0xA5:
        raise ValueError("garbled")
    return keyframes, poses, edges, step_bits


def decode_envelope(data):
    """The fields of CompactSubmap, from little endian CDR behind its four bytes of encapsulation."""
    body, at = data[4:], 0

    def take(kind):
        nonlocal at
        size = struct.calcsize(kind)
        at += -at % size
        value = struct.unpack_from("<" + kind, body, at)[0]
        at += size
        return value

    length = take("I")
    robot = body[at : at + length - 1].decode()
    at += length
    sample = {"robot": robot}
    for name in ("session", "incarnation", "number", "answer"):
        sample[name] = take("I")
    sample["answer_loss"] = take("B")
    sample["answer_age_ms"] = take("H")
    sample["keyframe"] = take("I")
    sample["stamp_ns"] = take("q")
    sample["p_odom"] = [take("f") for _ in range(3)]
    sample["q"] = normalized([take("h") / 16384.0 for _ in range(4)])
    length = take("I")
    sample["block"] = body[at : at + length]
    return sample


def decode_submap(data, stereo):
    sample = decode_envelope(data)
    keyframes, poses, edges, step_bits = decode_block(sample["block"], stereo, sample)
    step = 1.0 / (1 << step_bits)
    out = {"robot": sample["robot"], "number": sample["number"], "keyframes": [], "edges": []}
    for one, (_, p) in zip(keyframes, poses):
        if not one["observed"]:
            continue
        sigma = min(sigma_of(one["tilt"]), 3.14159) if one["tilt"] else 3.14159
        out["keyframes"].append(
            {
                "id": one["id"],
                "stamp_ns": sample["stamp_ns"] - one["age"] * 1000000,
                "rotation": one["q"],
                "position": plus(sample["p_odom"], p),
                "tilt_sigma": sigma,
                "observations": [[o[0]] + [c * step for c in o[1:]] for o in one["observations"]],
            }
        )
    out["edges"] = [edge_of(edge, keyframes, poses) for edge in edges]
    return out


def with_numbers(value):
    """Numbers in hexadecimal become floats."""
    if isinstance(value, dict):
        return {key: with_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [with_numbers(item) for item in value]
    return float.fromhex(value) if isinstance(value, str) and "0x" in value else value


def main():
    samples = 0
    with open(sys.argv[1], encoding="utf-8") as lines:
        for line in lines:
            vector = with_numbers(json.loads(line))
            decoded = decode_submap(bytes.fromhex(vector["sample"]), vector["stereo"])
            if decoded != vector["submap"]:
                print(f"sample {samples} differs:\n{decoded}\n{vector['submap']}")
                return 1
            samples += 1
    if Models.unused("submap"):
        print("rows of no model:", *Models.unused("submap"))
        return 1
    print(f"{samples} samples decoded to the same submaps")
    return 0 if samples > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
