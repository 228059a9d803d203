// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * A push decoder of .pmesh, progressive meshes (`spec/pmesh.md`).
 * @module
 */

import { refuse } from './errors.mjs';
import { FrameDecoder, RECORD_BYTES_MAXIMUM, recordLength } from './frame.mjs';
import { CodedPackets } from './pmesh-coded.mjs';
import { Lattice } from './pmesh-lattice.mjs';
import { Mesh } from './pmesh-mesh.mjs';
import { RawPackets } from './pmesh-raw.mjs';
import { bitLength, isUtf8, textOf, viewOf } from './wire.mjs';

export { FormatError, ERRORS } from './errors.mjs';

const COUNT_MAXIMUM = 2 ** 30;
const MODES = { 1: 'raw', 2: 'coded' };
const POSITIONS_F32 = 1;
const POSITIONS_LAST = 8;
const ENTRY_BYTES = 20;

const FORMAT = {
  magic: [0x89, 0x50, 0x4d, 0x53, 0x0d, 0x0a, 0x1a, 0x0a],
  minor: 2,
  headerBytes: 152,
  limits: { counts: 134217728 },
  chunkTypes: ['PDIR', 'MTRL'],
};

/**
 * The header of a mesh (section 2).
 * @typedef {import('./frame.mjs').CommonHeader & {
 *   vertexCount: number, wedgeCount: number, faceCount: number, baseVertices: number, packetCount: number,
 *   mode: 'raw' | 'coded', positions: number, attributeBits: number,
 *   attributes: {normals: boolean, uvs: boolean, colours: boolean, materials: boolean, seams: boolean},
 *   origin: number[], boundsMin: number[], boundsMax: number[], normalBits: number, uvBits: number, uvMin: number[],
 *   uvMax: number[] }} PmeshHeader
 * `positions` is the registry value: 1 binary32, 2 to 8 quantised to 10 to 16 bits. Lengths are in metres.
 */

/**
 * An entry of the packet directory (PMESH-DIR-02).
 * @typedef {{endVertex: number, endWedge: number, endFace: number, payloadBytes: number, error: number}} PacketEntry
 * Vertices, wedges and faces of this and all earlier packets, bytes of the payload, estimated error in metres.
 */

/**
 * A push decoder of .pmesh files. Its events, in order:
 *
 * - `{kind: 'header', header}`, when the packet directory is there too (PMESH-DIR-01);
 * - `{kind: 'materials', names()}`, the chunk `MTRL`;
 * - `{kind: 'packet', packet, level}`: a packet has been taken into `mesh`, which has all levels up to `level` now;
 * - `{kind: 'end'}`.
 */
export class PmeshDecoder extends FrameDecoder {
  #specific = null;
  #directory = null;
  #packets = null;
  #failed = null;

  /**
   * @param {{headerBytes?: number, chunkBytes?: number, chunks?: number, recordBytes?: number, counts?: number}}
   *   [limits] limits that replace the defaults of the specification (COM-LIM-01, PMESH-LIM-02)
   * @param {{stream?: boolean}} [options] `stream`: bytes after the end record are left to the caller (COM-REC-08)
   */
  constructor(limits = {}, { stream = false } = {}) {
    super(FORMAT, limits, stream);
    /** The mesh, once the header is known; before that null. @type {Mesh | null} */
    this.mesh = null;
  }

  /** Packets of the file; once the header is known. */
  get recordCount() {
    return this.#specific.packetCount;
  }

  /** Judges the specific header (PMESH-HDR-01). */
  judgeHeader(view, common) {
    const attributeBits = view.getUint16(78, true);
    if (attributeBits > 31) refuse('RESERVED', 78);
    const [normals, uvs, colours, materials, seams] = [1, 2, 4, 8, 16].map((bit) => (attributeBits & bit) !== 0);
    const [vertexCount, wedgeCount, faceCount, baseVertices, packetCount] = [56, 60, 64, 68, 72].map((at) =>
      view.getUint32(at, true),
    );
    const empty = vertexCount === 0;
    const wedgesFit = seams
      ? wedgeCount >= vertexCount && wedgeCount <= (empty ? 0 : COUNT_MAXIMUM) && (normals || uvs || colours)
      : wedgeCount === vertexCount;
    if (vertexCount > COUNT_MAXIMUM) refuse('COUNTS', 56);
    if (!wedgesFit) refuse('COUNTS', 60);
    if (faceCount > COUNT_MAXIMUM || (empty && faceCount > 0)) refuse('COUNTS', 64);
    if (baseVertices > vertexCount || (!empty && baseVertices < 1)) refuse('COUNTS', 68);
    const packetsMost = empty ? 0 : vertexCount - baseVertices + 1;
    if (packetCount > packetsMost || (!empty && packetCount < 1)) refuse('COUNTS', 72);
    const mode = view.getUint8(76);
    if (mode === 0) refuse('MODE_FORBIDDEN', 76);
    if (!(mode in MODES)) refuse('MODE_UNKNOWN', 76);
    const positions = view.getUint8(77);
    if (positions === 0) refuse('POSITIONS_FORBIDDEN', 77);
    if (positions > POSITIONS_LAST) refuse('POSITIONS_UNKNOWN', 77);
    const origin = [0, 1, 2].map((axis) => view.getFloat64(80 + 8 * axis, true));
    if (!origin.every(Number.isFinite)) refuse('MESH_ORIGIN', 80);
    const floats = (at, count) => Array.from({ length: count }, (_, axis) => view.getFloat32(at + 4 * axis, true));
    const [boundsMin, boundsMax] = [floats(104, 3), floats(116, 3)];
    judgeBox(boundsMin, boundsMax, 104, 116, 'BOUNDS');
    if (view.getUint16(130, true) !== 0) refuse('RESERVED', 130);
    if (view.getUint32(148, true) !== 0) refuse('RESERVED', 148);
    const normalBits = view.getUint8(128);
    const uvBits = view.getUint8(129);
    const [uvMin, uvMax] = [floats(132, 2), floats(140, 2)];
    const coded = mode === 2;
    const bitsFit = (bits, apply) => (apply ? bits >= 4 && bits <= 16 : bits === 0);
    if (!bitsFit(normalBits, coded && normals)) refuse('PARAMETERS', 128);
    if (!bitsFit(uvBits, coded && uvs)) refuse('PARAMETERS', 129);
    if (coded && uvs) judgeBox(uvMin, uvMax, 132, 140, 'PARAMETERS');
    else {
      if (uvMin.some((number) => number !== 0)) refuse('PARAMETERS', 132);
      if (uvMax.some((number) => number !== 0)) refuse('PARAMETERS', 140);
    }
    if (Math.max(vertexCount, wedgeCount, faceCount) > this.limits.counts) refuse('LIMIT_COUNTS', 56);
    if (common.dataOffset === common.headerBytes) refuse('DIRECTORY_MISSING', common.headerBytes);
    this.#specific = {
      ...common,
      vertexCount,
      wedgeCount,
      faceCount,
      baseVertices,
      packetCount,
      mode: MODES[mode],
      positions,
      attributeBits,
      attributes: Object.freeze({ normals, uvs, colours, materials, seams }),
      origin,
      boundsMin,
      boundsMax,
      normalBits,
      uvBits,
      uvMin,
      uvMax,
    };
  }

  /** PMESH-DIR-01. */
  judgeChunkType(type, index, offset) {
    if (index === 0 && type !== 'PDIR') refuse('DIRECTORY_MISSING', offset);
  }

  /** Judges and takes in a chunk of a known type. */
  takeChunk(type, payload, offset) {
    if (type === 'MTRL') {
      judgeNames(payload, offset);
      return { kind: 'materials', names: () => namesOf(payload) };
    }
    const header = Object.freeze(this.#specific);
    const total = this.#judgeDirectory(payload, offset);
    this.judgeFileBytes(BigInt(header.dataOffset) + total + 20n);
    this.#directory = viewOf(payload.slice());
    this.header = header;
    const lattice = header.positions === POSITIONS_F32 ? null : latticeOf(header);
    this.mesh = new Mesh(header);
    this.#packets = header.mode === 'raw'
      ? new RawPackets(header, this.mesh, lattice)
      : new CodedPackets(header, lattice);
    return { kind: 'header', header };
  }

  /** PMESH-DIR-02 to -05, entry by entry. Returns the bytes of all packets. */
  #judgeDirectory(payload, offset) {
    const header = this.#specific;
    if (payload.length !== header.packetCount * ENTRY_BYTES) refuse('DIRECTORY_LENGTH', offset);
    const view = viewOf(payload);
    let before = { endVertex: 0, endWedge: 0, endFace: 0, error: Infinity };
    let total = 0n;
    let sum = 0;
    for (let packet = 0; packet < header.packetCount; packet += 1) {
      const at = offset + packet * ENTRY_BYTES;
      const entry = entryOf(view, packet);
      const vertices = entry.endVertex - before.endVertex;
      const wedges = entry.endWedge - before.endWedge;
      if (vertices < 1 || entry.endVertex < header.baseVertices || entry.endVertex > header.vertexCount) {
        refuse('DIRECTORY_COUNTS', at);
      }
      const wedgesFit = header.attributes.seams ? wedges >= vertices : wedges === vertices;
      if (!wedgesFit || entry.endWedge > header.wedgeCount) refuse('DIRECTORY_COUNTS', at + 4);
      if (entry.endFace < before.endFace || entry.endFace > header.faceCount) refuse('DIRECTORY_COUNTS', at + 8);
      const length = recordLength(entry.payloadBytes);
      if (entry.payloadBytes < leastPayload(header, before, entry)) refuse('DIRECTORY_BYTES', at + 12);
      if (length > RECORD_BYTES_MAXIMUM) refuse('DIRECTORY_BYTES', at + 12);
      if (length > this.limits.recordBytes) refuse('LIMIT_RECORD_BYTES', at + 12);
      if (!(entry.error >= 0 && entry.error <= before.error && entry.error < Infinity)) {
        refuse('DIRECTORY_ERROR', at + 16);
      }
      before = entry;
      sum += length;
      if (sum > 2 ** 52) {
        total += BigInt(sum);
        sum = 0;
      }
    }
    if (header.packetCount > 0) {
      const at = offset + (header.packetCount - 1) * ENTRY_BYTES;
      if (before.endVertex !== header.vertexCount) refuse('DIRECTORY_COUNTS', at);
      if (before.endWedge !== header.wedgeCount) refuse('DIRECTORY_COUNTS', at + 4);
      if (before.endFace !== header.faceCount) refuse('DIRECTORY_COUNTS', at + 8);
    }
    return total + BigInt(sum);
  }

  /**
   * An entry of the packet directory; once the header is known.
   * @param {number} packet number of a packet
   * @returns {PacketEntry} the entry
   */
  packet(packet) {
    return entryOf(this.#directory, packet);
  }

  /** A record by its place in the file: its id, and the length of its payload. */
  recordAt(packet) {
    return { id: packet, payloadBytes: this.packet(packet).payloadBytes };
  }

  /** Judges a packet and takes it in. */
  takeRecord(id, generation, payload, offset) {
    if (generation !== 0) refuse('RESERVED', offset - 4);
    if (this.#failed !== null) throw this.#failed;
    const before = id === 0 ? { endVertex: 0, endWedge: 0, endFace: 0 } : this.packet(id - 1);
    const entry = this.packet(id);
    try {
      this.mesh.append(this.#packets.read(id, before, entry, payload, offset));
    } catch (error) {
      this.#failed = error;
      throw error;
    }
    return { kind: 'packet', packet: id, level: entry.endVertex };
  }

  /**
   * Where a packet lies, to fetch it by a range; once the header is known.
   * @param {number} packet number of a packet
   * @returns {{offset: number, bytes: number}} its first byte and its length
   */
  rangeOf(packet) {
    let offset = this.header.dataOffset;
    for (let before = 0; before < packet; before += 1) offset += recordLength(this.packet(before).payloadBytes);
    return { offset, bytes: recordLength(this.packet(packet).payloadBytes) };
  }

  /**
   * Reads a packet that was fetched alone (COM-REC-06), instead of pushing what lies behind `header.dataOffset`. Packets
   * are read in order (PMESH-LVL-04).
   * @param {number} packet number of the packet
   * @param {Uint8Array} bytes the record
   * @returns {{kind: 'packet', packet: number, level: number}} its event
   * @throws {FormatError} as inside the file; PACKET_ORDER if it is not the next; TRUNCATED or RECORD_LENGTH if the bytes
   *   are not those of one record. A packet whose payload is refused ends the mesh; levels before it stay.
   */
  readRecord(packet, bytes) {
    const { offset } = this.rangeOf(packet);
    if (packet !== this.mesh.packets) refuse('PACKET_ORDER', offset);
    return this.readAlone(packet, offset, this.packet(packet).payloadBytes, bytes);
  }
}

/** All numbers finite, none of the first greater than that of the second (PMESH-HDR-07, -08). */
function judgeBox(least, greatest, leastAt, greatestAt, name) {
  if (!least.every(Number.isFinite)) refuse(name, leastAt);
  if (!greatest.every(Number.isFinite)) refuse(name, greatestAt);
  if (least.some((number, axis) => number > greatest[axis])) refuse(name, greatestAt);
}

function latticeOf(header) {
  return new Lattice(header.boundsMin, header.boundsMax, header.positions + 8);
}

function entryOf(view, packet) {
  const at = packet * ENTRY_BYTES;
  return {
    endVertex: view.getUint32(at, true),
    endWedge: view.getUint32(at + 4, true),
    endFace: view.getUint32(at + 8, true),
    payloadBytes: view.getUint32(at + 12, true),
    error: view.getFloat32(at + 16, true),
  };
}

/** The fewest bytes that the payload of a packet may have: PMESH-DIR-04 in mode raw, PMESH-COD-12 in mode coded. */
function leastPayload(header, before, entry) {
  const vertices = entry.endVertex - before.endVertex;
  const wedges = entry.endWedge - before.endWedge;
  const faces = entry.endFace - before.endFace;
  if (header.mode === 'coded') return 8 + Math.floor((wedges + faces) / 4) + Math.floor(before.endVertex / 64);
  const { normals, uvs, colours, materials } = header.attributes;
  const wedgeBytes = (normals ? 12 : 0) + (uvs ? 8 : 0) + (colours ? 4 : 0);
  const splits = entry.endVertex - Math.max(before.endVertex, header.baseVertices);
  const parentBits = bitLength(entry.endVertex - 1);
  return 4 + (header.positions === POSITIONS_F32 ? 12 : 8) * vertices + wedgeBytes * wedges
    + (materials ? 14 : 12) * faces + Math.ceil((splits * parentBits) / 8);
}

/** PMESH-MTRL-02. */
function judgeNames(payload, offset) {
  for (let at = 0; at < payload.length; ) {
    if (at + 2 > payload.length) refuse('MATERIAL_NAMES', offset + payload.length);
    const end = at + 2 + viewOf(payload).getUint16(at, true);
    if (end > payload.length) refuse('MATERIAL_NAMES', offset + payload.length);
    if (!isUtf8(payload.subarray(at + 2, end))) refuse('MATERIAL_NAMES', offset + at + 2);
    at = end;
  }
}

/** The names of a judged payload, in order: text, which is untrusted, and its bytes. */
function namesOf(payload) {
  const names = [];
  for (let at = 0; at < payload.length; ) {
    const end = at + 2 + viewOf(payload).getUint16(at, true);
    const bytes = payload.slice(at + 2, end);
    names.push({ name: textOf(bytes), bytes });
    at = end;
  }
  return names;
}
