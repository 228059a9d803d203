#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# Compiles the headers as C and C++, the example of README.md and both adapters, and runs the tests of ../../vectors with
# sanitizers. Needs cc, c++ and python3; takes a few minutes.
set -eu
cd "$(dirname "$0")"
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
warnings="-Wall -Wextra -Werror -Wconversion -pedantic"

common() { sed -n '/^\/\* ==== Common part/,/^\/\* ==== End of the common part/p' "$1"; }
[ "$(common ivg.h)" = "$(common pmesh.h)" ] || { echo "the common parts differ"; exit 1; }

for one in IVG:ivg PMESH:pmesh; do
    printf '#include "%s.h"\n#define %s_IMPLEMENTATION\n#include "%s.h"\nint main(void) { return 0; }\n' \
        "${one#*:}" "${one%:*}" "${one#*:}" >"$made/one.c"
    cc -std=c99 $warnings -I. "$made/one.c" -o "$made/one" -lm
    c++ -x c++ -Wall -Wextra -Werror -I. "$made/one.c" -o "$made/one" -lm
done
sed -n '/^```c$/,/^```$/p' README.md | sed '/^```/d' >"$made/example.c"
cc -std=c99 $warnings -I. -c "$made/example.c" -o "$made/example.o"
cc -std=c99 $warnings -g -O1 -fsanitize=address,undefined -fno-sanitize-recover -I. ../../adapters/c/adapter.c \
    -o "$made/adapter" -lm
c++ -std=c++17 -Wall -Wextra -Werror -I. ../../adapters/cpp/adapter.cpp -o "$made/adapter-cpp" -lm

python3 - "$made" <<'PYTHON'
import hashlib, json, subprocess, sys
made, vectors = sys.argv[1], "../../vectors/"
status = {"ok": 0, "need-more": 40, "invalid": 41, "unsupported": 42, "limit": 43}
failed = tests = 0
for adapter in "adapter", "adapter-cpp":
    for test in json.load(open(vectors + "manifest.json"))["tests"]:
        op, out = test["op"], made + "/out"
        if adapter == "adapter-cpp" and op not in ("decode", "prefix", "lod"):
            continue
        words = [op, test["format"], vectors + test["file"], out] if op != "numeric" else [op]
        words += ([test["args"]] if "args" in test else []) + ([out] if op == "numeric" else [])
        run = subprocess.run([made + "/" + adapter] + words, capture_output=True, text=True, timeout=60)
        passed = run.returncode == (0 if op == "prefixes" else status[test["verdict"]])
        if passed and "code" in test and op != "prefixes":
            passed = run.stdout.split()[0] == str(test["code"])
        if passed and "out" in test:
            passed = hashlib.sha256(open(out, "rb").read()).hexdigest() == test["out"]["sha256"]
        tests += 1
        if not passed:
            failed += 1
            print(adapter, test["id"], run.returncode, run.stdout, run.stderr)
print(tests, "tests,", failed, "failed")
sys.exit(failed > 0)
PYTHON
