// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * A grid made of the events of an `IvgDecoder`: the newest of what came, in whatever order (`spec/ivg.md`, section 11).
 * @module
 */

/**
 * What is known of a grid. It keeps what came and nothing for vertices that did not; `received`, `validity` and `blocked`
 * make arrays of all vertices, so limit those first (IVG-LIM-01).
 */
export class IvgGrid {
  #records = new Map();

  /** @param {import('./ivg.mjs').IvgHeader} header the grid's header */
  constructor(header) {
    /** The header. */
    this.header = header;
    /** The lights, null while there is no `LITE`. */
    this.lights = null;
    /** The payload of `META`, null while there is none. */
    this.metadata = null;
  }

  /**
   * Takes in an event. A record replaces what it brought before if its generation is higher, and is ignored otherwise
   * (IVG-UPD-03).
   * @param {object} event any event of an `IvgDecoder`
   * @returns {boolean} whether it changed anything
   */
  take(event) {
    if (event.kind === 'lights') this.lights = event.lights();
    else if (event.kind === 'metadata') this.metadata = event.bytes.slice();
    else if (event.kind === 'vertices' || event.kind === 'validity') {
      const held = this.#records.get(event.id);
      if (held !== undefined && held.generation >= event.generation) return false;
      const record = { kind: event.kind, generation: event.generation };
      if (event.kind === 'vertices') {
        record.indices = event.indices();
        record.values = event.values();
      } else {
        record.first = event.first;
        record.validity = new Uint8Array(event.count).map((_, vertex) => event.validityOf(vertex));
        record.blocked = new Uint8Array(event.count).map((_, vertex) => event.blockedOf(vertex));
      }
      this.#records.set(event.id, record);
    } else return false;
    return true;
  }

  #of(kind) {
    return [...this.#records.values()].filter((record) => record.kind === kind);
  }

  /**
   * The light that arrived.
   * @returns {{indices: Float64Array, values: Float32Array}} linear indices, ascending, and the numbers of each vertex one
   *   behind the other, 54 or 27 of them (`header.numbers`)
   */
  light() {
    const records = this.#of('vertices');
    const total = records.reduce((sum, record) => sum + record.indices.length, 0);
    const indices = new Float64Array(total);
    const places = new Float64Array(total);
    const begins = [];
    let filled = 0;
    for (const record of records) {
      begins.push(filled);
      indices.set(record.indices, filled);
      filled += record.indices.length;
    }
    for (let at = 0; at < total; at += 1) places[at] = at;
    places.sort((a, b) => indices[a] - indices[b]);
    const all = new Float32Array(total * this.header.numbers);
    records.forEach((record, number) => all.set(record.values, begins[number] * this.header.numbers));
    const values = new Float32Array(all.length);
    places.forEach((place, at) => {
      const from = place * this.header.numbers;
      values.set(all.subarray(from, from + this.header.numbers), at * this.header.numbers);
    });
    return { indices: places.map((place) => indices[place]), values };
  }

  /** @returns {Uint8Array} by linear index: 1 if the vertex has arrived, else 0 */
  received() {
    const flags = new Uint8Array(this.header.vertices);
    for (const record of this.#of('vertices')) for (const index of record.indices) flags[index] = 1;
    return flags;
  }

  /** @returns {Uint8Array} by linear index the validity; 255 where nothing is known (IVG-VAL-01) */
  validity() {
    const validity = new Uint8Array(this.header.vertices).fill(255);
    for (const record of this.#of('validity')) validity.set(record.validity, record.first);
    return validity;
  }

  /** @returns {Uint8Array} by linear index bits 0, 1, 2 for blocked edges in +x, +y, +z; 0 where nothing is known */
  blocked() {
    const blocked = new Uint8Array(this.header.vertices);
    for (const record of this.#of('validity')) blocked.set(record.blocked, record.first);
    return blocked;
  }
}
