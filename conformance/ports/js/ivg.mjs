// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * A push decoder of .ivg, irradiance vector grids (`spec/ivg.md`).
 * @module
 */

import { refuse } from './errors.mjs';
import { FrameDecoder, RECORD_BYTES_MAXIMUM, recordLength } from './frame.mjs';
import { judgeLights, judgeMetadata, lightsOf, metadataOf } from './ivg-chunks.mjs';
import { corners, OctreeOrder, SlicesOrder } from './ivg-order.mjs';
import { BLOCK, FIRST_VALIDITY_ID, judgeList, ValidityEvent, VerticesEvent } from './ivg-records.mjs';
import { ENCODINGS, judgeValues } from './ivg-values.mjs';
import { viewOf } from './wire.mjs';

export { FormatError, ERRORS } from './errors.mjs';

const ORDERS = { 1: 'slices', 2: 'octree', 3: 'explicit' };
const UNITS = { 0: 'radiometric', 1: 'photometric' };
const ID_COUNT = 0x80000000;

const FORMAT = {
  magic: [0x89, 0x49, 0x56, 0x47, 0x0d, 0x0a, 0x1a, 0x0a],
  minor: 1,
  headerBytes: 144,
  limits: { vertices: 134217728 },
  chunkTypes: ['DIRE', 'LITE', 'META'],
};

/**
 * The header of a grid (section 3), with what follows from it.
 * @typedef {import('./frame.mjs').CommonHeader & {
 *   dims: number[], encoding: number, origin: number[], step: number[], order: string, scaleExponent: number,
 *   verticesPerSlice: number, seed: bigint, bundleCount: number, validityRecords: number, units: string,
 *   unitsId: number, vertices: number, corners: number, quantity: 'vectors' | 'harmonics', numbers: number }} IvgHeader
 * `origin` and `step` are in metres; `vertices` counts all of the lattice, `numbers` those of a vertex (54 or 27).
 */

/**
 * A push decoder of .ivg files. Its events, in order:
 *
 * - `{kind: 'header', header}`, for the order `explicit` when the directory is there too;
 * - `{kind: 'lights', lights()}` and `{kind: 'metadata', bytes, pairs()}`, the chunks `LITE` and `META`;
 * - {@link VerticesEvent} and {@link ValidityEvent}, the records;
 * - `{kind: 'end'}`.
 */
export class IvgDecoder extends FrameDecoder {
  #specific = null;
  #order = null;
  #directory = null;
  #vertexBytes = 0;

  /**
   * @param {{headerBytes?: number, chunkBytes?: number, chunks?: number, recordBytes?: number, vertices?: number}}
   *   [limits] limits that replace the defaults of the specification (COM-LIM-01, IVG-LIM-01)
   * @param {{stream?: boolean}} [options] `stream`: bytes after the end record are left to the caller (COM-REC-08)
   */
  constructor(limits = {}, { stream = false } = {}) {
    super(FORMAT, limits, stream);
  }

  /** Records of the file without the end record; once the header is known. */
  get recordCount() {
    return 1 + this.#specific.validityRecords + this.#specific.bundleCount;
  }

  /** Judges the specific header (IVG-HDR-01). */
  judgeHeader(view, common) {
    const dims = [0, 1, 2].map((axis) => view.getUint16(56 + 2 * axis, true));
    const origin = [0, 1, 2].map((axis) => view.getFloat64(64 + 8 * axis, true));
    const step = [0, 1, 2].map((axis) => view.getFloat64(88 + 8 * axis, true));
    for (let axis = 0; axis < 3; axis += 1) {
      if (dims[axis] === 0) refuse('DIMENSIONS', 56 + 2 * axis);
      const last = origin[axis] + (dims[axis] - 1) * step[axis];
      if (![origin[axis], step[axis], last].every(Number.isFinite)) refuse('ORIGIN', 64 + 8 * axis);
      if (dims[axis] > 1 ? step[axis] <= 0 : step[axis] !== 0) refuse('STEP', 88 + 8 * axis);
    }
    const encoding = view.getUint16(62, true);
    if (encoding === 0) refuse('ENCODING_FORBIDDEN', 62);
    if (!(encoding in ENCODINGS)) refuse('ENCODING_UNKNOWN', 62);
    const order = view.getUint16(112, true);
    if (order === 0) refuse('ORDER_FORBIDDEN', 112);
    if (!(order in ORDERS)) refuse('ORDER_UNKNOWN', 112);
    const scaleExponent = view.getInt16(114, true);
    const harmonics = encoding === 7;
    if (scaleExponent < -125 || scaleExponent > (harmonics ? 110 : 112)) refuse('SCALE_EXPONENT', 114);
    const units = view.getUint8(136);
    if (!(units in UNITS)) refuse('UNITS_UNKNOWN', 136);
    const share = view.getUint32(116, true);
    if (share === 0) refuse('SLICE_VERTICES', 116);
    const seed = view.getBigUint64(120, true);
    const bundleCount = view.getUint32(128, true);
    const vertices = dims[0] * dims[1] * dims[2];
    const cornerCount = corners(dims).length;
    const explicit = order === 3;
    if (explicit) {
      if (bundleCount > vertices - cornerCount || bundleCount >= ID_COUNT) refuse('BUNDLE_COUNT', 128);
    } else {
      this.#order = order === 1 ? new SlicesOrder(dims, share, seed) : new OctreeOrder(dims, share, seed);
      if (bundleCount !== this.#order.bundleCount || bundleCount >= ID_COUNT) refuse('BUNDLE_COUNT', 128);
    }
    const validityRecords = view.getUint32(132, true);
    const blocks = Math.ceil(vertices / BLOCK);
    if (validityRecords !== 0 && (validityRecords !== blocks || validityRecords >= ID_COUNT)) {
      refuse('VALIDITY_COUNT', 132);
    }
    this.#vertexBytes = ENCODINGS[encoding].bytes;
    this.#specific = {
      ...common,
      dims,
      encoding,
      origin,
      step,
      order: ORDERS[order],
      scaleExponent,
      verticesPerSlice: share,
      seed,
      bundleCount,
      validityRecords,
      units: UNITS[units],
      unitsId: units,
      vertices,
      corners: cornerCount,
      quantity: harmonics ? 'harmonics' : 'vectors',
      numbers: ENCODINGS[encoding].numbers,
    };
    const payloads = [cornerCount * this.#vertexBytes];
    if (validityRecords > 0) payloads.push(this.#validityBytes(0));
    if (!explicit && bundleCount > 0) payloads.push(this.#order.vertexCount(1) * this.#vertexBytes);
    const longest = Math.max(...payloads.map(recordLength));
    if (longest > RECORD_BYTES_MAXIMUM) refuse('RECORD_TOO_LARGE', 116);
    if (vertices > this.limits.vertices) refuse('LIMIT_VERTICES', 56);
    if (longest > this.limits.recordBytes) refuse('LIMIT_RECORD_BYTES', 116);
    for (let at = 137; at < 144; at += 1) if (view.getUint8(at) !== 0) refuse('RESERVED', 137);
    if (explicit) {
      if (common.dataOffset === common.headerBytes) refuse('DIRECTORY_ABSENT', common.headerBytes);
      return undefined;
    }
    return this.#headerEvent();
  }

  #headerEvent() {
    this.judgeFileBytes(this.#offsetOf(this.recordCount) + 20n);
    this.header = Object.freeze(this.#specific);
    return { kind: 'header', header: this.header };
  }

  /** IVG-DIRE-01: the directory is the first chunk of the order `explicit`, and of no other. */
  judgeChunkType(type, index, offset) {
    const explicit = this.#specific.order === 'explicit';
    if (explicit && index === 0 && type !== 'DIRE') refuse('DIRECTORY_ABSENT', offset);
    if (!explicit && type === 'DIRE') refuse('DIRECTORY_FORBIDDEN', offset);
  }

  /** Judges and takes in a chunk of a known type. */
  takeChunk(type, payload, offset) {
    if (type === 'LITE') {
      judgeLights(payload, offset);
      return { kind: 'lights', lights: () => lightsOf(payload) };
    }
    if (type === 'META') {
      judgeMetadata(payload, offset);
      return { kind: 'metadata', bytes: payload, pairs: () => metadataOf(payload) };
    }
    this.#takeDirectory(payload, offset);
    return this.#headerEvent();
  }

  /** IVG-DIRE-02, -03. The directory is kept as it came, and where each bundle begins behind the first. */
  #takeDirectory(payload, offset) {
    const { bundleCount, dims, vertices, corners: cornerCount, verticesPerSlice, validityRecords } = this.#specific;
    if (payload.length !== bundleCount * 8) refuse('DIRECTORY_ENTRIES', offset);
    const most = verticesPerSlice * Math.max(...dims);
    const directory = viewOf(payload.slice());
    const begins = new Float64Array(bundleCount + 1);
    let sum = 0;
    for (let entry = 0; entry < bundleCount; entry += 1) {
      const at = offset + entry * 8;
      const count = directory.getUint32(entry * 8, true);
      const indexBytes = directory.getUint32(entry * 8 + 4, true);
      if (count < 1 || count > most) refuse('DIRECTORY_VERTICES', at);
      if (indexBytes < count || indexBytes > 7 * count) refuse('DIRECTORY_INDEX', at + 4);
      const length = recordLength(indexBytes + count * this.#vertexBytes);
      if (length > RECORD_BYTES_MAXIMUM) refuse('RECORD_TOO_LARGE', at);
      if (length > this.limits.recordBytes) refuse('LIMIT_RECORD_BYTES', at);
      sum += count;
      if (sum > vertices - cornerCount) refuse('DIRECTORY_VERTICES', at);
      begins[entry + 1] = begins[entry] + length;
    }
    if (validityRecords === 0 && sum !== vertices - cornerCount) refuse('DIRECTORY_VERTICES', offset + payload.length);
    this.#directory = { view: directory, begins };
  }

  #validityBytes(block) {
    const count = Math.min(BLOCK, this.#specific.vertices - block * BLOCK);
    return count + Math.ceil((3 * count) / 8);
  }

  /** Vertices and bytes of the list of vertices of bundle k. */
  #bundle(bundle) {
    if (this.#directory === null) return { count: this.#order.vertexCount(bundle), indexBytes: 0 };
    const { view } = this.#directory;
    return {
      count: view.getUint32((bundle - 1) * 8, true),
      indexBytes: view.getUint32((bundle - 1) * 8 + 4, true),
    };
  }

  /**
   * A record by its place in the file (IVG-REC-01).
   * @param {number} place from 0: corners, validity records, bundles
   * @returns {{id: number, payloadBytes: number}} its id, and the length of its payload
   */
  recordAt(place) {
    const { validityRecords, corners: cornerCount } = this.#specific;
    if (place === 0) return { id: 0, payloadBytes: cornerCount * this.#vertexBytes };
    if (place <= validityRecords) {
      return { id: FIRST_VALIDITY_ID + place - 1, payloadBytes: this.#validityBytes(place - 1) };
    }
    const bundle = place - validityRecords;
    const { count, indexBytes } = this.#bundle(bundle);
    return { id: bundle, payloadBytes: indexBytes + count * this.#vertexBytes };
  }

  /** IVG-REC-03: where a record begins; in 64 bits, as a header may announce 2^56 bytes. */
  #offsetOf(place) {
    const { dataOffset, validityRecords } = this.#specific;
    let at = BigInt(dataOffset);
    if (place === 0) return at;
    at += BigInt(recordLength(this.recordAt(0).payloadBytes));
    const blocks = Math.min(place - 1, validityRecords);
    if (blocks > 0) {
      at += BigInt(blocks - 1) * BigInt(recordLength(this.#validityBytes(0)));
      at += BigInt(recordLength(this.#validityBytes(blocks - 1)));
    }
    const bundles = place - 1 - validityRecords;
    if (bundles <= 0) return at;
    if (this.#directory !== null) return at + BigInt(this.#directory.begins[bundles]);
    const equal = Math.min(bundles, this.#order.equalBundles);
    const length = (bundle) => BigInt(recordLength(this.#order.vertexCount(bundle) * this.#vertexBytes));
    if (equal > 0) at += BigInt(equal) * length(1);
    for (let bundle = equal + 1; bundle <= bundles; bundle += 1) at += length(bundle);
    return at;
  }

  /**
   * Where a record lies, to fetch it by a range; once the header is known.
   * @param {number} place from 0: corners, validity records, bundles, and the end record last (IVG-REC-01)
   * @returns {{offset: number, bytes: number}} its first byte and its length
   */
  rangeOf(place) {
    const end = place === this.recordCount;
    return {
      offset: Number(this.#offsetOf(place)),
      bytes: end ? 20 : recordLength(this.recordAt(place).payloadBytes),
    };
  }

  /**
   * Reads a record that was fetched alone, in any order and as often as there are newer ones (COM-REC-06, section 11).
   * @param {number} place which record, as for {@link IvgDecoder#rangeOf}; not the end record
   * @param {Uint8Array} bytes the record
   * @returns {VerticesEvent | ValidityEvent} its event
   * @throws {FormatError} as inside the file; TRUNCATED or RECORD_LENGTH if the bytes are not those of one record
   */
  readRecord(place, bytes) {
    const { id, payloadBytes } = this.recordAt(place);
    return this.readAlone(id, Number(this.#offsetOf(place)), payloadBytes, bytes);
  }

  /** Judges the payload of a record. */
  takeRecord(id, generation, payload, offset) {
    if (id >= FIRST_VALIDITY_ID) {
      const event = new ValidityEvent(this.#specific, id, generation, payload);
      event.judge(offset);
      return event;
    }
    const { encoding, scaleExponent } = this.#specific;
    const { count, indexBytes } = id === 0 ? { count: this.#specific.corners, indexBytes: 0 } : this.#bundle(id);
    const list = payload.subarray(0, indexBytes);
    if (indexBytes > 0) judgeList(this.#specific, list, count, offset);
    judgeValues(encoding, scaleExponent, payload.subarray(indexBytes), count, offset + indexBytes);
    const order = indexBytes > 0 ? list : this.#order;
    return new VerticesEvent(this.#specific, id, generation, count, order, payload.subarray(indexBytes));
  }
}
