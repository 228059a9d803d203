/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * An adapter (../../PROTOCOL.md) for the readers in ../../ports/c. To test another decoder, keep what is before and after
 * the parts for .ivg and .pmesh and replace those.
 *
 *     cc -std=c99 -O2 -Wall -Wextra -I../../ports/c adapter.c -o adapter -lm
 *     cc -std=c99 -g -fsanitize=address,undefined -I../../ports/c adapter.c -o adapter -lm      to find errors in it
 */

#define IVG_IMPLEMENTATION
#define PMESH_IMPLEMENTATION
#include "ivg.h"
#include "pmesh.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- Input and output ---- */

/* Statuses of its own: neither looks like a verdict. */
enum { INPUT_OUTPUT_ERROR = 1, WRONG_USAGE = 2 };

static void fail(int status, const char *text)
{
    fprintf(stderr, "adapter: %s\n", text);
    exit(status);
}

static void *allocate(void *old, size_t bytes)
{
    void *memory = realloc(old, bytes > 0 ? bytes : 1);
    if (memory == NULL) fail(INPUT_OUTPUT_ERROR, "out of memory");
    return memory;
}

static uint8_t *read_file(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    size_t capacity = 0;
    *length = 0;
    if (file == NULL) fail(INPUT_OUTPUT_ERROR, "the input cannot be opened");
    do {
        if (*length == capacity) bytes = (uint8_t *)allocate(bytes, capacity = 2 * capacity + 65536);
        *length += fread(bytes + *length, 1, capacity - *length, file);
    } while (!feof(file) && !ferror(file));
    if (ferror(file)) fail(INPUT_OUTPUT_ERROR, "the input cannot be read");
    fclose(file);
    return bytes;
}

static FILE *open_output(const char *path)
{
    FILE *file = fopen(path, "wb");
    if (file == NULL) fail(INPUT_OUTPUT_ERROR, "the output cannot be opened");
    return file;
}

static void close_output(FILE *file)
{
    if (ferror(file) || fclose(file) != 0) fail(INPUT_OUTPUT_ERROR, "the output cannot be written");
}

static void put_bytes(FILE *file, const void *bytes, size_t length)
{
    if (length > 0) fwrite(bytes, 1, length, file);
}

static void put_u32(FILE *file, uint32_t number)
{
    uint8_t bytes[4];
    for (int i = 0; i < 4; i++) bytes[i] = (uint8_t)(number >> (8 * i));
    put_bytes(file, bytes, 4);
}

static void put_f32(FILE *file, float number)
{
    uint32_t bits;
    memcpy(&bits, &number, 4);
    put_u32(file, bits);
}

static void put_f64(FILE *file, double number)
{
    uint64_t bits;
    memcpy(&bits, &number, 8);
    put_u32(file, (uint32_t)bits);
    put_u32(file, (uint32_t)(bits >> 32));
}

/* The same byte again and again. */
static void put_run(FILE *file, uint8_t byte, uint64_t count)
{
    uint8_t block[4096];
    memset(block, byte, sizeof block);
    while (count > 0) {
        const size_t part = count < sizeof block ? (size_t)count : sizeof block;
        put_bytes(file, block, part);
        count -= part;
    }
}

/* ---- The bytes of a file as they arrive ---- */

/* Gives a decoder the file in pieces: the sizes are numbers between commas, of which the last repeats. Without sizes the
 * file comes as a whole. */
typedef struct input {
    const uint8_t *file;
    size_t file_bytes;
    const char *sizes;
    uint64_t size;
    uint8_t *bytes; /* those that have arrived */
    size_t length, capacity;
} input;

/* Returns 0 if nothing more arrives. */
static int next_piece(input *in)
{
    uint64_t piece = in->file_bytes - in->length;
    if (in->bytes != NULL && piece == 0) return 0;
    if (in->sizes != NULL) {
        if (*in->sizes != '\0') {
            char *end;
            in->size = strtoull(in->sizes, &end, 10);
            if (end == in->sizes || in->size == 0 || (*end != ',' && *end != '\0')) fail(WRONG_USAGE, "sizes such as 1,7,4096");
            in->sizes = *end == ',' ? end + 1 : end;
        }
        if (in->size < piece) piece = in->size;
    }
    if (in->bytes == NULL || in->length + piece > in->capacity) {
        in->capacity = 2 * in->capacity + (size_t)piece;
        in->bytes = (uint8_t *)allocate(in->bytes, in->capacity);
    }
    if (piece > 0) memcpy(in->bytes + in->length, in->file + in->length, (size_t)piece);
    in->length += (size_t)piece;
    return 1;
}

/* ---- .ivg ---- */

/* What has been received of a grid. Vertices and records name places in the input, which may move while it grows. */
typedef struct grid_vertex {
    uint64_t linear_index;
    size_t record;
    uint32_t number;
} grid_vertex;

typedef struct grid {
    ivg_reader reader;
    int has_header;
    int has_lights, has_metadata;
    uint64_t lights_offset, lights_bytes, metadata_offset, metadata_bytes;
    ivg_record *records;
    size_t record_count, record_capacity;
    grid_vertex *vertices;
    size_t vertex_count, vertex_capacity;
} grid;

/* Takes in what has arrived. */
static frame_result read_grid(grid *grid, const uint8_t *bytes, size_t length)
{
    ivg_event event;
    while ((event = ivg_next(&grid->reader, bytes, length)).kind != IVG_STOP) {
        if (event.kind == IVG_HEADER) {
            grid->has_header = 1;
        } else if (event.kind == IVG_LIGHTS) {
            grid->has_lights = 1;
            grid->lights_offset = (uint64_t)(event.payload - bytes);
            grid->lights_bytes = event.payload_bytes;
        } else if (event.kind == IVG_METADATA) {
            grid->has_metadata = 1;
            grid->metadata_offset = (uint64_t)(event.payload - bytes);
            grid->metadata_bytes = event.payload_bytes;
        } else {
            ivg_vertices vertices;
            if (grid->record_count == grid->record_capacity) {
                grid->record_capacity = 2 * grid->record_capacity + 16;
                grid->records = (ivg_record *)allocate(grid->records, grid->record_capacity * sizeof *grid->records);
            }
            grid->records[grid->record_count] = event.record;
            ivg_first_vertex(&vertices, &grid->reader.header, &event.record);
            while (ivg_next_vertex(&vertices)) {
                if (grid->vertex_count == grid->vertex_capacity) {
                    grid->vertex_capacity = 2 * grid->vertex_capacity + 64;
                    grid->vertices = (grid_vertex *)allocate(grid->vertices, grid->vertex_capacity * sizeof *grid->vertices);
                }
                grid_vertex *vertex = &grid->vertices[grid->vertex_count++];
                vertex->linear_index = vertices.linear_index;
                vertex->record = grid->record_count;
                vertex->number = vertices.number;
            }
            grid->record_count++;
        }
    }
    return event.result;
}

static int by_linear_index(const void *a, const void *b)
{
    const uint64_t x = ((const grid_vertex *)a)->linear_index, y = ((const grid_vertex *)b)->linear_index;
    return (x > y) - (x < y);
}

static void write_grid(grid *grid, const uint8_t *bytes, FILE *out)
{
    const ivg_header *header = &grid->reader.header;
    const uint64_t count = ivg_vertex_count(header);
    if (!grid->has_header) return;
    for (int axis = 0; axis < 3; axis++) put_u32(out, header->dims[axis]);
    for (int axis = 0; axis < 3; axis++) put_f64(out, header->origin[axis]);
    for (int axis = 0; axis < 3; axis++) put_f64(out, header->step[axis]);
    put_u32(out, header->units);
    put_u32(out, header->encoding == IVG_SH2_28);

    if (grid->has_lights) {
        const uint8_t *payload = bytes + grid->lights_offset;
        uint64_t position = 0;
        ivg_named_light light;
        put_bytes(out, payload, 4); /* their number, as it is stored */
        while (ivg_next_named_light(payload, grid->lights_bytes, &position, &light)) {
            put_u32(out, (uint32_t)light.direct);
            put_u32(out, light.name_bytes);
            put_bytes(out, light.name, light.name_bytes);
        }
    } else {
        put_u32(out, 0xFFFFFFFFu);
    }
    if (grid->has_metadata) {
        put_u32(out, (uint32_t)grid->metadata_bytes);
        put_bytes(out, bytes + grid->metadata_offset, (size_t)grid->metadata_bytes);
    } else {
        put_u32(out, 0xFFFFFFFFu);
    }

    if (grid->vertex_count > 0) qsort(grid->vertices, grid->vertex_count, sizeof *grid->vertices, by_linear_index);
    uint64_t next = 0;
    for (size_t i = 0; i < grid->vertex_count; i++) { /* received */
        put_run(out, 0, grid->vertices[i].linear_index - next);
        put_run(out, 1, 1);
        next = grid->vertices[i].linear_index + 1;
    }
    put_run(out, 0, count - next);
    for (int what = 0; what < 2; what++) { /* validity, blocked */
        next = 0;
        for (size_t i = 0; i < grid->record_count; i++) {
            ivg_record record = grid->records[i];
            if (record.kind != IVG_VALIDITY) continue;
            record.payload = bytes + record.offset + 8;
            for (uint32_t j = 0; j < record.vertices; j++) {
                fputc(what == 0 ? ivg_validity(&record, j) : ivg_blocked_edges(&record, j), out);
            }
            next = record.first_vertex + record.vertices;
        }
        put_run(out, what == 0 ? 255 : 0, count - next);
    }
    for (size_t i = 0; i < grid->vertex_count; i++) {
        float values[IVG_VECTOR_VALUES];
        ivg_record record = grid->records[grid->vertices[i].record];
        record.payload = bytes + record.offset + 8;
        ivg_values(header, &record, grid->vertices[i].number, values);
        for (uint32_t j = 0; j < ivg_values_per_vertex(header); j++) put_f32(out, values[j]);
    }
}

static frame_result decode_ivg(input *in, FILE *out)
{
    grid grid;
    frame_result result;
    memset(&grid, 0, sizeof grid);
    ivg_start(&grid.reader, NULL);
    do {
        next_piece(in);
        result = read_grid(&grid, in->bytes, in->length);
    } while (result.verdict == FRAME_NEED_MORE && in->length < in->file_bytes);
    if (result.verdict == FRAME_OK && in->length < in->file_bytes) { /* what follows is judged too (COM-REC-08) */
        next_piece(in);
        result = read_grid(&grid, in->bytes, in->length);
    }
    if (result.verdict == FRAME_OK || result.verdict == FRAME_NEED_MORE) write_grid(&grid, in->bytes, out);
    free(grid.records);
    free(grid.vertices);
    return result;
}

static void prefixes_ivg(const uint8_t *bytes, size_t length, FILE *out)
{
    ivg_reader reader;
    ivg_start(&reader, NULL);
    for (size_t n = 0; n <= length; n++) {
        ivg_event event;
        do {
            event = ivg_next(&reader, bytes, n);
        } while (event.kind != IVG_STOP);
        put_u32(out, (uint32_t)event.result.verdict);
        put_u32(out, (uint32_t)reader.records);
    }
}

static void write_table(const char *table, FILE *out)
{
    float number = 0, direction[3];
    if (strcmp(table, "rgb9e5") == 0) {
        for (uint32_t exponent = 0; exponent < 32; exponent++) {
            for (uint32_t mantissa = 0; mantissa < 512; mantissa++) put_f32(out, ivg_rgb9e5_component(mantissa, exponent, 0));
        }
    } else if (strcmp(table, "f16") == 0) {
        for (uint32_t code = 0; code < 65536; code++) {
            if (ivg_binary16((uint16_t)code, &number)) {
                put_f32(out, number);
            } else {
                put_u32(out, 0xFFFFFFFFu);
            }
        }
    } else if (strcmp(table, "oct24") == 0) {
        for (int v = -2047; v <= 2047; v++) {
            for (int u = -2047; u <= 2047; u++) {
                ivg_oct24_direction(u, v, direction);
                for (int axis = 0; axis < 3; axis++) put_f32(out, direction[axis]);
            }
        }
    } else if (strcmp(table, "xyz24") == 0) {
        for (int z = -127; z <= 127; z++) {
            for (int y = -127; y <= 127; y++) {
                for (int x = -127; x <= 127; x++) {
                    const int forbidden = x == 0 && y == 0 && z == 0; /* IVG-XYZ-02 */
                    if (!forbidden) ivg_xyz24_direction(x, y, z, direction);
                    for (int axis = 0; axis < 3; axis++) {
                        if (forbidden) {
                            put_u32(out, 0xFFFFFFFFu);
                        } else {
                            put_f32(out, direction[axis]);
                        }
                    }
                }
            }
        }
    } else {
        fail(WRONG_USAGE, "no such table");
    }
}

/* ---- .pmesh ---- */

#define FINEST_COMPLETE 0xFFFFFFFFul

/* What has been received of a mesh. */
typedef struct mesh {
    pmesh_reader reader;
    void *memory;
    int has_header;
    int has_materials;
    uint64_t materials_offset, materials_bytes;
} mesh;

/* Takes in what has arrived. */
static frame_result read_mesh(mesh *mesh, const uint8_t *bytes, size_t length)
{
    pmesh_event event;
    while ((event = pmesh_next(&mesh->reader, bytes, length)).kind != PMESH_STOP) {
        if (event.kind == PMESH_MEMORY) {
            void *memory = allocate(NULL, (size_t)event.memory_bytes);
            if (!pmesh_give_memory(&mesh->reader, memory, event.memory_bytes)) fail(INPUT_OUTPUT_ERROR, "memory");
            free(mesh->memory);
            mesh->memory = memory;
        } else if (event.kind == PMESH_HEADER) {
            mesh->has_header = 1;
        } else if (event.kind == PMESH_MATERIAL_LIST) {
            mesh->has_materials = 1;
            mesh->materials_offset = (uint64_t)(event.payload - bytes);
            mesh->materials_bytes = event.payload_bytes;
        }
    }
    return event.result;
}

static void put_floats(FILE *out, const float *numbers, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) put_f32(out, numbers[i]);
}

static void put_numbers(FILE *out, const uint32_t *numbers, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) put_u32(out, numbers[i]);
}

static void write_mesh(const mesh *mesh, const uint8_t *bytes, unsigned long level, FILE *out)
{
    const pmesh_reader *reader = &mesh->reader;
    const pmesh_header *header = &reader->header;
    const pmesh_mesh *arrays = &reader->mesh;
    if (!mesh->has_header) return;
    for (int axis = 0; axis < 3; axis++) put_f64(out, header->origin[axis]);
    put_u32(out, header->attributes);
    put_u32(out, header->vertex_count);
    put_u32(out, header->wedge_count);
    put_u32(out, header->face_count);
    put_u32(out, header->base_vertices);
    put_u32(out, header->packet_count);
    put_bytes(out, bytes + reader->directory_offset, 20 * (size_t)header->packet_count); /* as it is stored */

    uint32_t names = 0;
    uint64_t position = 0;
    const uint8_t *name, *payload = bytes + mesh->materials_offset;
    uint16_t name_bytes;
    if (mesh->has_materials) {
        while (pmesh_next_material(payload, mesh->materials_bytes, &position, &name, &name_bytes)) names++;
        put_u32(out, names);
        position = 0;
        while (pmesh_next_material(payload, mesh->materials_bytes, &position, &name, &name_bytes)) {
            put_u32(out, name_bytes);
            put_bytes(out, name, name_bytes);
        }
    } else {
        put_u32(out, 0xFFFFFFFFu);
    }

    const uint32_t n = level == FINEST_COMPLETE ? pmesh_finest_level(reader) : (uint32_t)level;
    pmesh_level_counts counts;
    if (!pmesh_level(reader, n, &counts)) {
        put_u32(out, 0xFFFFFFFFu);
        return;
    }
    uint32_t *corners = (uint32_t *)allocate(NULL, 12 * (size_t)counts.faces);
    pmesh_corners(reader, n, corners);
    put_u32(out, n);
    put_u32(out, counts.vertices);
    put_u32(out, counts.wedges);
    put_u32(out, counts.faces);
    put_floats(out, arrays->positions, 3 * (uint64_t)counts.vertices);
    put_numbers(out, arrays->wedge_vertex, counts.wedges);
    if (header->attributes & PMESH_NORMALS) put_floats(out, arrays->normals, 3 * (uint64_t)counts.wedges);
    if (header->attributes & PMESH_UVS) put_floats(out, arrays->uvs, 2 * (uint64_t)counts.wedges);
    if (header->attributes & PMESH_COLOURS) put_bytes(out, arrays->colours, 4 * (size_t)counts.wedges);
    put_numbers(out, corners, 3 * (uint64_t)counts.faces);
    if (header->attributes & PMESH_MATERIALS) {
        for (uint32_t f = 0; f < counts.faces; f++) {
            fputc(arrays->materials[f] & 0xFF, out);
            fputc(arrays->materials[f] >> 8, out);
        }
    }
    free(corners);
}

static frame_result decode_pmesh(input *in, unsigned long level, FILE *out)
{
    mesh mesh;
    frame_result result;
    memset(&mesh, 0, sizeof mesh);
    pmesh_start(&mesh.reader, NULL);
    do {
        next_piece(in);
        result = read_mesh(&mesh, in->bytes, in->length);
    } while (result.verdict == FRAME_NEED_MORE && in->length < in->file_bytes);
    if (result.verdict == FRAME_OK && in->length < in->file_bytes) { /* what follows is judged too (COM-REC-08) */
        next_piece(in);
        result = read_mesh(&mesh, in->bytes, in->length);
    }
    if (result.verdict == FRAME_OK || result.verdict == FRAME_NEED_MORE) write_mesh(&mesh, in->bytes, level, out);
    free(mesh.memory);
    return result;
}

static void prefixes_pmesh(const uint8_t *bytes, size_t length, FILE *out)
{
    mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    pmesh_start(&mesh.reader, NULL);
    for (size_t n = 0; n <= length; n++) {
        put_u32(out, (uint32_t)read_mesh(&mesh, bytes, n).verdict);
        put_u32(out, mesh.reader.packets);
    }
    free(mesh.memory);
}


/* ---- Commands ---- */

static void print_capabilities(void)
{
    printf("name ivg.h and pmesh.h\n"
           "ivg decode prefix prefixes chunks\n"
           "pmesh decode prefix prefixes chunks lod\n"
           "encodings packed-oct24 packed-xyz24 pair-f16 pair-f16x4 pair-f32 vectors-f32 sh2-28\n"
           "orders slices octree explicit\n"
           "modes raw coded\n"
           "numeric rgb9e5 oct24 xyz24 f16\n"
           "codes\n");
}

static unsigned long number_argument(const char *text)
{
    char *end;
    const unsigned long number = strtoul(text, &end, 10);
    if (end == text || *end != '\0') fail(WRONG_USAGE, "a number is expected");
    return number;
}

int main(int argc, char **argv)
{
    const char *command = argc > 1 ? argv[1] : "";
    if (argc == 2 && strcmp(command, "capabilities") == 0) {
        print_capabilities();
        return 0;
    }
    if (argc == 4 && strcmp(command, "numeric") == 0) {
        FILE *out = open_output(argv[3]);
        write_table(argv[2], out);
        close_output(out);
        return 0;
    }

    int words = 0;
    if (strcmp(command, "decode") == 0 || strcmp(command, "prefixes") == 0) words = 5;
    if (strcmp(command, "prefix") == 0 || strcmp(command, "chunks") == 0 || strcmp(command, "lod") == 0) words = 6;
    if (argc != words) fail(WRONG_USAGE, "see conformance/PROTOCOL.md");
    const int is_ivg = strcmp(argv[2], "ivg") == 0;
    if (!is_ivg && strcmp(argv[2], "pmesh") != 0) fail(WRONG_USAGE, "ivg or pmesh");
    if (is_ivg && strcmp(command, "lod") == 0) fail(WRONG_USAGE, "only meshes have levels");

    input in;
    memset(&in, 0, sizeof in);
    uint8_t *file = read_file(argv[3], &in.file_bytes);
    in.file = file;
    FILE *out = open_output(argv[4]);
    if (strcmp(command, "prefixes") == 0) {
        if (is_ivg) {
            prefixes_ivg(in.file, in.file_bytes, out);
        } else {
            prefixes_pmesh(in.file, in.file_bytes, out);
        }
        close_output(out);
        free(file);
        return 0;
    }

    unsigned long level = FINEST_COMPLETE;
    if (strcmp(command, "prefix") == 0) {
        const unsigned long n = number_argument(argv[5]);
        if (n < in.file_bytes) in.file_bytes = n;
    } else if (strcmp(command, "chunks") == 0) {
        in.sizes = argv[5];
    } else if (strcmp(command, "lod") == 0) {
        level = number_argument(argv[5]);
    }
    const frame_result result = is_ivg ? decode_ivg(&in, out) : decode_pmesh(&in, level, out);
    close_output(out);
    free(in.bytes);
    free(file);
    if (result.verdict != FRAME_OK && result.verdict != FRAME_NEED_MORE) {
        printf("%d %llu\n", result.code, (unsigned long long)result.offset);
    }
    return (int)result.verdict;
}
