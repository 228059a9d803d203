/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * ivg.h: a reader of .ivg files (irradiance vector grids), version 0.1, written from spec/common.md and spec/ivg.md.
 *
 * A single header in C99, which is valid C++ too. In one source file write
 *
 *     #define IVG_IMPLEMENTATION
 *     #include "ivg.h"
 *
 * and in all others only the second line. Link with -lm (for sqrt).
 *
 * The reader allocates nothing and has no global state. Its caller keeps the bytes of the file that have arrived so far in
 * one piece, and asks for what they hold, event by event:
 *
 *     ivg_reader reader;
 *     ivg_event event;
 *     ivg_start(&reader, NULL);
 *     while ((event = ivg_next(&reader, bytes, length)).kind != IVG_STOP) {
 *         ...
 *     }
 *     event.result.verdict is FRAME_OK, FRAME_NEED_MORE, FRAME_INVALID, FRAME_UNSUPPORTED or FRAME_LIMIT
 *
 * After FRAME_NEED_MORE the loop is run again when more bytes are there; it goes on where it stopped, so that a file costs
 * the same in whatever pieces it arrives: each byte is judged once. The bytes may have moved in memory in the meantime.
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
#ifndef IVG_H
#define IVG_H

#ifdef __cplusplus
extern "C" {
#endif

/* Error codes of .ivg (ivg.md, section 9); those of the frame begin with FRAME_. */
enum {
    IVG_DIMENSIONS = 301,
    IVG_ORIGIN = 302,
    IVG_STEP = 303,
    IVG_SCALE_EXPONENT = 304,
    IVG_SLICE_VERTICES = 305,
    IVG_BUNDLE_COUNT = 306,
    IVG_VALIDITY_COUNT = 307,
    IVG_RECORD_TOO_LARGE = 308,
    IVG_DIRECTORY_ABSENT = 309,
    IVG_DIRECTORY_FORBIDDEN = 310,
    IVG_DIRECTORY_ENTRIES = 311,
    IVG_DIRECTORY_VERTICES = 312,
    IVG_DIRECTORY_INDEX = 313,
    IVG_ENCODING_FORBIDDEN = 401,
    IVG_ENCODING_UNKNOWN = 402,
    IVG_ORDER_FORBIDDEN = 403,
    IVG_ORDER_UNKNOWN = 404,
    IVG_UNITS_UNKNOWN = 405,
    IVG_DIRECTION_CODE = 406,
    IVG_NOT_FINITE = 407,
    IVG_UNUSED_BITS = 408,
    IVG_EDGE_OUTSIDE = 409,
    IVG_LIGHT_LIST = 410, /* LIGHTS */
    IVG_META_LINES = 411, /* METADATA */
    IVG_RATIO_CODE = 412,
    IVG_PAIR_COLOUR = 413,
    IVG_PAIR_DIRECTION = 414,
    IVG_INDEX_NUMBER = 420,
    IVG_INDEX_VERTEX = 421,
    IVG_INDEX_LENGTH = 422,
    IVG_LIMIT_VERTICES = 605
};

/* Encodings (ivg.md, section 6). */
enum {
    IVG_PACKED_OCT24 = 1,
    IVG_PACKED_XYZ24 = 2,
    IVG_PAIR_F16 = 3,
    IVG_PAIR_F16X4 = 4,
    IVG_PAIR_F32 = 5,
    IVG_VECTORS_F32 = 6,
    IVG_SH2_28 = 7
};

/* Orders (IVG-ORD-05). */
enum { IVG_SLICES = 1, IVG_OCTREE = 2, IVG_EXPLICIT = 3 };

/* Units (IVG-HDR-05). */
enum { IVG_RADIOMETRIC = 0, IVG_PHOTOMETRIC = 1 };

/* Ids of records (IVG-REC-01). Bundle k, from 1, has the id k; validity record j, from 0, IVG_VALIDITY_ID + j. */
#define IVG_CORNERS_ID 0u
#define IVG_VALIDITY_ID 0x80000000u

/* Vertices that a validity record covers (IVG-VAL-02). */
#define IVG_VALIDITY_VERTICES 4096u

/* Numbers of a vertex: 6 hemispheres x 3 channels x 3 coordinates (IVG-VEC-01), or 3 channels x 9 coefficients (IVG-SH-01). */
#define IVG_VECTOR_VALUES 54
#define IVG_HARMONICS_VALUES 27

/* What a reader refuses with the verdict FRAME_LIMIT (COM-LIM-01). */
typedef struct ivg_limits {
    frame_limits frame;
    uint64_t vertices; /* vertices of the lattice (IVG-LIM-01) */
} ivg_limits;

/* The header (ivg.md, section 3). */
typedef struct ivg_header {
    frame_header frame;
    uint16_t dims[3];           /* vertices along x, y, z */
    uint16_t encoding;
    double origin[3];           /* position of vertex (0, 0, 0) in metres */
    double step[3];             /* distance of neighbours in metres */
    uint16_t order;
    int16_t scale_exponent;
    uint32_t vertices_per_slice;
    uint64_t seed;
    uint32_t bundle_count;
    uint32_t validity_records;
    uint8_t units;
} ivg_header;

typedef enum ivg_record_kind { IVG_CORNERS, IVG_VALIDITY, IVG_BUNDLE } ivg_record_kind;

/* A record that has been judged and is good. */
typedef struct ivg_record {
    ivg_record_kind kind;
    uint32_t id;
    uint32_t generation;    /* of two with the same id the one with the higher generation counts (IVG-UPD-03) */
    uint64_t offset;        /* of its first byte in the file */
    uint64_t length;        /* in bytes, envelope and padding included */
    const uint8_t *payload; /* in the bytes that the caller gave; valid as long as they are */
    uint32_t vertices;      /* that it holds or, of a validity record, covers */
    uint32_t index_bytes;   /* of the list before the values (IVG-DIRE-02); 0 but in bundles of the order explicit */
    uint64_t first_vertex;  /* of a validity record: the linear index of the first vertex */
} ivg_record;

typedef enum ivg_event_kind {
    IVG_STOP,     /* nothing more for now: `result` says why */
    IVG_HEADER,   /* header and, in the order explicit, directory are known: `reader->header` */
    IVG_LIGHTS,   /* the chunk LITE is there: `payload`, for ivg_next_named_light */
    IVG_METADATA, /* the chunk META is there: `payload`, lines of key=value in UTF-8 */
    IVG_RECORD    /* a record is there: `record` */
} ivg_event_kind;

typedef struct ivg_event {
    ivg_event_kind kind;
    frame_result result;    /* FRAME_OK with all kinds but IVG_STOP */
    ivg_record record;      /* with IVG_RECORD */
    const uint8_t *payload; /* with IVG_LIGHTS and IVG_METADATA */
    uint64_t payload_bytes;
} ivg_event;

typedef enum ivg_phase { IVG_IN_HEADER, IVG_IN_CHUNKS, IVG_IN_RECORDS, IVG_AT_END, IVG_REFUSED } ivg_phase;

/* The state of a reader. Callers may read `header` after the event IVG_HEADER, `position` and `records` at any time. */
typedef struct ivg_reader {
    ivg_header header;
    ivg_limits limits;
    int stream_mode;           /* 1: bytes behind the end record are left to the caller (COM-REC-08); 0 after ivg_start */
    ivg_phase phase;
    uint64_t position;         /* bytes of whole header, chunks and records so far (COM-STR-02) */
    uint64_t records;          /* whole corners, validity records and bundles so far */
    uint32_t chunks;           /* whole chunks so far */
    uint64_t directory_offset; /* of the payload of DIRE in the file (IVG-DIRE-02), 0 without one */
    int has_lights;
    int has_metadata;
    frame_result error;        /* with IVG_REFUSED */
} ivg_reader;

/* One vertex of a record after the other: see ivg_first_vertex. */
typedef struct ivg_vertices {
    const ivg_header *header;
    ivg_record record;
    uint32_t number;        /* of the vertex in the record, from 0 */
    uint64_t linear_index;  /* of the vertex (IVG-LAT-05) */
    uint32_t done;          /* vertices so far */
    uint32_t slice;         /* order slices: the slice, */
    uint32_t next_slice;    /* the one to be looked at after it, */
    uint64_t rank;          /* its next rank, and the one behind its last, */
    uint64_t rank_end;
    uint32_t keys[6];       /* and its K_0 ... K_5 (IVG-ORD-10) */
    uint32_t list_position; /* order explicit: the next byte of the list */
} ivg_vertices;

/* A light of the chunk LITE (IVG-LITE-01). */
typedef struct ivg_named_light {
    int direct;          /* 1 if its direct light is in the grid too */
    const uint8_t *name; /* UTF-8, not ended by a zero; untrusted text (common.md, section 11) */
    uint16_t name_bytes;
} ivg_named_light;

/* The limits of the column "default" (common.md, section 9; ivg.md, section 9). */
ivg_limits ivg_default_limits(void);

/* Begins a file. `limits` may be NULL for the default ones. Does not fail. */
void ivg_start(ivg_reader *reader, const ivg_limits *limits);

/* The next event of a file of which the first `length` bytes are at `bytes`: all that were there in earlier calls, and any
 * number of new ones. Everything is judged in the order of COM-HDR-03, IVG-HDR-01, COM-CHK-03 and COM-REC-05; the verdict
 * and the events are the same in whatever pieces the bytes come (COM-STR-03). The kind IVG_STOP comes with the verdict
 *
 *   FRAME_OK           the file is whole; in file mode with nothing behind it (COM-REC-08),
 *   FRAME_NEED_MORE    so far a proper prefix of a valid file (COM-STR-01),
 *   FRAME_INVALID, FRAME_UNSUPPORTED, FRAME_LIMIT    with the error's code and the offset of the byte at fault, and again
 *                      the same for every further call (COM-VERD-03).
 *
 * Cost: in proportion to the new whole chunks and records; a call without any costs next to nothing. */
ivg_event ivg_next(ivg_reader *reader, const uint8_t *bytes, uint64_t length);

/* Judges a record that was fetched alone (COM-REC-06), after the event IVG_HEADER. `file` are the first bytes of the file,
 * at least its first header.frame.data_offset ones; they are looked at in the order explicit alone and may else be NULL.
 * `bytes` begin with the record `id`, which must be one of the file's. On FRAME_OK `record` is filled in; the caller uses
 * it if its generation is higher than that of the record it holds (IVG-UPD-03). Errors: those of records, with offsets in
 * the file; FRAME_NEED_MORE for fewer bytes than the record has, FRAME_RECORD_LENGTH for more. An id that the file does not
 * have is FRAME_RECORD_ID at offset 0. */
frame_result ivg_read_record(const ivg_reader *reader, const uint8_t *file, uint32_t id, const uint8_t *bytes,
    uint64_t length, ivg_record *record);

/* Where the record `id` lies in the file, in bytes (IVG-REC-03); `file` as in ivg_read_record. Returns 0 if the file has
 * no record of this id, else 1. Cost: constant; in the order explicit in proportion to the bundles before it. */
int ivg_record_place(const ivg_reader *reader, const uint8_t *file, uint32_t id, uint64_t *offset, uint64_t *length);

/* The number of vertices of the lattice, V. */
uint64_t ivg_vertex_count(const ivg_header *header);

/* The number of corners of the lattice (IVG-ORD-01): 1, 2, 4 or 8. */
uint32_t ivg_corner_count(const ivg_header *header);

/* The numbers of a vertex: IVG_HARMONICS_VALUES for sh2-28, IVG_VECTOR_VALUES for all other encodings. */
uint32_t ivg_values_per_vertex(const ivg_header *header);

/* The position of vertex i along an axis (0, 1, 2 for x, y, z) in metres (IVG-LAT-04). */
double ivg_position(const ivg_header *header, int axis, uint32_t i);

/* Begins the vertices of a corners record or a bundle, in stored order; of a validity record there are none.
 * `header` must stay where it is. */
void ivg_first_vertex(ivg_vertices *vertices, const ivg_header *header, const ivg_record *record);

/* Takes the next vertex: returns 1 and sets `number` and `linear_index`, or returns 0 if there is none left. Cost: a
 * constant on average over a file (IVG-LIM-02). */
int ivg_next_vertex(ivg_vertices *vertices);

/* The vertex with rank r, from 0, of the order octree (IVG-OCT-05), for single lookups. */
uint64_t ivg_octree_vertex(const ivg_header *header, uint64_t rank);

/* Dequantises the vertex with a number of a corners record or bundle (IVG-ENC-03) into ivg_values_per_vertex numbers:
 * irradiance vectors by hemisphere (+x -x +y -y +z -z), channel (red, green, blue), coordinate (x, y, z), in W/m2 or lux
 * (IVG-DEF-02); or radiance harmonics by channel and coefficient, in W/(m2 sr) or cd/m2 (IVG-SH-01). All are finite. */
void ivg_values(const ivg_header *header, const ivg_record *record, uint32_t number, float *values);

/* The validity, 0 to 255, of vertex i, from 0, of a validity record (IVG-VAL-03). */
uint8_t ivg_validity(const ivg_record *record, uint32_t i);

/* The blocked edges of vertex i, from 0, of a validity record (IVG-VAL-03): bit 0, 1, 2 for the neighbour in +x, +y, +z. */
uint8_t ivg_blocked_edges(const ivg_record *record, uint32_t i);

/* The next light of the payload of LITE. `position` is 0 before the first call. Returns 0 behind the last one. */
int ivg_next_named_light(const uint8_t *payload, uint64_t payload_bytes, uint64_t *position, ivg_named_light *light);

/* A component of a colour in RGB9E5 (IVG-RGB-02): mantissa x 2^(exponent - 24 + scale_exponent), exactly. */
float ivg_rgb9e5_component(uint32_t mantissa, uint32_t exponent, int scale_exponent);

/* The number of a code of binary16; infinities and NaN have none: returns 0 for them, else 1. */
int ivg_binary16(uint16_t code, float *number);

/* The direction of u, v from -2047 to 2047 (IVG-DIR-03), three components. */
void ivg_oct24_direction(int u, int v, float *direction);

/* The direction of x, y, z from -127 to 127, not all 0 (IVG-XYZ-03), three components. */
void ivg_xyz24_direction(int x, int y, int z, float *direction);

#ifdef __cplusplus
}
#endif

#endif /* IVG_H */

#ifdef IVG_IMPLEMENTATION
#ifndef IVG_IMPLEMENTED
#define IVG_IMPLEMENTED


#define IVG_MINOR 1u                          /* COM-HDR-02 */
#define IVG_HEADER_BYTES 144u                 /* ivg.md, section 3 */
#define IVG_SCALE_EXPONENT_LEAST (-125)       /* IVG-HDR-04 */
#define IVG_SCALE_EXPONENT_GREATEST 112       /* IVG-HDR-04 */
#define IVG_SCALE_EXPONENT_GREATEST_SH2 110   /* IVG-HDR-04 */
#define IVG_COUNT_END UINT64_C(0x80000000)    /* IVG-ORD-04, IVG-OCT-01, IVG-DIRE-04, IVG-VAL-01: counts are less */
#define IVG_DIRECTORY_ENTRY_BYTES 8u          /* IVG-DIRE-02 */
#define IVG_INDEX_NUMBER_BYTES 7u             /* IVG-EXP-02 */

ivg_limits ivg_default_limits(void)
{
    ivg_limits limits;
    limits.frame.header_bytes = 4096;
    limits.frame.chunk_bytes = 1048576;
    limits.frame.chunks = 1024;
    limits.frame.record_bytes = 67108864;
    limits.vertices = 134217728;
    return limits;
}

static uint64_t ivg_least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t ivg_divide_up(uint64_t a, uint64_t b)
{
    return a / b + (a % b != 0);
}

/* ---- Lattice (ivg.md, section 2) ---- */

uint64_t ivg_vertex_count(const ivg_header *header)
{
    return (uint64_t)header->dims[0] * header->dims[1] * header->dims[2];
}

uint32_t ivg_corner_count(const ivg_header *header)
{
    uint32_t count = 1;
    for (int axis = 0; axis < 3; axis++) count *= header->dims[axis] < 2 ? 1u : 2u;
    return count;
}

double ivg_position(const ivg_header *header, int axis, uint32_t i)
{
    volatile double product = (double)i * header->step[axis]; /* volatile: never fused (IVG-LAT-04) */
    return header->origin[axis] + product;
}

static uint64_t ivg_linear_index(const ivg_header *header, const uint32_t *vertex)
{
    return vertex[0] + header->dims[0] * (vertex[1] + (uint64_t)header->dims[1] * vertex[2]); /* IVG-LAT-05 */
}

static void ivg_coordinates(const ivg_header *header, uint64_t linear_index, uint32_t *vertex)
{
    vertex[0] = (uint32_t)(linear_index % header->dims[0]);
    linear_index /= header->dims[0];
    vertex[1] = (uint32_t)(linear_index % header->dims[1]);
    vertex[2] = (uint32_t)(linear_index / header->dims[1]);
}

/* IVG-ORD-01 */
static int ivg_is_corner(const ivg_header *header, uint64_t linear_index)
{
    uint32_t vertex[3];
    ivg_coordinates(header, linear_index, vertex);
    for (int axis = 0; axis < 3; axis++) {
        if (vertex[axis] != 0 && vertex[axis] != header->dims[axis] - 1u) return 0;
    }
    return 1;
}

/* The vertices that are not corners: W of IVG-OCT-01. */
static uint64_t ivg_other_vertices(const ivg_header *header)
{
    return ivg_vertex_count(header) - ivg_corner_count(header);
}

/* ---- Encodings: bytes a vertex (ivg.md, section 6) ---- */

static uint32_t ivg_bytes_per_vertex(const ivg_header *header)
{
    static const uint8_t bytes[8] = {0, 42, 42, 72, 96, 144, 216, 28};
    return bytes[header->encoding];
}

uint32_t ivg_values_per_vertex(const ivg_header *header)
{
    return header->encoding == IVG_SH2_28 ? IVG_HARMONICS_VALUES : IVG_VECTOR_VALUES;
}

/* ---- Order: sizes (ivg.md, section 5) ---- */

/* IVG-ORD-02: the axis with the most vertices, of equals the lowest. */
static int ivg_longest_axis(const ivg_header *header)
{
    int longest = 0;
    for (int axis = 1; axis < 3; axis++) {
        if (header->dims[axis] > header->dims[longest]) longest = axis;
    }
    return longest;
}

/* The slices of IVG-ORD-02 and -08. */
typedef struct ivg_slices {
    int a, b, c;             /* the longest axis, and the other two ascending */
    uint32_t outer, inner;   /* numbers of outer and inner slices */
    uint64_t outer_vertices; /* m of an outer slice */
    uint64_t inner_vertices; /* m of an inner slice */
} ivg_slices;

static ivg_slices ivg_slices_of(const ivg_header *header)
{
    ivg_slices slices;
    slices.a = ivg_longest_axis(header);
    slices.b = slices.a == 0 ? 1 : 0;
    slices.c = slices.a == 2 ? 1 : 2;
    const uint64_t n_b = header->dims[slices.b], n_c = header->dims[slices.c];
    slices.outer = header->dims[slices.a] < 2 ? 1 : 2;
    slices.inner = header->dims[slices.a] - slices.outer;
    slices.outer_vertices = n_b * n_c - ivg_least(n_b, 2) * ivg_least(n_c, 2);
    slices.inner_vertices = n_b * n_c;
    return slices;
}

/* What a slice of m vertices gives to bundle k (IVG-ORD-04). */
static uint64_t ivg_share(uint64_t m, uint64_t k, uint64_t vertices_per_slice)
{
    const uint64_t before = (k - 1) * vertices_per_slice;
    return before >= m ? 0 : ivg_least(vertices_per_slice, m - before);
}

/* The number of bundles that follows from the lattice, in the orders slices (IVG-ORD-04) and octree (IVG-OCT-01). */
static uint64_t ivg_expected_bundles(const ivg_header *header)
{
    const uint64_t s = header->vertices_per_slice;
    if (header->order == IVG_OCTREE) {
        return ivg_divide_up(ivg_other_vertices(header), s * header->dims[ivg_longest_axis(header)]);
    }
    const ivg_slices slices = ivg_slices_of(header);
    return ivg_divide_up(slices.inner > 0 ? slices.inner_vertices : slices.outer_vertices, s);
}

/* L(k) in the orders slices and octree. */
static uint64_t ivg_bundle_vertices(const ivg_header *header, uint64_t k)
{
    const uint64_t s = header->vertices_per_slice;
    if (header->order == IVG_OCTREE) {
        const uint64_t share = s * header->dims[ivg_longest_axis(header)];
        return ivg_least(share, ivg_other_vertices(header) - (k - 1) * share);
    }
    const ivg_slices slices = ivg_slices_of(header);
    return slices.outer * ivg_share(slices.outer_vertices, k, s) + slices.inner * ivg_share(slices.inner_vertices, k, s);
}

/* The last bundle, from k on, to which a slice of m vertices gives as many as to bundle k. */
static uint64_t ivg_last_equal_share(uint64_t m, uint64_t k, uint64_t vertices_per_slice)
{
    if (k * vertices_per_slice <= m) return m / vertices_per_slice;
    return (k - 1) * vertices_per_slice < m ? k : UINT64_MAX;
}

/* The bytes of bundles 1 ... end - 1 in the orders slices and octree (IVG-REC-03): a few runs of equal bundles. */
static uint64_t ivg_bundles_bytes(const ivg_header *header, uint64_t end)
{
    const uint64_t s = header->vertices_per_slice;
    const ivg_slices slices = ivg_slices_of(header);
    uint64_t sum = 0;
    for (uint64_t k = 1; k < end;) {
        uint64_t last = end - 1;
        if (header->order == IVG_OCTREE) {
            if (k < header->bundle_count) last = ivg_least(last, header->bundle_count - 1u);
        } else {
            last = ivg_least(last, ivg_last_equal_share(slices.outer_vertices, k, s));
            if (slices.inner > 0) last = ivg_least(last, ivg_last_equal_share(slices.inner_vertices, k, s));
        }
        sum += (last - k + 1) * frame_record_bytes(ivg_bundle_vertices(header, k) * ivg_bytes_per_vertex(header));
        k = last + 1;
    }
    return sum;
}

/* The vertices of validity record j. */
static uint32_t ivg_validity_vertices(const ivg_header *header, uint32_t j)
{
    const uint64_t first = (uint64_t)j * IVG_VALIDITY_VERTICES;
    return (uint32_t)ivg_least(IVG_VALIDITY_VERTICES, ivg_vertex_count(header) - first);
}

/* The payload of a validity record that covers n vertices (IVG-VAL-02). */
static uint64_t ivg_validity_bytes(uint64_t n)
{
    return n + (3 * n + 7) / 8;
}

/* The bytes of corners and validity records. */
static uint64_t ivg_bytes_before_bundles(const ivg_header *header)
{
    uint64_t sum = frame_record_bytes((uint64_t)ivg_corner_count(header) * ivg_bytes_per_vertex(header));
    if (header->validity_records > 0) {
        const uint32_t last = header->validity_records - 1;
        sum += last * frame_record_bytes(ivg_validity_bytes(IVG_VALIDITY_VERTICES));
        sum += frame_record_bytes(ivg_validity_bytes(ivg_validity_vertices(header, last)));
    }
    return sum;
}

/* ---- Header (ivg.md, section 3) ---- */

/* Judges the specific header up to `reserved`, in the order of IVG-HDR-01. */
static frame_result ivg_read_specific_header(const uint8_t *bytes, const ivg_limits *limits, ivg_header *header)
{
    for (int axis = 0; axis < 3; axis++) header->dims[axis] = frame_u16(bytes + 56 + 2 * axis);
    for (int axis = 0; axis < 3; axis++) header->origin[axis] = frame_f64(bytes + 64 + 8 * axis);
    for (int axis = 0; axis < 3; axis++) header->step[axis] = frame_f64(bytes + 88 + 8 * axis);
    header->encoding = frame_u16(bytes + 62);
    header->order = frame_u16(bytes + 112);
    const uint16_t exponent = frame_u16(bytes + 114);
    header->scale_exponent = (int16_t)(exponent < 0x8000 ? exponent : (int)exponent - 0x10000);
    header->vertices_per_slice = frame_u32(bytes + 116);
    header->seed = frame_u64(bytes + 120);
    header->bundle_count = frame_u32(bytes + 128);
    header->validity_records = frame_u32(bytes + 132);
    header->units = bytes[136];

    for (int axis = 0; axis < 3; axis++) {
        const uint64_t at = (uint64_t)axis;
        const double step = header->step[axis];
        if (header->dims[axis] == 0) return frame_error(IVG_DIMENSIONS, 56 + 2 * at); /* IVG-LAT-01 */
        if (!frame_is_finite_f64(header->origin[axis]) || !frame_is_finite_f64(step) ||
            !frame_is_finite_f64(ivg_position(header, axis, header->dims[axis] - 1u))) {
            return frame_error(IVG_ORIGIN, 64 + 8 * at); /* IVG-LAT-02 */
        }
        if (header->dims[axis] >= 2 ? !(step > 0) : step != 0) {
            return frame_error(IVG_STEP, 88 + 8 * at); /* IVG-LAT-03 */
        }
    }
    if (header->encoding == 0) return frame_error(IVG_ENCODING_FORBIDDEN, 62);
    if (header->encoding > IVG_SH2_28) return frame_error(IVG_ENCODING_UNKNOWN, 62);
    if (header->order == 0) return frame_error(IVG_ORDER_FORBIDDEN, 112);
    if (header->order > IVG_EXPLICIT) return frame_error(IVG_ORDER_UNKNOWN, 112);
    const int greatest = header->encoding == IVG_SH2_28 ? IVG_SCALE_EXPONENT_GREATEST_SH2 : IVG_SCALE_EXPONENT_GREATEST;
    if (header->scale_exponent < IVG_SCALE_EXPONENT_LEAST || header->scale_exponent > greatest) {
        return frame_error(IVG_SCALE_EXPONENT, 114);
    }
    if (header->units > IVG_PHOTOMETRIC) return frame_error(IVG_UNITS_UNKNOWN, 136);
    if (header->vertices_per_slice == 0) return frame_error(IVG_SLICE_VERTICES, 116);

    if (header->bundle_count >= IVG_COUNT_END ||
        (header->order == IVG_EXPLICIT ? header->bundle_count > ivg_other_vertices(header)
                                       : header->bundle_count != ivg_expected_bundles(header))) {
        return frame_error(IVG_BUNDLE_COUNT, 128);
    }
    if (header->validity_records != 0 &&
        (header->validity_records >= IVG_COUNT_END ||
         header->validity_records != ivg_divide_up(ivg_vertex_count(header), IVG_VALIDITY_VERTICES))) {
        return frame_error(IVG_VALIDITY_COUNT, 132);
    }

    /* IVG-HDR-06: corners, the first validity record, the first bundle; of explicit bundles later (IVG-DIRE-03) */
    uint64_t longest = frame_record_bytes((uint64_t)ivg_corner_count(header) * ivg_bytes_per_vertex(header));
    if (header->validity_records > 0) {
        const uint64_t validity = frame_record_bytes(ivg_validity_bytes(ivg_validity_vertices(header, 0)));
        if (validity > longest) longest = validity;
    }
    if (header->order != IVG_EXPLICIT && header->bundle_count > 0) {
        const uint64_t bundle = frame_record_bytes(ivg_bundle_vertices(header, 1) * ivg_bytes_per_vertex(header));
        if (bundle > longest) longest = bundle;
    }
    if (longest > FRAME_RECORD_BYTES_MAXIMUM) return frame_error(IVG_RECORD_TOO_LARGE, 116);
    if (ivg_vertex_count(header) > limits->vertices) return frame_error(IVG_LIMIT_VERTICES, 56);
    if (longest > limits->frame.record_bytes) return frame_error(FRAME_LIMIT_RECORD_BYTES, 116);
    for (int i = 0; i < 7; i++) {
        if (bytes[137 + i] != 0) return frame_error(FRAME_RESERVED, 137); /* IVG-HDR-02 */
    }
    return frame_ok();
}

/* Judges `file_bytes` (COM-HDR-10), given the bytes of all bundles. */
static frame_result ivg_check_file_bytes(const ivg_header *header, uint64_t bundles_bytes)
{
    /* data_offset <= file_bytes is known (COM-HDR-09); the other numbers are below 2^63. */
    const uint64_t records = ivg_bytes_before_bundles(header) + bundles_bytes + FRAME_END_RECORD_BYTES;
    if (header->frame.file_bytes - header->frame.data_offset != records) return frame_error(FRAME_FILE_BYTES, 48);
    return frame_ok();
}

/* ---- Order: which vertex is it (ivg.md, section 5) ---- */

/* F of IVG-ORD-10. */
static uint32_t ivg_feistel_round(uint32_t z)
{
    z = (z ^ (z >> 16)) * UINT32_C(0x85EBCA6B);
    z = (z ^ (z >> 13)) * UINT32_C(0xC2B2AE35);
    return z ^ (z >> 16);
}

/* P(r) of IVG-ORD-09 for a slice of m vertices. */
static uint64_t ivg_permute(uint64_t r, uint64_t m, const uint32_t *keys)
{
    unsigned beta = 2;
    while ((UINT64_C(1) << beta) < m) beta++;
    const unsigned lambda = beta / 2, rho = beta - lambda;
    const uint32_t left_mask = (uint32_t)((UINT64_C(1) << lambda) - 1), right_mask = (uint32_t)((UINT64_C(1) << rho) - 1);
    uint64_t x = r;
    do {
        uint32_t left = (uint32_t)(x >> rho), right = (uint32_t)x & right_mask;
        for (int t = 0; t < 6; t++) {
            if (t % 2 == 0) {
                left ^= ivg_feistel_round(right + keys[t]) & left_mask;
            } else {
                right ^= ivg_feistel_round(left + keys[t]) & right_mask;
            }
        }
        x = (uint64_t)left << rho | right;
    } while (x >= m);
    return x;
}

/* The slice index of the vertex with a number in a slice (IVG-ORD-08). */
static uint64_t ivg_slice_index(uint64_t number, int is_outer, uint64_t n_b, uint64_t n_c)
{
    if (!is_outer) return number;
    const uint64_t corners[4] = {0, n_b - 1, n_b * (n_c - 1), n_b * n_c - 1}; /* ascending */
    for (int i = 0; i < 4; i++) {
        if ((i == 0 || corners[i] != corners[i - 1]) && number >= corners[i]) number++;
    }
    return number;
}

/* A cell of the order octree (IVG-OCT-02). */
typedef struct ivg_cell {
    uint32_t lowest[3];
    uint32_t extent[3];
} ivg_cell;

/* The vertices of a cell that are not corners (IVG-OCT-05). */
static uint64_t ivg_cell_vertices(const ivg_header *header, const ivg_cell *cell)
{
    uint64_t all = 1, corners = 1;
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t last = header->dims[axis] - 1u;
        const uint32_t end = cell->lowest[axis] + cell->extent[axis];
        uint64_t ends = cell->lowest[axis] == 0;
        if (last > 0 && cell->lowest[axis] <= last && last < end) ends++;
        all *= cell->extent[axis];
        corners *= ends;
    }
    return all - corners;
}

uint64_t ivg_octree_vertex(const ivg_header *header, uint64_t rank)
{
    static const uint8_t turns[3][8] = {{0, 1}, {0, 3, 1, 2}, {0, 3, 5, 6, 7, 4, 2, 1}}; /* T of IVG-OCT-04 */
    ivg_cell cell;
    for (int axis = 0; axis < 3; axis++) {
        cell.lowest[axis] = 0;
        cell.extent[axis] = header->dims[axis];
    }
    for (uint64_t depth = 0;; depth++) {
        uint32_t largest = cell.extent[0];
        for (int axis = 1; axis < 3; axis++) {
            if (cell.extent[axis] > largest) largest = cell.extent[axis];
        }
        if (largest == 1) return ivg_linear_index(header, cell.lowest);

        /* The children, in the order of their turns (IVG-OCT-02, -04) */
        int cut_axes[3], cuts = 0;
        for (int axis = 0; axis < 3; axis++) {
            if (cell.extent[axis] >= 2 && 2 * cell.extent[axis] > largest) cut_axes[cuts++] = axis;
        }
        const unsigned m = 1u << cuts;
        const unsigned h =
            (unsigned)(frame_splitmix64(header->seed, 32 * ivg_linear_index(header, cell.lowest) + depth) % m);
        ivg_cell children[8];
        uint64_t vertices[8];
        for (unsigned t = 0; t < m; t++) {
            const unsigned number = turns[cuts - 1][t] ^ h;
            children[t] = cell;
            for (int i = 0; i < cuts; i++) {
                const int axis = cut_axes[i];
                const uint32_t lower = cell.extent[axis] - cell.extent[axis] / 2;
                if ((number >> i) & 1) {
                    children[t].lowest[axis] += lower;
                    children[t].extent[axis] = cell.extent[axis] / 2;
                } else {
                    children[t].extent[axis] = lower;
                }
            }
            vertices[t] = ivg_cell_vertices(header, &children[t]);
        }

        /* Which child has the rank (IVG-OCT-05) */
        for (uint64_t done = 0;;) {
            uint64_t next = UINT64_MAX, left = 0;
            for (unsigned t = 0; t < m; t++) {
                if (vertices[t] <= done) continue;
                left++;
                if (vertices[t] < next) next = vertices[t];
            }
            if (left == 0) return 0; /* a rank that the lattice does not have */
            if (rank < (next - done) * left) {
                uint64_t turn = rank % left;
                unsigned t = 0;
                while (vertices[t] <= done || turn-- > 0) t++;
                rank = done + rank / left;
                cell = children[t];
                break;
            }
            rank -= (next - done) * left;
            done = next;
        }
    }
}

/* Reads a number of a list of vertices (IVG-EXP-02) at `position`, which is moved behind it. Returns 0 if it is not well
 * formed. */
static int ivg_index_number(const uint8_t *list, uint32_t index_bytes, uint32_t *position, uint64_t *number)
{
    *number = 0;
    for (uint32_t i = 0; i < IVG_INDEX_NUMBER_BYTES; i++) {
        if (*position + i >= index_bytes) return 0;
        const uint8_t byte = list[*position + i];
        *number |= (uint64_t)(byte & 0x7F) << (7 * i);
        if ((byte & 0x80) == 0) {
            if (byte == 0 && i > 0) return 0;
            *position += i + 1;
            return 1;
        }
    }
    return 0;
}

void ivg_first_vertex(ivg_vertices *vertices, const ivg_header *header, const ivg_record *record)
{
    memset(vertices, 0, sizeof *vertices);
    vertices->header = header;
    vertices->record = *record;
}

/* The next vertex of a bundle of the order slices (IVG-ORD-07). */
static uint64_t ivg_next_of_slices(ivg_vertices *vertices)
{
    const ivg_header *header = vertices->header;
    const ivg_slices slices = ivg_slices_of(header);
    const uint32_t n_a = header->dims[slices.a];
    const uint64_t n_b = header->dims[slices.b], n_c = header->dims[slices.c];
    const uint64_t s = header->vertices_per_slice, k = vertices->record.id;
    while (vertices->rank == vertices->rank_end) { /* on to the next slice that gives this bundle vertices */
        vertices->slice = vertices->next_slice++;
        const int outer = vertices->slice == 0 || vertices->slice == n_a - 1;
        vertices->rank = (k - 1) * s;
        vertices->rank_end = vertices->rank + ivg_share(outer ? slices.outer_vertices : slices.inner_vertices, k, s);
        for (uint64_t t = 0; t < 6; t++) {
            vertices->keys[t] = (uint32_t)(frame_splitmix64(header->seed, 6 * (uint64_t)vertices->slice + t) >> 32);
        }
    }
    const int is_outer = vertices->slice == 0 || vertices->slice == n_a - 1;
    const uint64_t m = is_outer ? slices.outer_vertices : slices.inner_vertices;
    const uint64_t index = ivg_slice_index(ivg_permute(vertices->rank++, m, vertices->keys), is_outer, n_b, n_c);
    uint32_t vertex[3];
    vertex[slices.a] = vertices->slice;
    vertex[slices.b] = (uint32_t)(index % n_b);
    vertex[slices.c] = (uint32_t)(index / n_b);
    return ivg_linear_index(header, vertex);
}

int ivg_next_vertex(ivg_vertices *vertices)
{
    const ivg_header *header = vertices->header;
    const ivg_record *record = &vertices->record;
    if (record->kind == IVG_VALIDITY || vertices->done == record->vertices) return 0;
    if (record->kind == IVG_CORNERS) { /* ascending by linear index (IVG-ORD-01) */
        uint32_t vertex[3], bits = vertices->done;
        for (int axis = 0; axis < 3; axis++) {
            vertex[axis] = 0;
            if (header->dims[axis] < 2) continue;
            if (bits & 1) vertex[axis] = header->dims[axis] - 1u;
            bits >>= 1;
        }
        vertices->linear_index = ivg_linear_index(header, vertex);
    } else if (header->order == IVG_SLICES) {
        vertices->linear_index = ivg_next_of_slices(vertices);
    } else if (header->order == IVG_OCTREE) {
        const uint64_t share = (uint64_t)header->vertices_per_slice * header->dims[ivg_longest_axis(header)];
        vertices->linear_index = ivg_octree_vertex(header, (record->id - 1u) * share + vertices->done);
    } else { /* IVG-EXP-01; the list has been judged */
        uint64_t number;
        if (!ivg_index_number(record->payload, record->index_bytes, &vertices->list_position, &number)) return 0;
        vertices->linear_index = vertices->done == 0 ? number : vertices->linear_index + number + 1;
    }
    vertices->number = vertices->done++;
    return 1;
}

/* ---- Encodings (ivg.md, section 6) ---- */

float ivg_rgb9e5_component(uint32_t mantissa, uint32_t exponent, int scale_exponent)
{
    return (float)((double)mantissa * frame_power_of_two((int)exponent - 24 + scale_exponent)); /* exact */
}

int ivg_binary16(uint16_t code, float *number)
{
    const uint32_t exponent = (code >> 10) & 31u, mantissa = code & 1023u;
    double magnitude;
    if (exponent == 31) return 0;
    if (exponent == 0) {
        magnitude = (double)mantissa * frame_power_of_two(-24);
    } else {
        magnitude = (double)(mantissa + 1024) * frame_power_of_two((int)exponent - 25);
    }
    *number = (float)(code & 0x8000 ? -magnitude : magnitude);
    return 1;
}

/* A point divided by the root of q, each component rounded once in effect (IVG-DIR-03). */
static void ivg_direction_of_point(int x, int y, int z, float *direction)
{
    const double root = sqrt((double)(x * x + y * y + z * z));
    direction[0] = (float)(x / root);
    direction[1] = (float)(y / root);
    direction[2] = (float)(z / root);
}

void ivg_oct24_direction(int u, int v, float *direction)
{
    const int u_magnitude = u < 0 ? -u : u, v_magnitude = v < 0 ? -v : v;
    const int z = 2047 - u_magnitude - v_magnitude;
    if (z >= 0) {
        ivg_direction_of_point(u, v, z, direction);
    } else {
        ivg_direction_of_point((2047 - v_magnitude) * (u < 0 ? -1 : 1), (2047 - u_magnitude) * (v < 0 ? -1 : 1), z, direction);
    }
}

void ivg_xyz24_direction(int x, int y, int z, float *direction)
{
    ivg_direction_of_point(x, y, z, direction);
}

static int ivg_i8(uint8_t byte)
{
    return byte < 0x80 ? byte : byte - 0x100;
}

/* Decodes the direction code of packed-oct24 or packed-xyz24 at `code`. Returns 0 if it is forbidden (IVG-DIR-02,
 * IVG-XYZ-02). `direction` may be NULL. */
static int ivg_direction_code(int encoding, const uint8_t *code, float *direction)
{
    if (encoding == IVG_PACKED_OCT24) {
        const int low = code[0] | (code[1] & 0x0F) << 8, high = code[1] >> 4 | code[2] << 4;
        if (low == 4095 || high == 4095) return 0;
        if (direction != NULL) ivg_oct24_direction(low - 2047, high - 2047, direction);
        return 1;
    }
    if (code[0] == 0x80 || code[1] == 0x80 || code[2] == 0x80 || (code[0] | code[1] | code[2]) == 0) return 0;
    if (direction != NULL) ivg_xyz24_direction(ivg_i8(code[0]), ivg_i8(code[1]), ivg_i8(code[2]), direction);
    return 1;
}

/* A number of a pair encoding, as binary32; 0 if a binary16 is infinite or NaN. */
static int ivg_pair_number(int encoding, const uint8_t *bytes, float *number)
{
    if (encoding != IVG_PAIR_F32) return ivg_binary16(frame_u16(bytes), number);
    *number = frame_f32(bytes);
    return frame_is_finite_f32(*number);
}

/* A number times 2^scale_exponent, rounded once to binary32 (the power is a normal number of binary32). */
static float ivg_scaled(const ivg_header *header, float number)
{
    return header->scale_exponent == 0 ? number : number * (float)frame_power_of_two(header->scale_exponent);
}

/* The sizes of a pair encoding (IVG-PAIR-01): bytes of a number, numbers of a colour or direction. */
static uint32_t ivg_pair_number_bytes(const ivg_header *header)
{
    return header->encoding == IVG_PAIR_F32 ? 4 : 2;
}

static uint32_t ivg_pair_numbers(const ivg_header *header)
{
    return header->encoding == IVG_PAIR_F16X4 ? 4 : 3;
}

/* Judges the values of n vertices in stored order; `offset` is that of the first one in the file. */
static frame_result ivg_check_values(const ivg_header *header, const uint8_t *values, uint64_t n, uint64_t offset)
{
    if (header->encoding == IVG_PACKED_OCT24 || header->encoding == IVG_PACKED_XYZ24) {
        const uint64_t first = n * 6 * 4; /* behind the colours (IVG-PACK-01) */
        for (uint64_t i = 0; i < n * 6; i++) {
            if (!ivg_direction_code(header->encoding, values + first + 3 * i, NULL)) {
                return frame_error(IVG_DIRECTION_CODE, offset + first + 3 * i);
            }
        }
    } else if (header->encoding == IVG_VECTORS_F32) {
        for (uint64_t i = 0; i < n * IVG_VECTOR_VALUES; i++) {
            const float number = frame_f32(values + 4 * i);
            if (!frame_is_finite_f32(number) || !frame_is_finite_f32(ivg_scaled(header, number))) {
                return frame_error(IVG_NOT_FINITE, offset + 4 * i); /* IVG-VEC-02 */
            }
        }
    } else if (header->encoding == IVG_SH2_28) {
        const uint64_t first = n * 4; /* behind the coefficients 0 (IVG-SH-02) */
        for (uint64_t i = 0; i < n * 24; i++) {
            if (values[first + i] == 0x80) return frame_error(IVG_RATIO_CODE, offset + first + i);
        }
    } else { /* IVG-PAIR-04: all numbers in stored order */
        const uint32_t bytes = ivg_pair_number_bytes(header), numbers = ivg_pair_numbers(header);
        for (uint64_t i = 0; i < n * 6 * 2 * numbers; i++) {
            const uint8_t *at = values + bytes * i;
            const uint64_t at_offset = offset + bytes * i;
            float number = 0;
            if (i % numbers == 3) {
                if (frame_u16(at) != 0) return frame_error(FRAME_RESERVED, at_offset);
                continue;
            }
            const int is_number = ivg_pair_number(header->encoding, at, &number);
            if (i < n * 6 * numbers) {
                if (!is_number || number < 0 || !frame_is_finite_f32(ivg_scaled(header, number))) {
                    return frame_error(IVG_PAIR_COLOUR, at_offset); /* IVG-PAIR-02 */
                }
            } else if (!is_number || number < -1 || number > 1) {
                return frame_error(IVG_PAIR_DIRECTION, at_offset); /* IVG-PAIR-03 */
            }
        }
    }
    return frame_ok();
}

/* The components of an irradiance vector (IVG-PACK-05, IVG-PAIR-05). */
static void ivg_multiply(const float *colour, const float *direction, float *values)
{
    for (int channel = 0; channel < 3; channel++) {
        for (int axis = 0; axis < 3; axis++) values[3 * channel + axis] = colour[channel] * direction[axis];
    }
}

/* The scaled colour of RGB9E5 (IVG-RGB-01, -02). */
static void ivg_rgb9e5(const ivg_header *header, const uint8_t *bytes, float *colour)
{
    const uint32_t code = frame_u32(bytes);
    for (int channel = 0; channel < 3; channel++) {
        colour[channel] = ivg_rgb9e5_component((code >> (9 * channel)) & 511u, code >> 27, header->scale_exponent);
    }
}

/* IVG-SH-05 */
static void ivg_harmonics(const float *mean, const uint8_t *codes, float *values)
{
    for (int channel = 0; channel < 3; channel++) {
        values[9 * channel] = mean[channel];
        for (int k = 1; k <= 8; k++) {
            const int code = ivg_i8(codes[8 * channel + k - 1]);
            uint32_t bits = 0x3C79D29Bu;
            if (k <= 3) bits = 0x3C5F72BDu;
            if (k == 6) bits = code >= 0 ? 0x3C903C35u : 0x3C103C35u;
            const float ratio = (float)code * frame_float_of_bits(bits);
            values[9 * channel + k] = mean[channel] * ratio;
        }
    }
}

void ivg_values(const ivg_header *header, const ivg_record *record, uint32_t number, float *values)
{
    const uint8_t *payload = record->payload + record->index_bytes;
    const uint64_t n = record->vertices, i = number;
    float colour[3], direction[3];
    if (header->encoding == IVG_SH2_28) {
        ivg_rgb9e5(header, payload + 4 * i, colour);
        ivg_harmonics(colour, payload + 4 * n + 24 * i, values);
        return;
    }
    if (header->encoding == IVG_VECTORS_F32) {
        for (uint64_t j = 0; j < IVG_VECTOR_VALUES; j++) {
            values[j] = ivg_scaled(header, frame_f32(payload + 4 * (IVG_VECTOR_VALUES * i + j)));
        }
        return;
    }
    for (uint64_t d = 0; d < 6; d++) { /* hemispheres (IVG-DEF-03) */
        if (header->encoding == IVG_PACKED_OCT24 || header->encoding == IVG_PACKED_XYZ24) {
            ivg_rgb9e5(header, payload + 4 * (6 * i + d), colour);
            ivg_direction_code(header->encoding, payload + n * 24 + 3 * (6 * i + d), direction);
        } else {
            const uint32_t bytes = ivg_pair_number_bytes(header), numbers = ivg_pair_numbers(header);
            for (uint64_t j = 0; j < 3; j++) {
                colour[j] = direction[j] = 0;
                ivg_pair_number(header->encoding, payload + bytes * (numbers * (6 * i + d) + j), &colour[j]);
                ivg_pair_number(header->encoding, payload + bytes * (numbers * (6 * (n + i) + d) + j), &direction[j]);
                colour[j] = colour[j] == 0 ? 0 : ivg_scaled(header, colour[j]); /* -0 is read as +0 (IVG-PAIR-02) */
            }
        }
        ivg_multiply(colour, direction, values + 9 * d);
    }
}

/* ---- Validity (ivg.md, section 7) ---- */

uint8_t ivg_validity(const ivg_record *record, uint32_t i)
{
    return record->payload[i];
}

uint8_t ivg_blocked_edges(const ivg_record *record, uint32_t i)
{
    const uint8_t *bits = record->payload + record->vertices;
    const uint32_t bit = 3 * i;
    uint32_t window = bits[bit / 8];
    if (bit % 8 > 5) window |= (uint32_t)bits[bit / 8 + 1] << 8; /* the three bits lie in two bytes */
    return (uint8_t)((window >> (bit % 8)) & 7u);
}

static frame_result ivg_check_validity(const ivg_header *header, const ivg_record *record)
{
    const uint64_t bits_offset = record->offset + 8 + record->vertices;
    const uint32_t used = 3 * record->vertices % 8, last = (3 * record->vertices - 1) / 8;
    if (used != 0 && record->payload[record->vertices + last] >> used != 0) {
        return frame_error(IVG_UNUSED_BITS, bits_offset + last); /* IVG-VAL-04 */
    }
    for (uint32_t i = 0; i < record->vertices; i++) { /* IVG-VAL-05 */
        const uint8_t blocked = ivg_blocked_edges(record, i);
        uint32_t vertex[3];
        if (blocked == 0) continue;
        ivg_coordinates(header, record->first_vertex + i, vertex);
        for (int axis = 0; axis < 3; axis++) {
            if ((blocked >> axis & 1) != 0 && vertex[axis] == header->dims[axis] - 1u) {
                return frame_error(IVG_EDGE_OUTSIDE, bits_offset + 3 * i / 8);
            }
        }
    }
    return frame_ok();
}

/* ---- Chunks (ivg.md, sections 5.3 and 8) ---- */

/* IVG-DIRE-02, -03. On FRAME_OK `bundles_bytes` is the length of all bundles. */
static frame_result ivg_check_directory(const ivg_header *header, const ivg_limits *limits, const frame_chunk *chunk,
    uint64_t *bundles_bytes)
{
    const uint64_t others = ivg_other_vertices(header);
    const uint64_t share = (uint64_t)header->vertices_per_slice * header->dims[ivg_longest_axis(header)];
    uint64_t sum = 0;
    *bundles_bytes = 0;
    if (chunk->payload_bytes != (uint64_t)header->bundle_count * IVG_DIRECTORY_ENTRY_BYTES) {
        return frame_error(IVG_DIRECTORY_ENTRIES, chunk->payload_offset);
    }
    for (uint64_t i = 0; i < header->bundle_count; i++) {
        const uint64_t at = IVG_DIRECTORY_ENTRY_BYTES * i, offset = chunk->payload_offset + at;
        const uint64_t vertices = frame_u32(chunk->payload + at), index_bytes = frame_u32(chunk->payload + at + 4);
        if (vertices < 1 || vertices > share) return frame_error(IVG_DIRECTORY_VERTICES, offset);
        if (index_bytes < vertices || index_bytes > IVG_INDEX_NUMBER_BYTES * vertices) {
            return frame_error(IVG_DIRECTORY_INDEX, offset + 4);
        }
        const uint64_t total = frame_record_bytes(index_bytes + vertices * ivg_bytes_per_vertex(header));
        if (total > FRAME_RECORD_BYTES_MAXIMUM) return frame_error(IVG_RECORD_TOO_LARGE, offset);
        if (total > limits->frame.record_bytes) return frame_error(FRAME_LIMIT_RECORD_BYTES, offset);
        sum += vertices;
        if (sum > others) return frame_error(IVG_DIRECTORY_VERTICES, offset);
        *bundles_bytes += total;
    }
    if (header->validity_records == 0 && sum != others) {
        return frame_error(IVG_DIRECTORY_VERTICES, chunk->payload_offset + chunk->payload_bytes);
    }
    return frame_ok();
}

/* IVG-LITE-02 */
static frame_result ivg_check_lights(const frame_chunk *chunk)
{
    const uint8_t *payload = chunk->payload;
    const uint64_t end = chunk->payload_bytes, offset = chunk->payload_offset;
    uint64_t at = 4;
    if (end < 4) return frame_error(IVG_LIGHT_LIST, offset + end);
    const uint32_t count = frame_u32(payload);
    for (uint32_t i = 0; i < count; i++) {
        if (end - at < 2) return frame_error(IVG_LIGHT_LIST, offset + end);
        if ((payload[at] & 0xFE) != 0 || payload[at + 1] != 0) return frame_error(FRAME_RESERVED, offset + at);
        if (end - at < 4) return frame_error(IVG_LIGHT_LIST, offset + end);
        const uint16_t name_bytes = frame_u16(payload + at + 2);
        at += 4;
        if (end - at < name_bytes) return frame_error(IVG_LIGHT_LIST, offset + end);
        if (!frame_is_utf8(payload + at, name_bytes)) return frame_error(IVG_LIGHT_LIST, offset + at);
        at += name_bytes;
    }
    if (at != end) return frame_error(IVG_LIGHT_LIST, offset + at);
    return frame_ok();
}

int ivg_next_named_light(const uint8_t *payload, uint64_t payload_bytes, uint64_t *position, ivg_named_light *light)
{
    if (*position == 0) *position = 4; /* behind the count */
    if (*position >= payload_bytes) return 0;
    light->direct = payload[*position] & 1;
    light->name_bytes = frame_u16(payload + *position + 2);
    light->name = payload + *position + 4;
    *position += 4u + light->name_bytes;
    return 1;
}

/* IVG-META-01, -02 */
static frame_result ivg_check_metadata(const frame_chunk *chunk)
{
    const uint8_t *payload = chunk->payload;
    const frame_result error = frame_error(IVG_META_LINES, chunk->payload_offset);
    uint64_t at = 0;
    if (!frame_is_utf8(payload, (size_t)chunk->payload_bytes)) return error;
    while (at < chunk->payload_bytes) {
        const uint64_t key = at;
        while (at < chunk->payload_bytes &&
               ((payload[at] >= 'a' && payload[at] <= 'z') || (payload[at] >= '0' && payload[at] <= '9') ||
                payload[at] == '-' || payload[at] == '_')) {
            at++;
        }
        if (at == key || at == chunk->payload_bytes || payload[at] != '=') return error;
        while (at < chunk->payload_bytes && payload[at] != '\n') at++;
        if (at == chunk->payload_bytes) return error;
        at++;
    }
    return frame_ok();
}

/* ---- Records (ivg.md, section 4) ---- */

/* The list of vertices of a bundle of the order explicit (IVG-EXP-02, -03). */
static frame_result ivg_check_list(const ivg_header *header, const ivg_record *record)
{
    const uint64_t offset = record->offset + 8;
    uint64_t linear_index = 0;
    uint32_t at = 0;
    for (uint32_t i = 0; i < record->vertices; i++) {
        const uint32_t first = at;
        uint64_t number;
        if (!ivg_index_number(record->payload, record->index_bytes, &at, &number)) {
            return frame_error(IVG_INDEX_NUMBER, offset + first);
        }
        linear_index = i == 0 ? number : linear_index + number + 1;
        if (linear_index >= ivg_vertex_count(header) || ivg_is_corner(header, linear_index)) {
            return frame_error(IVG_INDEX_VERTEX, offset + first);
        }
    }
    if (at != record->index_bytes) return frame_error(IVG_INDEX_LENGTH, offset + at);
    return frame_ok();
}

/* Fills in what header and directory say of a record, all but place, payload and generation. */
static void ivg_describe_record(const ivg_reader *reader, const uint8_t *file, uint32_t id, ivg_record *record)
{
    const ivg_header *header = &reader->header;
    uint64_t payload_bytes;
    memset(record, 0, sizeof *record);
    record->id = id;
    if (id >= IVG_VALIDITY_ID) {
        const uint32_t j = id - IVG_VALIDITY_ID;
        record->kind = IVG_VALIDITY;
        record->vertices = ivg_validity_vertices(header, j);
        record->first_vertex = (uint64_t)j * IVG_VALIDITY_VERTICES;
        payload_bytes = ivg_validity_bytes(record->vertices);
    } else {
        record->kind = id == IVG_CORNERS_ID ? IVG_CORNERS : IVG_BUNDLE;
        if (id == IVG_CORNERS_ID) {
            record->vertices = ivg_corner_count(header);
        } else if (header->order == IVG_EXPLICIT) {
            const uint8_t *entry = file + reader->directory_offset + IVG_DIRECTORY_ENTRY_BYTES * (uint64_t)(id - 1);
            record->vertices = frame_u32(entry);
            record->index_bytes = frame_u32(entry + 4);
        } else {
            record->vertices = (uint32_t)ivg_bundle_vertices(header, id);
        }
        payload_bytes = record->index_bytes + (uint64_t)record->vertices * ivg_bytes_per_vertex(header);
    }
    record->length = frame_record_bytes(payload_bytes);
}

/* Judges a record of which all bytes are there; place and description are filled in. */
static frame_result ivg_judge_record(const ivg_header *header, const uint8_t *bytes, ivg_record *record)
{
    uint64_t payload_bytes = ivg_validity_bytes(record->vertices);
    if (record->kind != IVG_VALIDITY) {
        payload_bytes = record->index_bytes + (uint64_t)record->vertices * ivg_bytes_per_vertex(header);
    }
    frame_result result = frame_read_record(bytes, record->offset, header->frame.content_id, record->id, payload_bytes);
    if (result.verdict != FRAME_OK) return result;
    record->generation = frame_u32(bytes + 4); /* any (COM-REC-02) */
    record->payload = bytes + 8;
    if (record->kind == IVG_VALIDITY) return ivg_check_validity(header, record);
    if (record->kind == IVG_BUNDLE && header->order == IVG_EXPLICIT) {
        result = ivg_check_list(header, record);
        if (result.verdict != FRAME_OK) return result;
    }
    return ivg_check_values(header, record->payload + record->index_bytes, record->vertices,
        record->offset + 8 + record->index_bytes);
}

int ivg_record_place(const ivg_reader *reader, const uint8_t *file, uint32_t id, uint64_t *offset, uint64_t *length)
{
    const ivg_header *header = &reader->header;
    ivg_record record;
    if (id == FRAME_END_RECORD_ID) {
        *length = FRAME_END_RECORD_BYTES;
        *offset = header->frame.file_bytes - FRAME_END_RECORD_BYTES;
        return 1;
    }
    if (id >= IVG_VALIDITY_ID ? id - IVG_VALIDITY_ID >= header->validity_records : id > header->bundle_count) return 0;
    ivg_describe_record(reader, file, id, &record);
    *length = record.length;
    *offset = header->frame.data_offset;
    if (id == IVG_CORNERS_ID) return 1;
    if (id >= IVG_VALIDITY_ID) {
        *offset += frame_record_bytes((uint64_t)ivg_corner_count(header) * ivg_bytes_per_vertex(header));
        *offset += (id - IVG_VALIDITY_ID) * frame_record_bytes(ivg_validity_bytes(IVG_VALIDITY_VERTICES));
        return 1;
    }
    *offset += ivg_bytes_before_bundles(header);
    if (header->order != IVG_EXPLICIT) {
        *offset += ivg_bundles_bytes(header, id);
        return 1;
    }
    for (uint32_t k = 1; k < id; k++) {
        ivg_describe_record(reader, file, k, &record);
        *offset += record.length;
    }
    return 1;
}

frame_result ivg_read_record(const ivg_reader *reader, const uint8_t *file, uint32_t id, const uint8_t *bytes,
    uint64_t length, ivg_record *record)
{
    uint64_t offset, total;
    frame_result result;
    if (!ivg_record_place(reader, file, id, &offset, &total)) return frame_error(FRAME_RECORD_ID, 0);
    if (length < total) return frame_need_more(offset + length);
    if (id == FRAME_END_RECORD_ID) {
        memset(record, 0, sizeof *record);
        record->id = id;
        record->offset = offset;
        record->length = total;
        result = frame_read_end(bytes, offset, &reader->header.frame);
    } else {
        ivg_describe_record(reader, file, id, record);
        record->offset = offset;
        result = ivg_judge_record(&reader->header, bytes, record);
    }
    if (result.verdict == FRAME_OK && length > total) return frame_error(FRAME_RECORD_LENGTH, offset + total);
    return result;
}

/* ---- The reader ---- */

void ivg_start(ivg_reader *reader, const ivg_limits *limits)
{
    memset(reader, 0, sizeof *reader);
    reader->limits = limits != NULL ? *limits : ivg_default_limits();
    reader->phase = IVG_IN_HEADER;
}

static ivg_event ivg_stop(ivg_reader *reader, frame_result result)
{
    ivg_event event;
    memset(&event, 0, sizeof event);
    event.kind = IVG_STOP;
    event.result = result;
    if (result.verdict != FRAME_OK && result.verdict != FRAME_NEED_MORE) {
        reader->phase = IVG_REFUSED;
        reader->error = result;
    }
    return event;
}

static ivg_event ivg_event_of_kind(ivg_event_kind kind)
{
    ivg_event event;
    memset(&event, 0, sizeof event);
    event.kind = kind;
    event.result = frame_ok();
    return event;
}

/* Judges the chunk at `position`. On FRAME_OK `event` says what it was, IVG_STOP if nothing that is known. */
static frame_result ivg_take_chunk(ivg_reader *reader, const uint8_t *bytes, uint64_t length, ivg_event *event)
{
    ivg_header *header = &reader->header;
    frame_chunk chunk;
    const int is_first_of_explicit = header->order == IVG_EXPLICIT && reader->chunks == 0;
    frame_result result =
        frame_read_chunk(bytes, length, &header->frame, &reader->limits.frame, reader->position, reader->chunks, &chunk);
    *event = ivg_event_of_kind(IVG_STOP);
    if (result.verdict != FRAME_OK) return result;

    if (is_first_of_explicit && !frame_chunk_is(bytes, &chunk, "DIRE")) {
        return frame_error(IVG_DIRECTORY_ABSENT, chunk.offset); /* IVG-DIRE-01 */
    }
    if (frame_chunk_is(bytes, &chunk, "DIRE")) {
        uint64_t bundles_bytes;
        if (header->order != IVG_EXPLICIT) return frame_error(IVG_DIRECTORY_FORBIDDEN, chunk.offset);
        if (!is_first_of_explicit) return frame_error(FRAME_CHUNK_REPEATED, chunk.offset);
        result = ivg_check_directory(header, &reader->limits, &chunk, &bundles_bytes);
        if (result.verdict == FRAME_OK) result = ivg_check_file_bytes(header, bundles_bytes);
        reader->directory_offset = chunk.payload_offset;
        event->kind = IVG_HEADER;
    } else if (frame_chunk_is(bytes, &chunk, "LITE")) {
        if (reader->has_lights) return frame_error(FRAME_CHUNK_REPEATED, chunk.offset);
        result = ivg_check_lights(&chunk);
        reader->has_lights = 1;
        event->kind = IVG_LIGHTS;
    } else if (frame_chunk_is(bytes, &chunk, "META")) {
        if (reader->has_metadata) return frame_error(FRAME_CHUNK_REPEATED, chunk.offset);
        result = ivg_check_metadata(&chunk);
        reader->has_metadata = 1;
        event->kind = IVG_METADATA;
    } else if (frame_chunk_is_critical(bytes, &chunk)) {
        return frame_error(FRAME_CHUNK_CRITICAL, chunk.offset); /* COM-CHK-06 */
    }
    event->payload = chunk.payload;
    event->payload_bytes = chunk.payload_bytes;
    reader->position += chunk.total;
    reader->chunks++;
    return result;
}

/* The id of the record that comes next: corners, validity records, bundles, end (IVG-REC-01). */
static uint32_t ivg_next_record_id(const ivg_reader *reader)
{
    uint64_t number = reader->records;
    if (number == 0) return IVG_CORNERS_ID;
    number--;
    if (number < reader->header.validity_records) return IVG_VALIDITY_ID + (uint32_t)number;
    number -= reader->header.validity_records;
    if (number < reader->header.bundle_count) return 1u + (uint32_t)number;
    return FRAME_END_RECORD_ID;
}

ivg_event ivg_next(ivg_reader *reader, const uint8_t *bytes, uint64_t length)
{
    ivg_header *header = &reader->header;
    frame_result result;

    if (reader->phase == IVG_REFUSED) return ivg_stop(reader, reader->error);

    if (reader->phase == IVG_IN_HEADER) {
        result = frame_read_header(bytes, length, "IVG", IVG_MINOR, IVG_HEADER_BYTES, &reader->limits.frame, &header->frame);
        if (result.verdict == FRAME_OK) result = ivg_read_specific_header(bytes, &reader->limits, header);
        if (result.verdict == FRAME_OK) {
            if (header->order != IVG_EXPLICIT) {
                result = ivg_check_file_bytes(header, ivg_bundles_bytes(header, header->bundle_count + UINT64_C(1)));
            } else if (header->frame.data_offset == header->frame.header_bytes) {
                result = frame_error(IVG_DIRECTORY_ABSENT, header->frame.header_bytes); /* IVG-DIRE-01 */
            }
        }
        if (result.verdict != FRAME_OK) return ivg_stop(reader, result);
        reader->position = header->frame.header_bytes;
        reader->phase = IVG_IN_CHUNKS;
        if (header->order != IVG_EXPLICIT) return ivg_event_of_kind(IVG_HEADER);
    }

    while (reader->phase == IVG_IN_CHUNKS) {
        ivg_event event;
        if (reader->position == header->frame.data_offset) {
            reader->phase = IVG_IN_RECORDS;
            break;
        }
        result = ivg_take_chunk(reader, bytes, length, &event);
        if (result.verdict != FRAME_OK) return ivg_stop(reader, result);
        if (event.kind != IVG_STOP) return event;
    }

    if (reader->phase == IVG_IN_RECORDS) {
        const uint32_t id = ivg_next_record_id(reader);
        if (id != FRAME_END_RECORD_ID) {
            ivg_event event = ivg_event_of_kind(IVG_RECORD);
            ivg_describe_record(reader, bytes, id, &event.record);
            event.record.offset = reader->position;
            if (length < reader->position || length - reader->position < event.record.length) {
                return ivg_stop(reader, frame_need_more(length));
            }
            result = ivg_judge_record(header, bytes + reader->position, &event.record);
            if (result.verdict != FRAME_OK) return ivg_stop(reader, result);
            reader->position += event.record.length;
            reader->records++;
            return event;
        }
        if (length < reader->position || length - reader->position < FRAME_END_RECORD_BYTES) {
            return ivg_stop(reader, frame_need_more(length));
        }
        result = frame_read_end(bytes + reader->position, reader->position, &header->frame);
        if (result.verdict != FRAME_OK) return ivg_stop(reader, result);
        reader->position += FRAME_END_RECORD_BYTES;
        reader->phase = IVG_AT_END;
    }

    if (length > reader->position && !reader->stream_mode) {
        return ivg_stop(reader, frame_error(FRAME_TRAILING_BYTES, reader->position)); /* COM-REC-08 */
    }
    return ivg_stop(reader, frame_ok());
}

#endif /* IVG_IMPLEMENTED */
#endif /* IVG_IMPLEMENTATION */
