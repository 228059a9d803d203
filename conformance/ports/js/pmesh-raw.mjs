// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Packets of the mode `raw` (`spec/pmesh.md`, sections 4 to 7).
 * @module
 */

import { refuse } from './errors.mjs';
import { Column } from './pmesh-mesh.mjs';
import { readSwitches } from './pmesh-switches.mjs';
import { bitLength, viewOf } from './wire.mjs';

/** The next parts of a payload, one behind the other. */
class Parts {
  constructor(payload, offset) {
    this.payload = payload;
    this.view = viewOf(payload);
    this.offset = offset;
    this.at = 0;
  }

  /** Passes a part whose length the directory guarantees (PMESH-DIR-04). Returns where it begins. */
  pass(bytes) {
    const at = this.at;
    this.at += bytes;
    return at;
  }

  /** A number of variable length (PMESH-PKT-04). */
  number() {
    const first = this.at;
    let value = 0;
    for (let place = 0; ; place += 1) {
      if (this.at >= this.payload.length) refuse('PACKET_LENGTH', this.offset + first);
      const byte = this.payload[this.at];
      this.at += 1;
      if ((place === 4 && byte > 15) || (place > 0 && byte === 0)) refuse('VARINT', this.offset + first);
      value += (byte & 0x7f) * 2 ** (7 * place);
      if (byte < 0x80) return value;
    }
  }
}

/**
 * A packed number (PMESH-PKT-02).
 * @param {Uint8Array} bytes the bytes
 * @param {number} at byte at which the numbers begin
 * @param {number} bit its first bit, from there
 * @param {number} count how many bits it has, at most 32
 * @returns {number} the number
 */
export function packedNumber(bytes, at, bit, count) {
  let value = 0;
  for (let done = 0; done < count; ) {
    const from = (bit + done) % 8;
    const taken = Math.min(8 - from, count - done);
    const byte = bytes[at + Math.floor((bit + done) / 8)];
    value += ((byte >>> from) & ((1 << taken) - 1)) * 2 ** done;
    done += taken;
  }
  return value;
}

/**
 * Judges the unused bits of the last byte of packed numbers (PACKET_PADDING, PMESH-PKT-02).
 * @param {Uint8Array} payload the payload
 * @param {number} at byte at which the numbers begin
 * @param {number} bits bits in all
 * @param {number} offset where the payload lies in the file
 */
export function judgeUnusedBits(payload, at, bits, offset) {
  const last = at + Math.floor(bits / 8);
  if (bits % 8 !== 0 && payload[last] >>> (bits % 8) !== 0) refuse('PACKET_PADDING', offset + last);
}

/** Reads raw packets one after the other. */
export class RawPackets {
  #header;
  #mesh;
  #lattice;
  /** The corners of all faces, as mapped at the end of the last packet. */
  #finest = new Column(Uint32Array);

  /**
   * @param {import('./pmesh.mjs').PmeshHeader} header the header
   * @param {import('./pmesh-mesh.mjs').Mesh} mesh what earlier packets brought
   * @param {import('./pmesh-lattice.mjs').Lattice | null} lattice that of the positions, null for binary32
   */
  constructor(header, mesh, lattice) {
    this.#header = header;
    this.#mesh = mesh;
    this.#lattice = lattice;
  }

  /**
   * Judges and reads a packet (PMESH-PKT-03).
   * @param {number} index number of the packet
   * @param {{endVertex: number, endWedge: number, endFace: number}} before the entry of the packet before, or zeros
   * @param {import('./pmesh.mjs').PacketEntry} entry its entry
   * @param {Uint8Array} payload the payload
   * @param {number} offset where it lies in the file
   * @returns {import('./pmesh-mesh.mjs').PacketContents} what it brings
   * @throws {FormatError} the codes of sections 4 to 7
   */
  read(index, before, entry, payload, offset) {
    const { attributes, baseVertices } = this.#header;
    const packet = {
      start: before.endVertex,
      end: entry.endVertex,
      startWedge: before.endWedge,
      endWedge: entry.endWedge,
      startFace: before.endFace,
      vertices: entry.endVertex - before.endVertex,
      wedges: entry.endWedge - before.endWedge,
      faces: entry.endFace - before.endFace,
      // The first vertex of the packet that has a parent, and the least level of a face of the packet (PMESH-FACE-05).
      firstSplit: Math.max(before.endVertex, baseVertices),
      leastLevel: index === 0 ? baseVertices : before.endVertex + 1,
    };
    const parts = new Parts(payload, offset);
    const switchCount = parts.view.getUint32(parts.pass(4), true);
    const positions = this.#positions(packet, parts);
    const normals = attributes.normals ? readFloats(parts, packet.wedges, 3) : null;
    const uvs = attributes.uvs ? readFloats(parts, packet.wedges, 2) : null;
    let colours = null;
    if (attributes.colours) {
      const at = parts.pass(4 * packet.wedges);
      colours = payload.slice(at, parts.at);
    }
    const cornersAt = parts.pass(12 * packet.faces);
    let materials = null;
    if (attributes.materials) {
      const at = parts.pass(2 * packet.faces);
      materials = new Uint16Array(packet.faces).map((_, face) => parts.view.getUint16(at + 2 * face, true));
    }
    const parents = readParents(packet, parts);
    this.#readWedges(packet, parts, parents);
    const corners = this.#corners(packet, parts, cornersAt);
    const switched = readSwitches(packet, switchCount, this.#finest.array, parts);
    this.#judgeWork(packet, corners, switched.wedges, offset);
    const { initial, faceEnds } = this.#introduce(packet, corners);
    const switches = this.#switches(packet, corners, initial, faceEnds.levels, switched);
    this.#finest.append(corners);
    switched.slots.forEach((slot, place) => {
      this.#finest.array[slot] = switched.wedges[place];
    });
    return {
      startVertex: packet.start,
      positions,
      wedgeCounts: packet.wedgeCounts,
      wedgeCollapse: packet.collapse,
      normals,
      uvs,
      colours,
      corners: initial,
      materials,
      faceEnds: faceEnds.ends,
      switches,
    };
  }

  /** PMESH-POS-01 to -04. */
  #positions(packet, parts) {
    const { boundsMin, boundsMax } = this.#header;
    const { view, offset } = parts;
    const lattice = this.#lattice;
    const positions = new Float32Array(3 * packet.vertices);
    if (lattice === null) {
      const at = parts.pass(12 * packet.vertices);
      for (let number = 0; number < positions.length; number += 1) {
        const value = view.getFloat32(at + 4 * number, true);
        const axis = number % 3;
        if (!(value >= boundsMin[axis] && value <= boundsMax[axis])) refuse('POSITION', offset + at + 4 * (number - axis));
        positions[number] = value;
      }
      return positions;
    }
    const at = parts.pass(8 * packet.vertices);
    const greatest = [...lattice.greatest, 0];
    for (let number = 0; number < 4 * packet.vertices; number += 1) {
      if (view.getUint16(at + 2 * number, true) > greatest[number % 4]) refuse('POSITION', offset + at + 2 * (number - (number % 4)));
    }
    for (let vertex = 0; vertex < packet.vertices; vertex += 1) {
      for (let axis = 0; axis < 3; axis += 1) {
        const value = lattice.coordinate(axis, view.getUint16(at + 8 * vertex + 2 * axis, true));
        if (!Number.isFinite(value)) refuse('POSITION', offset + at + 8 * vertex);
        positions[3 * vertex + axis] = value;
      }
    }
    return positions;
  }

  /** Wedge counts and targets (PMESH-WDG-01, PMESH-COL-02): what each wedge becomes, and how deep it is. */
  #readWedges(packet, parts, parents) {
    const { start, startWedge, wedges, vertices, firstSplit } = packet;
    const { seams } = this.#header.attributes;
    packet.wedgeCounts = seams ? readWedgeCounts(packet, parts) : null;
    packet.wedgeVertices = null;
    packet.firstWedges = null;
    if (seams) {
      packet.wedgeVertices = new Uint32Array(wedges);
      packet.firstWedges = new Uint32Array(vertices + 1);
      let wedge = 0;
      packet.wedgeCounts.forEach((count, vertex) => {
        packet.firstWedges[vertex] = startWedge + wedge;
        packet.wedgeVertices.fill(start + vertex, wedge, wedge + count);
        wedge += count;
      });
      packet.firstWedges[vertices] = startWedge + wedge;
    }
    packet.firstWedge = (vertex) => {
      if (!seams) return vertex;
      return vertex < start ? this.#mesh.firstWedge(vertex) : packet.firstWedges[vertex - start];
    };
    packet.vertexOf = (wedge) => {
      if (!seams) return wedge;
      return wedge < startWedge ? this.#mesh.wedgeVertex(wedge) : packet.wedgeVertices[wedge - startWedge];
    };
    const collapse = new Uint32Array(wedges);
    const depths = new Uint32Array(wedges);
    for (let wedge = packet.firstWedge(firstSplit) - startWedge; wedge < wedges; wedge += 1) {
      const parent = parents[packet.vertexOf(startWedge + wedge) - firstSplit];
      const first = packet.firstWedge(parent);
      const at = parts.at;
      const place = seams ? parts.number() : 0;
      if (place >= packet.firstWedge(parent + 1) - first) refuse('WEDGE_TARGET', parts.offset + at);
      collapse[wedge] = first + place;
      depths[wedge] = 1 + (collapse[wedge] < startWedge ? 0 : depths[collapse[wedge] - startWedge]);
    }
    packet.collapse = collapse;
    packet.depths = depths;
  }

  /** PMESH-FACE-01: the corners, as mapped at the packet's end. */
  #corners(packet, parts, at) {
    const corners = new Uint32Array(3 * packet.faces);
    for (let face = 0; face < packet.faces; face += 1) {
      const offset = parts.offset + at + 12 * face;
      const [a, b, c] = [0, 4, 8].map((place) => parts.view.getUint32(at + 12 * face + place, true));
      if (a >= packet.endWedge || b >= packet.endWedge || c >= packet.endWedge) refuse('CORNER', offset);
      const [u, v, w] = [packet.vertexOf(a), packet.vertexOf(b), packet.vertexOf(c)];
      if (u === v || v === w || w === u) refuse('FACE_VERTICES', offset);
      corners.set([a, b, c], 3 * face);
    }
    return corners;
  }

  /** PMESH-SWI-07. */
  #judgeWork(packet, corners, switchedWedges, offset) {
    let sum = 0;
    for (const list of [corners, switchedWedges]) {
      for (const wedge of list) if (wedge >= packet.startWedge) sum += packet.depths[wedge - packet.startWedge];
    }
    if (sum > 8 * packet.payloadBytes) refuse('SWITCH_WORK', offset);
  }

  /** PMESH-FACE-05: from which level on each face is there, and its corners as mapped at that level. */
  #introduce(packet, corners) {
    const { start, startWedge, startFace, vertices, leastLevel, collapse, vertexOf } = packet;
    const initial = corners.slice();
    const levels = new Uint32Array(packet.faces);
    const ends = new Uint32Array(vertices);
    let level = leastLevel;
    for (let face = 0; face < packet.faces; face += 1) {
      const met = meetingLevel(initial.subarray(3 * face, 3 * face + 3), packet);
      level = Math.max(level, met);
      levels[face] = level;
      ends[level - 1 - start] += 1;
      for (let slot = 3 * face; slot < 3 * face + 3; slot += 1) {
        let wedge = corners[slot];
        while (vertexOf(wedge) >= level) wedge = collapse[wedge - startWedge];
        initial[slot] = wedge;
      }
    }
    let sum = startFace;
    for (let vertex = 0; vertex < vertices; vertex += 1) {
      sum += ends[vertex];
      ends[vertex] = start + vertex + 1 >= leastLevel ? sum : startFace;
    }
    return { initial, faceEnds: { ends, levels } };
  }

  /** For each vertex the slots that switch to it: those of earlier faces, and those of the packet's own. */
  #switches(packet, corners, initial, levels, switched) {
    const { start, startWedge, startFace, vertices, vertexOf, collapse } = packet;
    const offsets = new Uint32Array(vertices + 1);
    const each = (visit) => {
      switched.slots.forEach((slot, place) => {
        let wedge = switched.wedges[place];
        for (; wedge >= startWedge; wedge = collapse[wedge - startWedge]) visit(slot, wedge);
      });
      corners.forEach((corner, slot) => {
        for (let wedge = corner; wedge !== initial[slot]; wedge = collapse[wedge - startWedge]) {
          visit(3 * startFace + slot, wedge);
        }
      });
    };
    each((slot, wedge) => {
      offsets[vertexOf(wedge) - start + 1] += 1;
    });
    for (let vertex = 0; vertex < vertices; vertex += 1) offsets[vertex + 1] += offsets[vertex];
    const total = offsets[vertices];
    const slots = new Uint32Array(total);
    const most = packet.wedgeCounts === null ? 1 : packet.wedgeCounts.reduce((a, b) => Math.max(a, b), 1);
    let places = null;
    if (most > 1) places = new (most <= 256 ? Uint8Array : most <= 65536 ? Uint16Array : Uint32Array)(total);
    const filled = offsets.slice();
    each((slot, wedge) => {
      const vertex = vertexOf(wedge);
      const at = filled[vertex - start];
      filled[vertex - start] += 1;
      slots[at] = slot;
      if (places !== null) places[at] = wedge - packet.firstWedge(vertex);
    });
    return { offsets, slots, places };
  }
}

/** PMESH-WDG-02: values of some numbers of binary32, which are finite. */
function readFloats(parts, values, size) {
  const at = parts.pass(4 * size * values);
  const numbers = new Float32Array(size * values);
  for (let number = 0; number < numbers.length; number += 1) {
    numbers[number] = parts.view.getFloat32(at + 4 * number, true);
    if (!Number.isFinite(numbers[number])) refuse('ATTRIBUTE', parts.offset + at + 4 * (number - (number % size)));
  }
  return numbers;
}

/** PMESH-COL-01: the parents of the vertices from B on. */
function readParents(packet, parts) {
  const bits = bitLength(packet.end - 1);
  const parents = new Uint32Array(packet.end - packet.firstSplit);
  const at = parts.pass(Math.ceil((parents.length * bits) / 8));
  for (let split = 0; split < parents.length; split += 1) {
    parents[split] = packedNumber(parts.payload, at, split * bits, bits);
    if (parents[split] >= packet.firstSplit + split) {
      refuse('PARENT', parts.offset + at + Math.floor((split * bits) / 8));
    }
  }
  judgeUnusedBits(parts.payload, at, parents.length * bits, parts.offset);
  return parents;
}

/** PMESH-WDG-01. */
function readWedgeCounts(packet, parts) {
  const counts = new Uint32Array(packet.vertices);
  let sum = 0;
  for (let vertex = 0; vertex < counts.length; vertex += 1) {
    const at = parts.at;
    counts[vertex] = parts.number();
    sum += counts[vertex];
    if (counts[vertex] === 0 || sum > packet.wedges) refuse('WEDGE_COUNT', parts.offset + at);
  }
  if (sum < packet.wedges) refuse('WEDGE_COUNT', parts.offset + parts.at);
  return counts;
}

/** The least level, but at least that of the packet, at which three corners lie on three vertices. Changes the corners. */
function meetingLevel(corners, packet) {
  const { leastLevel, startWedge, collapse, vertexOf } = packet;
  for (;;) {
    let last = 0;
    for (let corner = 1; corner < 3; corner += 1) if (corners[corner] > corners[last]) last = corner;
    const vertex = vertexOf(corners[last]);
    if (vertex < leastLevel) return leastLevel;
    corners[last] = collapse[corners[last] - startWedge];
    const onto = vertexOf(corners[last]);
    if (onto === vertexOf(corners[(last + 1) % 3]) || onto === vertexOf(corners[(last + 2) % 3])) return vertex + 1;
  }
}
