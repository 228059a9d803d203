/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * pmesh.h: a reader of .pmesh files (progressive meshes), version 0.2, written from spec/common.md and spec/pmesh.md.
 *
 * A single header in C99, which is valid C++ too. In one source file write
 *
 *     #define PMESH_IMPLEMENTATION
 *     #include "pmesh.h"
 *
 * and in all others only the second line. Link with -lm (for sqrt).
 *
 * The reader allocates nothing and has no global state. Its caller keeps the bytes of the file that have arrived so far in
 * one piece, gives memory for the mesh when it is asked to, and takes event by event:
 *
 *     pmesh_reader reader;
 *     pmesh_event event;
 *     pmesh_start(&reader, NULL);
 *     while ((event = pmesh_next(&reader, bytes, length)).kind != PMESH_STOP) {
 *         if (event.kind == PMESH_MEMORY) {
 *             void *block = malloc(event.memory_bytes);
 *             if (!pmesh_give_memory(&reader, block, event.memory_bytes)) ...
 *             free(old_block), which is no longer in use
 *         }
 *     }
 *     event.result.verdict is FRAME_OK, FRAME_NEED_MORE, FRAME_INVALID, FRAME_UNSUPPORTED or FRAME_LIMIT
 *
 * After FRAME_NEED_MORE the loop is run again when more bytes are there; it goes on where it stopped, so that each packet is
 * decoded once, in whatever pieces the file arrives. The bytes may have moved in memory in the meantime. The memory that is
 * asked for follows from packets of which all bytes have arrived, never from counts that are only declared (PMESH-LIM-03).
 *
 * At any time pmesh_level and pmesh_corners show any level that is complete, up or down from the one before.
 */

/* ==== Common part =================================================================================================== */
/* The frame that .ivg and .pmesh share (spec/common.md). ivg.h and pmesh.h hold the same text, so that each can be
 * used alone; whoever includes both gets it once. */

#ifndef FRAME_COMMON_PART
#define FRAME_COMMON_PART

#include <stddef.h>
#include <stdint.h>

/* COM-VERD-02: the values are those that programs report by exit status. */
typedef enum frame_verdict {
    FRAME_OK = 0,
    FRAME_NEED_MORE = 40,
    FRAME_INVALID = 41,
    FRAME_UNSUPPORTED = 42,
    FRAME_LIMIT = 43
} frame_verdict;

/* COM-VERD-01: the error codes of the frame. */
enum {
    FRAME_TRUNCATED = 100,
    FRAME_MAGIC = 101,
    FRAME_HEADER_BYTES = 102,
    FRAME_HEADER_CHECKSUM = 103,
    FRAME_CHUNK_CHECKSUM = 104,
    FRAME_RECORD_CHECKSUM = 105,
    FRAME_CHUNK_LENGTH = 106,
    FRAME_CHUNK_PADDING = 107,
    FRAME_CHUNK_REPEATED = 108,
    FRAME_CHUNK_COUNT = 109,
    FRAME_CHUNK_CRITICAL = 110,
    FRAME_RECORD_ID = 111,
    FRAME_RECORD_PADDING = 112,
    FRAME_RECORD_LENGTH = 113,
    FRAME_END_MISMATCH = 114,
    FRAME_TRAILING_BYTES = 115,
    FRAME_DATA_OFFSET = 116,
    FRAME_FILE_BYTES = 117,
    FRAME_RESERVED = 118,
    FRAME_MAJOR_VERSION = 201,
    FRAME_REQUIRED_FEATURE = 202,
    FRAME_LIMIT_HEADER_BYTES = 601,
    FRAME_LIMIT_CHUNK_BYTES = 602,
    FRAME_LIMIT_CHUNKS = 603,
    FRAME_LIMIT_RECORD_BYTES = 604
};

/* What a reader says of the bytes that it was given (COM-VERD-01). */
typedef struct frame_result {
    frame_verdict verdict;
    int code;        /* 0 with FRAME_OK, FRAME_TRUNCATED with FRAME_NEED_MORE */
    uint64_t offset; /* the byte of the file at fault; with FRAME_NEED_MORE, which has none, the first that is missing */
} frame_result;

/* Limits of both formats (COM-LIM-01). */
typedef struct frame_limits {
    uint32_t header_bytes; /* bytes of the header */
    uint32_t chunk_bytes;  /* bytes of one chunk, envelope and padding included */
    uint32_t chunks;       /* chunks of a file */
    uint32_t record_bytes; /* bytes of one record, envelope and padding included */
} frame_limits;

/* The common header (common.md, section 4). */
typedef struct frame_header {
    uint16_t major;
    uint16_t minor;
    uint32_t required_features;
    uint32_t optional_features;
    uint32_t header_bytes;
    uint64_t content_id;
    uint64_t data_offset;
    uint64_t file_bytes;
} frame_header;

#endif /* FRAME_COMMON_PART */

#if (defined(IVG_IMPLEMENTATION) || defined(PMESH_IMPLEMENTATION)) && !defined(FRAME_COMMON_IMPLEMENTATION)
#define FRAME_COMMON_IMPLEMENTATION

#include <float.h>
#include <math.h>
#include <string.h>

#if defined(__FAST_MATH__)
#error "These formats are decoded bit by bit (IVG-ENC-03): compile without -ffast-math."
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "Operations must be rounded to the type of their operands (COM-INT-01); on x86 use -msse2 -mfpmath=sse."
#endif

#define FRAME_COMMON_HEADER_BYTES 56u           /* common.md, section 4 */
#define FRAME_HEADER_BYTES_MAXIMUM 65536u       /* COM-HDR-04 */
#define FRAME_CHUNK_BYTES_MAXIMUM 2147483640u   /* COM-CHK-02 */
#define FRAME_CHUNKS_MAXIMUM 65535u             /* COM-CHK-08 */
#define FRAME_RECORD_BYTES_MAXIMUM 2147483644u  /* COM-LIM-02 */
#define FRAME_CHUNK_ENVELOPE 20u                /* common.md, section 6 */
#define FRAME_RECORD_ENVELOPE 12u               /* COM-REC-01 */
#define FRAME_END_RECORD_BYTES 20u              /* COM-REC-07 */
#define FRAME_END_RECORD_ID 0xFFFFFFFFu         /* COM-REC-07 */

static inline frame_result frame_ok(void)
{
    frame_result result;
    result.verdict = FRAME_OK;
    result.code = 0;
    result.offset = 0;
    return result;
}

static inline frame_result frame_need_more(uint64_t length)
{
    frame_result result;
    result.verdict = FRAME_NEED_MORE;
    result.code = FRAME_TRUNCATED;
    result.offset = length;
    return result;
}

/* The verdict of each code is that of spec/tables/errors.toml. */
static inline frame_result frame_error(int code, uint64_t offset)
{
    frame_result result;
    result.code = code;
    result.offset = offset;
    switch (code) {
    case FRAME_CHUNK_CRITICAL:
    case FRAME_RESERVED:
    case FRAME_MAJOR_VERSION:
    case FRAME_REQUIRED_FEATURE:
    case 353: /* PMESH_MODE_UNKNOWN */
    case 355: /* PMESH_POSITIONS_UNKNOWN */
    case 402: /* IVG_ENCODING_UNKNOWN */
    case 404: /* IVG_ORDER_UNKNOWN */
    case 405: /* IVG_UNITS_UNKNOWN */
        result.verdict = FRAME_UNSUPPORTED;
        break;
    default:
        result.verdict = code >= 600 ? FRAME_LIMIT : FRAME_INVALID;
        break;
    }
    return result;
}

/* ---- Numbers (COM-INT-01) ---- */

static inline uint16_t frame_u16(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | (bytes[1] << 8));
}

static inline uint32_t frame_u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static inline uint64_t frame_u64(const uint8_t *bytes)
{
    return (uint64_t)frame_u32(bytes) | (uint64_t)frame_u32(bytes + 4) << 32;
}

static inline float frame_float_of_bits(uint32_t bits)
{
    float number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

static inline uint32_t frame_bits_of_float(float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static inline float frame_f32(const uint8_t *bytes)
{
    return frame_float_of_bits(frame_u32(bytes));
}

static inline double frame_f64(const uint8_t *bytes)
{
    uint64_t bits = frame_u64(bytes);
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

static inline int frame_is_finite_f32(float number)
{
    return (frame_bits_of_float(number) & 0x7F800000u) != 0x7F800000u;
}

static inline int frame_is_finite_f64(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return ((bits >> 52) & 0x7FFu) != 0x7FFu;
}

/* 2 to the power of an exponent in -1022 ... 1023. */
static inline double frame_power_of_two(int exponent)
{
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* COM-INT-02 */
static inline uint64_t frame_splitmix64(uint64_t seed, uint64_t n)
{
    uint64_t z = seed + UINT64_C(0x9E3779B97F4A7C15) * (n + 1);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Text is UTF-8 as in RFC 3629 (COM-INT-01): no overlong forms, no surrogates, nothing above U+10FFFF. */
static inline int frame_is_utf8(const uint8_t *text, size_t length)
{
    size_t i = 0;
    while (i < length) {
        uint8_t first = text[i];
        uint8_t least = 0x80, greatest = 0xBF; /* of the second byte */
        size_t following, j;
        if (first < 0x80) {
            i++;
            continue;
        }
        if (first >= 0xC2 && first <= 0xDF) {
            following = 1;
        } else if (first >= 0xE0 && first <= 0xEF) {
            following = 2;
            if (first == 0xE0) least = 0xA0;
            if (first == 0xED) greatest = 0x9F;
        } else if (first >= 0xF0 && first <= 0xF4) {
            following = 3;
            if (first == 0xF0) least = 0x90;
            if (first == 0xF4) greatest = 0x8F;
        } else {
            return 0;
        }
        if (length - i <= following || text[i + 1] < least || text[i + 1] > greatest) return 0;
        for (j = 2; j <= following; j++) {
            if (text[i + j] < 0x80 || text[i + j] > 0xBF) return 0;
        }
        i += following + 1;
    }
    return 1;
}

/* COM-CRC-01: takes the CRC-32 of what came before, 0 at first, on over further bytes; four bits at a time. */
static inline uint32_t frame_crc32(uint32_t crc, const uint8_t *bytes, uint64_t length)
{
    static const uint32_t table[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u, 0x5005713Cu,
        0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu, 0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu
    };
    uint64_t i;
    crc = ~crc;
    for (i = 0; i < length; i++) {
        crc ^= bytes[i];
        crc = (crc >> 4) ^ table[crc & 15];
        crc = (crc >> 4) ^ table[crc & 15];
    }
    return ~crc;
}

/* COM-CRC-02: the checksum of a chunk or record, content id first. */
static inline uint32_t frame_checksum(uint64_t content_id, const uint8_t *bytes, uint64_t length)
{
    uint8_t id[8];
    int i;
    for (i = 0; i < 8; i++) id[i] = (uint8_t)(content_id >> (8 * i));
    return frame_crc32(frame_crc32(0, id, 8), bytes, length);
}

/* Whether a stored checksum is another than the computed one: the only place that compares them. A fuzzer cannot guess a
 * checksum, so with IVG_FUZZING defined, which no program that reads files should do, every one counts as right. */
static inline int frame_is_other_checksum(uint32_t computed, const uint8_t *stored)
{
#if defined(IVG_FUZZING)
    (void)computed;
    (void)stored;
    return 0;
#else
    return computed != frame_u32(stored);
#endif
}

static inline int frame_all_zero(const uint8_t *bytes, uint64_t length)
{
    uint64_t i = 0;
    while (i < length && bytes[i] == 0) i++;
    return i == length;
}

/* ---- Header (common.md, section 4) ---- */

/* Judges the common header in the order of COM-HDR-03. FRAME_OK: the whole header is there, its checksum is right, and all
 * before the specific header is judged. `letters` are the three capital letters of the magic, `minor` is the version that
 * the reader knows and `header_bytes` the length of its header. */
static inline frame_result frame_read_header(const uint8_t *bytes, uint64_t length, const char *letters, uint16_t minor,
    uint32_t header_bytes, const frame_limits *limits, frame_header *header)
{
    uint8_t magic[8];
    uint64_t i;
    uint32_t crc;
    magic[0] = 0x89;
    for (i = 0; i < 3; i++) magic[i + 1] = (uint8_t)letters[i];
    magic[4] = 0x0D;
    magic[5] = 0x0A;
    magic[6] = 0x1A;
    magic[7] = 0x0A;
    for (i = 0; i < 8; i++) {
        if (i >= length) return frame_need_more(length);
        if (bytes[i] != magic[i]) return frame_error(FRAME_MAGIC, i);
    }
    if (length < 10) return frame_need_more(length);
    header->major = frame_u16(bytes + 8);
    if (header->major != 0) return frame_error(FRAME_MAJOR_VERSION, 8);
    if (length < 24) return frame_need_more(length);
    header->minor = frame_u16(bytes + 10);
    header->header_bytes = frame_u32(bytes + 20);
    if (header->minor <= minor) { /* COM-HDR-04 */
        if (header->header_bytes != header_bytes) return frame_error(FRAME_HEADER_BYTES, 20);
    } else if (header->header_bytes % 8 != 0 || header->header_bytes < header_bytes ||
               header->header_bytes > FRAME_HEADER_BYTES_MAXIMUM) {
        return frame_error(FRAME_HEADER_BYTES, 20);
    }
    if (header->header_bytes > limits->header_bytes) return frame_error(FRAME_LIMIT_HEADER_BYTES, 20);
    if (length < header->header_bytes) return frame_need_more(length);
    crc = frame_crc32(frame_crc32(0, bytes, 28), bytes + 32, header->header_bytes - 32);
    if (frame_is_other_checksum(crc, bytes + 28)) return frame_error(FRAME_HEADER_CHECKSUM, 28);
    if (frame_u32(bytes + 24) != 0) return frame_error(FRAME_RESERVED, 24);
    header->required_features = frame_u32(bytes + 12);
    header->optional_features = frame_u32(bytes + 16);
    if (header->required_features != 0) return frame_error(FRAME_REQUIRED_FEATURE, 12);
    header->content_id = frame_u64(bytes + 32);
    header->data_offset = frame_u64(bytes + 40);
    header->file_bytes = frame_u64(bytes + 48);
    if (header->data_offset % 8 != 0 || header->data_offset < header->header_bytes ||
        header->data_offset > header->file_bytes) {
        return frame_error(FRAME_DATA_OFFSET, 40); /* COM-HDR-09 */
    }
    return frame_ok();
}

/* ---- Chunks (common.md, section 6) ---- */

typedef struct frame_chunk {
    uint64_t offset;         /* of its first byte in the file */
    uint64_t total;          /* its length, envelope and padding included */
    const uint8_t *payload;
    uint64_t payload_offset; /* in the file */
    uint64_t payload_bytes;
} frame_chunk;

/* Judges a chunk up to its type (COM-CHK-03). `number` is that of the chunk, from 0. It is only called where
 * position < data_offset. */
static inline frame_result frame_read_chunk(const uint8_t *bytes, uint64_t length, const frame_header *header,
    const frame_limits *limits, uint64_t position, uint32_t number, frame_chunk *chunk)
{
    uint64_t space = header->data_offset - position;
    uint64_t padding;
    const uint8_t *start;
    if (number >= FRAME_CHUNKS_MAXIMUM) return frame_error(FRAME_CHUNK_COUNT, position);
    if (number >= limits->chunks) return frame_error(FRAME_LIMIT_CHUNKS, position);
    if (space < FRAME_CHUNK_ENVELOPE) return frame_error(FRAME_CHUNK_LENGTH, position); /* COM-CHK-02 */
    if (length < position || length - position < 16) return frame_need_more(length);
    start = bytes + position;
    chunk->offset = position;
    chunk->payload_bytes = frame_u64(start + 8);
    if (chunk->payload_bytes > FRAME_CHUNK_BYTES_MAXIMUM - FRAME_CHUNK_ENVELOPE) {
        return frame_error(FRAME_CHUNK_LENGTH, position + 8);
    }
    chunk->total = (chunk->payload_bytes + FRAME_CHUNK_ENVELOPE + 7) / 8 * 8; /* COM-CHK-04 */
    if (chunk->total > FRAME_CHUNK_BYTES_MAXIMUM || chunk->total > space) {
        return frame_error(FRAME_CHUNK_LENGTH, position + 8);
    }
    if (chunk->total > limits->chunk_bytes) return frame_error(FRAME_LIMIT_CHUNK_BYTES, position + 8);
    if (length - position < chunk->total) return frame_need_more(length);
    if (frame_is_other_checksum(frame_checksum(header->content_id, start, chunk->total - 4), start + chunk->total - 4)) {
        return frame_error(FRAME_CHUNK_CHECKSUM, position + chunk->total - 4); /* COM-CHK-05 */
    }
    if ((start[4] & 0xFE) != 0 || start[5] != 0 || start[6] != 0 || start[7] != 0) {
        return frame_error(FRAME_RESERVED, position + 4); /* COM-CHK-01 */
    }
    padding = chunk->total - FRAME_CHUNK_ENVELOPE - chunk->payload_bytes;
    if (!frame_all_zero(start + 16 + chunk->payload_bytes, padding)) {
        return frame_error(FRAME_CHUNK_PADDING, position + 16 + chunk->payload_bytes);
    }
    chunk->payload = start + 16;
    chunk->payload_offset = position + 16;
    return frame_ok();
}

static inline int frame_chunk_is(const uint8_t *bytes, const frame_chunk *chunk, const char *type)
{
    return memcmp(bytes + chunk->offset, type, 4) == 0;
}

/* COM-CHK-01: bit 0 of the flags. */
static inline int frame_chunk_is_critical(const uint8_t *bytes, const frame_chunk *chunk)
{
    return (bytes[chunk->offset + 4] & 1) != 0;
}

/* ---- Records (common.md, section 7) ---- */

/* COM-REC-01; the payload has at most 2^62 bytes. */
static inline uint64_t frame_record_bytes(uint64_t payload_bytes)
{
    return (payload_bytes + FRAME_RECORD_ENVELOPE + 3) / 4 * 4;
}

/* Judges checksum, id and padding of a record (COM-REC-05) of which all bytes are there. */
static inline frame_result frame_read_record(const uint8_t *record, uint64_t offset, uint64_t content_id, uint32_t id,
    uint64_t payload_bytes)
{
    uint64_t total = frame_record_bytes(payload_bytes);
    uint64_t padding = total - FRAME_RECORD_ENVELOPE - payload_bytes;
    if (frame_is_other_checksum(frame_checksum(content_id, record, total - 4), record + total - 4)) {
        return frame_error(FRAME_RECORD_CHECKSUM, offset + total - 4);
    }
    if (frame_u32(record) != id) return frame_error(FRAME_RECORD_ID, offset);
    if (!frame_all_zero(record + 8 + payload_bytes, padding)) {
        return frame_error(FRAME_RECORD_PADDING, offset + 8 + payload_bytes);
    }
    return frame_ok();
}

/* Judges the end record (COM-REC-07) of which all bytes are there. */
static inline frame_result frame_read_end(const uint8_t *record, uint64_t offset, const frame_header *header)
{
    frame_result result = frame_read_record(record, offset, header->content_id, FRAME_END_RECORD_ID, 8);
    if (result.verdict != FRAME_OK) return result;
    if (frame_u32(record + 4) != 0) return frame_error(FRAME_END_MISMATCH, offset + 4);
    if (frame_u64(record + 8) != header->file_bytes) return frame_error(FRAME_END_MISMATCH, offset + 8);
    return frame_ok();
}

#endif /* FRAME_COMMON_IMPLEMENTATION */
/* ==== End of the common part ======================================================================================== */
#ifndef PMESH_H
#define PMESH_H

#ifdef __cplusplus
extern "C" {
#endif

/* Error codes of .pmesh (pmesh.md, section 9); those of the frame begin with FRAME_. */
enum {
    PMESH_COUNTS = 351,
    PMESH_MODE_FORBIDDEN = 352,
    PMESH_MODE_UNKNOWN = 353,
    PMESH_POSITIONS_FORBIDDEN = 354,
    PMESH_POSITIONS_UNKNOWN = 355,
    PMESH_MESH_ORIGIN = 356,
    PMESH_BOUNDS = 357,
    PMESH_DIRECTORY_MISSING = 358,
    PMESH_DIRECTORY_LENGTH = 359,
    PMESH_DIRECTORY_COUNTS = 360,
    PMESH_DIRECTORY_BYTES = 361,
    PMESH_DIRECTORY_ERROR = 362,
    PMESH_MATERIAL_NAMES = 363,
    PMESH_PARAMETERS = 364,
    PMESH_POSITION = 501,
    PMESH_ATTRIBUTE = 502,
    PMESH_PARENT = 503,
    PMESH_CORNER = 504,
    PMESH_FACE_VERTICES = 505,
    PMESH_VARINT = 508,
    PMESH_WEDGE_COUNT = 509,
    PMESH_WEDGE_TARGET = 510,
    PMESH_SWITCH = 511,
    PMESH_PACKET_LENGTH = 512,
    PMESH_PACKET_PADDING = 513,
    PMESH_PACKET_ORDER = 514,
    PMESH_CODED_LENGTH = 515,
    PMESH_CODED_PADDING = 516,
    PMESH_CODED_FACES = 517,
    PMESH_CODED_WORK = 518,
    PMESH_SWITCH_SLOTS = 519,
    PMESH_SWITCH_WORK = 520,
    PMESH_LIMIT_COUNTS = 620
};

/* Modes (PMESH-HDR-03). */
enum { PMESH_RAW = 1, PMESH_CODED = 2 };

/* Encodings of positions (PMESH-HDR-04): binary32, or 10 to 16 bits, which is 8 more than the registry value. */
enum { PMESH_F32 = 1, PMESH_Q10 = 2, PMESH_Q16 = 8 };

/* Bits of `attributes` (PMESH-HDR-05). */
enum {
    PMESH_NORMALS = 1,
    PMESH_UVS = 2,
    PMESH_COLOURS = 4,
    PMESH_MATERIALS = 8,
    PMESH_SEAMS = 16
};

/* What pmesh_finest_level returns while no level is complete. */
#define PMESH_NO_LEVEL 0xFFFFFFFFu

/* What a reader refuses with the verdict FRAME_LIMIT (COM-LIM-01). */
typedef struct pmesh_limits {
    frame_limits frame;
    uint32_t counts; /* vertices, wedges or faces, whichever are most (PMESH-LIM-02) */
} pmesh_limits;

/* The header (pmesh.md, section 2). */
typedef struct pmesh_header {
    frame_header frame;
    uint32_t vertex_count;
    uint32_t wedge_count;
    uint32_t face_count;
    uint32_t base_vertices;
    uint32_t packet_count;
    uint8_t mode;
    uint8_t positions;
    uint16_t attributes;
    double origin[3];    /* what is added to each position, in metres (PMESH-HDR-06) */
    float bounds_min[3]; /* of stored positions, in metres */
    float bounds_max[3];
    uint8_t normal_bits;
    uint8_t uv_bits;
    float uv_min[2];
    float uv_max[2];
} pmesh_header;

/* A packet: its entry in the directory (PMESH-DIR-02), and where its record lies. */
typedef struct pmesh_packet {
    uint32_t number;
    uint32_t start_vertex, end_vertex; /* it brings what lies between */
    uint32_t start_wedge, end_wedge;
    uint32_t start_face, end_face;
    uint32_t payload_bytes;
    float error;     /* estimated error of its levels, in metres (PMESH-DIR-05) */
    uint64_t offset; /* of its record in the file */
    uint64_t length; /* of its record, envelope and padding included */
} pmesh_packet;

/* The mesh so far: arrays in the memory of the caller, made of all packets that have been accepted. A level is a prefix of
 * each array, but for the corners, which pmesh_corners maps. Pointers change with pmesh_give_memory. */
typedef struct pmesh_mesh {
    uint32_t vertices, wedges, faces;
    float *positions;         /* 3 a vertex: stored positions in metres, without the origin (PMESH-POS-01, -03) */
    uint32_t *collapse;       /* of each vertex from base_vertices on: its parent (PMESH-DEF-03) */
    uint32_t *first_wedge;    /* of each vertex: its first wedge; one more at the end */
    uint32_t *wedge_vertex;   /* of each wedge: its vertex */
    uint32_t *wedge_collapse; /* of each wedge of these vertices: what it becomes (PMESH-DEF-03) */
    float *normals;           /* 3 a wedge; NULL if the file has none */
    float *uvs;               /* 2 a wedge; NULL if the file has none */
    uint8_t *colours;         /* 4 a wedge: red, green, blue in sRGB, alpha linear; NULL if the file has none */
    uint32_t *corners;        /* 3 a face: wedges, as at the finest level that is complete */
    uint32_t *face_level;     /* of each face: the level from which on it is there (PMESH-FACE-05); never falls */
    uint16_t *materials;      /* of each face; NULL if the file has none: material 0 */
} pmesh_mesh;

/* A level of the mesh (PMESH-DEF-04): so many of the first vertices, wedges and faces. */
typedef struct pmesh_level_counts {
    uint32_t vertices, wedges, faces;
} pmesh_level_counts;

typedef enum pmesh_event_kind {
    PMESH_STOP,           /* nothing more for now: `result` says why */
    PMESH_MEMORY,         /* give `memory_bytes` of memory (pmesh_give_memory) and go on */
    PMESH_HEADER,         /* header and directory are known: `reader->header`, pmesh_packet_of */
    PMESH_MATERIAL_LIST,  /* the chunk MTRL is there: `payload`, for pmesh_next_material */
    PMESH_PACKET          /* a packet has been accepted: `packet`; its levels are complete (PMESH-DIR-06) */
} pmesh_event_kind;

typedef struct pmesh_event {
    pmesh_event_kind kind;
    frame_result result;    /* FRAME_OK with all kinds but PMESH_STOP */
    uint64_t memory_bytes;  /* with PMESH_MEMORY */
    pmesh_packet packet;    /* with PMESH_PACKET */
    const uint8_t *payload; /* with PMESH_MATERIAL_LIST */
    uint64_t payload_bytes;
} pmesh_event;

typedef enum pmesh_phase { PMESH_IN_HEADER, PMESH_IN_CHUNKS, PMESH_IN_PACKETS, PMESH_AT_END, PMESH_REFUSED } pmesh_phase;

/* For how much the arrays have room. */
typedef struct pmesh_capacity {
    uint32_t vertices, wedges, faces, payload_bytes;
} pmesh_capacity;

/* The slots of each vertex (PMESH-DEF-06), ascending, as linked lists; for coded packets. */
typedef struct pmesh_slots {
    uint32_t *first; /* of a vertex */
    uint32_t *last;
    uint32_t *count;
    uint32_t *next;  /* of a slot */
} pmesh_slots;

/* Arrays that are no part of the mesh. */
typedef struct pmesh_work {
    /* Of wedges: how many members have this key, and where they begin (see pmesh_group); 0 between uses. */
    uint32_t *group_count;
    uint32_t *group_begin;
    uint32_t *keys;    /* as many as wedges or faces, whichever are more */
    uint32_t *members;
    uint32_t *depth;   /* mode raw: of each wedge of a packet (PMESH-SWI-07) */
    /* Mode coded: */
    struct pmesh_models *models;
    int32_t *cells;           /* 3 a vertex (PMESH-COD-05) */
    uint8_t *scale;
    uint8_t *height_class;
    uint32_t *packet;
    uint8_t *split;
    uint32_t *corner_vertex;  /* 3 a face: vertices, in the first pass */
    pmesh_slots slots;        /* in the first pass */
    pmesh_slots second_slots; /* in the second pass */
    uint32_t *slot_list;      /* the slots of one vertex */
    uint8_t *switch_bits;     /* which slots switch, split by split: at most 64 bits a byte of payload (PMESH-COD-12) */
    int16_t *normal_codes;    /* 2 a wedge */
    uint16_t *uv_points;      /* 2 a wedge */
    uint8_t *value_classes;   /* 3 a wedge */
} pmesh_work;

/* The state of a reader. Callers may read `header` after the event PMESH_HEADER, `mesh`, `position`, `packets` at any time. */
typedef struct pmesh_reader {
    pmesh_header header;
    pmesh_limits limits;
    int stream_mode;           /* 1: bytes behind the end record are left to the caller (COM-REC-08); 0 after pmesh_start */
    pmesh_phase phase;
    uint64_t position;         /* bytes of whole header, chunks and records so far (COM-STR-02) */
    uint32_t packets;          /* whole packets so far */
    uint32_t chunks;           /* whole chunks so far */
    uint64_t directory_offset; /* of the payload of PDIR in the file */
    int has_material_list;
    frame_result error;        /* with PMESH_REFUSED */
    pmesh_mesh mesh;
    pmesh_work work;
    pmesh_capacity capacity;
    pmesh_capacity wanted;     /* what has been asked for */
} pmesh_reader;

/* The limits of the column "default" (common.md, section 9; pmesh.md, section 10). */
pmesh_limits pmesh_default_limits(void);

/* Begins a file. `limits` may be NULL for the default ones. Does not fail. */
void pmesh_start(pmesh_reader *reader, const pmesh_limits *limits);

/* The next event of a file of which the first `length` bytes are at `bytes`: all that were there in earlier calls, and any
 * number of new ones. Everything is judged in the order of COM-HDR-03, PMESH-HDR-01, COM-CHK-03, COM-REC-05 and PMESH-PKT-03;
 * the verdict and the events, but for PMESH_MEMORY, are the same in whatever pieces the bytes come (COM-STR-03). The kind
 * PMESH_STOP comes with the verdict
 *
 *   FRAME_OK           the file is whole; in file mode with nothing behind it (COM-REC-08),
 *   FRAME_NEED_MORE    so far a proper prefix of a valid file (COM-STR-01),
 *   FRAME_INVALID, FRAME_UNSUPPORTED, FRAME_LIMIT    with the error's code and the offset of the byte at fault, and again
 *                      the same for every further call (COM-VERD-03). Levels that were complete before can still be shown
 *                      (PMESH-LVL-04).
 *
 * Cost: in proportion to the new whole chunks and records (PMESH-LIM-04); a call without any costs next to nothing. */
pmesh_event pmesh_next(pmesh_reader *reader, const uint8_t *bytes, uint64_t length);

/* Answers PMESH_MEMORY: `memory`, aligned as malloc aligns, has `bytes` bytes, at least those asked for. What the reader had
 * is copied into it, and the memory given before is no longer in use. Returns 0, and changes nothing, if `memory` is NULL,
 * not aligned to 8 bytes, or too small; else 1. The memory stays the caller's. */
int pmesh_give_memory(pmesh_reader *reader, void *memory, uint64_t bytes);

/* Packet k, from 0, of header.packet_count, after the event PMESH_HEADER; `file` are the first bytes of the file, at least
 * its first header.frame.data_offset ones. Cost: in proportion to k, since the place is a sum. */
pmesh_packet pmesh_packet_of(const pmesh_reader *reader, const uint8_t *file, uint32_t k);

/* The memory that must be given (pmesh_give_memory) before the next packet can be taken in by pmesh_read_packet; 0 if there
 * is enough. `file` as in pmesh_packet_of. To be called when the bytes of that packet are there. */
uint64_t pmesh_packet_memory(pmesh_reader *reader, const uint8_t *file);

/* Takes in packet k that was fetched alone (COM-REC-06): `bytes` begin with its record; `file` as in pmesh_packet_of. A
 * packet that is not the next one is PMESH_PACKET_ORDER (PMESH-LVL-04), which does not end the reading; nor do
 * FRAME_NEED_MORE, for fewer bytes than the record has or too little memory (pmesh_packet_memory), and FRAME_RECORD_LENGTH
 * for more. Other errors are those of packets, with offsets in the file. */
frame_result pmesh_read_packet(pmesh_reader *reader, const uint8_t *file, uint32_t k, const uint8_t *bytes, uint64_t length);

/* The finest level that is complete (PMESH-DIR-06): the end_vertex of the last packet accepted; 0 for a mesh without vertices
 * as soon as its header is known; PMESH_NO_LEVEL before. */
uint32_t pmesh_finest_level(const pmesh_reader *reader);

/* The counts of level n, base_vertices <= n <= pmesh_finest_level (PMESH-LVL-01). Returns 0 if there is no such level, else 1.
 * Cost: the logarithm of the number of faces. */
int pmesh_level(const pmesh_reader *reader, uint32_t n, pmesh_level_counts *counts);

/* Writes the corners of level n, 3 wedges for each of its faces, as mapped at that level (PMESH-DEF-04). Returns 0 if there is
 * no such level, else 1. Cost: in proportion to the faces of the level and to the corners that switch between it and the
 * finest level; together at most a constant times the bytes of the packets (PMESH-SWI-07, PMESH-COD-12). */
int pmesh_corners(const pmesh_reader *reader, uint32_t n, uint32_t *corners);

/* The next name of the payload of MTRL (PMESH-MTRL-02), in UTF-8, not ended by a zero; untrusted text (common.md, section 11).
 * `position` is 0 before the first call. Returns 0 behind the last one. */
int pmesh_next_material(const uint8_t *payload, uint64_t payload_bytes, uint64_t *position, const uint8_t **name,
    uint16_t *name_bytes);

#ifdef __cplusplus
}
#endif

#endif /* PMESH_H */

#ifdef PMESH_IMPLEMENTATION
#ifndef PMESH_IMPLEMENTED
#define PMESH_IMPLEMENTED

#define PMESH_MINOR 2u                        /* COM-HDR-02 */
#define PMESH_HEADER_BYTES 152u               /* pmesh.md, section 2 */
#define PMESH_COUNTS_MAXIMUM 1073741824u      /* PMESH-LIM-01 */
#define PMESH_ENTRY_BYTES 20u                 /* PMESH-DIR-02 */
#define PMESH_PARAMETER_BITS_LEAST 4          /* PMESH-HDR-08 */
#define PMESH_PARAMETER_BITS_GREATEST 16      /* PMESH-HDR-08 */
#define PMESH_VARINT_BYTES 5u                 /* PMESH-PKT-04 */
#define PMESH_DEPTH_PER_BYTE 8u               /* PMESH-SWI-07 */
#define PMESH_FACES_PER_BYTE 64u              /* PMESH-COD-12 */
#define PMESH_BATCH 64u                       /* PMESH-COD-07 */
#define PMESH_ORDERED_FACES 32u               /* PMESH-COD-08 */
#define PMESH_NEIGHBOURS 34u                  /* PMESH-COD-10, 1 */
#define PMESH_BESIDE_SLOTS 32u                /* PMESH-COD-14, 4 */
#define PMESH_VALUE_SLOTS 16u                 /* PMESH-COD-15, 1 */
#define PMESH_BASE_CLASS 12                   /* PMESH-COD-17 */
#define PMESH_STATE_END UINT32_C(0x10000)     /* PMESH-COD-03, 3 */
#define PMESH_NONE 0xFFFFFFFFu                /* no slot, no face, no vertex */

pmesh_limits pmesh_default_limits(void)
{
    pmesh_limits limits;
    limits.frame.header_bytes = 4096;
    limits.frame.chunk_bytes = 1048576;
    limits.frame.chunks = 1024;
    limits.frame.record_bytes = 67108864;
    limits.counts = 134217728;
    return limits;
}

static uint32_t pmesh_greater(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* The number of binary digits of x, 0 for 0: the bits that a number up to x needs. */
static unsigned pmesh_bits(uint64_t x)
{
    unsigned bits = 0;
    while (x != 0) {
        bits++;
        x >>= 1;
    }
    return bits;
}

/* The logarithm to base 2 of x >= 1, rounded up. */
static unsigned pmesh_log2_up(uint64_t x)
{
    return pmesh_bits(x - 1);
}

/* ---- Header (pmesh.md, section 2) ---- */

/* PMESH-HDR-08 */
static frame_result pmesh_check_parameters(const pmesh_header *header)
{
    const int coded = header->mode == PMESH_CODED;
    const int normals = coded && (header->attributes & PMESH_NORMALS) != 0;
    const int uvs = coded && (header->attributes & PMESH_UVS) != 0;
    if (normals ? header->normal_bits < PMESH_PARAMETER_BITS_LEAST || header->normal_bits > PMESH_PARAMETER_BITS_GREATEST
                : header->normal_bits != 0) {
        return frame_error(PMESH_PARAMETERS, 128);
    }
    if (uvs ? header->uv_bits < PMESH_PARAMETER_BITS_LEAST || header->uv_bits > PMESH_PARAMETER_BITS_GREATEST
            : header->uv_bits != 0) {
        return frame_error(PMESH_PARAMETERS, 129);
    }
    for (int i = 0; i < 2; i++) {
        if (uvs ? !frame_is_finite_f32(header->uv_min[i]) : header->uv_min[i] != 0) return frame_error(PMESH_PARAMETERS, 132);
    }
    for (int i = 0; i < 2; i++) {
        if (uvs ? !frame_is_finite_f32(header->uv_max[i]) || header->uv_min[i] > header->uv_max[i] : header->uv_max[i] != 0) {
            return frame_error(PMESH_PARAMETERS, 140);
        }
    }
    return frame_ok();
}

/* Judges the specific header in the order of PMESH-HDR-01, without the directory. */
static frame_result pmesh_read_specific_header(const uint8_t *bytes, const pmesh_limits *limits, pmesh_header *header)
{
    header->vertex_count = frame_u32(bytes + 56);
    header->wedge_count = frame_u32(bytes + 60);
    header->face_count = frame_u32(bytes + 64);
    header->base_vertices = frame_u32(bytes + 68);
    header->packet_count = frame_u32(bytes + 72);
    header->mode = bytes[76];
    header->positions = bytes[77];
    header->attributes = frame_u16(bytes + 78);
    for (int axis = 0; axis < 3; axis++) {
        header->origin[axis] = frame_f64(bytes + 80 + 8 * axis);
        header->bounds_min[axis] = frame_f32(bytes + 104 + 4 * axis);
        header->bounds_max[axis] = frame_f32(bytes + 116 + 4 * axis);
    }
    header->normal_bits = bytes[128];
    header->uv_bits = bytes[129];
    for (int i = 0; i < 2; i++) {
        header->uv_min[i] = frame_f32(bytes + 132 + 4 * i);
        header->uv_max[i] = frame_f32(bytes + 140 + 4 * i);
    }

    const uint32_t v = header->vertex_count, w = header->wedge_count, f = header->face_count;
    const uint32_t base = header->base_vertices, packets = header->packet_count;
    const int seams = (header->attributes & PMESH_SEAMS) != 0;
    const int values = (header->attributes & (PMESH_NORMALS | PMESH_UVS | PMESH_COLOURS)) != 0;
    if (header->attributes >= 2 * PMESH_SEAMS) return frame_error(FRAME_RESERVED, 78); /* PMESH-HDR-05 */
    if (v > PMESH_COUNTS_MAXIMUM) return frame_error(PMESH_COUNTS, 56);                /* PMESH-HDR-02 */
    if (seams ? w < v || w > PMESH_COUNTS_MAXIMUM || (v == 0 && w != 0) || !values : w != v) {
        return frame_error(PMESH_COUNTS, 60);
    }
    if (f > PMESH_COUNTS_MAXIMUM || (v == 0 && f != 0)) return frame_error(PMESH_COUNTS, 64);
    if (v == 0 ? base != 0 : base < 1 || base > v) return frame_error(PMESH_COUNTS, 68);
    if (v == 0 ? packets != 0 : packets < 1 || packets > v - base + 1) return frame_error(PMESH_COUNTS, 72);
    if (header->mode == 0) return frame_error(PMESH_MODE_FORBIDDEN, 76);
    if (header->mode > PMESH_CODED) return frame_error(PMESH_MODE_UNKNOWN, 76);
    if (header->positions == 0) return frame_error(PMESH_POSITIONS_FORBIDDEN, 77);
    if (header->positions > PMESH_Q16) return frame_error(PMESH_POSITIONS_UNKNOWN, 77);
    for (int axis = 0; axis < 3; axis++) {
        if (!frame_is_finite_f64(header->origin[axis])) return frame_error(PMESH_MESH_ORIGIN, 80);
    }
    for (int axis = 0; axis < 3; axis++) {
        if (!frame_is_finite_f32(header->bounds_min[axis])) return frame_error(PMESH_BOUNDS, 104);
    }
    for (int axis = 0; axis < 3; axis++) {
        if (!frame_is_finite_f32(header->bounds_max[axis])) return frame_error(PMESH_BOUNDS, 116);
    }
    for (int axis = 0; axis < 3; axis++) {
        if (header->bounds_min[axis] > header->bounds_max[axis]) return frame_error(PMESH_BOUNDS, 116);
    }
    if (frame_u16(bytes + 130) != 0) return frame_error(FRAME_RESERVED, 130);
    if (frame_u32(bytes + 148) != 0) return frame_error(FRAME_RESERVED, 148);
    const frame_result result = pmesh_check_parameters(header);
    if (result.verdict != FRAME_OK) return result;
    if (v > limits->counts || w > limits->counts || f > limits->counts) return frame_error(PMESH_LIMIT_COUNTS, 56);
    return frame_ok();
}

/* ---- Chunks (pmesh.md, section 3) ---- */

/* The number of a packet's vertices from B on: s of PMESH-PKT-02. */
static uint32_t pmesh_split_count(const pmesh_header *header, const pmesh_packet *packet)
{
    return packet->end_vertex - pmesh_greater(packet->start_vertex, header->base_vertices);
}

/* The bytes of the parts up to `materials` (PMESH-PKT-02), mode raw. */
static uint64_t pmesh_array_bytes(const pmesh_header *header, const pmesh_packet *packet)
{
    const uint64_t v = packet->end_vertex - packet->start_vertex, w = packet->end_wedge - packet->start_wedge;
    const uint64_t f = packet->end_face - packet->start_face;
    uint64_t bytes = 4 + (header->positions == PMESH_F32 ? 12 : 8) * v + 12 * f;
    if (header->attributes & PMESH_NORMALS) bytes += 12 * w;
    if (header->attributes & PMESH_UVS) bytes += 8 * w;
    if (header->attributes & PMESH_COLOURS) bytes += 4 * w;
    if (header->attributes & PMESH_MATERIALS) bytes += 2 * f;
    return bytes;
}

/* The bytes of `parents`. */
static uint64_t pmesh_parent_bytes(const pmesh_header *header, const pmesh_packet *packet)
{
    return ((uint64_t)pmesh_split_count(header, packet) * pmesh_log2_up(packet->end_vertex) + 7) / 8;
}

/* What the payload of a packet must at least have: PMESH-DIR-04 or, in mode coded, PMESH-COD-12. */
static uint64_t pmesh_least_payload(const pmesh_header *header, const pmesh_packet *packet)
{
    if (header->mode == PMESH_CODED) {
        const uint64_t w = packet->end_wedge - packet->start_wedge, f = packet->end_face - packet->start_face;
        return 8 + (w + f) / 4 + packet->start_vertex / 64;
    }
    return pmesh_array_bytes(header, packet) + pmesh_parent_bytes(header, packet);
}

/* Makes the packet behind `before` from the entry of the directory; `before` is NULL for packet 0. */
static pmesh_packet pmesh_packet_after(const pmesh_header *header, const pmesh_packet *before, const uint8_t *entry)
{
    pmesh_packet packet;
    memset(&packet, 0, sizeof packet);
    packet.offset = header->frame.data_offset;
    if (before != NULL) {
        packet.number = before->number + 1;
        packet.start_vertex = before->end_vertex;
        packet.start_wedge = before->end_wedge;
        packet.start_face = before->end_face;
        packet.offset = before->offset + before->length;
    }
    packet.end_vertex = frame_u32(entry);
    packet.end_wedge = frame_u32(entry + 4);
    packet.end_face = frame_u32(entry + 8);
    packet.payload_bytes = frame_u32(entry + 12);
    packet.error = frame_f32(entry + 16);
    packet.length = frame_record_bytes(packet.payload_bytes);
    return packet;
}

/* PMESH-DIR-02 to -05, and COM-HDR-10. */
static frame_result pmesh_check_directory(const pmesh_header *header, const pmesh_limits *limits, const frame_chunk *chunk)
{
    pmesh_packet before, packet;
    if (chunk->payload_bytes != (uint64_t)header->packet_count * PMESH_ENTRY_BYTES) {
        return frame_error(PMESH_DIRECTORY_LENGTH, chunk->payload_offset);
    }
    memset(&packet, 0, sizeof packet);
    for (uint32_t k = 0; k < header->packet_count; k++) {
        const uint64_t offset = chunk->payload_offset + (uint64_t)PMESH_ENTRY_BYTES * k;
        before = packet;
        packet = pmesh_packet_after(header, k > 0 ? &before : NULL, chunk->payload + (uint64_t)PMESH_ENTRY_BYTES * k);
        if (packet.end_vertex <= packet.start_vertex || packet.end_vertex < header->base_vertices ||
            packet.end_vertex > header->vertex_count) {
            return frame_error(PMESH_DIRECTORY_COUNTS, offset); /* PMESH-DIR-03 */
        }
        const uint32_t vertices = packet.end_vertex - packet.start_vertex;
        if (packet.end_wedge < packet.start_wedge || packet.end_wedge - packet.start_wedge < vertices ||
            packet.end_wedge > header->wedge_count ||
            ((header->attributes & PMESH_SEAMS) == 0 && packet.end_wedge - packet.start_wedge != vertices)) {
            return frame_error(PMESH_DIRECTORY_COUNTS, offset + 4);
        }
        if (packet.end_face < packet.start_face || packet.end_face > header->face_count) {
            return frame_error(PMESH_DIRECTORY_COUNTS, offset + 8);
        }
        if (packet.payload_bytes < pmesh_least_payload(header, &packet) || packet.length > FRAME_RECORD_BYTES_MAXIMUM) {
            return frame_error(PMESH_DIRECTORY_BYTES, offset + 12); /* PMESH-DIR-04 */
        }
        if (packet.length > limits->frame.record_bytes) return frame_error(FRAME_LIMIT_RECORD_BYTES, offset + 12);
        if (!frame_is_finite_f32(packet.error) || packet.error < 0 || (k > 0 && packet.error > before.error)) {
            return frame_error(PMESH_DIRECTORY_ERROR, offset + 16); /* PMESH-DIR-05 */
        }
    }
    if (header->packet_count > 0) {
        const uint64_t last = chunk->payload_offset + (uint64_t)PMESH_ENTRY_BYTES * (header->packet_count - 1u);
        if (packet.end_vertex != header->vertex_count) return frame_error(PMESH_DIRECTORY_COUNTS, last);
        if (packet.end_wedge != header->wedge_count) return frame_error(PMESH_DIRECTORY_COUNTS, last);
        if (packet.end_face != header->face_count) return frame_error(PMESH_DIRECTORY_COUNTS, last);
    } else {
        packet.offset = header->frame.data_offset;
    }
    /* file_bytes >= data_offset is known (COM-HDR-09); the records have less than 2^62 bytes together */
    const uint64_t records = packet.offset - header->frame.data_offset + packet.length + FRAME_END_RECORD_BYTES;
    if (header->frame.file_bytes - header->frame.data_offset != records) return frame_error(FRAME_FILE_BYTES, 48);
    return frame_ok();
}

/* PMESH-MTRL-02 */
static frame_result pmesh_check_materials(const frame_chunk *chunk)
{
    uint64_t at = 0;
    while (at < chunk->payload_bytes) {
        if (chunk->payload_bytes - at < 2) break;
        const uint16_t name_bytes = frame_u16(chunk->payload + at);
        at += 2;
        if (chunk->payload_bytes - at < name_bytes) {
            return frame_error(PMESH_MATERIAL_NAMES, chunk->payload_offset + chunk->payload_bytes);
        }
        if (!frame_is_utf8(chunk->payload + at, name_bytes)) {
            return frame_error(PMESH_MATERIAL_NAMES, chunk->payload_offset + at);
        }
        at += name_bytes;
    }
    if (at != chunk->payload_bytes) return frame_error(PMESH_MATERIAL_NAMES, chunk->payload_offset + chunk->payload_bytes);
    return frame_ok();
}

int pmesh_next_material(const uint8_t *payload, uint64_t payload_bytes, uint64_t *position, const uint8_t **name,
    uint16_t *name_bytes)
{
    if (*position >= payload_bytes) return 0;
    *name_bytes = frame_u16(payload + *position);
    *name = payload + *position + 2;
    *position += 2u + *name_bytes;
    return 1;
}

/* ---- Models of coded packets (PMESH-COD-04) ---- */

typedef struct pmesh_binary_model {
    uint16_t probability; /* p, of the value true */
    uint16_t seen;        /* n */
} pmesh_binary_model;

typedef struct pmesh_model_of_16 {
    uint16_t starts[16]; /* s_0 = 0 < s_1 < ... < s_15 */
    uint16_t seen;       /* n */
} pmesh_model_of_16;

/* The models of residuals of classes 0 to 23. */
typedef struct pmesh_residual_models {
    pmesh_model_of_16 classes[24];
} pmesh_residual_models;

typedef struct pmesh_models {
    pmesh_binary_model parents[8 * 9 * 16]; /* PMESH-COD-07 */
    pmesh_model_of_16 counts[9 * 4];        /* PMESH-COD-09 */
    pmesh_model_of_16 ranks[4 * 9 * 4];
    pmesh_binary_model switches[3];
    pmesh_binary_model faces[16];
    pmesh_binary_model thirds[2];
    pmesh_residual_models surface; /* PMESH-COD-10 */
    pmesh_residual_models heights;
    pmesh_binary_model more[16]; /* PMESH-COD-14 */
    pmesh_binary_model targets[2];
    pmesh_binary_model same;
    pmesh_binary_model corners[6];
    pmesh_binary_model materials[2];
    pmesh_binary_model exact[3][16]; /* PMESH-COD-17 */
    pmesh_residual_models normals;
    pmesh_residual_models uvs;
    pmesh_residual_models green;
    pmesh_residual_models red_blue;
    pmesh_residual_models alpha;
} pmesh_models;

/* First starts of counts, for m = 2 ... 9, and 10 or more (PMESH-COD-09). */
static const uint16_t pmesh_counts_starts[9][15] = {
    {10860, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {4948, 19051, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {1732, 8268, 26103, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {416, 2890, 17518, 30560, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {221, 1205, 10343, 26061, 32045, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {187, 631, 5043, 19317, 30135, 32367, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {193, 417, 2607, 11481, 26019, 31522, 32487, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {209, 321, 1566, 7762, 19584, 28438, 31888, 32540, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {424, 523, 1768, 5252, 13476, 21052, 27061, 30066, 31166, 31726, 32004, 32226, 32399, 32502, 32567}
};

/* First starts of ranks, for n = 1 ... 3, and 4 or more, each for b = 0 ... 3 (PMESH-COD-09). */
static const uint16_t pmesh_ranks_starts[16][15] = {
    {6399, 14969, 20903, 25303, 29521, 31153, 32093, 32441, 32577, 32611, 32641, 32668, 32694, 32719, 32744},
    {7653, 13667, 21153, 26599, 29343, 31043, 31963, 32262, 32570, 32606, 32637, 32665, 32692, 32718, 32743},
    {7402, 15366, 22034, 27606, 30134, 31462, 32278, 32535, 32576, 32610, 32640, 32668, 32694, 32719, 32744},
    {8312, 14391, 21228, 27023, 30208, 31669, 32119, 32346, 32397, 32600, 32634, 32664, 32692, 32718, 32743},
    {10092, 18381, 24010, 28358, 30906, 32090, 32396, 32514, 32568, 32608, 32648, 32672, 32696, 32720, 32744},
    {12384, 20200, 25515, 28920, 31151, 32058, 32390, 32532, 32596, 32622, 32647, 32672, 32696, 32720, 32744},
    {13859, 20985, 25553, 28978, 31264, 32154, 32496, 32554, 32596, 32622, 32647, 32672, 32696, 32720, 32744},
    {17714, 22599, 26599, 29663, 31215, 32189, 32443, 32518, 32546, 32597, 32622, 32647, 32671, 32695, 32719},
    {11462, 21019, 26377, 29381, 31039, 31982, 32399, 32540, 32599, 32624, 32648, 32672, 32696, 32720, 32744},
    {13753, 21271, 26266, 29071, 30962, 32013, 32431, 32564, 32598, 32623, 32648, 32672, 32696, 32720, 32744},
    {16956, 23193, 27100, 29642, 31055, 31904, 32427, 32538, 32583, 32608, 32648, 32672, 32696, 32720, 32744},
    {21880, 25465, 27775, 30120, 31382, 32095, 32411, 32563, 32588, 32613, 32638, 32662, 32696, 32720, 32744},
    {11977, 21819, 26177, 28878, 30508, 31531, 32064, 32413, 32533, 32607, 32642, 32666, 32696, 32720, 32744},
    {15492, 23374, 27084, 29307, 30679, 31558, 32064, 32445, 32546, 32616, 32648, 32672, 32696, 32720, 32744},
    {19473, 24691, 27739, 29768, 31171, 31880, 32294, 32445, 32554, 32597, 32634, 32665, 32689, 32713, 32737},
    {24403, 27011, 29187, 30657, 31567, 32163, 32401, 32521, 32588, 32623, 32648, 32672, 32696, 32720, 32744}
};

/* First starts of residuals along the surface, for classes 0 ... 23 (PMESH-COD-10). */
static const uint16_t pmesh_surface_starts[24][15] = {
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32081, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {31486, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {30471, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {29030, 32419, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {27199, 32324, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {25107, 32103, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {22852, 31654, 32415, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {20554, 30916, 32294, 32477, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {18276, 29823, 32001, 32412, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {16112, 28406, 31489, 32262, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {14094, 26694, 30685, 31949, 32476, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {12465, 24761, 29562, 31405, 32384, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {10788, 22669, 28108, 30555, 32151, 32474, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {9294, 20524, 26388, 29397, 31733, 32348, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {7975, 18394, 24461, 27934, 31060, 32084, 32529, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {6822, 16335, 22403, 26207, 30087, 31612, 32447, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {5819, 14380, 20279, 24268, 28791, 30860, 32239, 32527, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {4953, 12577, 18178, 22213, 27215, 29812, 31860, 32412, 32600, 32624, 32648, 32672, 32696, 32720, 32744}
};

/* First starts of heights, and of residuals of attributes, for classes 0 ... 23 (PMESH-COD-10, -17). */
static const uint16_t pmesh_heights_starts[24][15] = {
    {32287, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {32180, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {30161, 32432, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {26665, 32281, 32456, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {22842, 31651, 32414, 32480, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {19269, 30346, 32153, 32448, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {16135, 28423, 31496, 32264, 32504, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {13471, 26082, 30352, 31798, 32453, 32528, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {11444, 23526, 28732, 30936, 32264, 32502, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {9559, 20925, 26726, 29636, 31828, 32379, 32552, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {7988, 18415, 24481, 27950, 31068, 32087, 32529, 32576, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {6679, 16068, 22122, 25959, 29933, 31529, 32428, 32573, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {5588, 13910, 19744, 23757, 28418, 30624, 32162, 32506, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {4679, 11987, 17460, 21482, 26609, 29377, 31678, 32348, 32600, 32624, 32648, 32672, 32696, 32720, 32744},
    {3919, 10278, 15307, 19205, 24567, 27788, 30886, 32004, 32553, 32624, 32648, 32672, 32696, 32720, 32744},
    {3285, 8788, 13333, 17013, 22403, 25935, 29767, 31412, 32422, 32608, 32648, 32672, 32696, 32720, 32744},
    {2754, 7588, 11643, 15045, 20187, 23881, 28310, 30504, 32129, 32527, 32648, 32672, 32696, 32720, 32744},
    {2311, 6455, 10035, 13128, 18021, 21738, 26583, 29282, 31623, 32349, 32644, 32672, 32696, 32720, 32744},
    {1939, 5480, 8614, 11388, 16017, 19643, 24634, 27744, 30825, 31985, 32587, 32672, 32696, 32720, 32744},
    {1628, 4645, 7370, 9831, 14060, 17509, 22553, 25950, 29713, 31378, 32440, 32648, 32696, 32720, 32744},
    {1367, 3932, 6287, 8450, 12260, 15473, 20412, 23964, 28286, 30471, 32135, 32560, 32696, 32720, 32744},
    {1148, 3324, 5351, 7238, 10632, 13574, 18299, 21880, 26596, 29261, 31618, 32371, 32688, 32720, 32744},
    {964, 2808, 4545, 6181, 9175, 11832, 16282, 19786, 24692, 27749, 30820, 32000, 32628, 32720, 32744},
    {810, 2370, 3854, 5266, 7886, 10257, 14342, 17686, 22646, 25980, 29709, 31382, 32470, 32689, 32744}
};

static void pmesh_set_binary(pmesh_binary_model *models, unsigned count, unsigned probability)
{
    for (unsigned i = 0; i < count; i++) {
        models[i].probability = (uint16_t)probability;
        models[i].seen = 0;
    }
}

static void pmesh_set_starts(pmesh_model_of_16 *model, const uint16_t *starts)
{
    model->starts[0] = 0;
    for (int i = 1; i < 16; i++) model->starts[i] = starts[i - 1];
    model->seen = 0;
}

static void pmesh_set_residuals(pmesh_residual_models *models, const uint16_t (*starts)[15])
{
    for (int i = 0; i < 24; i++) pmesh_set_starts(&models->classes[i], starts[i]);
}

static void pmesh_first_models(pmesh_models *models)
{
    pmesh_set_binary(models->parents, 8 * 9 * 16, 8192);
    for (int m = 0; m < 9; m++) {
        for (int a = 0; a < 4; a++) pmesh_set_starts(&models->counts[4 * m + a], pmesh_counts_starts[m]);
        for (int n = 0; n < 4; n++) {
            for (int b = 0; b < 4; b++) pmesh_set_starts(&models->ranks[4 * (9 * n + m) + b], pmesh_ranks_starts[4 * n + b]);
        }
    }
    pmesh_set_binary(models->switches, 3, 16384);
    pmesh_set_binary(models->faces, 16, 4000);
    for (int side = 0; side < 2; side++) { /* g = 0 */
        pmesh_set_binary(&models->faces[8 * side], 1, 16384);
        pmesh_set_binary(&models->faces[8 * side + 1], 1, 24000);
    }
    pmesh_set_binary(models->thirds, 2, 30000);
    pmesh_set_residuals(&models->surface, pmesh_surface_starts);
    pmesh_set_residuals(&models->heights, pmesh_heights_starts);
    for (unsigned e = 1; e <= 4; e++) {
        for (unsigned k = 1; k <= 4; k++) pmesh_set_binary(&models->more[4 * (e - 1) + k - 1], 1, k < e ? 30000 : 2768);
    }
    pmesh_set_binary(models->targets, 2, 30000);
    pmesh_set_binary(&models->same, 1, 30000);
    pmesh_set_binary(models->corners, 6, 30000);
    pmesh_set_binary(models->materials, 2, 30000);
    pmesh_set_binary(models->exact[0], 3 * 16, 16384);
    pmesh_set_residuals(&models->normals, pmesh_heights_starts);
    pmesh_set_residuals(&models->uvs, pmesh_heights_starts);
    pmesh_set_residuals(&models->green, pmesh_heights_starts);
    pmesh_set_residuals(&models->red_blue, pmesh_heights_starts);
    pmesh_set_residuals(&models->alpha, pmesh_heights_starts);
}

/* ---- Memory ---- */

/* Where the arrays lie in a block. Without a block only its length is found. */
typedef struct pmesh_layout {
    uint8_t *block;
    uint64_t used;
} pmesh_layout;

/* Places an array of `capacity` elements, copies the first `filled` of the old one, and sets the others to 0. */
static void *pmesh_place(pmesh_layout *layout, const void *old, uint64_t filled, uint64_t capacity, uint64_t element_bytes)
{
    uint8_t *array = layout->block == NULL ? NULL : layout->block + layout->used;
    if (array != NULL) {
        if (old == NULL) filled = 0;
        if (filled > 0) memcpy(array, old, (size_t)(filled * element_bytes));
        memset(array + filled * element_bytes, 0, (size_t)((capacity - filled) * element_bytes));
    }
    layout->used += (capacity * element_bytes + 7) / 8 * 8;
    return array;
}

static void pmesh_place_slots(pmesh_layout *layout, pmesh_slots *slots, uint64_t vertices, uint64_t faces,
    const pmesh_capacity *capacity)
{
    slots->first = (uint32_t *)pmesh_place(layout, slots->first, vertices, capacity->vertices, 4);
    slots->last = (uint32_t *)pmesh_place(layout, slots->last, vertices, capacity->vertices, 4);
    slots->count = (uint32_t *)pmesh_place(layout, slots->count, vertices, capacity->vertices, 4);
    slots->next = (uint32_t *)pmesh_place(layout, slots->next, 3 * faces, 3 * (uint64_t)capacity->faces, 4);
}

/* Places all arrays of a reader; `mesh` and `work` hold the old ones, and then the new ones. */
static uint64_t pmesh_place_all(const pmesh_header *header, const pmesh_capacity *capacity, uint8_t *block, pmesh_mesh *mesh,
    pmesh_work *work)
{
    const uint64_t v = mesh->vertices, w = mesh->wedges, f = mesh->faces;
    const uint64_t more_v = capacity->vertices, more_w = capacity->wedges, more_f = capacity->faces;
    const uint64_t scratch = pmesh_greater(capacity->wedges, capacity->faces);
    const unsigned attributes = header->attributes;
    pmesh_layout layout;
    layout.block = block;
    layout.used = 0;
    mesh->positions = (float *)pmesh_place(&layout, mesh->positions, 3 * v, 3 * more_v, 4);
    mesh->collapse = (uint32_t *)pmesh_place(&layout, mesh->collapse, v, more_v, 4);
    mesh->first_wedge = (uint32_t *)pmesh_place(&layout, mesh->first_wedge, v + 1, more_v + 1, 4);
    mesh->wedge_vertex = (uint32_t *)pmesh_place(&layout, mesh->wedge_vertex, w, more_w, 4);
    mesh->wedge_collapse = (uint32_t *)pmesh_place(&layout, mesh->wedge_collapse, w, more_w, 4);
    if (attributes & PMESH_NORMALS) mesh->normals = (float *)pmesh_place(&layout, mesh->normals, 3 * w, 3 * more_w, 4);
    if (attributes & PMESH_UVS) mesh->uvs = (float *)pmesh_place(&layout, mesh->uvs, 2 * w, 2 * more_w, 4);
    if (attributes & PMESH_COLOURS) mesh->colours = (uint8_t *)pmesh_place(&layout, mesh->colours, 4 * w, 4 * more_w, 1);
    mesh->corners = (uint32_t *)pmesh_place(&layout, mesh->corners, 3 * f, 3 * more_f, 4);
    mesh->face_level = (uint32_t *)pmesh_place(&layout, mesh->face_level, f, more_f, 4);
    if (attributes & PMESH_MATERIALS) mesh->materials = (uint16_t *)pmesh_place(&layout, mesh->materials, f, more_f, 2);
    work->group_count = (uint32_t *)pmesh_place(&layout, NULL, 0, more_w, 4);
    work->group_begin = (uint32_t *)pmesh_place(&layout, NULL, 0, more_w, 4);
    work->keys = (uint32_t *)pmesh_place(&layout, NULL, 0, scratch, 4);
    work->members = (uint32_t *)pmesh_place(&layout, NULL, 0, scratch, 4);
    if (header->mode == PMESH_RAW) {
        work->depth = (uint32_t *)pmesh_place(&layout, NULL, 0, more_w, 4);
        return layout.used;
    }
    const int is_first = work->models == NULL;
    work->models = (pmesh_models *)pmesh_place(&layout, work->models, 1, 1, sizeof *work->models);
    if (block != NULL && is_first) pmesh_first_models(work->models);
    work->cells = (int32_t *)pmesh_place(&layout, work->cells, 3 * v, 3 * more_v, 4);
    work->scale = (uint8_t *)pmesh_place(&layout, work->scale, v, more_v, 1);
    work->height_class = (uint8_t *)pmesh_place(&layout, work->height_class, v, more_v, 1);
    work->packet = (uint32_t *)pmesh_place(&layout, work->packet, v, more_v, 4);
    work->split = (uint8_t *)pmesh_place(&layout, work->split, v, more_v, 1);
    pmesh_place_slots(&layout, &work->slots, v, f, capacity);
    work->slot_list = (uint32_t *)pmesh_place(&layout, NULL, 0, more_f, 4);
    work->switch_bits = (uint8_t *)pmesh_place(&layout, NULL, 0, 8 * (uint64_t)capacity->payload_bytes, 1);
    if (attributes == 0) {
        work->corner_vertex = mesh->corners; /* wedges are vertices, and there is no second pass */
    } else {
        work->corner_vertex = (uint32_t *)pmesh_place(&layout, work->corner_vertex, 3 * f, 3 * more_f, 4);
        pmesh_place_slots(&layout, &work->second_slots, v, f, capacity);
        work->normal_codes = (int16_t *)pmesh_place(&layout, work->normal_codes, 2 * w, 2 * more_w, 2);
        work->uv_points = (uint16_t *)pmesh_place(&layout, work->uv_points, 2 * w, 2 * more_w, 2);
        work->value_classes = (uint8_t *)pmesh_place(&layout, work->value_classes, 3 * w, 3 * more_w, 1);
    }
    return layout.used;
}

static uint64_t pmesh_memory_for(const pmesh_reader *reader, const pmesh_capacity *capacity)
{
    pmesh_mesh mesh = reader->mesh;
    pmesh_work work = reader->work;
    return pmesh_place_all(&reader->header, capacity, NULL, &mesh, &work);
}

int pmesh_give_memory(pmesh_reader *reader, void *memory, uint64_t bytes)
{
    if (memory == NULL || (uintptr_t)memory % 8 != 0 || bytes < pmesh_memory_for(reader, &reader->wanted)) return 0;
    if (bytes > (size_t)-1) return 0;
    pmesh_place_all(&reader->header, &reader->wanted, (uint8_t *)memory, &reader->mesh, &reader->work);
    reader->capacity = reader->wanted;
    return 1;
}

/* Half as much again where there is not enough, but never more than the file declares: so copying costs no more than a
 * constant times what is there, and nothing is asked for that no byte has arrived for. */
static uint32_t pmesh_grow(uint32_t there, uint32_t needed, uint32_t declared)
{
    if (needed <= there) return there;
    const uint64_t more = (uint64_t)there + there / 2;
    if (more <= needed) return needed;
    return more < declared ? (uint32_t)more : declared;
}

/* Returns 0 if there is memory for packets up to `last`, which has the greatest ends, and payloads of `payload_bytes`; else
 * the bytes that are wanted. */
static uint64_t pmesh_want(pmesh_reader *reader, const pmesh_packet *last, uint32_t payload_bytes)
{
    const pmesh_header *header = &reader->header;
    const pmesh_capacity *there = &reader->capacity;
    if (reader->mesh.positions != NULL && last->end_vertex <= there->vertices && last->end_wedge <= there->wedges &&
        last->end_face <= there->faces && payload_bytes <= there->payload_bytes) {
        return 0;
    }
    reader->wanted.vertices = pmesh_grow(there->vertices, last->end_vertex, header->vertex_count);
    reader->wanted.wedges = pmesh_grow(there->wedges, last->end_wedge, header->wedge_count);
    reader->wanted.faces = pmesh_grow(there->faces, last->end_face, header->face_count);
    reader->wanted.payload_bytes = pmesh_greater(there->payload_bytes, payload_bytes);
    return pmesh_memory_for(reader, &reader->wanted);
}

/* Groups of wedges: members 0 ... n - 1, member i with the key keys[i], a wedge. Afterwards group_count says how many members
 * a key has, and work->members[group_begin[key]] and the following ones are these, ascending. Cost: in proportion to n. */
static void pmesh_group(pmesh_work *work, uint32_t n)
{
    uint32_t end = 0;
    for (uint32_t i = 0; i < n; i++) work->group_count[work->keys[i]]++;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t key = work->keys[i];
        if (work->group_begin[key] == 0) work->group_begin[key] = end += work->group_count[key]; /* its end, for now */
    }
    for (uint32_t i = n; i-- > 0;) work->members[--work->group_begin[work->keys[i]]] = i;
}

static void pmesh_ungroup(pmesh_work *work, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) work->group_count[work->keys[i]] = work->group_begin[work->keys[i]] = 0;
}

/* ---- Quantised numbers (PMESH-POS-03, -04; PMESH-COD-17) ---- */

/* A lattice of `bits` in up to three dimensions. */
typedef struct pmesh_lattice {
    double least[3];
    double step;
    uint32_t greatest[3];
} pmesh_lattice;

static pmesh_lattice pmesh_lattice_of(const float *least, const float *most, int dimensions, unsigned bits)
{
    pmesh_lattice lattice;
    const uint32_t last = (UINT32_C(1) << bits) - 1;
    double longest = 0;
    memset(&lattice, 0, sizeof lattice);
    for (int axis = 0; axis < dimensions; axis++) {
        const double difference = (double)most[axis] - (double)least[axis];
        lattice.least[axis] = least[axis];
        if (difference > longest) longest = difference;
    }
    lattice.step = longest / (double)last;
    for (int axis = 0; axis < dimensions && lattice.step > 0; axis++) {
        const double difference = (double)most[axis] - (double)least[axis];
        volatile double quotient = difference / lattice.step; /* volatile: each operation is rounded */
        const double points = quotient + 0.5;
        lattice.greatest[axis] = points >= (double)last ? last : (uint32_t)points;
    }
    return lattice;
}

static pmesh_lattice pmesh_position_lattice(const pmesh_header *header)
{
    return pmesh_lattice_of(header->bounds_min, header->bounds_max, 3, 8u + header->positions);
}

static float pmesh_coordinate(const pmesh_lattice *lattice, int axis, uint32_t q)
{
    volatile double product = (double)q * lattice->step; /* volatile: never fused */
    const double coordinate = lattice->least[axis] + product;
    /* From here on it rounds to infinity, a conversion that C leaves undefined */
    const double too_great = frame_power_of_two(128) - frame_power_of_two(103);
    if (coordinate >= too_great || coordinate <= -too_great) {
        return frame_float_of_bits(coordinate > 0 ? 0x7F800000u : 0xFF800000u);
    }
    return (float)coordinate;
}

/* ---- Raw packets (pmesh.md, sections 4 to 7) ---- */

/* A packet's payload and where it lies. */
typedef struct pmesh_payload {
    const uint8_t *bytes;
    uint64_t length;
    uint64_t offset; /* in the file */
} pmesh_payload;

/* A packed number of n <= 32 bits (PMESH-PKT-02); its bits are there. */
static uint32_t pmesh_packed(const uint8_t *bytes, uint64_t bit, unsigned n)
{
    uint64_t window = 0;
    if (n == 0) return 0;
    for (uint64_t i = bit / 8; i <= (bit + n - 1) / 8; i++) window |= (uint64_t)bytes[i] << (8 * (i - bit / 8));
    return (uint32_t)((window >> (bit % 8)) & ((UINT64_C(1) << n) - 1));
}

/* The unused bits of the last byte of `bits` packed bits at `at`: 1 if they are 0. */
static int pmesh_padding_is_zero(const uint8_t *bytes, uint64_t at, uint64_t bits)
{
    return bits % 8 == 0 || bytes[at + bits / 8] >> (bits % 8) == 0;
}

/* Reads a number of variable length (PMESH-PKT-04) at *at, and moves it behind the number. */
static frame_result pmesh_variable(const pmesh_payload *payload, uint64_t *at, uint32_t *number)
{
    uint64_t value = 0;
    for (uint32_t i = 0; i < PMESH_VARINT_BYTES; i++) {
        if (*at + i >= payload->length) return frame_error(PMESH_PACKET_LENGTH, payload->offset + *at);
        const uint8_t byte = payload->bytes[*at + i];
        value |= (uint64_t)(byte & 0x7F) << (7 * i);
        if (value > 0xFFFFFFFFu) break;
        if ((byte & 0x80) == 0) {
            if (byte == 0 && i > 0) break;
            *number = (uint32_t)value;
            *at += i + 1;
            return frame_ok();
        }
    }
    return frame_error(PMESH_VARINT, payload->offset + *at);
}

/* PMESH-POS-01 to -04. Moves *at behind the part. */
static frame_result pmesh_raw_positions(pmesh_reader *reader, const pmesh_packet *packet, const pmesh_payload *payload,
    uint64_t *at)
{
    const pmesh_header *header = &reader->header;
    float *positions = reader->mesh.positions + 3 * (uint64_t)packet->start_vertex;
    const uint64_t v = packet->end_vertex - packet->start_vertex;
    const uint8_t *part = payload->bytes + *at;
    const uint64_t offset = payload->offset + *at;
    if (header->positions == PMESH_F32) {
        for (uint64_t i = 0; i < 3 * v; i++) {
            const float number = frame_f32(part + 4 * i);
            if (!(number >= header->bounds_min[i % 3] && number <= header->bounds_max[i % 3])) { /* NaN is not either */
                return frame_error(PMESH_POSITION, offset + 12 * (i / 3));
            }
            positions[i] = number;
        }
        *at += 12 * v;
        return frame_ok();
    }
    const pmesh_lattice lattice = pmesh_position_lattice(header);
    for (uint64_t i = 0; i < 4 * v; i++) {
        const uint32_t q = frame_u16(part + 2 * i);
        if (i % 4 == 3 ? q != 0 : q > lattice.greatest[i % 4]) return frame_error(PMESH_POSITION, offset + 8 * (i / 4));
    }
    for (uint64_t i = 0; i < 4 * v; i++) {
        if (i % 4 == 3) continue;
        const float number = pmesh_coordinate(&lattice, (int)(i % 4), frame_u16(part + 2 * i));
        if (!frame_is_finite_f32(number)) return frame_error(PMESH_POSITION, offset + 8 * (i / 4));
        positions[3 * (i / 4) + i % 4] = number;
    }
    *at += 8 * v;
    return frame_ok();
}

/* Normals or texture coordinates (PMESH-WDG-02): so many numbers for each of so many wedges. */
static frame_result pmesh_raw_values(float *values, uint64_t wedges, uint64_t numbers, const pmesh_payload *payload,
    uint64_t *at)
{
    for (uint64_t i = 0; i < wedges * numbers; i++) {
        values[i] = frame_f32(payload->bytes + *at + 4 * i);
        if (!frame_is_finite_f32(values[i])) {
            return frame_error(PMESH_ATTRIBUTE, payload->offset + *at + 4 * numbers * (i / numbers));
        }
    }
    *at += 4 * wedges * numbers;
    return frame_ok();
}

/* PMESH-COL-01 */
static frame_result pmesh_raw_parents(pmesh_reader *reader, const pmesh_packet *packet, const pmesh_payload *payload,
    uint64_t *at)
{
    const uint32_t first = pmesh_greater(packet->start_vertex, reader->header.base_vertices);
    const unsigned b = pmesh_log2_up(packet->end_vertex);
    uint64_t bit = 0;
    for (uint32_t v = first; v < packet->end_vertex; v++, bit += b) {
        const uint32_t parent = pmesh_packed(payload->bytes + *at, bit, b);
        if (parent >= v) return frame_error(PMESH_PARENT, payload->offset + *at + bit / 8);
        reader->mesh.collapse[v] = parent;
    }
    if (!pmesh_padding_is_zero(payload->bytes, *at, bit)) {
        return frame_error(PMESH_PACKET_PADDING, payload->offset + *at + bit / 8);
    }
    *at += (bit + 7) / 8;
    return frame_ok();
}

/* Wedges: PMESH-WDG-01 and PMESH-COL-02. */
static frame_result pmesh_raw_wedges(pmesh_reader *reader, const pmesh_packet *packet, const pmesh_payload *payload,
    uint64_t *at)
{
    pmesh_mesh *mesh = &reader->mesh;
    const int seams = (reader->header.attributes & PMESH_SEAMS) != 0;
    uint32_t wedge = packet->start_wedge;
    frame_result result;
    for (uint32_t v = packet->start_vertex; v < packet->end_vertex; v++) {
        uint32_t count = 1;
        const uint64_t number_at = *at;
        if (seams) {
            result = pmesh_variable(payload, at, &count);
            if (result.verdict != FRAME_OK) return result;
            if (count == 0 || count > packet->end_wedge - wedge) {
                return frame_error(PMESH_WEDGE_COUNT, payload->offset + number_at);
            }
        }
        mesh->first_wedge[v] = wedge;
        for (uint32_t i = 0; i < count; i++) mesh->wedge_vertex[wedge++] = v;
        mesh->first_wedge[v + 1] = wedge;
    }
    if (wedge != packet->end_wedge) return frame_error(PMESH_WEDGE_COUNT, payload->offset + *at);
    for (uint32_t v = pmesh_greater(packet->start_vertex, reader->header.base_vertices); v < packet->end_vertex; v++) {
        const uint32_t first = mesh->first_wedge[mesh->collapse[v]], end = mesh->first_wedge[mesh->collapse[v] + 1];
        for (uint32_t w = mesh->first_wedge[v]; w < mesh->first_wedge[v + 1]; w++) {
            uint32_t target = 0;
            const uint64_t number_at = *at;
            if (seams) {
                result = pmesh_variable(payload, at, &target);
                if (result.verdict != FRAME_OK) return result;
                if (target >= end - first) return frame_error(PMESH_WEDGE_TARGET, payload->offset + number_at);
            }
            mesh->wedge_collapse[w] = first + target;
        }
    }
    return frame_ok();
}

/* PMESH-FACE-01 */
static frame_result pmesh_raw_faces(pmesh_reader *reader, const pmesh_packet *packet, const pmesh_payload *payload,
    uint64_t at)
{
    pmesh_mesh *mesh = &reader->mesh;
    for (uint32_t f = packet->start_face; f < packet->end_face; f++, at += 12) {
        uint32_t *corners = mesh->corners + 3 * (uint64_t)f;
        for (int c = 0; c < 3; c++) {
            corners[c] = frame_u32(payload->bytes + at + 4 * (unsigned)c);
            if (corners[c] >= packet->end_wedge) return frame_error(PMESH_CORNER, payload->offset + at);
        }
        const uint32_t *vertex = mesh->wedge_vertex;
        if (vertex[corners[0]] == vertex[corners[1]] || vertex[corners[1]] == vertex[corners[2]] ||
            vertex[corners[2]] == vertex[corners[0]]) {
            return frame_error(PMESH_FACE_VERTICES, payload->offset + at);
        }
    }
    return frame_ok();
}

/* Goes through the slots of PMESH-SWI-05. */
typedef struct pmesh_switches {
    const uint8_t *low;
    const uint8_t *high;
    unsigned low_bits;  /* l */
    uint64_t high_bits; /* the length of switch_high in bits */
    uint64_t bit;       /* of switch_high, the next one */
    uint64_t index;     /* i */
} pmesh_switches;

/* The next slot; 0 behind the last one. */
static int pmesh_next_switch(pmesh_switches *switches, uint64_t *slot)
{
    while (switches->bit < switches->high_bits) {
        const uint64_t bit = switches->bit++;
        if (bit % 8 == 0 && switches->high[bit / 8] == 0) { /* eight at once */
            switches->bit += 7;
            continue;
        }
        if ((switches->high[bit / 8] >> (bit % 8) & 1) == 0) continue;
        const uint64_t i = switches->index++;
        *slot = (bit - i) << switches->low_bits | pmesh_packed(switches->low, i * switches->low_bits, switches->low_bits);
        return 1;
    }
    return 0;
}

/* PMESH-SWI-05 to -07: judges the switches and makes them. `at` is where the part switch_low begins. */
static frame_result pmesh_raw_switches(pmesh_reader *reader, const pmesh_packet *packet, const pmesh_payload *payload,
    uint64_t at)
{
    pmesh_mesh *mesh = &reader->mesh;
    pmesh_work *work = &reader->work;
    const uint64_t m = frame_u32(payload->bytes), u = 3 * (uint64_t)packet->start_face;
    const uint32_t wedges = packet->end_wedge - packet->start_wedge;
    const uint64_t low_at = at;
    pmesh_switches switches, all;
    uint64_t slot, depths = 0;
    if (m > u) return frame_error(PMESH_SWITCH_SLOTS, payload->offset);
    if (m > 0) {
        uint64_t least = UINT64_MAX;
        memset(&all, 0, sizeof all);
        for (unsigned l = 0; l < 33; l++) {
            const uint64_t bits = m * l + m + ((u - 1) >> l);
            if (bits < least) {
                least = bits;
                all.low_bits = l;
            }
        }
        const uint64_t low_bits = m * all.low_bits, low_bytes = (low_bits + 7) / 8;
        all.high_bits = m + ((u - 1) >> all.low_bits);
        const uint64_t high_bytes = (all.high_bits + 7) / 8, high_at = at + low_bytes;
        if (low_bytes + high_bytes > payload->length - at) return frame_error(PMESH_PACKET_LENGTH, payload->offset + at);
        all.low = payload->bytes + at;
        all.high = payload->bytes + high_at;
        uint64_t ones = 0;
        for (uint64_t bit = 0; bit < all.high_bits; bit++) ones += all.high[bit / 8] >> (bit % 8) & 1;
        if (ones != m) return frame_error(PMESH_SWITCH_SLOTS, payload->offset + low_at);
        uint64_t next = 0; /* the least that the next slot may be */
        switches = all;
        while (pmesh_next_switch(&switches, &slot)) {
            if (slot < next || slot >= u) return frame_error(PMESH_SWITCH_SLOTS, payload->offset + low_at);
            next = slot + 1;
        }
        if (!pmesh_padding_is_zero(payload->bytes, at, low_bits)) {
            return frame_error(PMESH_PACKET_PADDING, payload->offset + at + low_bits / 8);
        }
        if (!pmesh_padding_is_zero(payload->bytes, high_at, all.high_bits)) {
            return frame_error(PMESH_PACKET_PADDING, payload->offset + high_at + all.high_bits / 8);
        }
        at = high_at + high_bytes;
    }

    /* The depth of each wedge of the packet, and the wedge of an earlier packet that it descends from (PMESH-SWI-04, -07) */
    for (uint32_t i = 0; i < wedges; i++) {
        const uint32_t w = packet->start_wedge + i;
        if (mesh->wedge_vertex[w] < reader->header.base_vertices) {
            work->depth[i] = 0;
            continue;
        }
        const uint32_t onto = mesh->wedge_collapse[w];
        const int outside = onto < packet->start_wedge;
        work->depth[i] = 1 + (outside ? 0 : work->depth[onto - packet->start_wedge]);
        work->keys[i] = outside ? onto : work->keys[onto - packet->start_wedge];
    }
    if (m > 0) { /* so it is not packet 0, and every wedge descends from one of an earlier packet */
        const uint64_t to_at = at;
        uint64_t bit = 0;
        pmesh_group(work, wedges);
        while (pmesh_next_switch(&all, &slot)) {
            const uint32_t wedge = mesh->corners[slot], d = work->group_count[wedge];
            if (d == 0) return frame_error(PMESH_SWITCH, payload->offset + to_at);
            const unsigned bits = pmesh_log2_up(d);
            if ((payload->length - to_at) * 8 - bit < bits) return frame_error(PMESH_PACKET_LENGTH, payload->offset + to_at);
            const uint32_t number = pmesh_packed(payload->bytes + to_at, bit, bits);
            if (number >= d) return frame_error(PMESH_SWITCH, payload->offset + to_at);
            bit += bits;
            const uint32_t member = work->members[work->group_begin[wedge] + number];
            mesh->corners[slot] = packet->start_wedge + member; /* any coarser level maps it back: PMESH-LVL-04 */
            depths += work->depth[member];
        }
        pmesh_ungroup(work, wedges);
        if (!pmesh_padding_is_zero(payload->bytes, to_at, bit)) {
            return frame_error(PMESH_PACKET_PADDING, payload->offset + to_at + bit / 8);
        }
        at = to_at + (bit + 7) / 8;
    }
    if (at != payload->length) return frame_error(PMESH_PACKET_LENGTH, payload->offset + at);
    for (uint64_t i = 3 * (uint64_t)packet->start_face; i < 3 * (uint64_t)packet->end_face; i++) {
        if (mesh->corners[i] >= packet->start_wedge) depths += work->depth[mesh->corners[i] - packet->start_wedge];
    }
    if (depths > (uint64_t)PMESH_DEPTH_PER_BYTE * payload->length) return frame_error(PMESH_SWITCH_WORK, payload->offset);
    return frame_ok();
}

/* PMESH-FACE-05: from which level on each face of a raw packet is there. */
static void pmesh_raw_face_levels(pmesh_reader *reader, const pmesh_packet *packet)
{
    pmesh_mesh *mesh = &reader->mesh;
    const uint32_t base = reader->header.base_vertices;
    uint32_t level = packet->number == 0 ? base : packet->start_vertex + 1;
    for (uint32_t f = packet->start_face; f < packet->end_face; f++) {
        uint32_t vertices[3], t = 0;
        for (int c = 0; c < 3; c++) vertices[c] = mesh->wedge_vertex[mesh->corners[3 * (uint64_t)f + (unsigned)c]];
        for (;;) { /* takes the last vertex away until two corners meet, or nothing of the packet is left */
            int last = 0;
            for (int c = 1; c < 3; c++) {
                if (vertices[c] > vertices[last]) last = c;
            }
            if (vertices[last] < packet->start_vertex || vertices[last] < base) break;
            const uint32_t parent = mesh->collapse[vertices[last]];
            if (parent == vertices[(last + 1) % 3] || parent == vertices[(last + 2) % 3]) {
                t = vertices[last] + 1;
                break;
            }
            vertices[last] = parent;
        }
        level = pmesh_greater(level, t);
        mesh->face_level[f] = level;
    }
}

/* Judges the payload of a raw packet in the order of PMESH-PKT-03, and takes it in. */
static frame_result pmesh_take_raw(pmesh_reader *reader, const pmesh_packet *packet, const pmesh_payload *payload)
{
    pmesh_mesh *mesh = &reader->mesh;
    const unsigned attributes = reader->header.attributes;
    const uint64_t w = packet->end_wedge - packet->start_wedge, f = packet->end_face - packet->start_face;
    uint64_t at = 4; /* behind switch_count; the directory has made room for all parts up to parents (PMESH-DIR-04) */
    frame_result result = pmesh_raw_positions(reader, packet, payload, &at);
    if (result.verdict == FRAME_OK && (attributes & PMESH_NORMALS) != 0) {
        result = pmesh_raw_values(mesh->normals + 3 * (uint64_t)packet->start_wedge, w, 3, payload, &at);
    }
    if (result.verdict == FRAME_OK && (attributes & PMESH_UVS) != 0) {
        result = pmesh_raw_values(mesh->uvs + 2 * (uint64_t)packet->start_wedge, w, 2, payload, &at);
    }
    if (result.verdict != FRAME_OK) return result;
    if (attributes & PMESH_COLOURS) {
        memcpy(mesh->colours + 4 * (uint64_t)packet->start_wedge, payload->bytes + at, (size_t)(4 * w));
        at += 4 * w;
    }
    const uint64_t corners_at = at;
    at += 12 * f;
    if (attributes & PMESH_MATERIALS) {
        for (uint64_t i = 0; i < f; i++) mesh->materials[packet->start_face + i] = frame_u16(payload->bytes + at + 2 * i);
        at += 2 * f;
    }
    result = pmesh_raw_parents(reader, packet, payload, &at);
    if (result.verdict == FRAME_OK) result = pmesh_raw_wedges(reader, packet, payload, &at);
    if (result.verdict == FRAME_OK) result = pmesh_raw_faces(reader, packet, payload, corners_at);
    if (result.verdict == FRAME_OK) result = pmesh_raw_switches(reader, packet, payload, at);
    if (result.verdict == FRAME_OK) pmesh_raw_face_levels(reader, packet);
    return result;
}

/* ---- Coded packets: symbols (pmesh.md, section 8.2) ---- */

/* ⌊x / 2^bits⌋, of negative numbers too. */
static int64_t pmesh_shift_down(int64_t x, unsigned bits)
{
    return x >= 0 ? x >> bits : ~(~x >> bits);
}

/* ⌊a / b⌋ for b > 0, of negative numbers too. */
static int64_t pmesh_divide_down(int64_t a, int64_t b)
{
    return a / b - (a % b < 0);
}

static uint64_t pmesh_magnitude(int64_t x)
{
    return x < 0 ? 0 - (uint64_t)x : (uint64_t)x;
}

/* The 32-bit number, two's complement, that x is when it wraps. */
static int32_t pmesh_wrap(int64_t x)
{
    const uint32_t low = (uint32_t)(uint64_t)x;
    return low < 0x80000000u ? (int32_t)low : (int32_t)(low - 0x80000000u) - 0x7FFFFFFF - 1;
}

/* The class of x, c(x) (PMESH-COD-05). */
static uint32_t pmesh_class(uint64_t x)
{
    if (x == 0) x = 1;
    const unsigned log = pmesh_bits(x) - 1;
    const uint64_t below = log >= 2 ? x >> (log - 2) : x << (2 - log);
    return 4 * log + (uint32_t)(below & 3);
}

/* The scale for a distance (PMESH-COD-05). */
static uint8_t pmesh_scale(uint64_t distance)
{
    const unsigned bits = pmesh_bits(distance);
    return (uint8_t)(bits < 15 ? bits : 15);
}

/* Where a coded payload is being read (PMESH-COD-02). */
typedef struct pmesh_symbols {
    const uint8_t *bytes;
    uint64_t length;
    uint32_t x, y;
    uint64_t words_end; /* behind states and words */
    uint64_t raw_bits;  /* that have been read */
} pmesh_symbols;

static pmesh_symbols pmesh_first_symbol(const uint8_t *bytes, uint64_t length)
{
    pmesh_symbols symbols;
    symbols.bytes = bytes;
    symbols.length = length;
    symbols.x = frame_u32(bytes);
    symbols.y = frame_u32(bytes + 4);
    symbols.words_end = 8;
    symbols.raw_bits = 0;
    return symbols;
}

/* The number l that says which symbol comes. */
static uint32_t pmesh_symbol_place(const pmesh_symbols *symbols)
{
    return symbols->x & 0x7FFFu;
}

/* Takes the symbol with the range [c, c + f), in which l lies. */
static void pmesh_take_symbol(pmesh_symbols *symbols, uint32_t c, uint32_t f)
{
    uint32_t x = f * (symbols->x >> 15) + (symbols->x & 0x7FFFu) - c;
    if (x < 0x10000u) {
        const int there = symbols->words_end + 2 <= symbols->length;
        x = x << 16 | (there ? frame_u16(symbols->bytes + symbols->words_end) : 0u);
        symbols->words_end += 2;
    }
    symbols->x = symbols->y;
    symbols->y = x;
}

/* A raw number of n <= 32 bits. */
static uint32_t pmesh_raw(pmesh_symbols *symbols, unsigned n)
{
    uint64_t number = 0;
    for (unsigned done = 0; done < n;) { /* what is left of a byte at once */
        const uint64_t byte = symbols->raw_bits / 8;
        const unsigned bit = (unsigned)(symbols->raw_bits % 8);
        const unsigned part = n - done < 8 - bit ? n - done : 8 - bit;
        const uint64_t bits = byte < symbols->length ? (uint64_t)(symbols->bytes[symbols->length - 1 - byte] >> bit) : 0;
        number |= (bits & ((1u << part) - 1)) << done;
        symbols->raw_bits += part;
        done += part;
    }
    return (uint32_t)number;
}

/* PMESH-COD-03, 2 */
static int pmesh_overruns(const pmesh_symbols *symbols)
{
    return symbols->words_end + (symbols->raw_bits + 7) / 8 > symbols->length;
}

/* The next value of a binary model (PMESH-COD-04). */
static int pmesh_binary(pmesh_symbols *symbols, pmesh_binary_model *model)
{
    const int32_t p = model->probability;
    const int value = pmesh_symbol_place(symbols) < (uint32_t)p;
    const int32_t t = value ? 32768 - 32 : 32;
    const int32_t r = 655360 / (10 * model->seen + 16);
    if (value) {
        pmesh_take_symbol(symbols, 0, (uint32_t)p);
    } else {
        pmesh_take_symbol(symbols, (uint32_t)p, 32768u - (uint32_t)p);
    }
    model->probability = (uint16_t)(p + pmesh_shift_down((int64_t)(t - p) * r, 16));
    if (model->seen < 60) model->seen++;
    return value;
}

/* The next symbol of a model of 16 symbols (PMESH-COD-04). */
static uint32_t pmesh_symbol(pmesh_symbols *symbols, pmesh_model_of_16 *model)
{
    const uint32_t l = pmesh_symbol_place(symbols);
    const unsigned h = model->seen < 20 ? 4 : model->seen < 80 ? 5 : 6;
    uint32_t k = 15;
    while (model->starts[k] > l) k--;
    const uint32_t c = model->starts[k], end = k < 15 ? model->starts[k + 1] : 32768u;
    pmesh_take_symbol(symbols, c, end - c);
    for (uint32_t i = 1; i < 16; i++) {
        const int32_t s = model->starts[i];
        const int32_t t = i <= k ? (int32_t)(8 * i) : (int32_t)(32768 - 8 * (16 - i));
        model->starts[i] = (uint16_t)(s + pmesh_shift_down(t - s, h));
    }
    if (model->seen < 80) model->seen++;
    return k;
}

/* A residual with class c (PMESH-COD-10). */
static int32_t pmesh_residual(pmesh_symbols *symbols, pmesh_residual_models *models, uint32_t c)
{
    const unsigned s = c / 4 > 5 ? c / 4 - 5 : 0;
    const uint32_t k = pmesh_symbol(symbols, &models->classes[s == 0 ? c : 20 + c % 4]);
    int64_t w = k;
    if (k >= 4 && k < 14) {
        const unsigned j = k / 2 - 1;
        w = ((int64_t)(2 + k % 2) << j) + pmesh_raw(symbols, j);
    } else if (k == 14) {
        w = 128 + pmesh_raw(symbols, 7);
    } else if (k == 15) {
        const uint32_t j = pmesh_raw(symbols, 5);
        const unsigned digits = j < 27 ? j : 27;
        w = ((int64_t)1 << digits) + pmesh_raw(symbols, digits);
    }
    const int64_t l = pmesh_raw(symbols, s);
    if (w != 0 && pmesh_raw(symbols, 1) == 1) w = -w;
    return pmesh_wrap(w * ((int64_t)1 << s) + l - ((int64_t)1 << s) / 2);
}

/* ---- Coded packets: slots ---- */

static void pmesh_append_slot(pmesh_slots *slots, uint32_t vertex, uint32_t slot)
{
    if (slots->count[vertex]++ == 0) {
        slots->first[vertex] = slot;
    } else {
        slots->next[slots->last[vertex]] = slot;
    }
    slots->last[vertex] = slot;
    slots->next[slot] = PMESH_NONE;
}

static void pmesh_no_slots(pmesh_slots *slots, uint32_t vertex)
{
    slots->first[vertex] = slots->last[vertex] = PMESH_NONE;
    slots->count[vertex] = 0;
}

/* Writes the slots of a vertex, ascending, to work->slot_list and returns their number. */
static uint32_t pmesh_list_slots(pmesh_work *work, const pmesh_slots *slots, uint32_t vertex)
{
    uint32_t count = 0;
    for (uint32_t slot = slots->first[vertex]; slot != PMESH_NONE; slot = slots->next[slot]) work->slot_list[count++] = slot;
    return count;
}

/* The slots of the two corners that follow in the face: out, then back (PMESH-COD-08). */
static uint32_t pmesh_out_slot(uint32_t slot)
{
    return slot % 3 == 2 ? slot - 2 : slot + 1;
}

static uint32_t pmesh_back_slot(uint32_t slot)
{
    return slot % 3 == 0 ? slot + 2 : slot - 1;
}

static int pmesh_bit(const uint8_t *bits, uint64_t i)
{
    return bits[i / 8] >> (i % 8) & 1;
}

static void pmesh_put_bit(uint8_t *bits, uint64_t i, int value)
{
    const unsigned mask = 1u << (i % 8);
    bits[i / 8] = (uint8_t)(value ? bits[i / 8] | mask : bits[i / 8] & ~mask);
}

/* Moves those m slots of work->slot_list whose bits, from `first_bit` on, are set from vertex p to vertex v. */
static void pmesh_split_slots(pmesh_work *work, pmesh_slots *slots, uint32_t p, uint32_t v, uint32_t m, uint64_t first_bit)
{
    pmesh_no_slots(slots, p);
    pmesh_no_slots(slots, v);
    for (uint32_t i = 0; i < m; i++) {
        pmesh_append_slot(slots, pmesh_bit(work->switch_bits, first_bit + i) ? v : p, work->slot_list[i]);
    }
}

/* ---- Coded packets: cells (PMESH-COD-11) ---- */

/* What cells stand for. */
typedef struct pmesh_cells {
    int is_f32;
    uint32_t greatest[3];
    pmesh_lattice lattice; /* q10 to q16 */
    double unit;           /* f32: u, */
    double least[3];       /* and ⌊low / u⌋ */
} pmesh_cells;

static pmesh_cells pmesh_cells_of(const pmesh_header *header)
{
    pmesh_cells cells;
    memset(&cells, 0, sizeof cells);
    cells.is_f32 = header->positions == PMESH_F32;
    if (!cells.is_f32) {
        cells.lattice = pmesh_position_lattice(header);
        memcpy(cells.greatest, cells.lattice.greatest, sizeof cells.greatest);
        return cells;
    }
    uint32_t magnitude = 0; /* as bits, which ascend with the magnitude */
    for (int axis = 0; axis < 3; axis++) {
        magnitude = pmesh_greater(magnitude, frame_bits_of_float(header->bounds_min[axis]) & 0x7FFFFFFFu);
        magnitude = pmesh_greater(magnitude, frame_bits_of_float(header->bounds_max[axis]) & 0x7FFFFFFFu);
    }
    const int exponent = (int)pmesh_greater(magnitude >> 23, 1) - 150; /* of the step between numbers as great as that */
    for (int doubled = 0;; doubled++) {
        int fits = 1;
        cells.unit = frame_power_of_two(exponent + doubled);
        for (int axis = 0; axis < 3; axis++) {
            cells.least[axis] = floor((double)header->bounds_min[axis] / cells.unit); /* exact: u is a power of two */
            const double difference = floor((double)header->bounds_max[axis] / cells.unit) - cells.least[axis];
            if (difference >= 1048576.0) {
                fits = 0;
                break;
            }
            cells.greatest[axis] = (uint32_t)difference;
        }
        if (fits) return cells;
    }
}

/* The place of a binary32 number among all, ascending: +0 has 0, and -0 comes directly before. */
static int64_t pmesh_float_place(float number)
{
    const uint32_t bits = frame_bits_of_float(number);
    return bits < 0x80000000u ? (int64_t)bits : -1 - (int64_t)(bits & 0x7FFFFFFFu);
}

/* The place of the first number of the cell that begins at `number`, which has at most 25 digits (PMESH-COD-11, 2). */
static int64_t pmesh_cell_place(double number)
{
    if (number == 0) return -1; /* -0 is in the cell of +0 */
    if (number >= frame_power_of_two(128)) return 0x7F800000;   /* behind the greatest number */
    if (number <= -frame_power_of_two(128)) return -0x7F800000; /* the least number there is */
    return pmesh_float_place((float)number);
}

/* Reads the place of a number in its cell (PMESH-COD-11, 3). Returns 0 if there is no such number in the box. */
static int pmesh_number_in_cell(pmesh_symbols *symbols, const pmesh_header *header, const pmesh_cells *cells, int axis,
    int32_t cell, float *number)
{
    const int64_t first = pmesh_cell_place((cells->least[axis] + cell) * cells->unit);
    const int64_t last = pmesh_cell_place((cells->least[axis] + cell + 1) * cells->unit) - 1;
    const int64_t place = pmesh_raw(symbols, pmesh_bits((uint64_t)(last - first)));
    if (place > last - first) return 0;
    const int64_t at = first + place;
    *number = frame_float_of_bits(at >= 0 ? (uint32_t)at : 0x80000000u + (uint32_t)(-1 - at));
    return *number >= header->bounds_min[axis] && *number <= header->bounds_max[axis];
}

/* ---- Coded packets: the state of reading one ---- */

typedef struct pmesh_decoder {
    pmesh_reader *reader;
    const pmesh_packet *packet;
    pmesh_symbols symbols;
    pmesh_cells cells;
    pmesh_lattice uv_lattice;
    int32_t normal_greatest;    /* M of PMESH-COD-16 */
    uint32_t vertices;          /* there are so far */
    uint32_t wedges;
    uint32_t faces;
    uint64_t faces_of_parents;  /* the sum of PMESH-COD-12; also the bits of switch_bits so far */
    int positions_are_finite;   /* PMESH-COD-10, judged last */
} pmesh_decoder;

static int pmesh_distance_axis(int32_t a, int32_t b)
{
    return a < b ? b - a : a - b;
}

/* The distance of two cells (PMESH-COD-05). */
static uint64_t pmesh_distance(const int32_t *a, const int32_t *b)
{
    uint64_t distance = 0;
    for (int axis = 0; axis < 3; axis++) distance += (uint64_t)pmesh_distance_axis(a[axis], b[axis]);
    return distance;
}

static int32_t *pmesh_cell(const pmesh_decoder *decoder, uint32_t vertex)
{
    return decoder->reader->work.cells + 3 * (uint64_t)vertex;
}

/* Adds (out - p) x (back - p) to a sum in 64-bit numbers that wrap (PMESH-COD-10, 3). */
static void pmesh_add_normal(uint64_t *sum, const int32_t *p, const int32_t *out, const int32_t *back)
{
    int64_t a[3], b[3];
    for (int axis = 0; axis < 3; axis++) {
        a[axis] = (int64_t)out[axis] - p[axis];
        b[axis] = (int64_t)back[axis] - p[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        const int next = (axis + 1) % 3, after = (axis + 2) % 3;
        sum[axis] += (uint64_t)(a[next] * b[after] - a[after] * b[next]); /* below 2^43 each */
    }
}

static int64_t pmesh_signed(uint64_t x)
{
    return x < UINT64_C(0x8000000000000000) ? (int64_t)x : -(int64_t)(~x) - 1;
}

/* The main axis (PMESH-COD-10, 4): that of the greatest magnitude, the first of equal ones. */
static int pmesh_main_axis(const int64_t *normal)
{
    int main_axis = 0;
    for (int axis = 1; axis < 3; axis++) {
        if (pmesh_magnitude(normal[axis]) > pmesh_magnitude(normal[main_axis])) main_axis = axis;
    }
    return main_axis;
}

/* Begins vertex v, of which the cell is known: its position (PMESH-COD-11) and what is known of it at first. */
static frame_result pmesh_begin_vertex(pmesh_decoder *decoder, uint32_t v)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_work *work = &reader->work;
    const int32_t *cell = pmesh_cell(decoder, v);
    const frame_result error = frame_error(PMESH_POSITION, 0);
    float *position = reader->mesh.positions + 3 * (uint64_t)v;
    for (int axis = 0; axis < 3; axis++) {
        if (cell[axis] < 0 || (uint32_t)cell[axis] > decoder->cells.greatest[axis]) return error;
    }
    for (int axis = 0; axis < 3; axis++) {
        if (decoder->cells.is_f32) {
            if (!pmesh_number_in_cell(&decoder->symbols, &reader->header, &decoder->cells, axis, cell[axis], &position[axis])) {
                return error;
            }
        } else {
            position[axis] = pmesh_coordinate(&decoder->cells.lattice, axis, (uint32_t)cell[axis]);
            if (!frame_is_finite_f32(position[axis])) decoder->positions_are_finite = 0;
        }
    }
    work->scale[v] = 0;
    work->height_class[v] = 0;
    work->packet[v] = decoder->packet->number;
    work->split[v] = 0;
    pmesh_no_slots(&work->slots, v);
    if (reader->header.attributes == 0) { /* one wedge a vertex, of the same number */
        reader->mesh.first_wedge[v] = v;
        reader->mesh.first_wedge[v + 1] = v + 1;
        reader->mesh.wedge_vertex[v] = v;
    } else {
        pmesh_no_slots(&work->second_slots, v);
    }
    return frame_ok();
}

/* Adds the face with number `f`, whose corners are known, to the slots of its vertices in the first pass. */
static void pmesh_link_face(pmesh_work *work, uint32_t f)
{
    for (uint32_t slot = 3 * f; slot < 3 * f + 3; slot++) pmesh_append_slot(&work->slots, work->corner_vertex[slot], slot);
}

/* PMESH-COD-06 */
static frame_result pmesh_coded_base(pmesh_decoder *decoder)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_symbols *symbols = &decoder->symbols;
    const uint32_t base = reader->header.base_vertices;
    for (uint32_t v = 0; v < base; v++) {
        int32_t *cell = pmesh_cell(decoder, v);
        for (int axis = 0; axis < 3; axis++) {
            cell[axis] = (int32_t)pmesh_raw(symbols, pmesh_bits(decoder->cells.greatest[axis]));
        }
        const frame_result result = pmesh_begin_vertex(decoder, v);
        if (result.verdict != FRAME_OK) return result;
        if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
    }
    decoder->vertices = base;
    const uint32_t faces = pmesh_raw(symbols, 32);
    if (faces > decoder->packet->end_face) return frame_error(PMESH_CODED_FACES, 0);
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t *corners = reader->work.corner_vertex + 3 * (uint64_t)f;
        for (int c = 0; c < 3; c++) corners[c] = pmesh_raw(symbols, pmesh_bits(base - 1u));
        if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
        for (int c = 0; c < 3; c++) {
            if (corners[c] >= base) return frame_error(PMESH_CORNER, 0);
        }
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
            return frame_error(PMESH_FACE_VERTICES, 0);
        }
        pmesh_link_face(&reader->work, f);
        reader->mesh.face_level[f] = base;
    }
    decoder->faces = faces;
    return frame_ok();
}

/* ---- Coded packets: splits (pmesh.md, sections 8.4 to 8.6) ---- */

/* The faces of p in the order of PMESH-COD-08: their slots, and the places of these among all slots of p, ascending. */
typedef struct pmesh_order {
    const uint32_t *slots;
    uint32_t m;
    int goes_round;
    uint32_t places[PMESH_ORDERED_FACES]; /* with at most so many faces */
} pmesh_order;

static uint32_t pmesh_place_in_order(const pmesh_order *order, uint32_t i)
{
    return order->m > PMESH_ORDERED_FACES ? i : order->places[i];
}

static uint32_t pmesh_out(const pmesh_work *work, const pmesh_order *order, uint32_t i)
{
    return work->corner_vertex[pmesh_out_slot(order->slots[pmesh_place_in_order(order, i)])];
}

static uint32_t pmesh_back(const pmesh_work *work, const pmesh_order *order, uint32_t i)
{
    return work->corner_vertex[pmesh_back_slot(order->slots[pmesh_place_in_order(order, i)])];
}

/* Puts the slot at `place`, and behind each the first one left whose out is its back (PMESH-COD-08, 1). */
static uint32_t pmesh_put_in_order(const uint32_t *out, const uint32_t *back, uint32_t m, uint32_t place, uint8_t *is_put,
    uint32_t *places, uint32_t count)
{
    while (place < m) {
        const uint32_t last = place;
        is_put[place] = 1;
        places[count++] = place;
        for (place = 0; place < m && (is_put[place] || out[place] != back[last]); place++) {}
    }
    return count;
}

/* PMESH-COD-08 */
static pmesh_order pmesh_order_of(const pmesh_work *work, uint32_t m)
{
    uint32_t out[PMESH_ORDERED_FACES], back[PMESH_ORDERED_FACES], count;
    uint8_t is_put[PMESH_ORDERED_FACES];
    pmesh_order order;
    memset(&order, 0, sizeof order);
    order.slots = work->slot_list;
    order.m = m;
    if (m == 0 || m > PMESH_ORDERED_FACES) return order;
    for (uint32_t i = 0; i < m; i++) {
        out[i] = work->corner_vertex[pmesh_out_slot(order.slots[i])];
        back[i] = work->corner_vertex[pmesh_back_slot(order.slots[i])];
    }
    memset(is_put, 0, sizeof is_put);
    count = pmesh_put_in_order(out, back, m, 0, is_put, order.places, 0);
    if (count == m && m >= 2 && back[order.places[m - 1]] == out[order.places[0]]) {
        order.goes_round = 1;
        return order;
    }
    memset(is_put, 0, sizeof is_put);
    count = 0;
    for (uint32_t i = 0; i < m; i++) {
        int follows = 0;
        for (uint32_t j = 0; j < m; j++) follows |= j != i && back[j] == out[i];
        if (!follows) count = pmesh_put_in_order(out, back, m, i, is_put, order.places, count);
    }
    for (uint32_t i = 0; i < m; i++) {
        if (!is_put[i]) count = pmesh_put_in_order(out, back, m, i, is_put, order.places, count);
    }
    return order;
}

/* One split: vertex v from p. */
typedef struct pmesh_split {
    uint32_t p, v;
    pmesh_order order;
    uint64_t first_bit; /* in switch_bits: one bit for each slot of p, ascending */
    int is_regular;
    uint32_t run_first, run_faces; /* of a regular split: its first face in order, and n */
    uint64_t edges;     /* of all faces, of the first 32 where there are more: Σ e */
    uint64_t run_edges; /* E of PMESH-COD-10 */
    uint32_t neighbours[PMESH_NEIGHBOURS];
    uint32_t neighbour_count;
} pmesh_split;

static int pmesh_is_switched(const pmesh_work *work, const pmesh_split *split, uint32_t i)
{
    return pmesh_bit(work->switch_bits, split->first_bit + pmesh_place_in_order(&split->order, i));
}

/* The symbol of a model of 16, of which the last stands for 15 and more. */
static uint32_t pmesh_long_symbol(pmesh_symbols *symbols, pmesh_model_of_16 *model)
{
    const uint32_t symbol = pmesh_symbol(symbols, model);
    return symbol < 15 ? symbol : 15 + pmesh_raw(symbols, 5);
}

/* Writes a new face at the end of those there are (not among the slots yet). */
static frame_result pmesh_put_face(pmesh_decoder *decoder, uint32_t a, uint32_t b, uint32_t c)
{
    if (decoder->faces >= decoder->packet->end_face) return frame_error(PMESH_CODED_FACES, 0); /* PMESH-COD-07 */
    uint32_t *corners = decoder->reader->work.corner_vertex + 3 * (uint64_t)decoder->faces;
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
    decoder->reader->mesh.face_level[decoder->faces++] = decoder->vertices + 1;
    return frame_ok();
}

static uint32_t pmesh_at_most(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* A regular split, if the faces go round and it is one (PMESH-COD-09). */
static frame_result pmesh_cut_regular(pmesh_decoder *decoder, pmesh_split *split)
{
    pmesh_work *work = &decoder->reader->work;
    pmesh_models *models = work->models;
    pmesh_symbols *symbols = &decoder->symbols;
    const uint32_t m = split->order.m;
    uint64_t e[PMESH_ORDERED_FACES], weight[PMESH_ORDERED_FACES], sum = 0, greatest = 0;
    uint32_t ranked[PMESH_ORDERED_FACES];
    for (uint32_t i = 0; i < m; i++) {
        e[i] = pmesh_distance(pmesh_cell(decoder, split->p), pmesh_cell(decoder, pmesh_out(work, &split->order, i)));
        sum += e[i];
        if (e[i] > greatest) greatest = e[i];
    }
    const uint32_t a = (uint32_t)(4 * m * greatest >= 5 * sum) + (4 * m * greatest >= 6 * sum) + (4 * m * greatest >= 8 * sum);
    const uint32_t n = pmesh_long_symbol(symbols, &models->counts[4 * (pmesh_at_most(m, 10) - 2) + a]);
    if (n == 0) return frame_ok();
    if (n >= m) return frame_error(PMESH_CORNER, 0);

    for (uint32_t k = 0; k < m; k++) { /* ranks by descending weight, equal ones by ascending k */
        uint32_t at = k;
        weight[k] = n == 1 ? e[k] + e[(k + 1) % m] : 0;
        for (uint32_t i = 1; i < n; i++) weight[k] += e[(k + i) % m];
        for (; at > 0 && weight[ranked[at - 1]] < weight[k]; at--) ranked[at] = ranked[at - 1];
        ranked[at] = k;
    }
    const uint64_t d = 8 * m * (weight[ranked[0]] - weight[ranked[1]]);
    const uint32_t b = (uint32_t)(d >= sum) + (d >= 2 * sum) + (d >= 4 * sum);
    const uint32_t rank =
        pmesh_long_symbol(symbols, &models->ranks[4 * (9 * (pmesh_at_most(n, 4) - 1) + pmesh_at_most(m, 10) - 2) + b]);
    if (rank >= m) return frame_error(PMESH_CORNER, 0);

    split->is_regular = 1;
    split->run_first = ranked[rank];
    split->run_faces = n;
    split->neighbours[split->neighbour_count++] = split->p;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t face = (split->run_first + i) % m;
        pmesh_put_bit(work->switch_bits, split->first_bit + split->order.places[face], 1);
        split->neighbours[split->neighbour_count++] = pmesh_out(work, &split->order, face);
        if (i > 0) split->run_edges += e[face];
    }
    const uint32_t x = pmesh_out(work, &split->order, split->run_first);
    const uint32_t y = pmesh_back(work, &split->order, (split->run_first + n - 1) % m);
    split->neighbours[split->neighbour_count++] = y;
    const frame_result result = pmesh_put_face(decoder, split->p, x, split->v);
    return result.verdict != FRAME_OK ? result : pmesh_put_face(decoder, split->p, split->v, y);
}

/* A neighbour of an escape, left out if one with the same cell is there (PMESH-COD-10, 1). */
static void pmesh_add_neighbour(const pmesh_decoder *decoder, pmesh_split *split, uint32_t vertex)
{
    if (split->neighbour_count == PMESH_NEIGHBOURS) return;
    for (uint32_t i = 0; i < split->neighbour_count; i++) {
        if (pmesh_distance(pmesh_cell(decoder, split->neighbours[i]), pmesh_cell(decoder, vertex)) == 0) return;
    }
    split->neighbours[split->neighbour_count++] = vertex;
}

/* An escape (PMESH-COD-09). */
static frame_result pmesh_cut_escape(pmesh_decoder *decoder, pmesh_split *split)
{
    pmesh_work *work = &decoder->reader->work;
    pmesh_models *models = work->models;
    pmesh_symbols *symbols = &decoder->symbols;
    const pmesh_order *order = &split->order;
    const uint32_t m = order->m;
    uint32_t expected[2] = {PMESH_NONE, PMESH_NONE};
    int before = 0;
    pmesh_add_neighbour(decoder, split, split->p);
    for (uint32_t i = 0; i < m; i++) {
        const int value = pmesh_binary(symbols, &models->switches[i == 0 ? 0 : 1 + before]);
        pmesh_put_bit(work->switch_bits, split->first_bit + pmesh_place_in_order(order, i), value);
        if (i > 0 && value && !before && expected[0] == PMESH_NONE) expected[0] = pmesh_out(work, order, i);
        if (i > 0 && !value && before && expected[1] == PMESH_NONE) expected[1] = pmesh_back(work, order, i - 1);
        if (value) {
            pmesh_add_neighbour(decoder, split, pmesh_out(work, order, i));
            pmesh_add_neighbour(decoder, split, pmesh_back(work, order, i));
        }
        before = value;
    }
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t is_expected = expected[side] != PMESH_NONE;
        uint32_t guess = expected[side], g = 0;
        if (!is_expected) guess = m == 0 ? 0 : side == 0 ? pmesh_out(work, order, 0) : pmesh_back(work, order, m - 1);
        while (pmesh_binary(symbols, &models->faces[2 * (4 * side + pmesh_at_most(g, 3)) + is_expected])) {
            uint32_t x = guess;
            if (!pmesh_binary(symbols, &models->thirds[0])) {
                if (pmesh_binary(symbols, &models->thirds[1])) {
                    const uint32_t i = pmesh_raw(symbols, pmesh_bits(m));
                    if (i >= m) return frame_error(PMESH_CORNER, 0);
                    x = pmesh_raw(symbols, 1) == 1 ? pmesh_back(work, order, i) : pmesh_out(work, order, i);
                } else {
                    x = pmesh_raw(symbols, pmesh_bits(split->v));
                }
            }
            g++;
            if (x >= split->v) return frame_error(PMESH_CORNER, 0);
            if (x == split->p) return frame_error(PMESH_FACE_VERTICES, 0);
            if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
            const frame_result result = side == 0 ? pmesh_put_face(decoder, split->p, x, split->v)
                                                  : pmesh_put_face(decoder, split->p, split->v, x);
            if (result.verdict != FRAME_OK) return result;
        }
    }
    return frame_ok();
}

/* The cell of the new vertex, and what changes afterwards (PMESH-COD-10). */
static frame_result pmesh_coded_cell(pmesh_decoder *decoder, const pmesh_split *split)
{
    pmesh_work *work = &decoder->reader->work;
    pmesh_models *models = work->models;
    pmesh_symbols *symbols = &decoder->symbols;
    const int64_t k = split->neighbour_count;
    const int32_t *p = pmesh_cell(decoder, split->p);
    int32_t *cell = pmesh_cell(decoder, split->v);
    int32_t mean[3];
    uint32_t spread[3];

    for (int axis = 0; axis < 3; axis++) { /* 2 */
        int64_t sum = p[axis], away = 0;
        for (uint32_t i = 0; i < split->neighbour_count; i++) sum += pmesh_cell(decoder, split->neighbours[i])[axis];
        mean[axis] = (int32_t)((2 * sum + k + 1) / (2 * k + 2));
        for (uint32_t i = 0; i < split->neighbour_count; i++) {
            away += pmesh_distance_axis(pmesh_cell(decoder, split->neighbours[i])[axis], mean[axis]);
        }
        spread[axis] = pmesh_class((uint64_t)(8 * away / k) + 1);
    }

    uint64_t sum[3] = {0, 0, 0}; /* 3 */
    int64_t normal[3];
    uint64_t greatest = 0;
    for (uint32_t i = 0; i < split->order.m; i++) {
        if (!pmesh_is_switched(work, split, i)) continue;
        pmesh_add_normal(sum, p, pmesh_cell(decoder, pmesh_out(work, &split->order, i)),
            pmesh_cell(decoder, pmesh_back(work, &split->order, i)));
    }
    for (int axis = 0; axis < 3; axis++) {
        normal[axis] = pmesh_signed(sum[axis]);
        if (pmesh_magnitude(normal[axis]) > greatest) greatest = pmesh_magnitude(normal[axis]);
    }
    if (pmesh_bits(greatest) > 24) {
        for (int axis = 0; axis < 3; axis++) normal[axis] = pmesh_shift_down(normal[axis], pmesh_bits(greatest) - 24);
    }
    const int a3 = pmesh_main_axis(normal), a1 = (a3 + 1) % 3, a2 = (a3 + 2) % 3; /* 4 */

    cell[a1] = pmesh_wrap((int64_t)mean[a1] + pmesh_residual(symbols, &models->surface, spread[a1])); /* 5 */
    cell[a2] = pmesh_wrap((int64_t)mean[a2] + pmesh_residual(symbols, &models->surface, spread[a2]));

    int64_t expected = mean[a3]; /* 6 */
    if (normal[a3] != 0) {
        const int64_t d = (int64_t)pmesh_magnitude(normal[a3]);
        int64_t n = -(normal[a1] * ((int64_t)cell[a1] - p[a1]) + normal[a2] * ((int64_t)cell[a2] - p[a2]));
        if (normal[a3] < 0) n = -n;
        expected = pmesh_wrap(p[a3] + (int64_t)pmesh_wrap(pmesh_divide_down(2 * n + d, 2 * d)));
    }
    uint32_t classes = 0;
    for (uint32_t i = 0; i < split->neighbour_count; i++) classes += work->height_class[split->neighbours[i]];
    const int32_t height = pmesh_residual(symbols, &models->heights, classes / split->neighbour_count);
    cell[a3] = pmesh_wrap(expected + height);
    const frame_result result = pmesh_begin_vertex(decoder, split->v);
    if (result.verdict != FRAME_OK) return result;

    /* Afterwards */
    const uint32_t h = pmesh_class(2 * pmesh_magnitude(height) + 1) & 0xFFu;
    work->height_class[split->v] = (uint8_t)h;
    work->height_class[split->p] = (uint8_t)((h + work->height_class[split->p]) / 2);
    uint64_t away = 0;
    for (uint32_t i = 0; i < split->neighbour_count; i++) {
        away += pmesh_distance(pmesh_cell(decoder, split->neighbours[i]), mean);
    }
    work->scale[split->v] = pmesh_scale(away / split->neighbour_count + pmesh_distance(cell, mean));
    const uint64_t inner = split->is_regular ? split->run_faces - 1 : 0;
    work->scale[split->p] =
        pmesh_scale((split->edges + pmesh_distance(p, cell) - split->run_edges) / (split->order.m + 1 - inner));
    return frame_ok();
}

/* One split (PMESH-COD-08 to -11): the next vertex from p. */
static frame_result pmesh_coded_split(pmesh_decoder *decoder, uint32_t p)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_work *work = &reader->work;
    const uint32_t v = decoder->vertices, first_face = decoder->faces;
    pmesh_split split;
    frame_result result = frame_ok();
    memset(&split, 0, sizeof split);
    split.p = p;
    split.v = v;
    split.first_bit = decoder->faces_of_parents;
    decoder->faces_of_parents += work->slots.count[p];
    if (decoder->faces_of_parents > (uint64_t)PMESH_FACES_PER_BYTE * decoder->packet->payload_bytes) {
        return frame_error(PMESH_CODED_WORK, 0); /* PMESH-COD-12 */
    }
    const uint32_t m = pmesh_list_slots(work, &work->slots, p);
    split.order = pmesh_order_of(work, m);
    for (uint32_t i = 0; i < m; i++) {
        pmesh_put_bit(work->switch_bits, split.first_bit + i, 0);
        if (i < PMESH_ORDERED_FACES) {
            split.edges += pmesh_distance(pmesh_cell(decoder, p), pmesh_cell(decoder, pmesh_out(work, &split.order, i)));
        }
    }
    if (split.order.goes_round) result = pmesh_cut_regular(decoder, &split);
    if (result.verdict == FRAME_OK && !split.is_regular) result = pmesh_cut_escape(decoder, &split);
    if (result.verdict == FRAME_OK) result = pmesh_coded_cell(decoder, &split);
    if (result.verdict != FRAME_OK) return result;
    if (pmesh_overruns(&decoder->symbols)) return frame_error(PMESH_CODED_LENGTH, 0);

    reader->mesh.collapse[v] = p;
    if (reader->header.attributes == 0) reader->mesh.wedge_collapse[v] = p;
    pmesh_split_slots(work, &work->slots, p, v, m, split.first_bit);
    for (uint32_t slot = work->slots.first[v]; slot != PMESH_NONE; slot = work->slots.next[slot]) {
        work->corner_vertex[slot] = v;
    }
    for (uint32_t f = first_face; f < decoder->faces; f++) pmesh_link_face(work, f);
    work->packet[p] = decoder->packet->number;
    work->split[p] = 1;
    decoder->vertices++;
    return frame_ok();
}

/* The first pass over the vertices from B on (PMESH-COD-07). */
static frame_result pmesh_coded_splits(pmesh_decoder *decoder)
{
    pmesh_work *work = &decoder->reader->work;
    const pmesh_packet *packet = decoder->packet;
    uint32_t p = 0, children = 0; /* of p in this packet */
    while (decoder->vertices < packet->end_vertex) {
        uint32_t parents[PMESH_BATCH], count = 0;
        const uint32_t size = pmesh_at_most(PMESH_BATCH, packet->end_vertex - decoder->vertices);
        while (count < size && p < decoder->vertices) {
            uint32_t h = children == 1 ? 6 : 7;
            if (children == 0) {
                const uint32_t since = packet->number - work->packet[p];
                h = !work->split[p] ? pmesh_at_most(since, 3) : since == 1 ? 4 : 5;
            }
            const uint32_t faces = work->slots.count[p];
            const uint32_t d = pmesh_at_most(pmesh_greater(faces, 3), 11) - 3;
            if (pmesh_binary(&decoder->symbols, &work->models->parents[(9 * h + d) * 16 + work->scale[p]])) {
                parents[count++] = p;
                children++;
            } else {
                p++;
                children = 0;
            }
        }
        if (count == 0) return frame_error(PMESH_PARENT, 0);
        for (uint32_t i = 0; i < count; i++) {
            const frame_result result = pmesh_coded_split(decoder, parents[i]);
            if (result.verdict != FRAME_OK) return result;
        }
    }
    if (decoder->faces != packet->end_face) return frame_error(PMESH_CODED_FACES, 0);
    return frame_ok();
}

/* ---- Coded packets: attributes (pmesh.md, section 8.7) ---- */

static uint32_t pmesh_wedges_of(const pmesh_mesh *mesh, uint32_t vertex)
{
    return mesh->first_wedge[vertex + 1] - mesh->first_wedge[vertex];
}

/* The number of wedges of v (PMESH-COD-14, 1); e is the number expected. */
static frame_result pmesh_coded_wedge_count(pmesh_decoder *decoder, uint32_t v, uint32_t e)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_mesh *mesh = &reader->mesh;
    const uint32_t end = decoder->packet->end_wedge;
    mesh->first_wedge[v] = decoder->wedges;
    for (uint32_t k = 1;; k++) {
        if (decoder->wedges >= end) return frame_error(PMESH_WEDGE_COUNT, 0);
        mesh->wedge_vertex[decoder->wedges++] = v;
        if ((reader->header.attributes & PMESH_SEAMS) == 0) break;
        pmesh_binary_model *more = &reader->work.models->more[4 * (pmesh_at_most(e, 4) - 1) + pmesh_at_most(k, 4) - 1];
        if (!pmesh_binary(&decoder->symbols, more)) break;
    }
    mesh->first_wedge[v + 1] = decoder->wedges;
    return frame_ok();
}

/* Turns a code (PMESH-COD-16, 1). */
static void pmesh_turn(int32_t greatest, const int32_t *code, int32_t *turned)
{
    const int32_t u = code[0], v = code[1];
    turned[0] = (greatest - (v < 0 ? -v : v)) * (u < 0 ? -1 : 1);
    turned[1] = (greatest - (u < 0 ? -u : u)) * (v < 0 ? -1 : 1);
}

/* The point of a code (PMESH-COD-16, 2). */
static void pmesh_normal_point(int32_t greatest, const int32_t *code, int32_t *point)
{
    point[0] = code[0];
    point[1] = code[1];
    point[2] = greatest - (code[0] < 0 ? -code[0] : code[0]) - (code[1] < 0 ? -code[1] : code[1]);
    if (point[2] < 0) pmesh_turn(greatest, code, point);
}

static void pmesh_put_normal(pmesh_decoder *decoder, uint32_t wedge, const int32_t *code)
{
    float *normal = decoder->reader->mesh.normals + 3 * (uint64_t)wedge;
    int16_t *stored = decoder->reader->work.normal_codes + 2 * (uint64_t)wedge;
    int32_t point[3];
    pmesh_normal_point(decoder->normal_greatest, code, point);
    double squares = 0;
    for (int axis = 0; axis < 3; axis++) squares += (double)point[axis] * point[axis]; /* whole numbers: exact */
    const double root = sqrt(squares);
    for (int axis = 0; axis < 3; axis++) normal[axis] = (float)(point[axis] / root);
    stored[0] = (int16_t)code[0];
    stored[1] = (int16_t)code[1];
}

/* Returns 0 if the coordinates are not finite. */
static int pmesh_put_uv(pmesh_decoder *decoder, uint32_t wedge, const int32_t *q)
{
    float *uv = decoder->reader->mesh.uvs + 2 * (uint64_t)wedge;
    uint16_t *stored = decoder->reader->work.uv_points + 2 * (uint64_t)wedge;
    for (int axis = 0; axis < 2; axis++) {
        stored[axis] = (uint16_t)q[axis];
        uv[axis] = pmesh_coordinate(&decoder->uv_lattice, axis, (uint32_t)q[axis]);
        if (!frame_is_finite_f32(uv[axis])) return 0;
    }
    return 1;
}

static int pmesh_is_in(const int32_t *numbers, int count, int32_t least, int32_t greatest)
{
    for (int i = 0; i < count; i++) {
        if (numbers[i] < least || numbers[i] > greatest) return 0;
    }
    return 1;
}

/* The values of a wedge of the base (PMESH-COD-13, 3). */
static frame_result pmesh_coded_base_values(pmesh_decoder *decoder, uint32_t wedge)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_symbols *symbols = &decoder->symbols;
    const unsigned attributes = reader->header.attributes;
    int32_t numbers[2];
    memset(reader->work.value_classes + 3 * (uint64_t)wedge, PMESH_BASE_CLASS, 3);
    if (attributes & PMESH_NORMALS) {
        const int32_t m = decoder->normal_greatest;
        for (int i = 0; i < 2; i++) numbers[i] = (int32_t)pmesh_raw(symbols, pmesh_bits(2 * (uint64_t)m)) - m;
        if (!pmesh_is_in(numbers, 2, -m, m)) return frame_error(PMESH_ATTRIBUTE, 0);
        pmesh_put_normal(decoder, wedge, numbers);
    }
    if (attributes & PMESH_UVS) {
        for (int i = 0; i < 2; i++) numbers[i] = (int32_t)pmesh_raw(symbols, pmesh_bits(decoder->uv_lattice.greatest[i]));
        for (int i = 0; i < 2; i++) {
            if ((uint32_t)numbers[i] > decoder->uv_lattice.greatest[i]) return frame_error(PMESH_ATTRIBUTE, 0);
        }
        if (!pmesh_put_uv(decoder, wedge, numbers)) return frame_error(PMESH_ATTRIBUTE, 0);
    }
    if (attributes & PMESH_COLOURS) {
        for (int i = 0; i < 4; i++) reader->mesh.colours[4 * (uint64_t)wedge + (unsigned)i] = (uint8_t)pmesh_raw(symbols, 8);
    }
    return frame_ok();
}

/* Adds a face whose corners are known as wedges to the slots of the second pass. */
static void pmesh_link_second(pmesh_reader *reader, uint32_t f)
{
    for (uint32_t slot = 3 * f; slot < 3 * f + 3; slot++) {
        pmesh_append_slot(&reader->work.second_slots, reader->mesh.wedge_vertex[reader->mesh.corners[slot]], slot);
    }
}

/* PMESH-COD-13, what concerns the base. */
static frame_result pmesh_coded_base_attributes(pmesh_decoder *decoder, uint32_t base_faces)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_mesh *mesh = &reader->mesh;
    pmesh_symbols *symbols = &decoder->symbols;
    frame_result result;
    for (uint32_t v = 0; v < reader->header.base_vertices; v++) {
        result = pmesh_coded_wedge_count(decoder, v, 1);
        if (result.verdict != FRAME_OK) return result;
        if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
    }
    for (uint32_t f = 0; f < base_faces; f++) {
        for (uint32_t slot = 3 * f; slot < 3 * f + 3; slot++) {
            const uint32_t v = reader->work.corner_vertex[slot]; /* of the finest level so far: back to the base */
            uint32_t vertex = v;
            while (vertex >= reader->header.base_vertices) vertex = mesh->collapse[vertex];
            const uint32_t count = pmesh_wedges_of(mesh, vertex);
            const uint32_t place = pmesh_raw(symbols, pmesh_bits(count - 1u));
            if (place >= count) return frame_error(PMESH_CORNER, 0);
            mesh->corners[slot] = mesh->first_wedge[vertex] + place;
        }
        if (reader->header.attributes & PMESH_MATERIALS) mesh->materials[f] = (uint16_t)pmesh_raw(symbols, 16);
        if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
        pmesh_link_second(reader, f);
    }
    for (uint32_t w = 0; w < decoder->wedges; w++) {
        result = pmesh_coded_base_values(decoder, w);
        if (result.verdict != FRAME_OK) return result;
        if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
    }
    return frame_ok();
}

/* Sorts numbers ascending, with a heap: in the worst case too a time of n log n. */
static void pmesh_sort(uint32_t *numbers, uint32_t n)
{
    for (uint32_t heap = n / 2, end = n; end > 1;) {
        uint32_t number;
        if (heap > 0) {
            number = numbers[--heap];
        } else {
            number = numbers[--end];
            numbers[end] = numbers[0];
        }
        uint32_t at = heap;
        for (uint64_t child = 2 * (uint64_t)at + 1; child < end; child = 2 * child + 1) {
            if (child + 1 < end && numbers[child] < numbers[child + 1]) child++;
            if (numbers[child] <= number) break;
            numbers[at] = numbers[child];
            at = (uint32_t)child;
        }
        numbers[at] = number;
    }
}

/* The wedges of v, what they become, and to which of them corners switch (PMESH-COD-14, 1 to 3). The m slots of p are in
 * work->slot_list; those whose bits, from `first_bit` on, are set switch. */
static frame_result pmesh_coded_wedges(pmesh_decoder *decoder, uint32_t p, uint32_t v, uint32_t m, uint64_t first_bit)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_mesh *mesh = &reader->mesh;
    pmesh_work *work = &reader->work;
    pmesh_symbols *symbols = &decoder->symbols;
    const uint32_t first_of_p = mesh->first_wedge[p], count_of_p = pmesh_wedges_of(mesh, p);
    uint32_t *t = work->members; /* T */
    uint32_t length = 0;
    if (count_of_p > 1) {
        uint32_t all = 0;
        for (uint32_t i = 0; i < m; i++) {
            if (pmesh_bit(work->switch_bits, first_bit + i)) t[all++] = mesh->corners[work->slot_list[i]];
        }
        pmesh_sort(t, all);
        for (uint32_t i = 0; i < all; i++) {
            if (i == 0 || t[i] != t[i - 1]) t[length++] = t[i];
        }
    }
    const frame_result result = pmesh_coded_wedge_count(decoder, v, length > 0 ? length : 1); /* 1 */
    if (result.verdict != FRAME_OK) return result;

    const uint32_t first = mesh->first_wedge[v], count = pmesh_wedges_of(mesh, v);
    for (uint32_t j = 0; j < count; j++) { /* 2 */
        uint32_t target = first_of_p;
        if (count_of_p > 1) {
            if (length > 0) target = j < length ? t[j] : t[length - 1];
            if (!pmesh_binary(symbols, &work->models->targets[j < length ? 0 : 1])) {
                const uint32_t place = pmesh_raw(symbols, pmesh_bits(count_of_p - 1u));
                if (place >= count_of_p) return frame_error(PMESH_WEDGE_TARGET, 0);
                target = first_of_p + place;
            }
        }
        mesh->wedge_collapse[first + j] = target;
    }

    for (uint32_t j = 0; j < count; j++) work->keys[j] = mesh->wedge_collapse[first + j]; /* 3 */
    pmesh_group(work, count);
    uint32_t last = PMESH_NONE; /* what the slot before it with several gave */
    for (uint32_t i = 0; i < m; i++) {
        if (!pmesh_bit(work->switch_bits, first_bit + i)) continue;
        const uint32_t slot = work->slot_list[i], wedge = mesh->corners[slot], several = work->group_count[wedge];
        if (several == 0) return frame_error(PMESH_SWITCH, 0);
        const uint32_t *candidates = work->members + work->group_begin[wedge];
        uint32_t choice = first + candidates[0];
        if (several > 1) {
            if (last != PMESH_NONE && mesh->wedge_collapse[last] == wedge) choice = last;
            if (!pmesh_binary(symbols, &work->models->same)) {
                const uint32_t place = pmesh_raw(symbols, pmesh_bits(several - 1u));
                if (place >= several) return frame_error(PMESH_SWITCH, 0);
                choice = first + candidates[place];
            }
            last = choice;
        }
        mesh->corners[slot] = choice;
    }
    pmesh_ungroup(work, count);
    return frame_ok();
}

/* The face beside a new face at a vertex: that of the first of its first 32 slots whose face has a corner on x
 * (PMESH-COD-14, 4); PMESH_NONE if there is none. */
static uint32_t pmesh_face_beside(const pmesh_reader *reader, uint32_t vertex, uint32_t x)
{
    const pmesh_slots *slots = &reader->work.second_slots;
    uint32_t slot = slots->first[vertex];
    for (uint32_t i = 0; i < PMESH_BESIDE_SLOTS && slot != PMESH_NONE; i++, slot = slots->next[slot]) {
        if (reader->mesh.wedge_vertex[reader->mesh.corners[pmesh_out_slot(slot)]] == x ||
            reader->mesh.wedge_vertex[reader->mesh.corners[pmesh_back_slot(slot)]] == x) {
            return slot / 3;
        }
    }
    return PMESH_NONE;
}

/* The wedge of a new face at a vertex, with the face F of PMESH-COD-14, 4. `k` is 0 for p, 1 for v, 2 for x. Sets
 * *is_guessed to 0 if it was asked for and is not the guessed one. */
static frame_result pmesh_coded_corner(pmesh_decoder *decoder, uint32_t vertex, uint32_t k, uint32_t face, uint32_t *wedge,
    int *is_guessed)
{
    pmesh_reader *reader = decoder->reader;
    const pmesh_mesh *mesh = &reader->mesh;
    const uint32_t first = mesh->first_wedge[vertex], count = pmesh_wedges_of(mesh, vertex);
    *wedge = first;
    if (count == 1) return frame_ok();
    if (face != PMESH_NONE) {
        for (uint32_t slot = 3 * face; slot < 3 * face + 3; slot++) {
            if (mesh->wedge_vertex[mesh->corners[slot]] == vertex) *wedge = mesh->corners[slot];
        }
    }
    if (!pmesh_binary(&decoder->symbols, &reader->work.models->corners[2 * k + (face != PMESH_NONE)])) {
        const uint32_t place = pmesh_raw(&decoder->symbols, pmesh_bits(count - 1u));
        if (place >= count) return frame_error(PMESH_CORNER, 0);
        *wedge = first + place;
        *is_guessed = 0;
    }
    return frame_ok();
}

/* A new face (PMESH-COD-14, 4 and 5). */
static frame_result pmesh_coded_face(pmesh_decoder *decoder, uint32_t f, uint32_t p, uint32_t v)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_mesh *mesh = &reader->mesh;
    pmesh_models *models = reader->work.models;
    uint32_t *corners = mesh->corners + 3 * (uint64_t)f;
    /* Which corner is x: it is that of the first pass, mapped at level v + 1, which neither p nor v is (PMESH-COD-09) */
    uint32_t vertices[3], third = 1;
    for (uint32_t c = 0; c < 3; c++) {
        vertices[c] = reader->work.corner_vertex[3 * (uint64_t)f + c];
        while (vertices[c] > v) vertices[c] = mesh->collapse[vertices[c]];
    }
    if (vertices[1] == v) third = 2;
    const uint32_t x = vertices[third];
    const uint32_t at_p = pmesh_face_beside(reader, p, x), at_v = pmesh_face_beside(reader, v, x);
    int p_is_guessed = 1, ignored = 1;
    frame_result result = pmesh_coded_corner(decoder, p, 0, at_p, &corners[0], &p_is_guessed);
    if (result.verdict == FRAME_OK) result = pmesh_coded_corner(decoder, v, 1, at_v, &corners[3 - third], &ignored);
    if (result.verdict == FRAME_OK) {
        const uint32_t near_p = at_p != PMESH_NONE ? at_p : at_v, near_v = at_v != PMESH_NONE ? at_v : at_p;
        result = pmesh_coded_corner(decoder, x, 2, p_is_guessed ? near_p : near_v, &corners[third], &ignored);
    }
    if (result.verdict != FRAME_OK) return result;
    if (reader->header.attributes & PMESH_MATERIALS) {
        uint16_t expected = 0;
        if (at_p != PMESH_NONE) {
            expected = mesh->materials[at_p];
        } else if (at_v != PMESH_NONE) {
            expected = mesh->materials[at_v];
        } else if (f > 0) {
            expected = mesh->materials[f - 1];
        }
        if (!pmesh_binary(&decoder->symbols, &models->materials[0])) {
            const int other = at_v != PMESH_NONE && mesh->materials[at_v] != expected;
            if (other && pmesh_binary(&decoder->symbols, &models->materials[1])) {
                expected = mesh->materials[at_v];
            } else {
                expected = (uint16_t)pmesh_raw(&decoder->symbols, 16);
            }
        }
        mesh->materials[f] = expected;
    }
    pmesh_link_second(reader, f);
    if (pmesh_overruns(&decoder->symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
    return frame_ok();
}

/* What PMESH-COD-15 says of a wedge: its neighbours, at most 32, and their weights. */
typedef struct pmesh_prediction {
    uint32_t wedges[2 * PMESH_VALUE_SLOTS];
    int64_t weights[2 * PMESH_VALUE_SLOTS]; /* h */
    int64_t k;
    uint32_t becomes; /* the wedge that it becomes */
} pmesh_prediction;

/* PMESH-COD-15, 1 to 4; `slots` are the first of the slots of v that have the wedge. */
static pmesh_prediction pmesh_predict(const pmesh_decoder *decoder, uint32_t v, uint32_t wedge, const uint32_t *slots,
    uint32_t slot_count)
{
    const pmesh_mesh *mesh = &decoder->reader->mesh;
    const int32_t *cell = pmesh_cell(decoder, v);
    pmesh_prediction prediction;
    uint64_t sum[3] = {0, 0, 0};
    int64_t normal[3], local[2 * PMESH_VALUE_SLOTS + 1][2]; /* (x, y) of the neighbours, behind them (X, Y) */
    memset(&prediction, 0, sizeof prediction);
    prediction.becomes = mesh->wedge_collapse[wedge];
    for (uint32_t i = 0; i < slot_count && i < PMESH_VALUE_SLOTS; i++) { /* 1, 2 */
        const uint32_t out = mesh->corners[pmesh_out_slot(slots[i])], back = mesh->corners[pmesh_back_slot(slots[i])];
        prediction.wedges[prediction.k++] = out;
        prediction.wedges[prediction.k++] = back;
        pmesh_add_normal(sum, cell, pmesh_cell(decoder, mesh->wedge_vertex[out]), pmesh_cell(decoder, mesh->wedge_vertex[back]));
    }
    if (slot_count == 0) prediction.wedges[prediction.k++] = prediction.becomes;
    for (int axis = 0; axis < 3; axis++) normal[axis] = pmesh_signed(sum[axis]);
    const int main_axis = pmesh_main_axis(normal);

    uint64_t greatest = 0; /* 3 */
    for (int i = 0; i < 2; i++) {
        const int axis = (main_axis + 1 + i) % 3;
        int64_t cells = 0;
        for (int64_t j = 0; j < prediction.k; j++) cells += pmesh_cell(decoder, mesh->wedge_vertex[prediction.wedges[j]])[axis];
        const int64_t mean = (2 * cells + prediction.k) / (2 * prediction.k);
        for (int64_t j = 0; j <= prediction.k; j++) {
            const int32_t *of = j < prediction.k ? pmesh_cell(decoder, mesh->wedge_vertex[prediction.wedges[j]]) : cell;
            local[j][i] = of[axis] - mean;
            if (pmesh_magnitude(local[j][i]) > greatest) greatest = pmesh_magnitude(local[j][i]);
        }
    }
    const unsigned digits = pmesh_bits(greatest), shift = digits > 8 ? digits - 8 : 0;
    int64_t a = 0, b = 0, c = 0; /* 4 */
    for (int64_t j = 0; j <= prediction.k; j++) {
        const int64_t x = local[j][0] = pmesh_shift_down(local[j][0], shift);
        const int64_t y = local[j][1] = pmesh_shift_down(local[j][1], shift);
        if (j == prediction.k) break;
        a += x * x;
        b += x * y;
        c += y * y;
    }
    const int64_t d = a * c - b * b, X = local[prediction.k][0], Y = local[prediction.k][1];
    uint64_t magnitudes = 0;
    for (int64_t j = 0; j < prediction.k && d != 0; j++) {
        const int64_t product = local[j][0] * (c * X - b * Y) + local[j][1] * (a * Y - b * X);
        prediction.weights[j] = pmesh_divide_down(product * 1024, d);
        magnitudes += pmesh_magnitude(prediction.weights[j]);
    }
    if (magnitudes > 2048) memset(prediction.weights, 0, sizeof prediction.weights);
    return prediction;
}

/* The number expected where the neighbours have the numbers z (PMESH-COD-15, 5). */
static int64_t pmesh_expect(const pmesh_prediction *prediction, const int32_t *z)
{
    const int64_t k = prediction->k;
    int64_t sum = 0, weighted = 0;
    for (int64_t j = 0; j < k; j++) sum += z[j];
    const int64_t m = pmesh_divide_down(2 * sum + k, 2 * k);
    for (int64_t j = 0; j < k; j++) weighted += prediction->weights[j] * (z[j] - m);
    return m + pmesh_shift_down(weighted + 512, 10);
}

/* One kind of values (0 normals, 1 texture coordinates, 2 colours) of a wedge: PMESH-COD-17, 1 and 4 around the residuals. */
static int pmesh_is_exact(pmesh_decoder *decoder, const pmesh_prediction *prediction, int kind, int same, uint32_t *c)
{
    pmesh_work *work = &decoder->reader->work;
    uint32_t classes = 0;
    for (int64_t j = 0; j < prediction->k; j++) {
        classes += work->value_classes[3 * (uint64_t)prediction->wedges[j] + (unsigned)kind];
    }
    *c = classes / (uint32_t)prediction->k;
    return pmesh_binary(&decoder->symbols, &work->models->exact[kind][2 * pmesh_at_most(*c / 4, 7) + (uint32_t)same]);
}

static void pmesh_put_class(pmesh_decoder *decoder, const pmesh_prediction *prediction, uint32_t wedge, int kind,
    uint64_t residuals)
{
    uint8_t *classes = decoder->reader->work.value_classes + kind;
    const uint32_t h = pmesh_class(1 + residuals) & 0xFFu;
    classes[3 * (uint64_t)wedge] = (uint8_t)h;
    classes[3 * (uint64_t)prediction->becomes] = (uint8_t)((h + classes[3 * (uint64_t)prediction->becomes]) / 2);
}

static frame_result pmesh_coded_normal(pmesh_decoder *decoder, const pmesh_prediction *prediction, uint32_t wedge)
{
    pmesh_work *work = &decoder->reader->work;
    const int32_t greatest = decoder->normal_greatest;
    int32_t points[3][2 * PMESH_VALUE_SLOTS], code[2];
    int64_t expected[3], sum = 0;
    uint64_t residuals = 0;
    uint32_t c;
    int same = 1;
    for (int64_t j = 0; j < prediction->k; j++) {
        const int16_t *stored = work->normal_codes + 2 * (uint64_t)prediction->wedges[j];
        const int16_t *first = work->normal_codes + 2 * (uint64_t)prediction->wedges[0];
        int32_t point[3];
        code[0] = stored[0];
        code[1] = stored[1];
        same &= stored[0] == first[0] && stored[1] == first[1];
        pmesh_normal_point(greatest, code, point);
        for (int axis = 0; axis < 3; axis++) points[axis][j] = 16 * point[axis];
    }
    for (int axis = 0; axis < 3; axis++) { /* PMESH-COD-16, 4 */
        expected[axis] = pmesh_expect(prediction, points[axis]);
        sum += (int64_t)pmesh_magnitude(expected[axis]);
    }
    if (sum == 0) {
        code[0] = work->normal_codes[2 * (uint64_t)prediction->becomes];
        code[1] = work->normal_codes[2 * (uint64_t)prediction->becomes + 1];
    } else {
        for (int i = 0; i < 2; i++) code[i] = (int32_t)pmesh_divide_down(2 * expected[i] * greatest + sum, 2 * sum);
        if (expected[2] < 0) {
            int32_t turned[2];
            pmesh_turn(greatest, code, turned);
            memcpy(code, turned, sizeof code);
        }
    }
    {
        int32_t outside[2];
        const int turn = (code[0] < 0 ? -code[0] : code[0]) + (code[1] < 0 ? -code[1] : code[1]) > greatest; /* 5 */
        if (turn) {
            pmesh_turn(greatest, code, outside);
            memcpy(code, outside, sizeof code);
        }
        if (!pmesh_is_exact(decoder, prediction, 0, same, &c)) {
            for (int i = 0; i < 2; i++) {
                const int32_t residual = pmesh_residual(&decoder->symbols, &work->models->normals, c);
                residuals += pmesh_magnitude(residual);
                code[i] = pmesh_wrap((int64_t)code[i] + residual);
            }
        }
        if (!pmesh_is_in(code, 2, -greatest, greatest)) return frame_error(PMESH_ATTRIBUTE, 0);
        if (turn) {
            pmesh_turn(greatest, code, outside);
            memcpy(code, outside, sizeof code);
        }
    }
    pmesh_put_normal(decoder, wedge, code);
    pmesh_put_class(decoder, prediction, wedge, 0, residuals);
    return frame_ok();
}

/* Brings an expected number into 0 ... greatest (PMESH-COD-17). */
static int32_t pmesh_bring_in(int64_t number, uint32_t greatest)
{
    return number < 0 ? 0 : number > (int64_t)greatest ? (int32_t)greatest : (int32_t)number;
}

static frame_result pmesh_coded_uv(pmesh_decoder *decoder, const pmesh_prediction *prediction, uint32_t wedge)
{
    pmesh_work *work = &decoder->reader->work;
    int32_t z[2][2 * PMESH_VALUE_SLOTS], q[2];
    uint64_t residuals = 0;
    uint32_t c;
    int same = 1;
    for (int i = 0; i < 2; i++) {
        for (int64_t j = 0; j < prediction->k; j++) {
            z[i][j] = work->uv_points[2 * (uint64_t)prediction->wedges[j] + (unsigned)i];
            same &= z[i][j] == z[i][0];
        }
        q[i] = pmesh_bring_in(pmesh_expect(prediction, z[i]), decoder->uv_lattice.greatest[i]);
    }
    if (!pmesh_is_exact(decoder, prediction, 1, same, &c)) {
        for (int i = 0; i < 2; i++) {
            const int32_t residual = pmesh_residual(&decoder->symbols, &work->models->uvs, c);
            residuals += pmesh_magnitude(residual);
            q[i] = pmesh_wrap((int64_t)q[i] + residual);
        }
        for (int i = 0; i < 2; i++) {
            if (q[i] < 0 || (uint32_t)q[i] > decoder->uv_lattice.greatest[i]) return frame_error(PMESH_ATTRIBUTE, 0);
        }
    }
    if (!pmesh_put_uv(decoder, wedge, q)) return frame_error(PMESH_ATTRIBUTE, 0);
    pmesh_put_class(decoder, prediction, wedge, 1, residuals);
    return frame_ok();
}

static frame_result pmesh_coded_colour(pmesh_decoder *decoder, const pmesh_prediction *prediction, uint32_t wedge)
{
    pmesh_work *work = &decoder->reader->work;
    uint8_t *colours = decoder->reader->mesh.colours;
    int32_t z[4][2 * PMESH_VALUE_SLOTS], colour[4];
    uint64_t residuals = 0;
    uint32_t c;
    int same = 1;
    for (int i = 0; i < 4; i++) {
        for (int64_t j = 0; j < prediction->k; j++) {
            z[i][j] = colours[4 * (uint64_t)prediction->wedges[j] + (unsigned)i];
            same &= z[i][j] == z[i][0];
        }
        colour[i] = pmesh_bring_in(pmesh_expect(prediction, z[i]), 255);
    }
    if (!pmesh_is_exact(decoder, prediction, 2, same, &c)) {
        const int32_t g = pmesh_residual(&decoder->symbols, &work->models->green, c);
        const int32_t r = pmesh_residual(&decoder->symbols, &work->models->red_blue, c);
        const int32_t b = pmesh_residual(&decoder->symbols, &work->models->red_blue, c);
        const int32_t a = pmesh_residual(&decoder->symbols, &work->models->alpha, c);
        residuals = pmesh_magnitude(g) + pmesh_magnitude(r) + pmesh_magnitude(b) + pmesh_magnitude(a);
        colour[0] = pmesh_wrap((int64_t)colour[0] + r + g);
        colour[1] = pmesh_wrap((int64_t)colour[1] + g);
        colour[2] = pmesh_wrap((int64_t)colour[2] + b + g);
        colour[3] = pmesh_wrap((int64_t)colour[3] + a);
        if (!pmesh_is_in(colour, 4, 0, 255)) return frame_error(PMESH_ATTRIBUTE, 0);
    }
    for (int i = 0; i < 4; i++) colours[4 * (uint64_t)wedge + (unsigned)i] = (uint8_t)colour[i];
    pmesh_put_class(decoder, prediction, wedge, 2, residuals);
    return frame_ok();
}

/* The values of the wedges of v, at level v + 1 (PMESH-COD-15 to -17). */
static frame_result pmesh_coded_values(pmesh_decoder *decoder, uint32_t v)
{
    pmesh_reader *reader = decoder->reader;
    const pmesh_mesh *mesh = &reader->mesh;
    pmesh_work *work = &reader->work;
    const unsigned attributes = reader->header.attributes;
    const uint32_t m = pmesh_list_slots(work, &work->second_slots, v); /* grouped by the wedge that they have */
    for (uint32_t i = 0; i < m; i++) work->keys[i] = mesh->corners[work->slot_list[i]];
    pmesh_group(work, m);
    for (uint32_t wedge = mesh->first_wedge[v]; wedge < mesh->first_wedge[v + 1]; wedge++) {
        uint32_t slots[PMESH_VALUE_SLOTS], count = pmesh_at_most(work->group_count[wedge], PMESH_VALUE_SLOTS);
        for (uint32_t i = 0; i < count; i++) slots[i] = work->slot_list[work->members[work->group_begin[wedge] + i]];
        const pmesh_prediction prediction = pmesh_predict(decoder, v, wedge, slots, count);
        frame_result result = frame_ok();
        if (attributes & PMESH_NORMALS) result = pmesh_coded_normal(decoder, &prediction, wedge);
        if (result.verdict == FRAME_OK && (attributes & PMESH_UVS) != 0) result = pmesh_coded_uv(decoder, &prediction, wedge);
        if (result.verdict == FRAME_OK && (attributes & PMESH_COLOURS) != 0) {
            result = pmesh_coded_colour(decoder, &prediction, wedge);
        }
        if (result.verdict != FRAME_OK) return result;
    }
    pmesh_ungroup(work, m);
    if (pmesh_overruns(&decoder->symbols)) return frame_error(PMESH_CODED_LENGTH, 0);
    return frame_ok();
}

/* PMESH-COD-13 */
static frame_result pmesh_second_pass(pmesh_decoder *decoder, uint32_t base_faces)
{
    pmesh_reader *reader = decoder->reader;
    pmesh_mesh *mesh = &reader->mesh;
    pmesh_work *work = &reader->work;
    const pmesh_packet *packet = decoder->packet;
    uint32_t face = packet->start_face;
    uint64_t first_bit = 0;
    frame_result result;
    if (packet->number == 0) {
        result = pmesh_coded_base_attributes(decoder, base_faces);
        if (result.verdict != FRAME_OK) return result;
        face = base_faces;
    }
    for (uint32_t v = pmesh_greater(packet->start_vertex, reader->header.base_vertices); v < packet->end_vertex; v++) {
        const uint32_t p = mesh->collapse[v], m = pmesh_list_slots(work, &work->second_slots, p);
        result = pmesh_coded_wedges(decoder, p, v, m, first_bit);
        if (result.verdict != FRAME_OK) return result;
        pmesh_split_slots(work, &work->second_slots, p, v, m, first_bit);
        first_bit += m;
        for (; face < packet->end_face && mesh->face_level[face] == v + 1; face++) {
            result = pmesh_coded_face(decoder, face, p, v);
            if (result.verdict != FRAME_OK) return result;
        }
        result = pmesh_coded_values(decoder, v);
        if (result.verdict != FRAME_OK) return result;
    }
    if (decoder->wedges != packet->end_wedge) return frame_error(PMESH_WEDGE_COUNT, 0);
    return frame_ok();
}

/* PMESH-COD-03, 3 to 5 */
static frame_result pmesh_coded_end(const pmesh_decoder *decoder)
{
    const pmesh_symbols *symbols = &decoder->symbols;
    if (pmesh_overruns(symbols)) return frame_error(PMESH_CODED_LENGTH, 0); /* by the number of faces of the base */
    const uint64_t raw_bytes = (symbols->raw_bits + 7) / 8;
    const uint64_t between = symbols->length - symbols->words_end - raw_bytes;
    uint64_t least = pmesh_least_payload(&decoder->reader->header, decoder->packet);
    const uint64_t least_for_work = (decoder->faces_of_parents + PMESH_FACES_PER_BYTE - 1) / PMESH_FACES_PER_BYTE;
    if (least_for_work > least) least = least_for_work;
    if (symbols->x != PMESH_STATE_END || symbols->y != PMESH_STATE_END) return frame_error(PMESH_CODED_LENGTH, 0);
    if (symbols->length > least && between > 0) return frame_error(PMESH_CODED_LENGTH, symbols->words_end);
    if (!frame_all_zero(symbols->bytes + symbols->words_end, between)) {
        return frame_error(PMESH_CODED_PADDING, symbols->words_end);
    }
    if (symbols->raw_bits % 8 != 0 && symbols->bytes[symbols->length - raw_bytes] >> (symbols->raw_bits % 8) != 0) {
        return frame_error(PMESH_CODED_PADDING, symbols->words_end);
    }
    return frame_ok();
}

/* Judges the payload of a coded packet, and takes it in. Offsets of errors count from its first byte. */
static frame_result pmesh_take_coded(pmesh_reader *reader, const pmesh_packet *packet, const uint8_t *payload)
{
    const pmesh_header *header = &reader->header;
    pmesh_decoder decoder;
    uint32_t base_faces = 0;
    frame_result result = frame_ok();
    if (packet->payload_bytes < 8) return frame_error(PMESH_CODED_LENGTH, 0);
    memset(&decoder, 0, sizeof decoder);
    decoder.reader = reader;
    decoder.packet = packet;
    decoder.symbols = pmesh_first_symbol(payload, packet->payload_bytes);
    decoder.cells = pmesh_cells_of(header);
    if (header->attributes & PMESH_UVS) decoder.uv_lattice = pmesh_lattice_of(header->uv_min, header->uv_max, 2, header->uv_bits);
    if (header->attributes & PMESH_NORMALS) decoder.normal_greatest = (1 << (header->normal_bits - 1)) - 1;
    decoder.vertices = packet->start_vertex;
    decoder.wedges = packet->start_wedge;
    decoder.faces = packet->start_face;
    decoder.positions_are_finite = 1;
    if (packet->number == 0) {
        result = pmesh_coded_base(&decoder);
        base_faces = decoder.faces;
    }
    if (result.verdict == FRAME_OK) result = pmesh_coded_splits(&decoder);
    if (result.verdict == FRAME_OK && header->attributes != 0) result = pmesh_second_pass(&decoder, base_faces);
    if (result.verdict == FRAME_OK) result = pmesh_coded_end(&decoder);
    if (result.verdict == FRAME_OK && !decoder.positions_are_finite) result = frame_error(PMESH_POSITION, 0);
    return result;
}

/* ---- Levels (pmesh.md, section 9) ---- */

uint32_t pmesh_finest_level(const pmesh_reader *reader)
{
    const int is_known = reader->directory_offset != 0 && reader->position > reader->header.frame.header_bytes;
    if (reader->packets > 0) return reader->mesh.vertices;
    return is_known && reader->header.vertex_count == 0 ? 0 : PMESH_NO_LEVEL;
}

int pmesh_level(const pmesh_reader *reader, uint32_t n, pmesh_level_counts *counts)
{
    const pmesh_mesh *mesh = &reader->mesh;
    const uint32_t finest = pmesh_finest_level(reader);
    if (finest == PMESH_NO_LEVEL || n > finest || n < reader->header.base_vertices) return 0;
    counts->vertices = n;
    counts->wedges = n == 0 ? 0 : mesh->first_wedge[n];
    uint32_t low = 0, high = mesh->faces; /* the first face that is not there */
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (mesh->face_level[middle] <= n) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    counts->faces = low;
    return 1;
}

int pmesh_corners(const pmesh_reader *reader, uint32_t n, uint32_t *corners)
{
    const pmesh_mesh *mesh = &reader->mesh;
    pmesh_level_counts counts;
    if (!pmesh_level(reader, n, &counts)) return 0;
    for (uint64_t slot = 0; slot < 3 * (uint64_t)counts.faces; slot++) {
        uint32_t wedge = mesh->corners[slot];
        while (mesh->wedge_vertex[wedge] >= n) wedge = mesh->wedge_collapse[wedge];
        corners[slot] = wedge;
    }
    return 1;
}

/* ---- The reader ---- */

void pmesh_start(pmesh_reader *reader, const pmesh_limits *limits)
{
    memset(reader, 0, sizeof *reader);
    reader->limits = limits != NULL ? *limits : pmesh_default_limits();
    reader->phase = PMESH_IN_HEADER;
}

pmesh_packet pmesh_packet_of(const pmesh_reader *reader, const uint8_t *file, uint32_t k)
{
    const uint8_t *entry = file + reader->directory_offset;
    pmesh_packet packet = pmesh_packet_after(&reader->header, NULL, entry);
    while (packet.number < k) {
        const pmesh_packet before = packet;
        entry += PMESH_ENTRY_BYTES;
        packet = pmesh_packet_after(&reader->header, &before, entry);
    }
    return packet;
}

/* The next packet, without going through those before it. */
static pmesh_packet pmesh_next_packet(const pmesh_reader *reader, const uint8_t *file)
{
    const pmesh_mesh *mesh = &reader->mesh;
    const uint8_t *entry = file + reader->directory_offset + (uint64_t)PMESH_ENTRY_BYTES * reader->packets;
    pmesh_packet before;
    memset(&before, 0, sizeof before);
    before.number = reader->packets - 1u; /* so the next one has the number 0 if there is none */
    before.end_vertex = mesh->vertices;
    before.end_wedge = mesh->wedges;
    before.end_face = mesh->faces;
    before.offset = reader->position;
    return pmesh_packet_after(&reader->header, &before, entry);
}

/* Judges a packet of which all bytes are there, and takes it in. */
static frame_result pmesh_take_packet(pmesh_reader *reader, const pmesh_packet *packet, const uint8_t *record)
{
    const pmesh_header *header = &reader->header;
    frame_result result =
        frame_read_record(record, packet->offset, header->frame.content_id, packet->number, packet->payload_bytes);
    if (result.verdict != FRAME_OK) return result;
    if (frame_u32(record + 4) != 0) return frame_error(FRAME_RESERVED, packet->offset + 4); /* PMESH-PKT-01 */
    if (header->mode == PMESH_RAW) {
        pmesh_payload payload;
        payload.bytes = record + 8;
        payload.length = packet->payload_bytes;
        payload.offset = packet->offset + 8;
        result = pmesh_take_raw(reader, packet, &payload);
    } else {
        result = pmesh_take_coded(reader, packet, record + 8);
        if (result.verdict != FRAME_OK) result.offset += packet->offset + 8;
    }
    if (result.verdict != FRAME_OK) return result;
    reader->mesh.vertices = packet->end_vertex;
    reader->mesh.wedges = packet->end_wedge;
    reader->mesh.faces = packet->end_face;
    reader->position += packet->length;
    reader->packets++;
    return result;
}

static uint32_t pmesh_scratch_payload(const pmesh_reader *reader, const pmesh_packet *packet)
{
    return reader->header.mode == PMESH_CODED ? packet->payload_bytes : 0;
}

uint64_t pmesh_packet_memory(pmesh_reader *reader, const uint8_t *file)
{
    if (reader->phase != PMESH_IN_PACKETS && reader->phase != PMESH_IN_CHUNKS) return 0;
    if (reader->packets == reader->header.packet_count) return 0;
    const pmesh_packet packet = pmesh_next_packet(reader, file);
    return pmesh_want(reader, &packet, pmesh_scratch_payload(reader, &packet));
}

static pmesh_event pmesh_stop(pmesh_reader *reader, frame_result result)
{
    pmesh_event event;
    memset(&event, 0, sizeof event);
    event.kind = PMESH_STOP;
    event.result = result;
    if (result.verdict != FRAME_OK && result.verdict != FRAME_NEED_MORE) {
        reader->phase = PMESH_REFUSED;
        reader->error = result;
    }
    return event;
}

static pmesh_event pmesh_event_of_kind(pmesh_event_kind kind)
{
    pmesh_event event;
    memset(&event, 0, sizeof event);
    event.kind = kind;
    event.result = frame_ok();
    return event;
}

frame_result pmesh_read_packet(pmesh_reader *reader, const uint8_t *file, uint32_t k, const uint8_t *bytes, uint64_t length)
{
    if (reader->phase == PMESH_REFUSED) return reader->error;
    if (k != reader->packets || k >= reader->header.packet_count) {
        return frame_error(PMESH_PACKET_ORDER, 0); /* PMESH-LVL-04 */
    }
    reader->position = reader->packets == 0 ? reader->header.frame.data_offset : reader->position;
    reader->phase = PMESH_IN_PACKETS;
    const pmesh_packet packet = pmesh_next_packet(reader, file);
    if (length < packet.length || pmesh_packet_memory(reader, file) != 0) {
        return frame_need_more(packet.offset + (length < packet.length ? length : packet.length));
    }
    const frame_result result = pmesh_take_packet(reader, &packet, bytes);
    if (result.verdict != FRAME_OK) return pmesh_stop(reader, result).result;
    if (length > packet.length) return frame_error(FRAME_RECORD_LENGTH, packet.offset + packet.length);
    return result;
}

/* Judges the chunk at `position`. On FRAME_OK `event` says what it was, PMESH_STOP if nothing that is known. */
static frame_result pmesh_take_chunk(pmesh_reader *reader, const uint8_t *bytes, uint64_t length, pmesh_event *event)
{
    const pmesh_header *header = &reader->header;
    frame_chunk chunk;
    frame_result result =
        frame_read_chunk(bytes, length, &header->frame, &reader->limits.frame, reader->position, reader->chunks, &chunk);
    *event = pmesh_event_of_kind(PMESH_STOP);
    if (result.verdict != FRAME_OK) return result;
    if (reader->chunks == 0 && !frame_chunk_is(bytes, &chunk, "PDIR")) {
        return frame_error(PMESH_DIRECTORY_MISSING, chunk.offset); /* PMESH-DIR-01 */
    }
    if (frame_chunk_is(bytes, &chunk, "PDIR")) {
        if (reader->chunks > 0) return frame_error(FRAME_CHUNK_REPEATED, chunk.offset);
        result = pmesh_check_directory(header, &reader->limits, &chunk);
        reader->directory_offset = chunk.payload_offset;
        event->kind = PMESH_HEADER;
    } else if (frame_chunk_is(bytes, &chunk, "MTRL")) {
        if (reader->has_material_list) return frame_error(FRAME_CHUNK_REPEATED, chunk.offset);
        result = pmesh_check_materials(&chunk);
        reader->has_material_list = 1;
        event->kind = PMESH_MATERIAL_LIST;
        event->payload = chunk.payload;
        event->payload_bytes = chunk.payload_bytes;
    } else if (frame_chunk_is_critical(bytes, &chunk)) {
        return frame_error(FRAME_CHUNK_CRITICAL, chunk.offset); /* COM-CHK-06 */
    }
    if (result.verdict != FRAME_OK) return result;
    reader->position += chunk.total;
    reader->chunks++;
    return result;
}

/* The memory for all packets of which all bytes are there: the next one, `packet`, and those behind it. */
static uint64_t pmesh_memory_wanted(pmesh_reader *reader, const uint8_t *bytes, uint64_t length, const pmesh_packet *packet)
{
    pmesh_packet last = *packet;
    uint32_t payload_bytes = pmesh_scratch_payload(reader, packet);
    if (pmesh_want(reader, &last, payload_bytes) == 0) return 0;
    while (last.number + 1 < reader->header.packet_count) {
        const uint64_t entry = reader->directory_offset + (uint64_t)PMESH_ENTRY_BYTES * (last.number + 1u);
        const pmesh_packet next = pmesh_packet_after(&reader->header, &last, bytes + entry);
        if (length < next.offset || length - next.offset < next.length) break;
        payload_bytes = pmesh_greater(payload_bytes, pmesh_scratch_payload(reader, &next));
        last = next;
    }
    return pmesh_want(reader, &last, payload_bytes);
}

pmesh_event pmesh_next(pmesh_reader *reader, const uint8_t *bytes, uint64_t length)
{
    pmesh_header *header = &reader->header;
    frame_result result;

    if (reader->phase == PMESH_REFUSED) return pmesh_stop(reader, reader->error);

    if (reader->phase == PMESH_IN_HEADER) {
        result = frame_read_header(bytes, length, "PMS", PMESH_MINOR, PMESH_HEADER_BYTES, &reader->limits.frame, &header->frame);
        if (result.verdict == FRAME_OK) result = pmesh_read_specific_header(bytes, &reader->limits, header);
        if (result.verdict == FRAME_OK && header->frame.data_offset == header->frame.header_bytes) {
            result = frame_error(PMESH_DIRECTORY_MISSING, header->frame.header_bytes); /* PMESH-DIR-01 */
        }
        if (result.verdict != FRAME_OK) return pmesh_stop(reader, result);
        reader->position = header->frame.header_bytes;
        reader->phase = PMESH_IN_CHUNKS;
    }

    while (reader->phase == PMESH_IN_CHUNKS) {
        pmesh_event event;
        if (reader->position == header->frame.data_offset) {
            reader->phase = PMESH_IN_PACKETS;
            break;
        }
        result = pmesh_take_chunk(reader, bytes, length, &event);
        if (result.verdict != FRAME_OK) return pmesh_stop(reader, result);
        if (event.kind != PMESH_STOP) return event;
    }

    if (reader->phase == PMESH_IN_PACKETS) {
        if (reader->packets < header->packet_count) {
            pmesh_event event = pmesh_event_of_kind(PMESH_PACKET);
            event.packet = pmesh_next_packet(reader, bytes);
            if (length < event.packet.offset || length - event.packet.offset < event.packet.length) {
                return pmesh_stop(reader, frame_need_more(length));
            }
            event.memory_bytes = pmesh_memory_wanted(reader, bytes, length, &event.packet);
            if (event.memory_bytes > 0) {
                event.kind = PMESH_MEMORY;
                return event;
            }
            result = pmesh_take_packet(reader, &event.packet, bytes + event.packet.offset);
            if (result.verdict != FRAME_OK) return pmesh_stop(reader, result);
            return event;
        }
        if (length < reader->position || length - reader->position < FRAME_END_RECORD_BYTES) {
            return pmesh_stop(reader, frame_need_more(length));
        }
        result = frame_read_end(bytes + reader->position, reader->position, &header->frame);
        if (result.verdict != FRAME_OK) return pmesh_stop(reader, result);
        reader->position += FRAME_END_RECORD_BYTES;
        reader->phase = PMESH_AT_END;
    }

    if (length > reader->position && !reader->stream_mode) {
        return pmesh_stop(reader, frame_error(FRAME_TRAILING_BYTES, reader->position)); /* COM-REC-08 */
    }
    return pmesh_stop(reader, frame_ok());
}

#endif /* PMESH_IMPLEMENTED */
#endif /* PMESH_IMPLEMENTATION */
