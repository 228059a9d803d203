// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The records of .ivg as events (`spec/ivg.md`, sections 4, 5.3 and 7).
 * @module
 */

import { refuse } from './errors.mjs';
import { corners, isCorner } from './ivg-order.mjs';
import { decodeValues } from './ivg-values.mjs';

/** Vertices of a validity record (IVG-VAL-02). */
export const BLOCK = 4096;

/** Id of the first validity record (IVG-REC-01). */
export const FIRST_VALIDITY_ID = 0x80000000;

/**
 * Judges the list of a bundle's vertices (IVG-EXP-01 to -03).
 * @param {{dims: number[], vertices: number}} header the grid's header
 * @param {Uint8Array} list the index bytes
 * @param {number} count vertices of the bundle
 * @param {number} offset where the list lies in the file
 * @param {Float64Array} [into] receives the linear indices
 * @throws {FormatError} INDEX_NUMBER, INDEX_VERTEX, INDEX_LENGTH
 */
export function judgeList(header, list, count, offset, into) {
  let at = 0;
  let vertex = -1;
  for (let number = 0; number < count; number += 1) {
    const first = at;
    let value = 0;
    let factor = 1;
    let byte;
    do {
      if (at >= list.length || at - first >= 7) refuse('INDEX_NUMBER', offset + first);
      byte = list[at];
      value += (byte & 0x7f) * factor;
      factor *= 128;
      at += 1;
    } while (byte >= 0x80);
    if (byte === 0 && at - first > 1) refuse('INDEX_NUMBER', offset + first);
    vertex += 1 + value;
    if (vertex >= header.vertices || isCorner(header.dims, vertex)) refuse('INDEX_VERTEX', offset + first);
    if (into !== undefined) into[number] = vertex;
  }
  if (at < list.length) refuse('INDEX_LENGTH', offset + at);
}

/** The record of the corners or of a bundle. */
export class VerticesEvent {
  #header;
  #order;
  #payload;

  constructor(header, id, generation, count, order, payload) {
    /** `vertices`. */
    this.kind = 'vertices';
    /** Id of the record: 0 for the corners, k for bundle k. */
    this.id = id;
    /** Generation of the record (COM-REC-02). */
    this.generation = generation;
    /** How many vertices it has. */
    this.count = count;
    this.#header = header;
    this.#order = order;
    this.#payload = payload;
  }

  /** @returns {Float64Array} the linear indices of its vertices, in stored order (section 5); a new array */
  indices() {
    if (this.id === 0) return corners(this.#header.dims);
    if (!(this.#order instanceof Uint8Array)) return this.#order.vertices(this.id);
    const indices = new Float64Array(this.count);
    judgeList(this.#header, this.#order, this.count, 0, indices);
    return indices;
  }

  /** @returns {Float32Array} the numbers of its vertices, as {@link decodeValues} gives them; a new array */
  values() {
    return decodeValues(this.#header.encoding, this.#header.scaleExponent, this.#payload, this.count);
  }
}

/** A validity record (section 7): what is known of 4096 vertices, fewer in the last one. */
export class ValidityEvent {
  #header;
  #payload;

  constructor(header, id, generation, payload) {
    /** `validity`. */
    this.kind = 'validity';
    /** Id of the record, 0x80000000 + j. */
    this.id = id;
    /** Generation of the record (COM-REC-02). */
    this.generation = generation;
    /** Linear index of the first vertex. */
    this.first = (id - FIRST_VALIDITY_ID) * BLOCK;
    /** How many vertices it is about. */
    this.count = Math.min(BLOCK, header.vertices - this.first);
    this.#header = header;
    this.#payload = payload;
  }

  /** IVG-VAL-04, -05. */
  judge(offset) {
    const { dims } = this.#header;
    const used = (3 * this.count) % 8;
    const last = this.#payload.length - 1;
    if (used !== 0 && this.#payload[last] >>> used !== 0) refuse('UNUSED_BITS', offset + last);
    for (let vertex = 0; vertex < this.count; vertex += 1) {
      const edges = this.blockedOf(vertex);
      if (edges === 0) continue;
      const index = this.first + vertex;
      const row = Math.floor(index / dims[0]);
      const place = [index % dims[0], row % dims[1], Math.floor(row / dims[1])];
      for (let axis = 0; axis < 3; axis += 1) {
        if ((edges >>> axis) & 1 && place[axis] === dims[axis] - 1) {
          refuse('EDGE_OUTSIDE', offset + this.count + ((3 * vertex) >>> 3));
        }
      }
    }
  }

  /**
   * @param {number} vertex a vertex, counted from the first of the record
   * @returns {number} its validity, 0 inside geometry, 255 where all around it is free (IVG-VAL-03)
   */
  validityOf(vertex) {
    return this.#payload[vertex];
  }

  /**
   * @param {number} vertex a vertex, counted from the first of the record
   * @returns {number} bits 0, 1, 2: the edge to the neighbour in +x, +y, +z is blocked (IVG-VAL-03)
   */
  blockedOf(vertex) {
    const bit = 3 * vertex;
    const at = this.count + (bit >>> 3);
    const bits = this.#payload[at] | ((this.#payload[at + 1] ?? 0) << 8);
    return (bits >>> (bit & 7)) & 7;
  }
}
