// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The second pass over a coded packet: wedges, corners and materials (`spec/pmesh.md`, PMESH-COD-13 and -14).
 * @module
 */

import { refuse } from './errors.mjs';
import { SlotLists } from './pmesh-cells.mjs';
import { Column } from './pmesh-mesh.mjs';
import { BinaryModel, models } from './pmesh-symbols.mjs';
import { WedgeValues } from './pmesh-values.mjs';
import { bitLength } from './wire.mjs';

const BESIDE_SLOTS = 32;
const NEIGHBOUR_SLOTS = 16;
const LIKELY = 30000;
const UNLIKELY = 2768;

/** PMESH-COD-14: the first probability that there is one more wedge, for e and k from 1 to 4. */
function firstOfMore(index) {
  return index % 4 < Math.floor(index / 4) ? LIKELY : UNLIKELY;
}

/** The state of the second pass, which is kept from packet to packet, and its models. */
export class SecondPass {
  #header;
  #vertices;
  #values;
  #lists = new SlotLists();
  #corners = new Column(Uint32Array);
  #materials = new Column(Uint16Array);
  #firstWedges = new Column(Uint32Array);
  #wedgeVertices = new Column(Uint32Array);
  #more = models(16, (index) => new BinaryModel(firstOfMore(index)));
  #targets = models(2, () => new BinaryModel(LIKELY));
  #same = new BinaryModel(LIKELY);
  #cornerModels = models(6, () => new BinaryModel(LIKELY));
  #materialModels = models(2, () => new BinaryModel(LIKELY));

  /**
   * @param {import('./pmesh.mjs').PmeshHeader} header the header
   * @param {import('./pmesh-cells.mjs').VertexStates} vertices what the first pass knows of vertices
   */
  constructor(header, vertices) {
    this.#header = header;
    this.#vertices = vertices;
    this.#values = new WedgeValues(header);
  }

  /**
   * Reads the second pass of a packet.
   * @param {object} packet the packet as the first pass left it
   * @param {number} base vertices of the base in it
   * @returns {object} wedges, their values, corners, materials, and the places that slots switch to
   * @throws {FormatError} WEDGE_COUNT, WEDGE_TARGET, SWITCH, CORNER, ATTRIBUTE, CODED_LENGTH
   */
  read(packet, base) {
    const { seams, materials } = this.#header.attributes;
    const firstFace = this.#faces;
    packet.collapse = new Column(Uint32Array);
    packet.places = new Column(Uint32Array);
    packet.cornerWedges = new Column(Uint32Array);
    this.#values.begin();
    if (packet.index === 0) this.#readBase(packet, base);
    for (let split = 0; split < packet.parents.length; split += 1) this.#readSplit(packet, base, split);
    const wedges = this.#wedgeVertices.length;
    if (wedges !== packet.endWedge) refuse('WEDGE_COUNT', packet.offset);
    const firsts = this.#firstWedges.array;
    const countOf = (_, place) => {
      const vertex = packet.start + place;
      return (vertex + 1 < packet.end ? firsts[vertex + 1] : wedges) - firsts[vertex];
    };
    return {
      wedgeCounts: seams ? new Uint32Array(packet.end - packet.start).map(countOf) : null,
      wedgeCollapse: packet.collapse.array.slice(0, packet.collapse.length),
      ...this.#values.taken(),
      corners: packet.cornerWedges.array.slice(0, packet.cornerWedges.length),
      materials: materials ? this.#materials.array.slice(firstFace, this.#faces) : null,
      places: seams ? packet.places.array.slice(0, packet.places.length) : null,
    };
  }

  get #faces() {
    return this.#corners.length / 3;
  }

  #first(vertex) {
    return this.#firstWedges.array[vertex];
  }

  #count(vertex) {
    const end = vertex + 1 < this.#firstWedges.length ? this.#firstWedges.array[vertex + 1] : this.#wedgeVertices.length;
    return end - this.#firstWedges.array[vertex];
  }

  /** A place among some wedges, raw, where it is not as guessed. */
  #place(packet, count, name) {
    const place = packet.symbols.raw(bitLength(count - 1));
    if (place >= count) refuse(name, packet.offset);
    return place;
  }

  /** PMESH-COD-14, 1: adds the next vertex, with its wedges. */
  #addVertex(packet, expected) {
    const vertex = this.#firstWedges.length;
    this.#firstWedges.append([this.#wedgeVertices.length]);
    this.#lists.addVertices(1);
    for (let k = 1; ; k += 1) {
      if (this.#wedgeVertices.length >= packet.endWedge) refuse('WEDGE_COUNT', packet.offset);
      this.#wedgeVertices.append([vertex]);
      if (!this.#header.attributes.seams) return;
      const model = this.#more[4 * (Math.min(expected, 4) - 1) + Math.min(k, 4) - 1];
      if (!packet.symbols.binary(model)) return;
    }
  }

  #addFace(packet, vertices, wedges, material) {
    const slot = this.#corners.length;
    this.#corners.append(wedges);
    packet.cornerWedges.append(wedges);
    this.#lists.addFace();
    vertices.forEach((vertex, corner) => this.#lists.append(vertex, slot + corner));
    this.#materials.append([material]);
    packet.symbols.judgeLength();
  }

  /** PMESH-COD-13, 1 to 3 of the base. */
  #readBase(packet, base) {
    const { symbols } = packet;
    for (let vertex = 0; vertex < base; vertex += 1) {
      this.#addVertex(packet, 1);
      symbols.judgeLength();
    }
    const faces = packet.faceOffsets.array[0];
    for (let face = 0; face < faces; face += 1) {
      const vertices = packet.introduced.array.slice(3 * face, 3 * face + 3);
      const wedges = vertices.map((vertex) => this.#first(vertex) + this.#place(packet, this.#count(vertex), 'CORNER'));
      this.#addFace(packet, vertices, wedges, this.#header.attributes.materials ? symbols.raw(16) : 0);
    }
    for (let wedge = 0; wedge < this.#wedgeVertices.length; wedge += 1) {
      this.#values.readBase(symbols, packet.offset);
      packet.collapse.append([0]);
      symbols.judgeLength();
    }
  }

  /** PMESH-COD-13, 1 to 3 of a split. */
  #readSplit(packet, base, split) {
    const v = packet.start + base + split;
    const p = packet.parents.array[split];
    const [from, to] = packet.switchOffsets.array.subarray(split, split + 2);
    const moving = packet.switchSlots.array.subarray(from, to);
    const targets = this.#readTargets(packet, p, moving);
    this.#switch(packet, v, moving, targets);
    this.#lists.move(p, v, moving);
    const [firstFace, endFace] = packet.faceOffsets.array.subarray(split, split + 2);
    for (let face = firstFace; face < endFace; face += 1) {
      const at = 3 * (face - packet.startFace);
      this.#readFace(packet, p, v, packet.introduced.array.slice(at, at + 3));
    }
    this.#readValues(packet, v, targets);
    packet.symbols.judgeLength();
  }

  /** PMESH-COD-14, 1 and 2: the wedges of the next vertex, and what each becomes. */
  #readTargets(packet, p, moving) {
    const { symbols } = packet;
    const several = this.#count(p) > 1;
    const firstOfP = this.#first(p);
    const countOfP = this.#count(p);
    let had = [];
    if (several) had = [...new Set(Array.from(moving, (slot) => this.#corners.array[slot]))].sort((a, b) => a - b);
    const firstWedge = this.#wedgeVertices.length;
    this.#addVertex(packet, Math.max(had.length, 1));
    const targets = [];
    for (let j = 0; j < this.#wedgeVertices.length - firstWedge; j += 1) {
      let target = firstOfP;
      if (several) {
        if (had.length > 0) target = had[Math.min(j, had.length - 1)];
        const model = this.#targets[j < had.length ? 0 : 1];
        if (!symbols.binary(model)) target = firstOfP + this.#place(packet, countOfP, 'WEDGE_TARGET');
      }
      targets.push(target);
    }
    packet.collapse.append(targets);
    return targets;
  }

  /** PMESH-COD-14, 3: the wedge that each slot switches to. */
  #switch(packet, v, moving, targets) {
    const first = this.#first(v);
    const corners = this.#corners.array;
    const becoming = new Map();
    targets.forEach((target, place) => {
      if (!becoming.has(target)) becoming.set(target, []);
      becoming.get(target).push(first + place);
    });
    let last = -1;
    for (const slot of moving) {
      const choices = becoming.get(corners[slot]);
      if (choices === undefined) refuse('SWITCH', packet.offset);
      let wedge = choices[0];
      if (choices.length > 1) {
        // The choices are those wedges that become the one that the last choice was among, or others.
        if (last !== -1 && targets[last - first] === corners[slot]) wedge = last;
        if (!packet.symbols.binary(this.#same)) wedge = choices[this.#place(packet, choices.length, 'SWITCH')];
        last = wedge;
      }
      corners[slot] = wedge;
      packet.places.append([wedge - first]);
    }
  }

  /** The face beside a new one at a vertex: the first whose corners have one on x. -1 if there is none. */
  #beside(vertex, x) {
    const corners = this.#corners.array;
    for (const slot of this.#lists.of(vertex, BESIDE_SLOTS)) {
      const face = Math.floor(slot / 3);
      for (let at = 3 * face; at < 3 * face + 3; at += 1) if (this.#wedgeVertices.array[corners[at]] === x) return face;
    }
    return -1;
  }

  /** PMESH-COD-14, 4 and 5. */
  #readFace(packet, p, v, vertices) {
    const x = vertices.find((vertex) => vertex !== p && vertex !== v);
    const atP = this.#beside(p, x);
    const atV = this.#beside(v, x);
    const wedgeOf = new Map();
    const ask = (vertex, k, face) => {
      let wedge = this.#first(vertex);
      let missed = false;
      const count = this.#count(vertex);
      if (count > 1) {
        if (face !== -1) {
          const corners = this.#corners.array.subarray(3 * face, 3 * face + 3);
          wedge = corners.find((corner) => this.#wedgeVertices.array[corner] === vertex);
        }
        missed = !packet.symbols.binary(this.#cornerModels[2 * k + (face === -1 ? 0 : 1)]);
        if (missed) wedge = this.#first(vertex) + this.#place(packet, count, 'CORNER');
      }
      wedgeOf.set(vertex, wedge);
      return missed;
    };
    const missed = ask(p, 0, atP);
    ask(v, 1, atV);
    const [near, far] = missed ? [atV, atP] : [atP, atV];
    ask(x, 2, near !== -1 ? near : far);
    const material = this.#header.attributes.materials ? this.#readMaterial(packet, atP, atV) : 0;
    this.#addFace(packet, vertices, vertices.map((vertex) => wedgeOf.get(vertex)), material);
  }

  #readMaterial(packet, atP, atV) {
    const materials = this.#materials.array;
    const { symbols } = packet;
    let like = this.#faces - 1;
    if (atP !== -1) like = atP;
    else if (atV !== -1) like = atV;
    const expected = like === -1 ? 0 : materials[like];
    if (symbols.binary(this.#materialModels[0])) return expected;
    if (atV !== -1 && materials[atV] !== expected && symbols.binary(this.#materialModels[1])) return materials[atV];
    return symbols.raw(16);
  }

  /** PMESH-COD-13, 3: the values of the wedges of v, at level v + 1. */
  #readValues(packet, v, targets) {
    const first = this.#first(v);
    const corners = this.#corners.array;
    const slotsOf = targets.map(() => []);
    for (const slot of this.#lists.of(v)) {
      const slots = slotsOf[corners[slot] - first];
      if (slots.length < NEIGHBOUR_SLOTS) slots.push(slot);
    }
    const cellOf = (wedge) => this.#vertices.cell(this.#wedgeVertices.array[wedge]);
    targets.forEach((target, place) => {
      const around = slotsOf[place].map((slot) => {
        const face = slot - (slot % 3);
        return [corners[face + ((slot + 1) % 3)], corners[face + ((slot + 2) % 3)]];
      });
      this.#values.read(packet.symbols, packet.offset, around, target, this.#vertices.cell(v), cellOf);
    });
  }
}
