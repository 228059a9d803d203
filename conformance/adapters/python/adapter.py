#!/usr/bin/env python3
"""An adapter (../../PROTOCOL.md) to copy, around the small reader of .ivg in reader.py: `packed-oct24` and `vectors-f32`, `slices`.

To test another decoder, replace `read` and `out_of`, and say in CAPABILITIES what it has.

    python3 ../../run.py run --decoder 'python3 adapter.py'
"""

import struct
import sys

from reader import NeedMore, Reader, Refused

CAPABILITIES = """name reader.py, a minimal reader
ivg decode prefix prefixes
encodings packed-oct24 vectors-f32
orders slices
codes"""

NOTHING = 0xFFFFFFFF


def read(data, known=None):
    """Reads a file or its beginning: exit status, code and offset, the reader."""
    reader = Reader(known)
    try:
        reader.read(data)
        status, fault = 0, None
    except NeedMore:
        status, fault = 40, None
    except Refused as error:
        status, fault = error.status, (error.code, error.offset)
    return status, fault, reader


def out_of(reader):
    """What is known, as PROTOCOL.md has it."""
    if reader.dims is None:
        return b""
    out = struct.pack("<3I6d2I", *reader.dims, *reader.origin, *reader.step, reader.units, 0)
    out += struct.pack("<I", NOTHING if reader.lights is None else len(reader.lights))
    for direct, name in reader.lights or []:
        out += struct.pack("<2I", direct, len(name)) + name
    out += struct.pack("<I", NOTHING) if reader.metadata is None else struct.pack("<I", len(reader.metadata)) + reader.metadata
    vertices = range(reader.dims[0] * reader.dims[1] * reader.dims[2])
    out += bytes(int(vertex in reader.values) for vertex in vertices)
    out += bytes(reader.validity.get(vertex, (255, 0))[0] for vertex in vertices)
    out += bytes(reader.validity.get(vertex, (255, 0))[1] for vertex in vertices)
    return out + b"".join(reader.values[vertex] for vertex in sorted(reader.values))


def main(arguments):
    if arguments == ["capabilities"]:
        print(CAPABILITIES)
        return 0
    command, file_format, source, out = arguments[:4]
    with open(source, "rb") as file:
        data = file.read()
    if file_format != "ivg":
        return 2
    if command == "prefixes":
        known, table, status = set(), b"", 0
        for length in range(len(data) + 1):
            row, _, reader = read(data[:length], known)
            table += struct.pack("<II", row, reader.records)
    else:
        data = data[: int(arguments[4])] if command == "prefix" else data
        status, fault, reader = read(data)
        table = out_of(reader)
        if fault:
            print("%d %d" % fault)
    if status in (0, 40):
        with open(out, "wb") as file:
            file.write(table)
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
