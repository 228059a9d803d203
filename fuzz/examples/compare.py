#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Shows two decoders the same files and compares what they say: verdict, error code and OUT (conformance/PROTOCOL.md).

    compare.py FORMAT 'ADAPTER A' 'ADAPTER B' FOLDER...

For a decoder in any language that has an adapter: the files are those that a fuzzer kept. Exits with 1 when any differs.
"""
import pathlib
import shlex
import subprocess
import sys
import tempfile

SECONDS = 10
VERDICTS = {0: "ok", 40: "need-more", 41: "invalid", 42: "unsupported", 43: "limit"}


def say(adapter: str, form: str, file: pathlib.Path, out: pathlib.Path) -> tuple:
    out.write_bytes(b"")
    words = [*shlex.split(adapter), "decode", form, str(file), str(out)]
    try:
        ran = subprocess.run(words, capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "hangs", [], b""
    verdict = VERDICTS.get(ran.returncode, f"crash {ran.returncode}")
    shown = out.read_bytes() if ran.returncode in (0, 40) else b""
    return verdict, ran.stdout.split()[:1], shown


def in_words(said: tuple) -> str:
    verdict, code, shown = said
    return " ".join([verdict, *(word.decode("ascii", "replace") for word in code), f"({len(shown)} bytes)"])


def first_difference(a: bytes, b: bytes) -> str:
    at = next((n for n, pair in enumerate(zip(a, b)) if pair[0] != pair[1]), None)
    return "" if at is None else f"; OUT differs from byte {at} on"


def main() -> int:
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    form, a, b, *folders = sys.argv[1:]
    files = sorted(file for folder in folders for file in pathlib.Path(folder).iterdir() if file.is_file())
    different = 0
    with tempfile.TemporaryDirectory() as made:
        out = pathlib.Path(made) / "out"
        for file in files:
            said = [say(adapter, form, file, out) for adapter in (a, b)]
            if said[0] != said[1] or said[0][0].startswith(("crash", "hangs")):
                different += 1
                print(f"{file}: {in_words(said[0])} | {in_words(said[1])}{first_difference(said[0][2], said[1][2])}")
    print(f"{len(files)} files, {different} different")
    return different > 0


if __name__ == "__main__":
    sys.exit(main())
