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

VERDICTS = {0: "ok", 40: "need-more", 41: "invalid", 42: "unsupported", 43: "limit"}


def say(adapter: str, form: str, file: pathlib.Path, out: pathlib.Path) -> tuple:
    out.write_bytes(b"")
    ran = subprocess.run([*shlex.split(adapter), "decode", form, str(file), str(out)], capture_output=True, timeout=10)
    verdict = VERDICTS.get(ran.returncode, f"crash {ran.returncode}")
    shown = out.read_bytes() if ran.returncode in (0, 40) else b""
    return verdict, ran.stdout.split()[:1], shown


def main() -> int:
    form, a, b, *folders = sys.argv[1:]
    files = sorted(file for folder in folders for file in pathlib.Path(folder).iterdir() if file.is_file())
    different = 0
    with tempfile.TemporaryDirectory() as made:
        out = pathlib.Path(made) / "out"
        for file in files:
            said = [say(adapter, form, file, out) for adapter in (a, b)]
            if said[0] != said[1] or said[0][0].startswith("crash"):
                different += 1
                print(file, *[(verdict, code, len(shown)) for verdict, code, shown in said])
    print(f"{len(files)} files, {different} different")
    return different > 0


if __name__ == "__main__":
    sys.exit(main())
