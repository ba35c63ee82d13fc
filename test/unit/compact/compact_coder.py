"""Range decoder and models of the compact encoding, from idl/README.md alone.

The models start as idl/compact_models.txt says.
"""

import pathlib

TABLE = pathlib.Path(__file__).resolve().parents[3] / "idl" / "compact_models.txt"


def read_table():
    rows = {}
    for line in TABLE.read_text(encoding="utf-8").splitlines():
        words = line.partition("#")[0].split()
        if not words:
            continue
        if words[0] in rows:
            raise ValueError(f"{words[0]}: a second row")
        rows[words[0]] = [int(word) for word in words[1:]]
    return rows


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
    def __init__(self, share):
        self.quick = self.slow = share << 8

    def probability_of_zero(self):
        one = (self.quick + self.slow) >> 2
        return 32768 - min(max(one, 64), 32768 - 64)

    def learn(self, bit):
        def moved(value, shift):
            return value + ((65535 - value) >> shift) if bit else value - (value >> shift)

        self.quick = moved(self.quick, 4)
        self.slow = moved(self.slow, 7)


class Integer:
    def __init__(self, models, name):
        self.longer = models.bits(name + ".longer", 32)
        self.first = models.bits(name + ".first", 11)
        self.second = models.bits(name + ".second", 20)
        (self.negative,) = models.bits(name + ".negative", 1)

    def unsigned(self, coder):
        length = 0
        while length < 32 and coder.bit(self.longer[length]):
            length += 1
        value, left = 1, length
        if 0 < length <= 11:
            first = coder.bit(self.first[length - 1])
            value, left = 2 * value + first, left - 1
            if left > 0:
                value = 2 * value + coder.bit(self.second[2 * (length - 2) + first])
                left -= 1
        return (value << left | coder.raw(left)) - 1

    def signed(self, coder):
        size = self.unsigned(coder)
        if size == 0:
            return 0
        return -size if coder.bit(self.negative) else size


class Models:
    """The models of one block, by their names behind `prefix`."""

    table = read_table()
    used = set()

    def __init__(self, prefix):
        self.prefix = prefix

    def bits(self, name, count):
        name = f"{self.prefix}.{name}"
        self.used.add(name)
        shares = self.table[name]
        if len(shares) > count:
            raise ValueError(f"{name}: more than {count} shares")
        return [Bit(share) for share in shares + [128] * (count - len(shares))]

    def bit(self, name):
        return self.bits(name, 1)[0]

    def integer(self, name):
        return Integer(self, name)

    def integers(self, name, count):
        return [Integer(self, f"{name}.{i}") for i in range(count)]

    @classmethod
    def unused(cls, prefix):
        """Rows that no block has asked for."""
        return sorted(n for n in cls.table if n.startswith(prefix + ".") and n not in cls.used)
