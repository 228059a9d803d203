/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What the readers in ../../ports/c see of a file, as bytes that ../src/transcript.rs makes of our decoders too: numbers are
 * little-endian, one after the other. The file comes in pieces, each in memory of its own that ends where the piece ends, so that the
 * address sanitiser finds every look behind it.
 */

#if defined(IVG_FUZZING)
/* What the compiler calls at each edge: libFuzzer's function of that name only ends the process. See coverage.c. */
__asm__(".set __sanitizer_cov_trace_pc, differential_trace_pc");
#endif

#define IVG_IMPLEMENTATION
#define PMESH_IMPLEMENTATION
#include "ivg.h"
#include "pmesh.h"

#include <stdio.h>
#include <stdlib.h>

/* Mistakes for the check that the fuzzer finds some (fuzz/README.md). No other caller asks for one. */
enum { NO_MISTAKE = 0, READS_BEHIND_THE_END = 1, FORGETS_THE_SCALE = 2 };

/* What has been seen; grows. */
typedef struct transcript {
    uint8_t *bytes;
    uint64_t length;
    uint64_t capacity;
} transcript;

static void *allocate(void *old, size_t bytes)
{
    void *memory = realloc(old, bytes > 0 ? bytes : 1);
    if (memory == NULL) {
        fprintf(stderr, "the differential test has no memory\n");
        abort();
    }
    return memory;
}

static void put(transcript *seen, const void *bytes, uint64_t length)
{
    if (seen->capacity - seen->length < length) {
        seen->capacity = 2 * seen->capacity + length + 4096;
        seen->bytes = (uint8_t *)allocate(seen->bytes, (size_t)seen->capacity);
    }
    if (length > 0) memcpy(seen->bytes + seen->length, bytes, (size_t)length);
    seen->length += length;
}

static void put_u8(transcript *seen, unsigned number)
{
    const uint8_t byte = (uint8_t)number;
    put(seen, &byte, 1);
}

static void put_u32(transcript *seen, uint32_t number)
{
    uint8_t bytes[4];
    for (int i = 0; i < 4; i++) bytes[i] = (uint8_t)(number >> (8 * i));
    put(seen, bytes, 4);
}

static void put_u64(transcript *seen, uint64_t number)
{
    put_u32(seen, (uint32_t)number);
    put_u32(seen, (uint32_t)(number >> 32));
}

static void put_f32(transcript *seen, float number)
{
    uint32_t bits;
    memcpy(&bits, &number, 4);
    put_u32(seen, bits);
}

static void put_f64(transcript *seen, double number)
{
    uint64_t bits;
    memcpy(&bits, &number, 8);
    put_u64(seen, bits);
}

static void put_frame(transcript *seen, const frame_header *frame)
{
    put_u32(seen, frame->minor);
    put_u32(seen, frame->optional_features);
    put_u32(seen, frame->header_bytes);
    put_u64(seen, frame->content_id);
    put_u64(seen, frame->data_offset);
    put_u64(seen, frame->file_bytes);
}

/* ---- .ivg ---- */

static void put_grid(transcript *seen, const ivg_header *header)
{
    put_u8(seen, 'H');
    put_frame(seen, &header->frame);
    for (int axis = 0; axis < 3; axis++) put_u32(seen, header->dims[axis]);
    for (int axis = 0; axis < 3; axis++) put_f64(seen, header->origin[axis]);
    for (int axis = 0; axis < 3; axis++) put_f64(seen, header->step[axis]);
    put_u32(seen, header->encoding);
    put_u32(seen, header->order);
    put_u32(seen, (uint32_t)(int32_t)header->scale_exponent);
    put_u32(seen, header->vertices_per_slice);
    put_u64(seen, header->seed);
    put_u32(seen, header->bundle_count);
    put_u32(seen, header->validity_records);
    put_u32(seen, header->units);
}

static void put_lights(transcript *seen, const ivg_event *event)
{
    uint64_t position = 0;
    ivg_named_light light;
    put_u8(seen, 'L');
    while (ivg_next_named_light(event->payload, event->payload_bytes, &position, &light)) {
        put_u32(seen, (uint32_t)light.direct);
        put_u32(seen, light.name_bytes);
        put(seen, light.name, light.name_bytes);
    }
}

static void put_record(transcript *seen, const ivg_header *header, const ivg_record *record, int mistake)
{
    put_u8(seen, 'R');
    put_u32(seen, record->id);
    put_u32(seen, record->generation);
    put_u64(seen, record->offset);
    put_u64(seen, record->length);
    put_u32(seen, record->vertices);
    if (record->kind == IVG_VALIDITY) {
        put_u64(seen, record->first_vertex);
        for (uint32_t i = 0; i < record->vertices; i++) {
            put_u8(seen, ivg_validity(record, i));
            put_u8(seen, ivg_blocked_edges(record, i));
        }
        return;
    }
    if (mistake == READS_BEHIND_THE_END && record->generation > 2) {
        const volatile uint8_t *behind = record->payload + record->length - 8 + FRAME_END_RECORD_BYTES;
        (void)*behind;
    }
    ivg_header scaled = *header;
    if (mistake == FORGETS_THE_SCALE && record->kind == IVG_BUNDLE) scaled.scale_exponent = 0;
    ivg_vertices vertices;
    float values[IVG_VECTOR_VALUES];
    const uint32_t count = ivg_values_per_vertex(header);
    ivg_first_vertex(&vertices, header, record);
    while (ivg_next_vertex(&vertices)) {
        put_u64(seen, vertices.linear_index);
        ivg_values(&scaled, record, vertices.number, values);
        for (uint32_t i = 0; i < count; i++) put_f32(seen, values[i]);
    }
}

static frame_result see_grid(transcript *seen, ivg_reader *reader, const uint8_t *bytes, uint64_t length, int mistake)
{
    ivg_event event;
    while ((event = ivg_next(reader, bytes, length)).kind != IVG_STOP) {
        switch (event.kind) {
        case IVG_HEADER: put_grid(seen, &reader->header); break;
        case IVG_LIGHTS: put_lights(seen, &event); break;
        case IVG_METADATA:
            put_u8(seen, 'M');
            put_u64(seen, event.payload_bytes);
            put(seen, event.payload, event.payload_bytes);
            break;
        default: put_record(seen, &reader->header, &event.record, mistake); break;
        }
    }
    return event.result;
}

/* ---- .pmesh ---- */

static void put_mesh(transcript *seen, const pmesh_header *header)
{
    put_u8(seen, 'H');
    put_frame(seen, &header->frame);
    put_u32(seen, header->vertex_count);
    put_u32(seen, header->wedge_count);
    put_u32(seen, header->face_count);
    put_u32(seen, header->base_vertices);
    put_u32(seen, header->packet_count);
    put_u32(seen, header->attributes);
    for (int axis = 0; axis < 3; axis++) put_f64(seen, header->origin[axis]);
    for (int axis = 0; axis < 3; axis++) put_f32(seen, header->bounds_min[axis]);
    for (int axis = 0; axis < 3; axis++) put_f32(seen, header->bounds_max[axis]);
    put_u32(seen, header->normal_bits);
    put_u32(seen, header->uv_bits);
    for (int axis = 0; axis < 2; axis++) put_f32(seen, header->uv_min[axis]);
    for (int axis = 0; axis < 2; axis++) put_f32(seen, header->uv_max[axis]);
}

static void put_packet(transcript *seen, const pmesh_packet *packet)
{
    put_u8(seen, 'P');
    put_u32(seen, packet->number);
    put_u32(seen, packet->end_vertex);
    put_u32(seen, packet->end_wedge);
    put_u32(seen, packet->end_face);
    put_u32(seen, packet->payload_bytes);
    put_f32(seen, packet->error);
    put_u64(seen, packet->offset);
    put_u64(seen, packet->length);
}

static void put_materials(transcript *seen, const pmesh_event *event)
{
    uint64_t position = 0;
    const uint8_t *name;
    uint16_t name_bytes;
    put_u8(seen, 'M');
    while (pmesh_next_material(event->payload, event->payload_bytes, &position, &name, &name_bytes)) {
        put_u32(seen, name_bytes);
        put(seen, name, name_bytes);
    }
}

static void put_level(transcript *seen, const pmesh_reader *reader, uint32_t level)
{
    const pmesh_mesh *mesh = &reader->mesh;
    const uint32_t attributes = reader->header.attributes;
    pmesh_level_counts counts;
    put_u8(seen, 'V');
    put_u32(seen, level);
    if (!pmesh_level(reader, level, &counts)) return;
    uint32_t *corners = (uint32_t *)allocate(NULL, 12 * (size_t)counts.faces);
    pmesh_corners(reader, level, corners);
    put_u32(seen, counts.vertices);
    put_u32(seen, counts.wedges);
    put_u32(seen, counts.faces);
    for (uint64_t i = 0; i < 3 * (uint64_t)counts.vertices; i++) put_f32(seen, mesh->positions[i]);
    for (uint32_t i = 0; i < counts.wedges; i++) put_u32(seen, mesh->wedge_vertex[i]);
    if (attributes & PMESH_NORMALS) {
        for (uint64_t i = 0; i < 3 * (uint64_t)counts.wedges; i++) put_f32(seen, mesh->normals[i]);
    }
    if (attributes & PMESH_UVS) {
        for (uint64_t i = 0; i < 2 * (uint64_t)counts.wedges; i++) put_f32(seen, mesh->uvs[i]);
    }
    if (attributes & PMESH_COLOURS) put(seen, mesh->colours, 4 * (uint64_t)counts.wedges);
    for (uint64_t i = 0; i < 3 * (uint64_t)counts.faces; i++) put_u32(seen, corners[i]);
    if (attributes & PMESH_MATERIALS) {
        for (uint32_t i = 0; i < counts.faces; i++) {
            put_u8(seen, mesh->materials[i]);
            put_u8(seen, (unsigned)mesh->materials[i] >> 8);
        }
    }
    free(corners);
}

typedef struct mesh_reader {
    pmesh_reader reader;
    void *memory;
    int has_header;
} mesh_reader;

static frame_result see_mesh(transcript *seen, mesh_reader *mesh, const uint8_t *bytes, uint64_t length)
{
    pmesh_event event;
    while ((event = pmesh_next(&mesh->reader, bytes, length)).kind != PMESH_STOP) {
        switch (event.kind) {
        case PMESH_MEMORY: {
            void *memory = allocate(NULL, (size_t)event.memory_bytes);
            if (!pmesh_give_memory(&mesh->reader, memory, event.memory_bytes)) abort();
            free(mesh->memory);
            mesh->memory = memory;
            break;
        }
        case PMESH_HEADER:
            mesh->has_header = 1;
            put_mesh(seen, &mesh->reader.header);
            break;
        case PMESH_MATERIAL_LIST: put_materials(seen, &event); break;
        default: put_packet(seen, &event.packet); break;
        }
    }
    return event.result;
}

/* The coarsest level, the finest that is complete, and `between` levels between them. */
static void put_levels(transcript *seen, const mesh_reader *mesh, uint32_t between)
{
    const uint32_t finest = pmesh_finest_level(&mesh->reader);
    const uint32_t coarsest = mesh->reader.header.base_vertices;
    if (!mesh->has_header || finest == PMESH_NO_LEVEL) return;
    for (uint64_t i = 0; i <= between + 1; i++) {
        put_level(seen, &mesh->reader, (uint32_t)(finest - (uint64_t)(finest - coarsest) * i / (between + 1)));
    }
}

/* ---- For Rust ---- */

/* Fills in what was seen, for the caller to give back with `differential_free`, and how it ended. `ends` are `pieces` lengths, none
 * smaller than the one before, of what has arrived; the last is that of the whole file. */
void differential_ivg(const uint8_t *file, const uint64_t *ends, uint64_t pieces, int32_t mistake, transcript *seen,
    frame_result *result)
{
    ivg_reader reader;
    ivg_start(&reader, NULL);
    for (uint64_t piece = 0; piece < pieces; piece++) {
        uint8_t *bytes = (uint8_t *)malloc((size_t)ends[piece]);
        if (ends[piece] > 0) memcpy(bytes, file, (size_t)ends[piece]);
        *result = see_grid(seen, &reader, bytes, ends[piece], mistake);
        free(bytes);
    }
}

/* As `differential_ivg`. */
void differential_pmesh(const uint8_t *file, const uint64_t *ends, uint64_t pieces, uint32_t between, transcript *seen,
    frame_result *result)
{
    mesh_reader mesh;
    memset(&mesh, 0, sizeof mesh);
    pmesh_start(&mesh.reader, NULL);
    for (uint64_t piece = 0; piece < pieces; piece++) {
        uint8_t *bytes = (uint8_t *)malloc((size_t)ends[piece]);
        if (ends[piece] > 0) memcpy(bytes, file, (size_t)ends[piece]);
        *result = see_mesh(seen, &mesh, bytes, ends[piece]);
        free(bytes);
    }
    put_levels(seen, &mesh, between);
    free(mesh.memory);
}

void differential_free(uint8_t *bytes)
{
    free(bytes);
}
