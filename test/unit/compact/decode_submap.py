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


class RangeDecoder:
    def __init__(self, data):
        self.data = data
        self.next = 0
        self.range = 0xFFFFFFFF
        self.number = 0
        for _ in range(4):
            self.number = (self.number << 8) | self.byte()

    def byte(self):
        self.next += 1
        return self.data[self.next - 1] if self.next <= len(self.data) else 0

    def narrow(self, zero):
        bit = self.number >= zero
        if bit:
            self.number -= zero
            self.range -= zero
        else:
            self.range = zero
        while self.range < 1 << 24:
            self.number = (self.number << 8) | self.byte()
            self.range <<= 8
        return bit

    def bit(self, model):
        bit = self.narrow((self.range >> 15) * model.probability_of_zero())
        model.learn(bit)
        return bit

    def raw(self, count):
        value = 0
        for _ in range(count):
            value = 2 * value + self.narrow(self.range >> 1)
        return value


class Bit:
    def __init__(self):
        self.quick = self.slow = 1 << 15

    def probability_of_zero(self):
        one = (self.quick + self.slow) >> 2
        return 32768 - min(max(one, 64), 32768 - 64)

    def learn(self, bit):
        def moved(value, shift):
            return value + ((65535 - value) >> shift) if bit else value - (value >> shift)

        self.quick = moved(self.quick, 4)
        self.slow = moved(self.slow, 7)


class Integer:
    def __init__(self):
        self.longer = [Bit() for _ in range(33)]
        self.leading = [[Bit() for _ in range(3)] for _ in range(12)]
        self.negative = Bit()

    def unsigned(self, coder):
        length = 0
        while length < 32 and coder.bit(self.longer[length]):
            length += 1
        value, left = 1, length
        if length < 12 and left > 0:
            first = coder.bit(self.leading[length][0])
            value, left = 2 * value + first, left - 1
            if left > 0:
                value = 2 * value + coder.bit(self.leading[length][2 if first else 1])
                left -= 1
        return (value << left | coder.raw(left)) - 1

    def signed(self, coder):
        size = self.unsigned(coder)
        if size == 0:
            return 0
        return -size if coder.bit(self.negative) else size


def integers(count):
    return [Integer() for _ in range(count)]


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


def turn(coder, models, units=4096.0):
    largest = coder.raw(2) if coder.bit(models["far"]) else 0
    others = [model.signed(coder) for model in models["others"]]
    q, rest = [0.0] * 4, 1.0
    for i in range(4):
        if i != largest:
            q[i] = others.pop(0) / units
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
    def __init__(self, coder, predictor, stride, offset, first):
        self.coder, self.predictor, self.first = coder, predictor, first
        self.stride, self.offset = stride, offset
        self.tracks = {}
        self.observed = [[Bit() for _ in range(3)] for _ in range(3)]
        self.u, self.v, self.disparity = integers(3), integers(3), integers(3)
        self.in_right = [Bit(), Bit()]
        self.new_landmarks, self.first_landmark, self.gap = integers(3)
        self.new_u, self.new_v, self.new_disparity = integers(3)

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
            u, v = self.new_u.unsigned(self.coder), self.new_v.unsigned(self.coder)
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


def decode_poses(coder, keyframes):
    id_gap, interval, change = integers(3)
    first, later = integers(2), integers(2)
    models = {"far": Bit(), "others": integers(3)}
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
        one["q"] = normalized(times(newer["q"], turn(coder, models)))


def decode_tilts(coder, keyframes):
    has_observations, (first, change), tilt = Bit(), integers(2), 0
    for one in reversed(keyframes):
        one["observed"] = coder.bit(has_observations)
        if one["observed"]:
            tilt += (change if tilt else first).signed(coder)
            one["tilt"] = tilt


def decode_edges(coder, count):
    follows, edges = Bit(), []
    others, edge_to, edge_from = integers(3)
    kinds = [{"sigma": integers(3), "deviation": integers(2)} for _ in range(2)]

    def edge(a, b, kind, sigma):
        for i in range(3):
            sigma[i] += kinds[kind]["sigma"][i].signed(coder)
        deviation = [kinds[kind]["deviation"][i // 3].signed(coder) for i in range(6)]
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
    coder = RangeDecoder(block)
    if coder.raw(4) != 1:
        raise ValueError("another version")
    step_bits, stride = coder.raw(3), 1 + coder.raw(1)
    offset = coder.raw(1) if stride > 1 else 0
    count = 1 + Integer().unsigned(coder)
    keyframes = [{} for _ in range(count)]
    keyframes[-1].update(id=newest["keyframe"], age=0, position=[0, 0, 0], q=newest["q"])
    decode_poses(coder, keyframes)
    decode_tilts(coder, keyframes)
    poses = [(matrix(k["q"]), [c * 1e-3 for c in k["position"]]) for k in keyframes]
    first = coder.raw(32)
    predictor = Predictor(stereo, step_bits, poses)
    observations = Observations(coder, predictor, stride, offset, first)
    for i, one in enumerate(keyframes):
        if one["observed"]:
            one["observations"] = observations.keyframe(i, one["id"])
    edges = decode_edges(coder, count)
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
    print(f"{samples} samples decoded to the same submaps")
    return 0 if samples > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
