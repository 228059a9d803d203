/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* A target for libFuzzer, and for AFL++ (afl-clang-fast -fsanitize=fuzzer): here for a reader of .ivg in C. See ../README.md. */

#define IVG_IMPLEMENTATION
#include "ivg.h"
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ivg_reader reader;
    ivg_event event;
    ivg_start(&reader, NULL);
    while ((event = ivg_next(&reader, data, size)).kind != IVG_STOP) {
        if (event.kind != IVG_RECORD) continue;
        ivg_vertices vertices;
        float light[IVG_VECTOR_VALUES];
        ivg_first_vertex(&vertices, &reader.header, &event.record);
        while (ivg_next_vertex(&vertices)) {
            ivg_values(&reader.header, &event.record, vertices.number, light);
            if (vertices.linear_index >= ivg_vertex_count(&reader.header)) abort();
        }
    }
    return 0;
}
