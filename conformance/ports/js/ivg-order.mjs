// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Which vertices a bundle of an .ivg file has, and in which order (`spec/ivg.md`, section 5).
 * @module
 */

import { SplitMix64 } from './wire.mjs';

const CHILD_TURNS = { 2: [0, 1], 4: [0, 3, 1, 2], 8: [0, 3, 5, 6, 7, 4, 2, 1] };

/** The numbers 0 and n - 1, or 0 alone. */
function ends(n) {
  return n === 1 ? [0] : [0, n - 1];
}

/**
 * The lattice's corners (IVG-ORD-01).
 * @param {number[]} dims vertices along x, y, z
 * @returns {Float64Array} their linear indices, ascending
 */
export function corners(dims) {
  const [nx, ny, nz] = dims;
  const list = [];
  for (const k of ends(nz)) for (const j of ends(ny)) for (const i of ends(nx)) list.push(i + nx * (j + ny * k));
  return Float64Array.from(list);
}

/**
 * Whether a vertex is a corner (IVG-ORD-01).
 * @param {number[]} dims vertices along x, y, z
 * @param {number} index linear index of a vertex
 * @returns {boolean} whether it is
 */
export function isCorner(dims, index) {
  const [nx, ny, nz] = dims;
  const i = index % nx;
  const row = Math.floor(index / nx);
  const j = row % ny;
  const k = Math.floor(row / ny);
  return (i === 0 || i === nx - 1) && (j === 0 || j === ny - 1) && (k === 0 || k === nz - 1);
}

/** IVG-ORD-10: F. */
function mix(z) {
  z = Math.imul(z ^ (z >>> 16), 0x85ebca6b);
  z = Math.imul(z ^ (z >>> 13), 0xc2b2ae35);
  return z ^ (z >>> 16);
}

/** The permutation P of the vertices of a slice (IVG-ORD-09, -10). */
export class SlicePermutation {
  /**
   * @param {bigint} seed seed of the order
   * @param {number} slice number s of the slice
   * @param {number} count how many numbers there are, m, at least 1
   */
  constructor(seed, slice, count) {
    this.count = count;
    let bits = 2;
    while (2 ** bits < count) bits += 1;
    const lower = Math.floor(bits / 2);
    this.upper = 2 ** (bits - lower);
    this.leftMask = 2 ** lower - 1;
    this.rightMask = this.upper - 1;
    const generator = new SplitMix64(seed);
    this.keys = [];
    for (let round = 0; round < 6; round += 1) this.keys.push(generator.at(0, 6 * slice + round).high);
  }

  /** IVG-ORD-10: N, a Feistel network of six rounds. */
  #network(x) {
    let left = Math.floor(x / this.upper);
    let right = x % this.upper;
    for (let round = 0; round < 6; round += 2) {
      left ^= mix((right + this.keys[round]) | 0) & this.leftMask;
      right ^= mix((left + this.keys[round + 1]) | 0) & this.rightMask;
    }
    return left * this.upper + right;
  }

  /**
   * @param {number} rank r, below m
   * @returns {number} P(r)
   */
  at(rank) {
    let x = this.#network(rank);
    while (x >= this.count) x = this.#network(x);
    return x;
  }
}

/** The order `slices` (section 5.1). */
export class SlicesOrder {
  /**
   * @param {number[]} dims vertices along x, y, z
   * @param {number} share S, vertices that a bundle takes from a slice
   * @param {bigint} seed seed of the order
   */
  constructor(dims, share, seed) {
    this.dims = dims;
    this.share = share;
    this.seed = seed;
    this.longest = dims.indexOf(Math.max(...dims));
    [this.b, this.c] = [0, 1, 2].filter((axis) => axis !== this.longest);
    const [na, nb, nc] = [dims[this.longest], dims[this.b], dims[this.c]];
    this.outerSlices = Math.min(na, 2);
    this.innerSlices = na - this.outerSlices;
    this.outerVertices = nb * nc - Math.min(nb, 2) * Math.min(nc, 2);
    this.innerVertices = nb * nc;
    const most = this.innerSlices > 0 ? this.innerVertices : this.outerVertices;
    /** IVG-ORD-04: the number of bundles that follows. */
    this.bundleCount = Math.ceil(most / share);
    /** How many bundles, the first ones, take the whole share of every slice. */
    this.equalBundles = Math.floor(this.outerVertices / share);
    this.outerCorners = [];
    for (const j of ends(nc)) for (const i of ends(nb)) this.outerCorners.push(i + nb * j);
  }

  /**
   * @param {number} bundle number k of a bundle, from 1
   * @returns {number} L(k), how many vertices it has (IVG-ORD-04)
   */
  vertexCount(bundle) {
    const before = (bundle - 1) * this.share;
    const of = (m) => Math.min(this.share, Math.max(0, m - before));
    return this.outerSlices * of(this.outerVertices) + this.innerSlices * of(this.innerVertices);
  }

  /**
   * @param {number} bundle number k of a bundle, from 1
   * @returns {Float64Array} the linear indices of its vertices, in stored order (IVG-ORD-07)
   */
  vertices(bundle) {
    const { dims, share, longest, b, c, outerCorners } = this;
    const indices = new Float64Array(this.vertexCount(bundle));
    const stride = [1, dims[0], dims[0] * dims[1]];
    let filled = 0;
    for (let slice = 0; slice < dims[longest]; slice += 1) {
      const outer = slice === 0 || slice === dims[longest] - 1;
      const count = outer ? this.outerVertices : this.innerVertices;
      const first = (bundle - 1) * share;
      const end = Math.min(bundle * share, count);
      if (first >= end) continue;
      const permutation = new SlicePermutation(this.seed, slice, count);
      for (let rank = first; rank < end; rank += 1) {
        // IVG-ORD-08: the number of the vertex, then its slice index, past the corners that have no number.
        let number = permutation.at(rank);
        if (outer) for (const corner of outerCorners) if (number >= corner) number += 1;
        const i = number % dims[b];
        const j = Math.floor(number / dims[b]);
        indices[filled] = slice * stride[longest] + i * stride[b] + j * stride[c];
        filled += 1;
      }
    }
    return indices;
  }
}

/** The order `octree` (section 5.2). */
export class OctreeOrder {
  /**
   * @param {number[]} dims vertices along x, y, z
   * @param {number} share S; a bundle has S n vertices, n being the vertices along the longest axis
   * @param {bigint} seed seed of the order
   */
  constructor(dims, share, seed) {
    this.dims = dims;
    this.generator = new SplitMix64(seed);
    this.bundleVertices = share * Math.max(...dims);
    this.total = dims[0] * dims[1] * dims[2] - corners(dims).length;
    /** IVG-OCT-01: the number of bundles that follows. */
    this.bundleCount = Math.ceil(this.total / this.bundleVertices);
    /** How many bundles, the first ones, have the same length. */
    this.equalBundles = Math.floor(this.total / this.bundleVertices);
  }

  /**
   * @param {number} bundle number k of a bundle, from 1
   * @returns {number} how many vertices it has
   */
  vertexCount(bundle) {
    return Math.min(this.bundleVertices, this.total - (bundle - 1) * this.bundleVertices);
  }

  /**
   * @param {number} bundle number k of a bundle, from 1
   * @returns {Float64Array} the linear indices of its vertices, in stored order
   */
  vertices(bundle) {
    const first = (bundle - 1) * this.bundleVertices;
    return Float64Array.from(this.#ranks([0, 0, 0], this.dims, 0, first, first + this.vertexCount(bundle)));
  }

  /**
   * The children of a cell that have vertices, in the order of their turns (IVG-OCT-02, -04): for each its lowest
   * vertex, its extent, and how many of its vertices are not corners of the lattice (IVG-OCT-05).
   */
  #children(low, extent, depth) {
    const { dims } = this;
    const longest = Math.max(extent[0], extent[1], extent[2]);
    // For each axis and part: lowest coordinate, extent, how many of the lattice's first and last coordinates it has.
    const parts = [];
    const shifts = [0, 0, 0];
    let cuts = 0;
    for (let axis = 0; axis < 3; axis += 1) {
      const last = dims[axis] - 1;
      const part = (from, count) => {
        const high = from + count - 1;
        parts.push(from, count, (from === 0 ? 1 : 0) + (last > 0 && high === last ? 1 : 0));
      };
      const cut = extent[axis] >= 2 && 2 * extent[axis] > longest;
      const lower = cut ? Math.ceil(extent[axis] / 2) : extent[axis];
      part(low[axis], lower);
      part(low[axis] + lower, extent[axis] - lower);
      shifts[axis] = cut ? cuts : 31;
      if (cut) cuts += 1;
    }
    const turns = CHILD_TURNS[1 << cuts];
    const v = low[0] + dims[0] * (low[1] + dims[1] * low[2]);
    // 32 v + d has up to 53 bits; v and its product are exact.
    this.generator.at(Math.floor(v / 0x8000000), (v % 0x8000000) * 32 + depth);
    const turn = this.generator.low & (turns.length - 1);
    const children = [];
    for (const t of turns) {
      const number = t ^ turn;
      const x = 3 * ((number >>> shifts[0]) & 1);
      const y = 6 + 3 * ((number >>> shifts[1]) & 1);
      const z = 12 + 3 * ((number >>> shifts[2]) & 1);
      const all = parts[x + 1] * parts[y + 1] * parts[z + 1];
      const weight = all - parts[x + 2] * parts[y + 2] * parts[z + 2];
      if (weight === 0) continue;
      children.push({
        low: [parts[x], parts[y], parts[z]],
        extent: [parts[x + 1], parts[y + 1], parts[z + 1]],
        weight,
      });
    }
    return children;
  }

  /**
   * The vertices of the ranks from `first` to `end` in a cell (IVG-OCT-05). In each child of the cell they are vertices
   * of successive ranks too, so that no cell is cut twice.
   */
  #ranks(low, extent, depth, first, end) {
    if (end === first + 1) return [this.#single(low, extent, depth, first)];
    const children = this.#children(low, extent, depth);
    const childOf = new Uint8Array(end - first);
    const ranges = children.map(() => ({ first: 0, count: 0, given: 0 }));
    let at = 0;
    for (const { active, done, from, round } of this.#rounds(children, first)) {
      for (let rank = from; rank < round && at < childOf.length; rank += 1, at += 1) {
        const number = active[rank % active.length];
        const range = ranges[number];
        if (range.count === 0) range.first = done + Math.floor(rank / active.length);
        range.count += 1;
        childOf[at] = number;
      }
      if (at === childOf.length) break;
    }
    const lists = children.map((child, number) => {
      const range = ranges[number];
      if (range.count === 0) return null;
      return this.#ranks(child.low, child.extent, depth + 1, range.first, range.first + range.count);
    });
    return new Float64Array(childOf.length).map((_, place) => {
      const number = childOf[place];
      ranges[number].given += 1;
      return lists[number][ranges[number].given - 1];
    });
  }

  /** The stretches of a cell's ranks in which the same children take turns, those that end before `rank` left out. */
  *#rounds(children, rank) {
    let active = children.map((_, number) => number);
    let done = 0;
    let from = rank;
    while (active.length > 0) {
      const next = active.reduce((least, number) => Math.min(least, children[number].weight), Infinity);
      const round = (next - done) * active.length;
      if (from < round) yield { active, done, from, round };
      from = Math.max(0, from - round);
      done = next;
      active = active.filter((number) => children[number].weight > done);
    }
  }

  /** The vertex of one rank in a cell. */
  #single(low, extent, depth, rank) {
    while (extent[0] * extent[1] * extent[2] > 1) {
      const children = this.#children(low, extent, depth);
      const { active, done, from } = this.#rounds(children, rank).next().value;
      ({ low, extent } = children[active[from % active.length]]);
      rank = done + Math.floor(from / active.length);
      depth += 1;
    }
    return low[0] + this.dims[0] * (low[1] + this.dims[1] * low[2]);
  }

  /**
   * @param {number} rank rank of a vertex, below the number of vertices that are not corners
   * @returns {number} its linear index
   */
  vertex(rank) {
    return this.#single([0, 0, 0], this.dims, 0, rank);
  }
}
