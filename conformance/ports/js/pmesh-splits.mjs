// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The first pass over a coded packet: which vertices are split, which faces come, where the new vertices are
 * (`spec/pmesh.md`, sections 8.3 to 8.6).
 * @module
 */

import { refuse } from './errors.mjs';
import { addCross, axesOf, classOf, distance, FloatCells, scaleFor, shiftTo, SlotLists, VertexStates } from './pmesh-cells.mjs';
import { Column } from './pmesh-mesh.mjs';
import { COUNT_STARTS, RANK_STARTS } from './pmesh-starts.mjs';
import { BinaryModel, models, ResidualModels, SymbolModel } from './pmesh-symbols.mjs';
import { bitLength } from './wire.mjs';

const BATCH = 64;
const ORDERED_SLOTS = 32;
const NEIGHBOURS = 34;
const HALF = 0x4000;
/** So many cross products of cells below 2^20 add up exactly in binary64. */
const EXACT_CROSSES = 2048;

/** PMESH-COD-09: the first probability that there is one more face on a side. */
function firstOfFaces(index) {
  const expected = index % 2 === 1;
  const none = Math.floor(index / 2) % 4 === 0;
  if (!none) return 4000;
  return expected ? 24000 : HALF;
}

/** The state of the first pass, which is kept from packet to packet, and its models. */
export class Splits {
  #lattice;
  #cells;
  #greatest;
  #lists = new SlotLists();
  #corners = new Column(Uint32Array);
  #parents = models(8 * 9 * 16, () => new BinaryModel(0x2000));
  #counts = models(36, (index) => new SymbolModel(COUNT_STARTS[Math.floor(index / 4)]));
  #ranks = models(144, (index) => new SymbolModel(RANK_STARTS[4 * Math.floor(index / 36) + (index % 4)]));
  #switches = models(3, () => new BinaryModel(HALF));
  #faces = models(16, (index) => new BinaryModel(firstOfFaces(index)));
  #thirds = models(2, () => new BinaryModel(30000));
  #surface = new ResidualModels(true);
  #heights = new ResidualModels(false);

  /**
   * @param {import('./pmesh.mjs').PmeshHeader} header the header
   * @param {import('./pmesh-lattice.mjs').Lattice | null} lattice that of the positions, null for binary32
   */
  constructor(header, lattice) {
    this.#lattice = lattice;
    this.#cells = lattice === null ? new FloatCells(header.boundsMin, header.boundsMax) : null;
    this.#greatest = (lattice ?? this.#cells).greatest;
    this.baseVertices = header.baseVertices;
    /** What is known of the vertices. */
    this.vertices = new VertexStates();
    /** Faces there are. */
    this.faces = 0;
  }

  /**
   * Reads the first pass of a packet.
   * @param {object} packet index, start, end, endFace, payload, offset, symbols. Receives `positions`; the vertices that
   *   the corners of new faces lie on where they come, `introduced`; for each split its parent, the slots that switch, and
   *   the faces behind it, `parents`, `switchOffsets`, `switchSlots`, `faceOffsets`; the `work` of PMESH-COD-12; whether a
   *   coordinate is `infinite`
   * @throws {FormatError} POSITION, CORNER, FACE_VERTICES, PARENT, CODED_FACES, CODED_LENGTH, CODED_WORK
   */
  read(packet) {
    packet.work = 0;
    packet.infinite = false;
    packet.positions = new Column(Float32Array);
    packet.parents = new Column(Uint32Array);
    packet.introduced = new Column(Uint32Array);
    packet.switchSlots = new Column(Uint32Array);
    packet.switchOffsets = new Column(Uint32Array);
    packet.faceOffsets = new Column(Uint32Array);
    packet.switchOffsets.append([0]);
    if (packet.index === 0) this.#readBase(packet);
    packet.faceOffsets.append([this.faces]);
    let candidate = 0;
    let children = 0;
    while (this.vertices.count < packet.end) {
      const there = this.vertices.count;
      const most = Math.min(BATCH, packet.end - there);
      const batch = [];
      while (batch.length < most && candidate < there) {
        if (packet.symbols.binary(this.#parents[this.#question(packet.index, candidate, children)])) {
          batch.push(candidate);
          children += 1;
        } else {
          candidate += 1;
          children = 0;
        }
      }
      if (batch.length === 0) refuse('PARENT', packet.offset);
      for (const parent of batch) this.#split(packet, parent);
    }
    if (this.faces !== packet.endFace) refuse('CODED_FACES', packet.offset);
  }

  /** PMESH-COD-06. */
  #readBase(packet) {
    const { symbols, offset } = packet;
    for (let vertex = 0; vertex < this.baseVertices; vertex += 1) {
      const cell = this.#greatest.map((greatest) => symbols.raw(bitLength(greatest)));
      this.#addVertex(packet, cell);
      symbols.judgeLength();
    }
    const faces = symbols.raw(32);
    if (faces > packet.endFace) refuse('CODED_FACES', offset);
    const bits = bitLength(this.baseVertices - 1);
    for (let face = 0; face < faces; face += 1) {
      const corners = [symbols.raw(bits), symbols.raw(bits), symbols.raw(bits)];
      symbols.judgeLength();
      if (corners.some((corner) => corner >= this.baseVertices)) refuse('CORNER', offset);
      const [a, b, c] = corners;
      if (a === b || b === c || c === a) refuse('FACE_VERTICES', offset);
      this.#addFace(packet, corners);
    }
  }

  /** Judges a cell, reads the places in it, and adds the vertex (PMESH-COD-10, -11). */
  #addVertex(packet, cell) {
    const { symbols, offset } = packet;
    const position = [0, 0, 0];
    for (let axis = 0; axis < 3; axis += 1) {
      if (cell[axis] < 0 || cell[axis] > this.#greatest[axis]) refuse('POSITION', offset);
    }
    for (let axis = 0; axis < 3; axis += 1) {
      if (this.#lattice !== null) {
        position[axis] = this.#lattice.coordinate(axis, cell[axis]);
        if (!Number.isFinite(position[axis])) packet.infinite = true;
        continue;
      }
      const count = this.#cells.count(axis, cell[axis]);
      const place = symbols.raw(bitLength(count - 1));
      if (place >= count) refuse('POSITION', offset);
      position[axis] = this.#cells.number(axis, cell[axis], place);
      if (Number.isNaN(position[axis])) refuse('POSITION', offset);
    }
    this.vertices.add(cell, packet.index);
    this.#lists.addVertices(1);
    packet.positions.append(position);
  }

  #addFace(packet, corners) {
    const slot = 3 * this.faces;
    packet.introduced.append(corners);
    this.#corners.append(corners);
    this.#lists.addFace();
    corners.forEach((vertex, corner) => this.#lists.append(vertex, slot + corner));
    this.faces += 1;
  }

  /** PMESH-COD-07: the model of the question whether p is split (once more). */
  #question(index, p, children) {
    const { packets, split, scales } = this.vertices;
    let h = 7;
    if (children === 1) h = 6;
    else if (children === 0) {
      const since = index - packets[p];
      if (split[p] === 0) h = Math.min(since, 3);
      else h = since === 1 ? 4 : 5;
    }
    const d = Math.min(Math.max(this.#lists.count(p), 3), 11) - 3;
    return (9 * h + d) * 16 + scales[p];
  }

  /** One split: the next vertex is split from p. */
  #split(packet, p) {
    const v = this.vertices.count;
    const m = this.#lists.count(p);
    packet.work += m;
    if (packet.work > 64 * packet.payload.length) refuse('CODED_WORK', packet.offset);
    const fan = this.#orderFaces(p);
    const cut = this.#cut(packet, p, v, fan);
    const placed = this.#place(packet, p, fan, cut);
    this.#addVertex(packet, placed.cell);
    this.#afterwards(packet.index, p, v, fan, cut, placed);
    packet.parents.append([p]);
    const moving = cut.faces.map((face) => fan.slots[face]).sort((a, b) => a - b);
    packet.switchSlots.append(moving);
    packet.switchOffsets.append([packet.switchSlots.length]);
    for (const slot of moving) this.#corners.array[slot] = v;
    this.#lists.move(p, v, moving);
    for (const corners of cut.newFaces) this.#addFace(packet, corners);
    packet.faceOffsets.append([this.faces]);
    packet.symbols.judgeLength();
  }

  /** PMESH-COD-08: the faces of p in order, with what follows p in each, and the edges of PMESH-COD-09. */
  #orderFaces(p) {
    const slots = this.#lists.of(p);
    const corners = this.#corners.array;
    const follow = (slot, by) => corners[slot - (slot % 3) + ((slot + by) % 3)];
    const outOf = slots.map((slot) => follow(slot, 1));
    const backOf = slots.map((slot) => follow(slot, 2));
    let order = slots.map((_, place) => place);
    let round = false;
    if (slots.length > 0 && slots.length <= ORDERED_SLOTS) ({ order, round } = orderPlaces(outOf, backOf));
    const cell = this.vertices.cell(p);
    const outs = order.map((place) => outOf[place]);
    return {
      slots: order.map((place) => slots[place]),
      outs,
      backs: order.map((place) => backOf[place]),
      round,
      edges: outs.map((out) => distance(cell, this.vertices.cell(out))),
    };
  }

  /** PMESH-COD-09: which faces switch, and which come. */
  #cut(packet, p, v, fan) {
    const { symbols, offset } = packet;
    const m = fan.slots.length;
    const sum = fan.edges.reduce((total, edge) => total + edge, 0);
    if (fan.round) {
      const most = Math.max(...fan.edges);
      const a = [5, 6, 8].filter((factor) => 4 * m * most >= factor * sum).length;
      const n = symbols.count(this.#counts[4 * (Math.min(m, 10) - 2) + a]);
      if (n >= m) refuse('CORNER', offset);
      if (n > 0) return this.#regular(packet, p, v, fan, n, sum);
    }
    return this.#escape(packet, p, v, fan);
  }

  #regular(packet, p, v, fan, n, sum) {
    const m = fan.slots.length;
    const edge = (k) => fan.edges[k % m];
    const weights = fan.edges.map((_, k) => {
      if (n === 1) return edge(k) + edge(k + 1);
      let weight = 0;
      for (let i = 1; i < n; i += 1) weight += edge(k + i);
      return weight;
    });
    const ranked = weights.map((_, k) => k).sort((a, b) => weights[b] - weights[a] || a - b);
    const lead = weights[ranked[0]] - weights[ranked[1]];
    const b = [1, 2, 4].filter((factor) => 8 * m * lead >= factor * sum).length;
    const model = 4 * (9 * (Math.min(n, 4) - 1) + Math.min(m, 10) - 2) + b;
    const rank = packet.symbols.count(this.#ranks[model]);
    if (rank >= m) refuse('CORNER', packet.offset);
    const first = ranked[rank];
    const faces = Array.from({ length: n }, (_, i) => (first + i) % m);
    const last = fan.backs[faces[n - 1]];
    const newFaces = [[p, fan.outs[first], v], [p, v, last]];
    if (this.faces + 2 > packet.endFace) refuse('CODED_FACES', packet.offset);
    const between = n === 1 ? 0 : weights[first];
    const neighbours = [p, ...faces.map((face) => fan.outs[face]), last];
    return { faces, newFaces, neighbours, between, inner: n - 1 };
  }

  #escape(packet, p, v, fan) {
    const { symbols } = packet;
    const faces = [];
    let before = 0;
    fan.slots.forEach((_, face) => {
      const goes = symbols.binary(this.#switches[before]);
      before = goes ? 2 : 1;
      if (goes) faces.push(face);
    });
    const going = new Set(faces);
    const firstBehind = faces.find((face) => face > 0 && !going.has(face - 1));
    const lastBefore = faces.find((face) => face + 1 < fan.slots.length && !going.has(face + 1));
    const newFaces = [];
    const expected = [
      firstBehind === undefined ? null : fan.outs[firstBehind],
      lastBefore === undefined ? null : fan.backs[lastBefore],
    ];
    const guesses = [expected[0] ?? fan.outs[0] ?? 0, expected[1] ?? fan.backs.at(-1) ?? 0];
    for (let side = 0; side < 2; side += 1) {
      const has = expected[side] === null ? 0 : 1;
      for (let g = 0; symbols.binary(this.#faces[2 * (4 * side + Math.min(g, 3)) + has]); g += 1) {
        const x = this.#third(packet, v, fan, guesses[side]);
        if (x === p) refuse('FACE_VERTICES', packet.offset);
        symbols.judgeLength();
        newFaces.push(side === 0 ? [p, x, v] : [p, v, x]);
        if (this.faces + newFaces.length > packet.endFace) refuse('CODED_FACES', packet.offset);
      }
    }
    return { faces, newFaces, neighbours: this.#escapeNeighbours(p, fan, faces), between: 0, inner: 0 };
  }

  /** The third vertex of a new face of an escape. */
  #third(packet, v, fan, guess) {
    const { symbols, offset } = packet;
    if (symbols.binary(this.#thirds[0])) return guess;
    let x;
    if (symbols.binary(this.#thirds[1])) {
      const face = symbols.raw(bitLength(fan.slots.length));
      if (face >= fan.slots.length) refuse('CORNER', offset);
      x = symbols.raw(1) === 1 ? fan.backs[face] : fan.outs[face];
    } else x = symbols.raw(bitLength(v));
    if (x >= v) refuse('CORNER', offset);
    return x;
  }

  /** PMESH-COD-10, 1, for escapes: no two with the same cell. */
  #escapeNeighbours(p, fan, faces) {
    const neighbours = [p];
    const cells = [this.vertices.cell(p)];
    for (const face of faces) {
      for (const vertex of [fan.outs[face], fan.backs[face]]) {
        if (neighbours.length === NEIGHBOURS) return neighbours;
        const cell = this.vertices.cell(vertex);
        if (cells.some((other) => distance(cell, other) === 0)) continue;
        neighbours.push(vertex);
        cells.push(cell);
      }
    }
    return neighbours;
  }

  /** PMESH-COD-10: the cell of the new vertex. */
  #place(packet, p, fan, cut) {
    const { symbols, offset } = packet;
    const cellP = this.vertices.cell(p);
    const cells = cut.neighbours.map((vertex) => this.vertices.cell(vertex));
    const k = cells.length;
    const mean = [0, 1, 2].map((axis) => {
      const sum = cells.reduce((total, cell) => total + cell[axis], cellP[axis]);
      return Math.floor((2 * sum + k + 1) / (2 * k + 2));
    });
    const normal = this.#normal(p, fan, cut.faces);
    const [a1, a2, a3] = axesOf(normal);
    const cell = [0, 0, 0];
    for (const axis of [a1, a2]) {
      const spread = cells.reduce((total, other) => total + Math.abs(other[axis] - mean[axis]), 0);
      const residual = symbols.residual(this.#surface, classOf(Math.floor((8 * spread) / k) + 1));
      cell[axis] = (mean[axis] + residual) | 0;
      if (cell[axis] < 0 || cell[axis] > this.#greatest[axis]) refuse('POSITION', offset);
    }
    const heights = cut.neighbours.reduce((total, vertex) => total + this.vertices.heights[vertex], 0);
    const height = symbols.residual(this.#heights, Math.floor(heights / k));
    let expected = mean[a3];
    if (normal[a3] !== 0) {
      const divisor = Math.abs(normal[a3]);
      const along = normal[a1] * (cell[a1] - cellP[a1]) + normal[a2] * (cell[a2] - cellP[a2]);
      const dividend = normal[a3] > 0 ? -along : along;
      expected = cellP[a3] + (Math.floor((2 * dividend + divisor) / (2 * divisor)) | 0);
    }
    cell[a3] = ((expected | 0) + height) | 0;
    return { cell, cells, mean, height };
  }

  /** PMESH-COD-10, 3. */
  #normal(p, fan, faces) {
    const cellP = this.vertices.cell(p);
    const sum = [0, 0, 0];
    const totals = [0n, 0n, 0n];
    faces.forEach((face, place) => {
      addCross(sum, cellP, this.vertices.cell(fan.outs[face]), this.vertices.cell(fan.backs[face]));
      if ((place + 1) % EXACT_CROSSES !== 0) return;
      for (let axis = 0; axis < 3; axis += 1) {
        totals[axis] += BigInt(sum[axis]);
        sum[axis] = 0;
      }
    });
    if (faces.length < EXACT_CROSSES) return shiftTo(sum, 24);
    const wrapped = totals.map((total, axis) => BigInt.asIntN(64, total + BigInt(sum[axis])));
    const bits = Math.max(...wrapped.map((number) => (number < 0n ? -number : number).toString(2).length));
    return wrapped.map((number) => Number(number >> BigInt(Math.max(0, bits - 24))));
  }

  /** PMESH-COD-10, afterwards: height classes, scales, and that p has been split. */
  #afterwards(index, p, v, fan, cut, placed) {
    const { heights, scales, packets, split } = this.vertices;
    const { cells, mean } = placed;
    const cellV = this.vertices.cell(v);
    const height = classOf(2 * Math.abs(placed.height) + 1) % 256;
    heights[v] = height;
    heights[p] = Math.floor((height + heights[p]) / 2);
    const spread = cells.reduce((total, cell) => total + distance(cell, mean), 0);
    scales[v] = scaleFor(Math.floor(spread / cells.length) + distance(cellV, mean));
    const edges = fan.edges.slice(0, ORDERED_SLOTS).reduce((total, edge) => total + edge, 0);
    const rest = edges + distance(this.vertices.cell(p), cellV) - cut.between;
    scales[p] = scaleFor(Math.floor(rest / (fan.slots.length + 1 - cut.inner)));
    packets[p] = index;
    split[p] = 1;
  }
}

/** PMESH-COD-08: the order of up to 32 slots, given what follows p in the face of each, and whether they go round. */
function orderPlaces(outs, backs) {
  const count = outs.length;
  let used;
  const chain = (start, order) => {
    for (let place = start; place !== -1; ) {
      order.push(place);
      used[place] = true;
      const back = backs[place];
      place = outs.findIndex((out, other) => !used[other] && out === back);
    }
    return order;
  };
  used = new Array(count).fill(false);
  const order = chain(0, []);
  if (order.length === count && count >= 2 && backs[order[count - 1]] === outs[order[0]]) return { order, round: true };
  used = new Array(count).fill(false);
  const again = [];
  outs.forEach((out, place) => {
    if (!used[place] && !backs.some((back, other) => other !== place && back === out)) chain(place, again);
  });
  outs.forEach((_, place) => {
    if (!used[place]) chain(place, again);
  });
  return { order: again, round: false };
}
