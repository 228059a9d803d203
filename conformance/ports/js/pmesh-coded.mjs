// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Packets of the mode `coded` (`spec/pmesh.md`, section 8).
 * @module
 */

import { refuse } from './errors.mjs';
import { Splits } from './pmesh-splits.mjs';
import { Symbols } from './pmesh-symbols.mjs';
import { SecondPass } from './pmesh-wedges.mjs';

/** Reads coded packets one after the other. Models are kept from packet to packet (PMESH-COD-04). */
export class CodedPackets {
  #splits;
  #secondPass;

  /**
   * @param {import('./pmesh.mjs').PmeshHeader} header the header
   * @param {import('./pmesh-lattice.mjs').Lattice | null} lattice that of the positions, null for binary32
   */
  constructor(header, lattice) {
    this.#splits = new Splits(header, lattice);
    this.#secondPass = header.attributeBits === 0 ? null : new SecondPass(header, this.#splits.vertices);
  }

  /**
   * Judges and reads a packet (section 8.1).
   * @param {number} index number of the packet
   * @param {{endVertex: number, endWedge: number, endFace: number}} before the entry of the packet before, or zeros
   * @param {import('./pmesh.mjs').PacketEntry} entry its entry
   * @param {Uint8Array} payload the payload
   * @param {number} offset where it lies in the file
   * @returns {import('./pmesh-mesh.mjs').PacketContents} what it brings
   * @throws {FormatError} the codes of section 8
   */
  read(index, before, entry, payload, offset) {
    const symbols = new Symbols(payload, offset);
    const start = before.endVertex;
    const startFace = before.endFace;
    const startWedge = before.endWedge;
    const packet = { index, start, startFace, startWedge, payload, offset, symbols };
    packet.end = entry.endVertex;
    packet.endFace = entry.endFace;
    packet.endWedge = entry.endWedge;
    this.#splits.read(packet);
    const rates = entry.endWedge - startWedge + entry.endFace - startFace;
    const least = Math.max(8 + Math.floor(rates / 4) + Math.floor(start / 64), Math.ceil(packet.work / 64));
    // Vertices of the packet that are in the base: they come with its faces and switch nothing.
    const base = packet.end - start - packet.parents.length;
    const values = this.#secondPass === null ? this.#plain(packet, base) : this.#secondPass.read(packet, base);
    symbols.judgeEnd(least);
    if (packet.infinite) refuse('POSITION', offset);
    const faceEnds = new Uint32Array(packet.end - start);
    const offsets = new Uint32Array(packet.end - start + 1);
    // The first of the offsets of faces is that behind the faces of the base.
    if (base > 0) faceEnds[base - 1] = packet.faceOffsets.array[0];
    for (let split = 0; split < packet.parents.length; split += 1) {
      faceEnds[base + split] = packet.faceOffsets.array[split + 1];
      offsets[base + split + 1] = packet.switchOffsets.array[split + 1];
    }
    const slots = packet.switchSlots.array.slice(0, packet.switchSlots.length);
    return {
      startVertex: start,
      positions: packet.positions.array.slice(0, packet.positions.length),
      faceEnds,
      ...values,
      switches: { offsets, slots, places: values.places },
    };
  }

  /** Without attributes every wedge is its vertex. */
  #plain(packet, base) {
    const wedgeCollapse = new Uint32Array(packet.end - packet.start);
    wedgeCollapse.set(packet.parents.array.subarray(0, packet.parents.length), base);
    return {
      wedgeCounts: null,
      wedgeCollapse,
      normals: null,
      uvs: null,
      colours: null,
      corners: packet.introduced.array.slice(0, packet.introduced.length),
      materials: null,
      places: null,
    };
  }
}
