// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * What coded packets know of vertices: cells, classes, the faces around each (`spec/pmesh.md`, sections 8.3 to 8.6).
 * @module
 */

import { Column } from './pmesh-mesh.mjs';
import { bitLength, powerOfTwo } from './wire.mjs';

/**
 * The class of a number (PMESH-COD-05).
 * @param {number} x a whole number from 0 to 2^53 - 1
 * @returns {number} c(x)
 */
export function classOf(x) {
  if (x < 2) return 0;
  const log = bitLength(x) - 1;
  const below = log >= 2 ? Math.floor(x / 2 ** (log - 2)) & 3 : (x << 1) & 3;
  return 4 * log + below;
}

/**
 * The scale for a distance (PMESH-COD-05).
 * @param {number} distance a distance
 * @returns {number} 0 to 15
 */
export function scaleFor(distance) {
  return Math.min(bitLength(distance), 15);
}

/**
 * The main axis of a normal (PMESH-COD-10, 4).
 * @param {number[]} normal three numbers
 * @returns {number[]} a1, a2, a3
 */
export function axesOf(normal) {
  const sizes = normal.map(Math.abs);
  const main = sizes.indexOf(Math.max(...sizes));
  return [(main + 1) % 3, (main + 2) % 3, main];
}

/** Binary32 numbers in ascending order, as whole numbers; -0 is -1, +0 is 0. */
const floatView = new DataView(new ArrayBuffer(4));

function rankOf(number) {
  floatView.setFloat32(0, number);
  const bits = floatView.getInt32(0);
  return bits >= 0 ? bits : -(bits & 0x7fffffff) - 1;
}

/** The rank of the least finite number. */
const LEAST_RANK = -0x7f7fffff - 1;

function floatOf(rank) {
  floatView.setInt32(0, rank >= 0 ? rank : (-(rank + 1) | 0x80000000));
  return floatView.getFloat32(0);
}

/** Cells of positions of binary32 (PMESH-COD-11). */
export class FloatCells {
  /**
   * @param {number[]} least the bounding box's least coordinates
   * @param {number[]} most its greatest coordinates
   */
  constructor(least, most) {
    this.least = least;
    this.most = most;
    const size = Math.max(...least.map(Math.abs), ...most.map(Math.abs));
    floatView.setFloat32(0, size);
    const exponent = floatView.getInt32(0) >>> 23;
    this.unit = powerOfTwo(Math.max(exponent, 1) - 150);
    const counts = () => least.map((low, axis) => Math.floor(most[axis] / this.unit) - Math.floor(low / this.unit));
    while (counts().some((count) => count >= 2 ** 20)) this.unit *= 2;
    /** The greatest cell along each axis. */
    this.greatest = counts();
    this.lowest = least.map((low) => Math.floor(low / this.unit));
  }

  /** The rank of the first number of a cell: -0 for that of 0. */
  #first(axis, cell) {
    const number = (this.lowest[axis] + cell) * this.unit;
    // The first cell may begin below the least finite number.
    return number === 0 ? -1 : Math.max(rankOf(number), LEAST_RANK);
  }

  /** @returns {number} how many numbers a cell has */
  count(axis, cell) {
    return this.#first(axis, cell + 1) - this.#first(axis, cell);
  }

  /** @returns {number} the number at a place in a cell, or NaN if it is outside the bounding box */
  number(axis, cell, place) {
    const number = floatOf(this.#first(axis, cell) + place);
    return number >= this.least[axis] && number <= this.most[axis] ? number : NaN;
  }
}

/** The slots of each vertex at a level, ascending (PMESH-DEF-06), as linked lists: 0 is none, else the slot plus 1. */
export class SlotLists {
  #first = new Column(Uint32Array);
  #last = new Column(Uint32Array);
  #count = new Column(Uint32Array);
  #next = new Column(Uint32Array);

  /** Adds vertices without slots. */
  addVertices(count) {
    this.#first.grow(count);
    this.#last.grow(count);
    this.#count.grow(count);
  }

  /** Makes room for the slots of a new face. */
  addFace() {
    this.#next.grow(3);
  }

  /** Gives a vertex a slot, greater than those it has. */
  append(vertex, slot) {
    const last = this.#last.array[vertex];
    if (last === 0) this.#first.array[vertex] = slot + 1;
    else this.#next.array[last - 1] = slot + 1;
    this.#last.array[vertex] = slot + 1;
    this.#next.array[slot] = 0;
    this.#count.array[vertex] += 1;
  }

  /** @returns {number} how many slots a vertex has */
  count(vertex) {
    return this.#count.array[vertex];
  }

  /** @returns {number[]} the slots of a vertex, ascending, no more than `most` of them */
  of(vertex, most = Infinity) {
    const slots = [];
    const next = this.#next.array;
    for (let slot = this.#first.array[vertex]; slot !== 0 && slots.length < most; slot = next[slot - 1]) {
      slots.push(slot - 1);
    }
    return slots;
  }

  /** Moves slots, ascending ones, from one vertex to another that has none. */
  move(from, to, moving) {
    if (moving.length === 0) return;
    const slots = this.of(from);
    this.#first.array[from] = 0;
    this.#last.array[from] = 0;
    this.#count.array[from] = 0;
    let moved = 0;
    for (const slot of slots) {
      const goes = slot === moving[moved];
      if (goes) moved += 1;
      this.append(goes ? to : from, slot);
    }
  }
}

/** What is known of vertices (PMESH-COD-05). */
export class VertexStates {
  #cells = new Column(Int32Array);
  #scales = new Column(Uint8Array);
  #heights = new Column(Uint8Array);
  #packets = new Column(Uint32Array);
  #split = new Column(Uint8Array);

  /** Vertices there are. */
  get count() {
    return this.#scales.length;
  }

  /** Adds a vertex that a packet brings. */
  add(cell, packet) {
    this.#cells.append(cell);
    this.#scales.append([0]);
    this.#heights.append([0]);
    this.#packets.append([packet]);
    this.#split.append([0]);
  }

  /** @returns {Int32Array} the cell of a vertex; void after the next vertex */
  cell(vertex) {
    return this.#cells.array.subarray(3 * vertex, 3 * vertex + 3);
  }

  /** Scale, height class, packet and split of vertices, by vertex; void after the next vertex. */
  get scales() {
    return this.#scales.array;
  }

  get heights() {
    return this.#heights.array;
  }

  get packets() {
    return this.#packets.array;
  }

  get split() {
    return this.#split.array;
  }
}

/**
 * The distance of two cells (PMESH-COD-05).
 * @param {ArrayLike<number>} a a cell
 * @param {ArrayLike<number>} b a cell
 * @returns {number} the sum of the magnitudes of their differences
 */
export function distance(a, b) {
  return Math.abs(a[0] - b[0]) + Math.abs(a[1] - b[1]) + Math.abs(a[2] - b[2]);
}

/**
 * Adds the cross product (out - at) × (back - at) of cells to a sum.
 * @param {number[]} sum three numbers, which change
 * @param {ArrayLike<number>} at a cell
 * @param {ArrayLike<number>} out a cell
 * @param {ArrayLike<number>} back a cell
 */
export function addCross(sum, at, out, back) {
  const [ax, ay, az] = [out[0] - at[0], out[1] - at[1], out[2] - at[2]];
  const [bx, by, bz] = [back[0] - at[0], back[1] - at[1], back[2] - at[2]];
  sum[0] += ay * bz - az * by;
  sum[1] += az * bx - ax * bz;
  sum[2] += ax * by - ay * bx;
}

/**
 * Shifts numbers right, ⌊ ⌋, by as many bits as the greatest magnitude among them has beyond some.
 * @param {number[]} numbers whole numbers
 * @param {number} bits bits that it may have
 * @returns {number[]} the numbers, shifted
 */
export function shiftTo(numbers, bits) {
  const most = Math.max(...numbers.map(Math.abs));
  const shift = bitLength(most) - bits;
  return shift > 0 ? numbers.map((number) => Math.floor(number / 2 ** shift)) : numbers;
}
