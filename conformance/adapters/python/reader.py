"""A minimal reader of .ivg, after spec/README.md: the encodings `packed-oct24` and `vectors-f32`, the order `slices`, default
limits. It is slow and short, to be read beside the specification."""

import math
import struct
import zlib

MASK32, MASK64 = 0xFFFFFFFF, 0xFFFFFFFFFFFFFFFF
MAGIC = b"\x89IVG\r\n\x1a\n"
HEADER_BYTES = 144
UNSUPPORTED = {110, 118, 201, 202, 402, 404, 405}  # codes; from 600 on they are limits, all others are invalid
BYTES = {1: 42, 6: 216}  # a vertex, by encoding
LIMIT_HEADER, LIMIT_CHUNK, LIMIT_CHUNKS, LIMIT_RECORD, LIMIT_VERTICES = 4096, 1 << 20, 1024, 64 << 20, 1 << 27


class NeedMore(Exception):
    """The bytes end before the file does."""


class Refused(Exception):
    def __init__(self, code, offset):
        super().__init__("code %d at byte %d" % (code, offset))
        self.code, self.offset = code, offset
        self.status = 43 if code >= 600 else 42 if code in UNSUPPORTED else 41


def check(right, code, offset):
    if not right:
        raise Refused(code, offset)


def splitmix64(seed, n):  # COM-INT-02
    z = (seed + 0x9E3779B97F4A7C15 * (n + 1)) & MASK64
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & MASK64
    z = (z ^ z >> 27) * 0x94D049BB133111EB & MASK64
    return z ^ z >> 31


def f32(number):
    """Rounded to binary32."""
    return struct.unpack("<f", struct.pack("<f", number))[0]


class Reader:
    def __init__(self, known=None):
        """`known` holds where the records begin that another reader has accepted in a shorter beginning of the same file: they
        are counted and not read again."""
        self.known = set() if known is None else known
        self.dims = None  # what is known of the header, all at once
        self.lights = self.metadata = None
        self.values = {}  # the bytes of the numbers of a vertex, by linear index
        self.validity = {}  # validity and blocked edges, by linear index
        self.records = 0

    def need(self, length):
        if len(self.data) < length:
            raise NeedMore

    def fits(self, start, end):  # COM-CRC-02
        return zlib.crc32(self.data[start : end - 4], zlib.crc32(self.content)) == self.at("<I", end - 4)

    def at(self, form, offset):
        values = struct.unpack_from(form, self.data, offset)
        return values[0] if len(values) == 1 else values

    def read(self, data):
        self.data = data
        self.header()
        self.chunks()
        at = self.data_offset
        for record, payload, use in self.layout():
            at = self.record(at, record, payload, use)
        check(len(data) == at, 115, at)  # COM-REC-08

    # ---- Header: COM-HDR-03, IVG-HDR-01 ----

    def header(self):
        for n, byte in enumerate(self.data[:8]):
            check(byte == MAGIC[n], 101, n)
        self.need(10)
        check(self.at("<H", 8) == 0, 201, 8)
        self.need(24)
        minor, length = self.at("<H", 10), self.at("<I", 20)
        right = length == HEADER_BYTES if minor <= 1 else HEADER_BYTES <= length <= 65536 and length % 8 == 0
        check(right, 102, 20)
        check(length <= LIMIT_HEADER, 601, 20)
        self.need(length)
        crc = zlib.crc32(self.data[32:length], zlib.crc32(self.data[:28]))
        check(crc == self.at("<I", 28), 103, 28)
        check(self.at("<I", 24) == 0, 118, 24)
        check(self.at("<I", 12) == 0, 202, 12)
        self.content = self.data[32:40]
        self.header_bytes, self.data_offset, self.file_bytes = length, self.at("<Q", 40), self.at("<Q", 48)
        right = self.data_offset % 8 == 0 and length <= self.data_offset <= self.file_bytes
        check(right, 116, 40)
        self.lattice()

    def lattice(self):
        dims, origin, step = self.at("<3H", 56), self.at("<3d", 64), self.at("<3d", 88)
        for axis, n in enumerate(dims):
            check(n > 0, 301, 56 + 2 * axis)
            last = origin[axis] + (n - 1) * step[axis]
            check(all(map(math.isfinite, (origin[axis], step[axis], last))), 302, 64 + 8 * axis)
            check(step[axis] > 0 if n > 1 else step[axis] == 0, 303, 88 + 8 * axis)
        self.encoding, order = self.at("<H", 62), self.at("<H", 112)
        check(self.encoding != 0, 401, 62)
        check(self.encoding in BYTES, 402, 62)
        check(order != 0, 403, 112)
        check(order == 1, 404, 112)
        self.exponent = self.at("<h", 114)
        check(-125 <= self.exponent <= 112, 304, 114)
        self.units = self.at("<B", 136)
        check(self.units < 2, 405, 136)
        self.share, self.seed, bundles, validity = self.at("<IQII", 116)
        check(self.share > 0, 305, 116)
        self.slices(dims)
        largest = max(self.members(0), self.members(self.n[0] // 2))
        check(bundles == -(-largest // self.share) and bundles < 1 << 31, 306, 128)
        count = dims[0] * dims[1] * dims[2]
        blocks = -(-count // 4096)
        check(validity == 0 or validity == blocks < 1 << 31, 307, 132)
        corners = math.prod(min(n, 2) for n in dims)
        size = BYTES[self.encoding]
        longest = [corners * size, min(count, 4096) + -(-3 * min(count, 4096) // 8) if validity else 0]
        longest.append(self.bundle_length(1) * size if bundles else 0)
        longest = [(payload + 15) // 4 * 4 for payload in longest]
        check(max(longest) <= (1 << 31) - 4, 308, 116)
        check(count <= LIMIT_VERTICES, 605, 56)
        check(max(longest) <= LIMIT_RECORD, 604, 116)
        check(self.data[137:144] == bytes(7), 118, next((n for n in range(137, 144) if self.data[n]), 137))
        self.count, self.corners, self.bundles, self.blocks = count, corners, bundles, validity
        end = self.data_offset + sum((payload + 15) // 4 * 4 for _, payload, _ in self.layout(dims))
        check(self.file_bytes == end, 117, 48)
        self.dims, self.origin, self.step = dims, origin, step

    # ---- Which vertex is it: IVG-ORD-01 to -10 ----

    def slices(self, dims):
        """The longest axis and the two others; their numbers of vertices, and how far apart their vertices are."""
        longest = max(range(3), key=lambda axis: (dims[axis], -axis))
        axes = [longest] + [axis for axis in range(3) if axis != longest]
        strides = (1, dims[0], dims[0] * dims[1])
        self.n, self.strides = [dims[axis] for axis in axes], [strides[axis] for axis in axes]

    def is_outer(self, s):
        return s in (0, self.n[0] - 1)

    def members(self, s):
        """How many vertices of a slice are not corners."""
        _, nb, nc = self.n
        return nb * nc - (min(nb, 2) * min(nc, 2) if self.is_outer(s) else 0)

    def bundle_length(self, k):
        def of(s):
            return min(self.share, max(0, self.members(s) - (k - 1) * self.share))

        outer = min(self.n[0], 2)
        return outer * of(0) + (self.n[0] - outer) * (of(1) if self.n[0] > 2 else 0)

    def bundle(self, k):
        """The linear indices of the vertices of a bundle."""
        for s in range(self.n[0]):
            members = self.members(s)
            for rank in range((k - 1) * self.share, min(k * self.share, members)):
                yield self.vertex(s, self.permuted(s, rank, members))

    def vertex(self, s, number):
        """The vertex of a slice with this number among those that are not corners."""
        _, nb, nc = self.n
        if self.is_outer(s):
            for corner in sorted({0, nb - 1, nb * (nc - 1), nb * nc - 1}):
                number += number >= corner
        return s * self.strides[0] + number % nb * self.strides[1] + number // nb * self.strides[2]

    def permuted(self, s, x, m):  # IVG-ORD-09, -10
        bits = max(2, (m - 1).bit_length())
        left_bits = bits // 2
        right_bits = bits - left_bits
        while True:
            left, right = x >> right_bits, x & (1 << right_bits) - 1
            for t in range(6):
                key = splitmix64(self.seed, 6 * s + t) >> 32
                z = ((left if t % 2 else right) + key) & MASK32
                z = (z ^ z >> 16) * 0x85EBCA6B & MASK32
                z = (z ^ z >> 13) * 0xC2B2AE35 & MASK32
                z ^= z >> 16
                if t % 2:
                    right ^= z & (1 << right_bits) - 1
                else:
                    left ^= z & (1 << left_bits) - 1
            x = left << right_bits | right
            if x < m:
                return x

    # ---- Chunks: COM-CHK-01 to -08 ----

    def chunks(self):
        at, number = self.header_bytes, 0
        while at < self.data_offset:
            check(number < LIMIT_CHUNKS, 603, at)
            check(self.data_offset - at >= 20, 106, at)
            self.need(at + 16)
            kind, length = self.data[at : at + 4], self.at("<Q", at + 8)
            total = (length + 27) // 8 * 8
            check(total <= min(self.data_offset - at, (1 << 31) - 8), 106, at + 8)
            check(total <= LIMIT_CHUNK, 602, at + 8)
            self.need(at + total)
            end = at + total
            check(self.fits(at, end), 104, end - 4)
            flags = self.data[at + 4 : at + 8]
            check(flags[0] < 2 and flags[1:] == bytes(3), 118, at + 4)
            check(not any(self.data[at + 16 + length : end - 4]), 107, at + 16 + length)
            self.chunk(kind, flags[0], self.data[at + 16 : at + 16 + length], at)
            at, number = end, number + 1

    def chunk(self, kind, critical, payload, at):
        if kind == b"LITE":
            check(self.lights is None, 108, at)
            self.lights = read_lights(payload, at + 16)
        elif kind == b"META":
            check(self.metadata is None, 108, at)
            check(are_lines(payload), 411, at + 16)
            self.metadata = payload
        else:
            check(kind != b"DIRE", 310, at)
            check(not critical, 110, at)

    # ---- Records: COM-REC-01 to -08, IVG-REC-01 to -03 ----

    def layout(self, dims=None):
        """The records: id, bytes of the payload, and what uses it."""
        size = BYTES[self.encoding]
        yield 0, self.corners * size, lambda at: self.take(self.corner_vertices(), at)
        for j in range(self.blocks):
            n = min(4096, self.count - 4096 * j)
            yield 0x80000000 + j, n + -(-3 * n // 8), lambda at, j=j, n=n: self.block(4096 * j, n, at)
        for k in range(1, self.bundles + 1):
            yield k, self.bundle_length(k) * size, lambda at, k=k: self.take(self.bundle(k), at)
        yield MASK32, 8, self.end

    def record(self, at, record, payload, use):
        end = at + (payload + 15) // 4 * 4
        self.need(end)
        if at not in self.known:
            check(self.fits(at, end), 105, end - 4)
            check(self.at("<I", at) == record, 111, at)
            check(not any(self.data[at + 8 + payload : end - 4]), 112, at + 8 + payload)
            use(at + 8)
            self.known.add(at)
        self.records += record != MASK32
        return end

    def end(self, at):
        check(self.at("<I", at - 4) == 0, 114, at - 4)
        check(self.at("<Q", at) == self.file_bytes, 114, at)

    def corner_vertices(self):
        x, y, z = (sorted({0, n - 1}) for n in self.dims)
        return [i + self.dims[0] * (j + self.dims[1] * k) for k in z for j in y for i in x]

    def take(self, vertices, at):
        vertices = list(vertices)
        read = self.packed if self.encoding == 1 else self.vectors
        self.values.update(zip(vertices, list(read(len(vertices), at))))

    def vectors(self, count, at):  # IVG-VEC-01, -02
        scale, values = 2.0**self.exponent, []
        for n in range(54 * count):
            number = self.at("<f", at + 4 * n)
            check(abs(number) * scale < 2.0**128 * (1 - 2.0**-25), 407, at + 4 * n)
            values.append(number * scale)
        return [struct.pack("<54f", *values[54 * n : 54 * n + 54]) for n in range(count)]

    def packed(self, count, at):  # IVG-PACK-01, -05, IVG-RGB-01, IVG-DIR-01 to -03
        values = []
        for n in range(6 * count):
            code = self.at("<I", at + 4 * n)
            scale = 2.0 ** ((code >> 27) - 24 + self.exponent)
            place = at + 24 * count + 3 * n
            direction = int.from_bytes(self.data[place : place + 3], "little")
            u, v = (direction & 4095) - 2047, (direction >> 12) - 2047
            check(u < 2048 and v < 2048, 406, place)
            unit = octahedral(u, v)
            values += [(code >> shift & 511) * scale * component for shift in (0, 9, 18) for component in unit]
        return [struct.pack("<54f", *values[54 * n : 54 * n + 54]) for n in range(count)]

    def block(self, first, n, at):  # IVG-VAL-02 to -05
        bits = int.from_bytes(self.data[at + n : at + n + -(-3 * n // 8)], "little")
        check(bits >> 3 * n == 0, 408, at + n + -(-3 * n // 8) - 1)
        block = {}
        for i in range(n):
            vertex, blocked = first + i, bits >> 3 * i & 7
            x, rest = vertex % self.dims[0], vertex // self.dims[0]
            place = (x, rest % self.dims[1], rest // self.dims[1])
            outside = sum((place[axis] == self.dims[axis] - 1) << axis for axis in range(3))
            check(not blocked & outside, 409, at + n + 3 * i // 8)
            block[vertex] = self.data[at + i], blocked
        self.validity.update(block)


def octahedral(u, v):  # IVG-DIR-03
    x, y, z = u, v, 2047 - abs(u) - abs(v)
    if z < 0:
        x = (2047 - abs(v)) * (1 if u > 0 else -1)
        y = (2047 - abs(u)) * (1 if v > 0 else -1)
    length = math.sqrt(x * x + y * y + z * z)
    return [f32(component / length) for component in (x, y, z)]


def read_lights(payload, offset):  # IVG-LITE-01, -02
    at, lights = 0, []

    def need(length):
        check(at + length <= len(payload), 410, offset + len(payload))

    need(4)
    (count,) = struct.unpack_from("<I", payload)
    at = 4
    for _ in range(count):
        need(2)
        check(payload[at] < 2 and payload[at + 1] == 0, 118, offset + at)
        direct, at = payload[at], at + 2
        need(2)
        (length,) = struct.unpack_from("<H", payload, at)
        at += 2
        need(length)
        name = payload[at : at + length]
        check(is_utf8(name), 410, offset + at)
        lights.append((direct, name))
        at += length
    check(at == len(payload), 410, offset + at)
    return lights


def is_utf8(data):
    try:
        data.decode("utf-8")
        return True
    except UnicodeDecodeError:
        return False


def are_lines(payload):  # IVG-META-02
    if not is_utf8(payload) or payload and not payload.endswith(b"\n"):
        return False
    allowed = b"abcdefghijklmnopqrstuvwxyz0123456789-_"
    pairs = [line.partition(b"=") for line in payload.split(b"\n")[:-1]]
    return all(key and equals and all(byte in allowed for byte in key) for key, equals, _ in pairs)
