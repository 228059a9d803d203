// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * What has arrived of a mesh, and the way from level to level (`spec/pmesh.md`, sections 1 and 9).
 * @module
 */

/** A typed array that grows. */
export class Column {
  #array;

  /** @param {Uint32ArrayConstructor} Type constructor of the typed array */
  constructor(Type) {
    this.#array = new Type(0);
    /** Numbers there are. */
    this.length = 0;
  }

  /** Makes room for more numbers, which are 0. Returns the array; older ones are void. */
  grow(count) {
    const length = this.length + count;
    if (length > this.#array.length) {
      const larger = new this.#array.constructor(Math.ceil(length * 1.25));
      larger.set(this.#array.subarray(0, this.length));
      this.#array = larger;
    }
    this.length = length;
    return this.#array;
  }

  /** Appends numbers. */
  append(numbers) {
    const at = this.length;
    this.grow(numbers.length).set(numbers, at);
  }

  /** The numbers in memory; there may be room behind them. */
  get array() {
    return this.#array;
  }
}

/**
 * What a packet brings, as `Mesh.append` takes it. Arrays that the file does not have are null.
 * @typedef {object} PacketContents
 * @property {number} startVertex vertices before it
 * @property {Float32Array} positions three numbers a vertex
 * @property {Uint32Array | null} wedgeCounts wedges of each vertex; null without seams
 * @property {Uint32Array} wedgeCollapse what each wedge becomes; without a meaning for wedges of the base
 * @property {Float32Array | null} normals three numbers a wedge
 * @property {Float32Array | null} uvs two numbers a wedge
 * @property {Uint8Array | null} colours four bytes a wedge
 * @property {Uint32Array} corners three wedges a face, as mapped at the level from which on the face is there
 * @property {Uint16Array | null} materials one number a face
 * @property {Uint32Array} faceEnds for each vertex v the faces that level v + 1 has
 * @property {{offsets: Uint32Array, slots: Uint32Array, places: Uint8Array | Uint16Array | Uint32Array | null}} switches
 *   for each vertex v, from offsets[v] to offsets[v + 1], the slots that switch to it, and which of its wedges they switch
 *   to; null: to its only one
 */

/** A mesh as far as it has arrived: all levels from that of the base to `finest`. */
export class Mesh {
  #positions = new Column(Float32Array);
  #firstWedges = new Column(Uint32Array);
  #wedgeVertices = new Column(Uint32Array);
  #wedgeCollapse = new Column(Uint32Array);
  #normals = new Column(Float32Array);
  #uvs = new Column(Float32Array);
  #colours = new Column(Uint8Array);
  #corners = new Column(Uint32Array);
  #materials = new Column(Uint16Array);
  #faceEnds = new Column(Uint32Array);
  #switches = [];

  /** @param {import('./pmesh.mjs').PmeshHeader} header the mesh's header */
  constructor(header) {
    /** The header. */
    this.header = header;
    /** The coarsest level, B. */
    this.coarsest = header.baseVertices;
    /** The finest level that is complete (PMESH-DIR-06), null while there is none. @type {number | null} */
    this.finest = header.vertexCount === 0 ? 0 : null;
    /** Wedges of the finest level. */
    this.wedges = 0;
    /** Packets taken in. */
    this.packets = 0;
  }

  /**
   * Takes in the next packet; for decoders.
   * @param {PacketContents} contents what it brings
   */
  append(contents) {
    const { wedgeCounts, switches } = contents;
    this.#positions.append(contents.positions);
    if (wedgeCounts !== null) {
      const vertices = this.#wedgeVertices.grow(contents.wedgeCollapse.length);
      const firsts = new Uint32Array(wedgeCounts.length);
      let wedge = this.wedges;
      wedgeCounts.forEach((count, vertex) => {
        firsts[vertex] = wedge;
        vertices.fill(contents.startVertex + vertex, wedge, wedge + count);
        wedge += count;
      });
      this.#firstWedges.append(firsts);
    }
    this.#wedgeCollapse.append(contents.wedgeCollapse);
    if (contents.normals !== null) this.#normals.append(contents.normals);
    if (contents.uvs !== null) this.#uvs.append(contents.uvs);
    if (contents.colours !== null) this.#colours.append(contents.colours);
    this.#corners.append(contents.corners);
    if (contents.materials !== null) this.#materials.append(contents.materials);
    this.#faceEnds.append(contents.faceEnds);
    this.#switches.push({ ...switches, start: contents.startVertex });
    this.wedges += contents.wedgeCollapse.length;
    this.finest = contents.startVertex + contents.faceEnds.length;
    this.packets += 1;
  }

  /** Faces of the finest level. */
  get faces() {
    return this.#corners.length / 3;
  }

  /** @param {number} vertex a vertex, or the number of vertices @returns {number} its first wedge */
  firstWedge(vertex) {
    if (!this.header.attributes.seams) return vertex;
    return vertex === this.finest ? this.wedges : this.#firstWedges.array[vertex];
  }

  /** @param {number} wedge a wedge @returns {number} its vertex */
  wedgeVertex(wedge) {
    return this.header.attributes.seams ? this.#wedgeVertices.array[wedge] : wedge;
  }

  /** @param {number} wedge a wedge of a vertex from B on @returns {number} what it becomes (PMESH-DEF-03) */
  wedgeCollapse(wedge) {
    return this.#wedgeCollapse.array[wedge];
  }

  /** @param {number} level a level @returns {number} how many faces it has */
  facesAt(level) {
    return level === 0 ? 0 : this.#faceEnds.array[level - 1];
  }

  /** The corners of all faces, each as mapped at the level from which on it is there. */
  get introducedCorners() {
    return this.#corners.array.subarray(0, this.#corners.length);
  }

  /** @returns {Replay} a new way through the levels, at the coarsest */
  replay() {
    if (this.finest === null) throw new RangeError('no level has arrived');
    return new Replay(this, this.#switches);
  }

  /**
   * The arrays of a level but its corners; no copies, and void after the next packet.
   * @param {number} level a level
   * @returns {object} as {@link Replay#goTo} says
   */
  arraysAt(level) {
    const { normals, uvs, colours, materials, seams } = this.header.attributes;
    const wedges = this.firstWedge(level);
    const faces = this.facesAt(level);
    const part = (column, length) => column.array.subarray(0, length);
    return {
      level,
      vertices: level,
      wedges,
      faces,
      positions: part(this.#positions, 3 * level),
      wedgeVertices: seams ? part(this.#wedgeVertices, wedges) : Uint32Array.from({ length: wedges }, (_, wedge) => wedge),
      normals: normals ? part(this.#normals, 3 * wedges) : null,
      uvs: uvs ? part(this.#uvs, 2 * wedges) : null,
      colours: colours ? part(this.#colours, 4 * wedges) : null,
      materials: materials ? part(this.#materials, faces) : null,
    };
  }
}

/**
 * A way through the levels of a mesh, up and down (PMESH-LVL-01). A step touches no more than the corners that switch
 * (PMESH-LVL-05). Packets that arrive meanwhile are there at the next call.
 */
export class Replay {
  #mesh;
  #switches;
  #corners = new Column(Uint32Array);
  #block = 0;

  constructor(mesh, switches) {
    this.#mesh = mesh;
    this.#switches = switches;
    /** The level shown. */
    this.level = mesh.coarsest;
  }

  /**
   * Goes to a level.
   * @param {number} level from the mesh's `coarsest` to its `finest`
   * @returns {{level: number, vertices: number, wedges: number, faces: number, positions: Float32Array,
   *   wedgeVertices: Uint32Array, normals: Float32Array | null, uvs: Float32Array | null, colours: Uint8Array | null,
   *   corners: Uint32Array, materials: Uint16Array | null}} the mesh at this level: stored positions in metres, to which
   *   the header's `origin` is to be added (PMESH-HDR-06), the vertex of each wedge, attributes of wedges, corners of
   *   faces, as wedges. The arrays are no copies: use them before the next step and the next packet.
   * @throws {RangeError} if the level is not there
   */
  goTo(level) {
    const mesh = this.#mesh;
    if (!(Number.isInteger(level) && level >= mesh.coarsest && level <= mesh.finest)) {
      throw new RangeError(`level ${level} is not there`);
    }
    const introduced = mesh.introducedCorners;
    this.#corners.append(introduced.subarray(this.#corners.length));
    while (this.level < level) this.#up(this.level);
    while (this.level > level) this.#down(this.level - 1);
    const arrays = mesh.arraysAt(level);
    return { ...arrays, corners: this.#corners.array.subarray(0, 3 * arrays.faces) };
  }

  /** The switches of the packet that brought a vertex. Steps go from one to the next. */
  #blockOf(vertex) {
    while (this.#switches[this.#block].start > vertex) this.#block -= 1;
    while (this.#block + 1 < this.#switches.length && this.#switches[this.#block + 1].start <= vertex) this.#block += 1;
    return this.#switches[this.#block];
  }

  #up(vertex) {
    const { start, offsets, slots, places } = this.#blockOf(vertex);
    const first = this.#mesh.firstWedge(vertex);
    const corners = this.#corners.array;
    for (let at = offsets[vertex - start]; at < offsets[vertex - start + 1]; at += 1) {
      corners[slots[at]] = places === null ? first : first + places[at];
    }
    this.level += 1;
  }

  #down(vertex) {
    const { start, offsets, slots } = this.#blockOf(vertex);
    const corners = this.#corners.array;
    for (let at = offsets[vertex - start]; at < offsets[vertex - start + 1]; at += 1) {
      corners[slots[at]] = this.#mesh.wedgeCollapse(corners[slots[at]]);
    }
    this.level -= 1;
  }
}
