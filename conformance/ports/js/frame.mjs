// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The frame of both formats (`spec/common.md`): header, chunks, records, taken in as they arrive.
 * @module
 */

import { FormatError, refuse } from './errors.mjs';
import { crc32, viewOf } from './wire.mjs';

/** Limits of the column *default* (section 9). A decoder's `limits` replace any of them. */
const COMMON_LIMITS = { headerBytes: 4096, chunkBytes: 1048576, chunks: 1024, recordBytes: 67108864 };

/** The longest record that the format allows (section 9, column *maximum*). */
export const RECORD_BYTES_MAXIMUM = 2147483644;
const CHUNK_BYTES_MAXIMUM = 2147483640;
const HEADER_BYTES_MAXIMUM = 65536;
const CHUNKS_MAXIMUM = 65535;
const END_ID = 0xffffffff;

/**
 * The length of a record (COM-REC-01).
 * @param {number} payloadBytes bytes of its payload
 * @returns {number} bytes of the record, envelope and padding included
 */
export function recordLength(payloadBytes) {
  return Math.ceil((payloadBytes + 12) / 4) * 4;
}

/**
 * The header's fields that all formats share (section 4).
 * @typedef {object} CommonHeader
 * @property {number} major major version
 * @property {number} minor minor version
 * @property {number} optionalFeatures bits that a reader may ignore
 * @property {number} headerBytes length of the header
 * @property {bigint} contentId differs whenever anything encoded differs
 * @property {number} dataOffset where the records begin
 * @property {number} fileBytes length of the file (exact below 2^53)
 */

/**
 * A push decoder of the frame; `IvgDecoder` and `PmeshDecoder` say what is in it. For any split of the input into
 * pieces it reports the same events, and the same error at the same offset (COM-STR-03). It holds the bytes of the
 * incomplete header, chunk or record and nothing that is only declared (COM-LIM-03).
 */
export class FrameDecoder {
  #format;
  #common = null;
  #stage = 'header';
  #buffer = new Uint8Array(0);
  #held = 0;
  #base = 0;
  #want = 1;
  #chunkIndex = 0;
  #chunkTypes = new Set();
  #recordIndex = 0;
  #contentCrc = 0;
  #fileBytes = 0n;
  #error = null;
  #event = null;

  /**
   * @param {{magic: number[], minor: number, headerBytes: number, limits: object, chunkTypes: string[]}} format what
   *   the format has
   * @param {object} [limits] limits that replace defaults
   * @param {boolean} [stream] stream mode: bytes after the end record are left to the caller (COM-REC-08)
   */
  constructor(format, limits = {}, stream = false) {
    this.#format = format;
    /** The limits in force. */
    this.limits = Object.freeze({ ...COMMON_LIMITS, ...format.limits, ...limits });
    /** Whether the decoder is in stream mode. */
    this.stream = stream;
    /** The header's fields once the header is known, before that null. */
    this.header = null;
  }

  /** Bytes taken in so far. */
  get received() {
    return this.#base + this.#held;
  }

  /** Records read whole and accepted so far, without the end record. */
  get records() {
    return this.#recordIndex;
  }

  /** The error that ended reading, or null. */
  get error() {
    return this.#error;
  }

  /** What is to be said of the input so far (COM-VERD-01): `ok`, `need-more`, `invalid`, `unsupported` or `limit`. */
  get verdict() {
    if (this.#error !== null) return this.#error.verdict;
    return this.#stage === 'done' ? 'ok' : 'need-more';
  }

  /**
   * Takes in the next bytes of the file.
   * @param {Uint8Array} bytes the bytes, as many as there are; they are not kept
   * @param {(event: object) => void} [receive] is called for each event, in order; what an event refers to is there
   *   until the call returns
   * @returns {number} how many of the bytes belong to the file; all of them, but in stream mode
   * @throws {FormatError} the error of the input, again for any further input (COM-VERD-03)
   */
  push(bytes, receive = () => {}) {
    if (this.#error !== null) throw this.#error;
    let at = 0;
    while (this.#stage !== 'done') {
      let item;
      if (this.#held === 0 && bytes.length - at >= this.#want) {
        item = bytes.subarray(at, at + this.#want);
      } else {
        at += this.#keep(bytes.subarray(at));
        if (this.#held < this.#want) return at;
        item = this.#buffer.subarray(0, this.#want);
      }
      this.#event = null;
      this.#guard(() => this.#advance(item));
      if (this.#event === null) continue;
      if (this.#held === 0) at += item.length;
      this.#held = 0;
      this.#base += item.length;
      const event = this.#event;
      let refused = null;
      try {
        this.#guard(() => this.#beginNext());
      } catch (error) {
        refused = error;
      }
      if (event.kind !== undefined) receive(event);
      if (refused !== null) throw refused;
    }
    if (at < bytes.length && !this.stream) this.#guard(() => refuse('TRAILING_BYTES', this.#base));
    return at;
  }

  /**
   * Says that the input ends here.
   * @throws {FormatError} if it is not a whole valid file: TRUNCATED, whose verdict is `need-more`, or the error that
   *   ended reading
   */
  finish() {
    if (this.#error !== null) throw this.#error;
    if (this.#stage !== 'done') refuse('TRUNCATED', this.received);
  }

  /** Remembers an error, so that it is reported again. */
  #guard(action) {
    try {
      action();
    } catch (error) {
      if (error instanceof FormatError) this.#error = error;
      throw error;
    }
  }

  /** Keeps bytes of an incomplete item, as many as it wants next. Returns how many. */
  #keep(bytes) {
    const taken = Math.min(bytes.length, this.#want - this.#held);
    const held = this.#held + taken;
    if (held > this.#buffer.length) {
      const larger = new Uint8Array(Math.max(256, Math.min(this.#want, 2 * held)));
      larger.set(this.#buffer.subarray(0, this.#held));
      this.#buffer = larger;
    }
    this.#buffer.set(bytes.subarray(0, taken), this.#held);
    this.#held = held;
    return taken;
  }

  /** Judges as much of an item as is there: either wants more of it, or leaves an event (without a kind: none). */
  #advance(item) {
    if (this.#stage === 'header') this.#advanceHeader(item);
    else if (this.#stage === 'chunk') this.#advanceChunk(item);
    else this.#advanceRecord(item);
  }

  /** COM-HDR-03: each byte of the magic, the major version and the length of the header as soon as they are there. */
  #advanceHeader(item) {
    const { magic, minor: minorKnown, headerBytes: headerBytesKnown } = this.#format;
    const view = viewOf(item);
    if (item.length <= 8) {
      const last = item.length - 1;
      if (item[last] !== magic[last]) refuse('MAGIC', last);
      this.#want = item.length < 8 ? item.length + 1 : 10;
      return;
    }
    if (item.length === 10) {
      if (view.getUint16(8, true) !== 0) refuse('MAJOR_VERSION', 8);
      this.#want = 24;
      return;
    }
    const headerBytes = view.getUint32(20, true);
    if (item.length === 24) {
      const known = view.getUint16(10, true) <= minorKnown;
      const fits = known
        ? headerBytes === headerBytesKnown
        : headerBytes % 8 === 0 && headerBytes >= headerBytesKnown && headerBytes <= HEADER_BYTES_MAXIMUM;
      if (!fits) refuse('HEADER_BYTES', 20);
      if (headerBytes > this.limits.headerBytes) refuse('LIMIT_HEADER_BYTES', 20);
      this.#want = headerBytes;
      return;
    }
    if (crc32(item.subarray(32), crc32(item.subarray(0, 28))) !== view.getUint32(28, true)) {
      refuse('HEADER_CHECKSUM', 28);
    }
    if (view.getUint32(24, true) !== 0) refuse('RESERVED', 24);
    if (view.getUint32(12, true) !== 0) refuse('REQUIRED_FEATURE', 12);
    const dataOffset = view.getBigUint64(40, true);
    this.#fileBytes = view.getBigUint64(48, true);
    if (dataOffset % 8n !== 0n || dataOffset < BigInt(headerBytes) || dataOffset > this.#fileBytes) {
      refuse('DATA_OFFSET', 40);
    }
    this.#contentCrc = crc32(item.subarray(32, 40));
    this.#common = {
      major: 0,
      minor: view.getUint16(10, true),
      optionalFeatures: view.getUint32(16, true),
      headerBytes,
      contentId: view.getBigUint64(32, true),
      dataOffset: Number(dataOffset),
      fileBytes: Number(this.#fileBytes),
    };
    this.#event = this.judgeHeader(view, this.#common) ?? {};
  }

  /** COM-HDR-10: compares the length in the header with the one that follows from header and directory. */
  judgeFileBytes(expected) {
    if (this.#fileBytes !== expected) refuse('FILE_BYTES', 48);
  }

  /** Begins the item behind the one that is complete. What shows without further bytes is judged (COM-CHK-03). */
  #beginNext() {
    if (this.#stage === 'header' || this.#stage === 'chunk') {
      const left = this.#common.dataOffset - this.#base;
      this.#stage = left > 0 ? 'chunk' : 'record';
      if (left > 0) {
        if (this.#chunkIndex >= CHUNKS_MAXIMUM) refuse('CHUNK_COUNT', this.#base);
        if (this.#chunkIndex >= this.limits.chunks) refuse('LIMIT_CHUNKS', this.#base);
        if (left < 20) refuse('CHUNK_LENGTH', this.#base);
        this.#want = 16;
        return;
      }
    } else if (this.#event.kind === 'end') {
      this.#stage = 'done';
      return;
    }
    const end = this.#recordIndex === this.recordCount;
    this.#want = end ? 20 : recordLength(this.recordAt(this.#recordIndex).payloadBytes);
  }

  /** COM-CHK-03: first the length, then the whole chunk. */
  #advanceChunk(item) {
    const view = viewOf(item);
    const at = this.#base;
    const length = Number(view.getBigUint64(8, true));
    if (item.length === 16) {
      const total = Math.ceil((length + 20) / 8) * 8;
      if (total > CHUNK_BYTES_MAXIMUM || total > this.#common.dataOffset - at) refuse('CHUNK_LENGTH', at + 8);
      if (total > this.limits.chunkBytes) refuse('LIMIT_CHUNK_BYTES', at + 8);
      this.#want = total;
      return;
    }
    const crcAt = item.length - 4;
    if (crc32(item.subarray(0, crcAt), this.#contentCrc) !== view.getUint32(crcAt, true)) {
      refuse('CHUNK_CHECKSUM', at + crcAt);
    }
    const flags = item[4];
    if (flags > 1 || item[5] !== 0 || item[6] !== 0 || item[7] !== 0) refuse('RESERVED', at + 4);
    this.#judgePadding(item, 16 + length, 'CHUNK_PADDING');
    const type = String.fromCharCode(...item.subarray(0, 4));
    this.judgeChunkType(type, this.#chunkIndex, at);
    this.#event = {};
    if (this.#format.chunkTypes.includes(type)) {
      if (this.#chunkTypes.has(type)) refuse('CHUNK_REPEATED', at);
      this.#chunkTypes.add(type);
      this.#event = this.takeChunk(type, item.subarray(16, 16 + length), at + 16) ?? {};
    } else if (flags === 1) refuse('CHUNK_CRITICAL', at);
    this.#chunkIndex += 1;
  }

  #judgePadding(item, from, name, base = this.#base) {
    for (let at = from; at < item.length - 4; at += 1) if (item[at] !== 0) refuse(name, base + from);
  }

  #advanceRecord(item) {
    const at = this.#base;
    if (this.#recordIndex === this.recordCount) {
      const { generation, payload } = this.#judgeRecord(item, END_ID, 8, at);
      if (generation !== 0) refuse('END_MISMATCH', at + 4);
      if (viewOf(payload).getBigUint64(0, true) !== this.#fileBytes) refuse('END_MISMATCH', at + 8);
      this.#event = { kind: 'end' };
    } else {
      const { id, payloadBytes } = this.recordAt(this.#recordIndex);
      const { generation, payload } = this.#judgeRecord(item, id, payloadBytes, at);
      this.#event = this.takeRecord(id, generation, payload, at + 8);
      this.#recordIndex += 1;
    }
  }

  /** COM-REC-05: the checksum, then id and padding. */
  #judgeRecord(item, id, payloadBytes, at) {
    const view = viewOf(item);
    const crcAt = item.length - 4;
    if (crc32(item.subarray(0, crcAt), this.#contentCrc) !== view.getUint32(crcAt, true)) {
      refuse('RECORD_CHECKSUM', at + crcAt);
    }
    if (view.getUint32(0, true) !== id) refuse('RECORD_ID', at);
    this.#judgePadding(item, 8 + payloadBytes, 'RECORD_PADDING', at);
    return { generation: view.getUint32(4, true), payload: item.subarray(8, 8 + payloadBytes) };
  }

  /**
   * Judges a record that was fetched alone exactly as inside its file (COM-REC-06). An error does not end the decoder:
   * the record can be fetched again.
   * @param {number} id which record it has to be
   * @param {number} offset where it lies in the file
   * @param {number} payloadBytes bytes of its payload
   * @param {Uint8Array} bytes the record, and nothing else
   * @returns {object} its event
   * @throws {FormatError} the error of the record; TRUNCATED if bytes are missing
   */
  readAlone(id, offset, payloadBytes, bytes) {
    const total = recordLength(payloadBytes);
    if (bytes.length < total) refuse('TRUNCATED', offset + bytes.length);
    const { generation, payload } = this.#judgeRecord(bytes.subarray(0, total), id, payloadBytes, offset);
    const event = this.takeRecord(id, generation, payload, offset + 8);
    if (bytes.length > total) refuse('RECORD_LENGTH', offset + total);
    return event;
  }
}
