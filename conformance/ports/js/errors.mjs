// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Error codes of both formats (`spec/tables/errors.toml`) and the one error that the decoders throw.
 * @module
 */

/**
 * All errors by name: number, verdict, clause, text.
 * @type {Readonly<Record<string, readonly [number, 'need-more' | 'invalid' | 'unsupported' | 'limit', string, string]>>}
 */
export const ERRORS = Object.freeze({
  TRUNCATED: [100, 'need-more', 'COM-STR-01', 'the input ends here and more bytes are needed'],
  MAGIC: [101, 'invalid', 'COM-HDR-01', "the first bytes are not this format's signature"],
  HEADER_BYTES: [102, 'invalid', 'COM-HDR-04', 'the header length is not one this version allows'],
  HEADER_CHECKSUM: [103, 'invalid', 'COM-HDR-06', "the header's checksum does not fit"],
  CHUNK_CHECKSUM: [104, 'invalid', 'COM-CHK-05', "the chunk's checksum does not fit; fetch the file again"],
  RECORD_CHECKSUM: [105, 'invalid', 'COM-REC-05', "the record's checksum does not fit; fetch the record again"],
  CHUNK_LENGTH: [106, 'invalid', 'COM-CHK-02', 'the chunk does not fit between header and data'],
  CHUNK_PADDING: [107, 'invalid', 'COM-CHK-04', "the chunk's padding is not zero"],
  CHUNK_REPEATED: [108, 'invalid', 'COM-CHK-07', 'this chunk type may appear only once'],
  CHUNK_COUNT: [109, 'invalid', 'COM-CHK-08', 'there are more chunks than the format allows'],
  CHUNK_CRITICAL: [110, 'unsupported', 'COM-CHK-06', 'a critical chunk of unknown type needs a newer reader'],
  RECORD_ID: [111, 'invalid', 'COM-REC-03', 'the record here has another id than belongs here'],
  RECORD_PADDING: [112, 'invalid', 'COM-REC-04', "the record's padding is not zero"],
  RECORD_LENGTH: [113, 'invalid', 'COM-REC-06', 'there are more bytes than this record has'],
  END_MISMATCH: [114, 'invalid', 'COM-REC-07', "the end record does not name the file's length"],
  TRAILING_BYTES: [115, 'invalid', 'COM-REC-08', 'there are bytes after the end record'],
  DATA_OFFSET: [116, 'invalid', 'COM-HDR-09', 'the data offset does not fit header and file length'],
  FILE_BYTES: [117, 'invalid', 'COM-HDR-10', 'the file length is not the one that follows from the header'],
  RESERVED: [118, 'unsupported', 'COM-VER-04', 'a reserved field is not zero: a newer reader is needed'],
  MAJOR_VERSION: [201, 'unsupported', 'COM-VER-01', 'the file has another major version'],
  REQUIRED_FEATURE: [202, 'unsupported', 'COM-VER-03', 'the file needs a feature that this reader lacks'],
  DIMENSIONS: [301, 'invalid', 'IVG-LAT-01', 'an axis of the lattice has no vertex'],
  ORIGIN: [302, 'invalid', 'IVG-LAT-02', 'a vertex of the lattice has no finite position'],
  STEP: [303, 'invalid', 'IVG-LAT-03', 'the step does not fit the number of vertices along its axis'],
  SCALE_EXPONENT: [304, 'invalid', 'IVG-HDR-04', 'the scale exponent is not in -125 to 112, or to 110 in sh2-28'],
  SLICE_VERTICES: [305, 'invalid', 'IVG-ORD-03', 'a bundle takes no vertex from a slice'],
  BUNDLE_COUNT: [306, 'invalid', 'IVG-ORD-04', 'the number of bundles is not the one that follows from the lattice'],
  VALIDITY_COUNT: [307, 'invalid', 'IVG-VAL-01', 'the number of validity records is neither 0 nor the one that follows from the lattice'],
  RECORD_TOO_LARGE: [308, 'invalid', 'IVG-HDR-06', 'a bundle would be longer than a record may be'],
  DIRECTORY_ABSENT: [309, 'invalid', 'IVG-DIRE-01', 'a file of the order explicit has its directory as its first chunk'],
  DIRECTORY_FORBIDDEN: [310, 'invalid', 'IVG-DIRE-01', 'only files of the order explicit have a directory'],
  DIRECTORY_ENTRIES: [311, 'invalid', 'IVG-DIRE-02', 'the directory does not have one entry for each bundle'],
  DIRECTORY_VERTICES: [312, 'invalid', 'IVG-DIRE-03', 'a bundle has no vertices or too many, or all bundles together have too many or too few'],
  DIRECTORY_INDEX: [313, 'invalid', 'IVG-DIRE-03', "the list of a bundle's vertices cannot be as short or as long as the directory says"],
  COUNTS: [351, 'invalid', 'PMESH-HDR-02', 'the counts of the header contradict each other'],
  MODE_FORBIDDEN: [352, 'invalid', 'PMESH-HDR-03', 'mode 0 does not exist'],
  MODE_UNKNOWN: [353, 'unsupported', 'PMESH-HDR-03', 'this mode of packets needs another reader'],
  POSITIONS_FORBIDDEN: [354, 'invalid', 'PMESH-HDR-04', 'position encoding 0 does not exist'],
  POSITIONS_UNKNOWN: [355, 'unsupported', 'PMESH-HDR-04', 'this encoding of positions needs another reader'],
  MESH_ORIGIN: [356, 'invalid', 'PMESH-HDR-06', 'the origin is not finite'],
  BOUNDS: [357, 'invalid', 'PMESH-HDR-07', 'the bounding box is not finite or inside out'],
  DIRECTORY_MISSING: [358, 'invalid', 'PMESH-DIR-01', 'the first chunk is not the packet directory'],
  DIRECTORY_LENGTH: [359, 'invalid', 'PMESH-DIR-02', 'the packet directory does not have one entry for each packet'],
  DIRECTORY_COUNTS: [360, 'invalid', 'PMESH-DIR-03', 'an entry of the packet directory contradicts the header or the entry before it'],
  DIRECTORY_BYTES: [361, 'invalid', 'PMESH-DIR-04', 'a packet is too short for its arrays or longer than a record may be'],
  DIRECTORY_ERROR: [362, 'invalid', 'PMESH-DIR-05', 'the error of a packet is negative, not finite or greater than that of the packet before'],
  MATERIAL_NAMES: [363, 'invalid', 'PMESH-MTRL-02', 'the list of material names is not well formed'],
  PARAMETERS: [364, 'invalid', 'PMESH-HDR-08', 'the bits or the box of coded attributes do not fit what the file has'],
  ENCODING_FORBIDDEN: [401, 'invalid', 'IVG-ENC-01', 'encoding 0 does not exist'],
  ENCODING_UNKNOWN: [402, 'unsupported', 'IVG-ENC-02', 'this encoding needs another reader'],
  ORDER_FORBIDDEN: [403, 'invalid', 'IVG-ORD-05', 'order 0 does not exist'],
  ORDER_UNKNOWN: [404, 'unsupported', 'IVG-ORD-06', 'this order of vertices needs another reader'],
  UNITS_UNKNOWN: [405, 'unsupported', 'IVG-HDR-05', 'these units need a newer reader'],
  DIRECTION_CODE: [406, 'invalid', 'IVG-DIR-02', 'a direction code has a forbidden value'],
  NOT_FINITE: [407, 'invalid', 'IVG-VEC-02', 'an irradiance vector is not finite'],
  UNUSED_BITS: [408, 'invalid', 'IVG-VAL-04', 'unused bits after the blocked edges are not zero'],
  EDGE_OUTSIDE: [409, 'invalid', 'IVG-VAL-05', 'a blocked edge leads out of the lattice'],
  LIGHTS: [410, 'invalid', 'IVG-LITE-02', 'the list of lights is not well formed'],
  METADATA: [411, 'invalid', 'IVG-META-02', 'the metadata are not lines of key=value in UTF-8'],
  RATIO_CODE: [412, 'invalid', 'IVG-SH-04', 'a ratio code holds the forbidden value -128'],
  PAIR_COLOUR: [413, 'invalid', 'IVG-PAIR-02', 'a colour is negative or not finite'],
  PAIR_DIRECTION: [414, 'invalid', 'IVG-PAIR-03', 'a component of a direction is not in -1 to 1'],
  INDEX_NUMBER: [420, 'invalid', 'IVG-EXP-02', 'a number in the list of vertices is not in its shortest form, is too long or has no end'],
  INDEX_VERTEX: [421, 'invalid', 'IVG-EXP-03', 'the list of vertices names a corner or a vertex outside the lattice'],
  INDEX_LENGTH: [422, 'invalid', 'IVG-EXP-03', 'the list of vertices does not fill its bytes exactly'],
  POSITION: [501, 'invalid', 'PMESH-POS-02', 'a position is not finite or outside the bounding box'],
  ATTRIBUTE: [502, 'invalid', 'PMESH-WDG-02', 'a normal or texture coordinate is not finite'],
  PARENT: [503, 'invalid', 'PMESH-COL-01', 'a vertex does not collapse onto an earlier vertex'],
  CORNER: [504, 'invalid', 'PMESH-FACE-01', 'a face names a wedge that has not arrived'],
  FACE_VERTICES: [505, 'invalid', 'PMESH-FACE-01', 'two corners of a face are the same vertex'],
  VARINT: [508, 'invalid', 'PMESH-PKT-04', 'a number of variable length is not in its shortest form or exceeds 32 bits'],
  WEDGE_COUNT: [509, 'invalid', 'PMESH-WDG-01', 'the wedges of the vertices do not add up to those of the packet'],
  WEDGE_TARGET: [510, 'invalid', 'PMESH-COL-02', 'a wedge becomes a wedge that the parent vertex does not have'],
  SWITCH: [511, 'invalid', 'PMESH-SWI-06', 'a corner switches to a wedge that does not collapse back onto it'],
  PACKET_LENGTH: [512, 'invalid', 'PMESH-SWI-06', 'the parts of a packet do not fill it exactly'],
  PACKET_PADDING: [513, 'invalid', 'PMESH-PKT-02', 'unused bits of a packet are not zero'],
  PACKET_ORDER: [514, 'invalid', 'PMESH-LVL-04', 'this packet is not the one that comes next'],
  CODED_LENGTH: [515, 'invalid', 'PMESH-COD-03', 'the symbols of a coded packet do not fill it exactly'],
  CODED_PADDING: [516, 'invalid', 'PMESH-COD-03', 'bytes after the symbols of a coded packet are not zero'],
  CODED_FACES: [517, 'invalid', 'PMESH-COD-07', 'the faces of a coded packet are more or fewer than the directory says'],
  CODED_WORK: [518, 'invalid', 'PMESH-COD-12', 'a coded packet asks for more work than its bytes allow'],
  SWITCH_SLOTS: [519, 'invalid', 'PMESH-SWI-05', 'the list of corners that switch is not one of ascending corners of earlier faces'],
  SWITCH_WORK: [520, 'invalid', 'PMESH-SWI-07', 'corners pass more vertices than the bytes of the packet allow; write smaller packets'],
  LIMIT_HEADER_BYTES: [601, 'limit', 'COM-LIM-01', 'the header is longer than the limit'],
  LIMIT_CHUNK_BYTES: [602, 'limit', 'COM-LIM-01', 'the chunk is longer than the limit'],
  LIMIT_CHUNKS: [603, 'limit', 'COM-LIM-01', 'there are more chunks than the limit'],
  LIMIT_RECORD_BYTES: [604, 'limit', 'COM-LIM-01', 'a record is longer than the limit'],
  LIMIT_VERTICES: [605, 'limit', 'IVG-LIM-01', 'the lattice has more vertices than the limit'],
  LIMIT_COUNTS: [620, 'limit', 'PMESH-LIM-02', 'the mesh has more vertices, wedges or faces than the limit'],
});

/**
 * What a decoder throws for input that is not a whole valid file (COM-VERD-01). Everything else that it throws is a
 * wrong use of the decoder.
 */
export class FormatError extends Error {
  /**
   * @param {keyof typeof ERRORS} name name of the error, such as `MAGIC`
   * @param {number} offset byte of the file at fault, from its beginning
   */
  constructor(name, offset) {
    const [code, verdict, clause, text] = ERRORS[name];
    super(`${verdict}: ${text} (${name} ${code}, ${clause}, at byte ${offset})`);
    /** Name of the error, such as `MAGIC`. */
    this.name = name;
    /** Number of the error, such as 101. */
    this.code = code;
    /** `need-more`, `invalid`, `unsupported` or `limit`. */
    this.verdict = verdict;
    /** The clause that the input breaks. */
    this.clause = clause;
    /** Byte of the file at fault. */
    this.offset = offset;
  }
}

/**
 * Throws a {@link FormatError}.
 * @param {keyof typeof ERRORS} name name of the error
 * @param {number} offset byte of the file at fault
 * @returns {never}
 */
export function refuse(name, offset) {
  throw new FormatError(name, offset);
}
