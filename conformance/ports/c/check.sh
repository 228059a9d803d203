#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# Compiles the headers as C and C++, the example of README.md and both adapters, and runs the suite on them, the one in C with
# sanitizers. Needs cc, c++ and python3; takes a minute.
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

for adapter in adapter adapter-cpp; do
    python3 ../../run.py run --decoder "$made/$adapter"
done
