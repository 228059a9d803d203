// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Normals, texture coordinates and colours of coded packets (`spec/pmesh.md`, PMESH-COD-15 to -17).
 * @module
 */

import { refuse } from './errors.mjs';
import { addCross, axesOf, classOf, shiftTo } from './pmesh-cells.mjs';
import { Lattice } from './pmesh-lattice.mjs';
import { Column } from './pmesh-mesh.mjs';
import { BinaryModel, models, ResidualModels } from './pmesh-symbols.mjs';
import { bitLength } from './wire.mjs';

const BASE_CLASS = 12;
const HALF = 0x4000;

/**
 * A code of a normal, turned (PMESH-COD-16, 1).
 * @param {number[]} code u and v
 * @param {number} most M
 * @returns {number[]} the turned code
 */
export function turned([u, v], most) {
  return [(u < 0 ? -1 : 1) * (most - Math.abs(v)), (v < 0 ? -1 : 1) * (most - Math.abs(u))];
}

/**
 * The point of a code of a normal (PMESH-COD-16, 2).
 * @param {number[]} code u and v
 * @param {number} most M
 * @returns {number[]} three whole numbers
 */
export function pointOf(code, most) {
  const z = most - Math.abs(code[0]) - Math.abs(code[1]);
  return [...(z < 0 ? turned(code, most) : code), z];
}

/**
 * The normal of a code (PMESH-COD-16, 3).
 * @param {number[]} code u and v
 * @param {number} most M
 * @returns {number[]} x, y, z, each a number of binary32
 */
export function normalOf(code, most) {
  const point = pointOf(code, most);
  const length = Math.sqrt(point[0] ** 2 + point[1] ** 2 + point[2] ** 2);
  // Adding 0 makes +0 of -0, which products with signs may give.
  return point.map((number) => Math.fround((number + 0) / length));
}

/**
 * How the values of neighbours weigh (PMESH-COD-15, 2 to 4).
 * @param {ArrayLike<number>[]} cells their cells
 * @param {ArrayLike<number>} cell the cell of the vertex
 * @param {number[]} normal the sum of cross products around it
 * @returns {number[]} a weight for each
 */
export function weightsOf(cells, cell, normal) {
  const k = cells.length;
  const axes = axesOf(normal).slice(0, 2);
  const numbers = [];
  const means = axes.map((axis) => Math.floor((2 * cells.reduce((sum, other) => sum + other[axis], 0) + k) / (2 * k)));
  for (const other of [...cells, cell]) axes.forEach((axis, place) => numbers.push(other[axis] - means[place]));
  const shifted = shiftTo(numbers, 8);
  const [X, Y] = shifted.slice(2 * k);
  let [a, b, c] = [0, 0, 0];
  for (let at = 0; at < 2 * k; at += 2) {
    const [x, y] = [shifted[at], shifted[at + 1]];
    a += x * x;
    b += x * y;
    c += y * y;
  }
  const divisor = a * c - b * b;
  const none = new Array(k).fill(0);
  if (divisor === 0) return none;
  const weights = none.map((_, place) => {
    const [x, y] = [shifted[2 * place], shifted[2 * place + 1]];
    return Math.floor((1024 * (x * (c * X - b * Y) + y * (a * Y - b * X))) / divisor);
  });
  return weights.reduce((sum, weight) => sum + Math.abs(weight), 0) > 2048 ? none : weights;
}

/**
 * The number expected where the neighbours have some (PMESH-COD-15, 5).
 * @param {number[]} numbers those of the neighbours
 * @param {number[]} weights their weights
 * @returns {number} the number
 */
export function expectedOf(numbers, weights) {
  const k = numbers.length;
  const mean = Math.floor((2 * numbers.reduce((sum, number) => sum + number, 0) + k) / (2 * k));
  const weighed = numbers.reduce((sum, number, place) => sum + weights[place] * (number - mean), 0);
  return mean + Math.floor((weighed + 512) / 1024);
}

function clamp(number, most) {
  return Math.min(Math.max(number, 0), most);
}

/** One kind of values: what wedges have, their classes, and the models. */
class Kind {
  /** @param {number} size numbers of a value @param {number} sets sets of models of residuals */
  constructor(size, sets) {
    this.size = size;
    this.numbers = new Column(Int32Array);
    this.classes = new Column(Uint8Array);
    this.exact = models(16, () => new BinaryModel(HALF));
    this.residuals = models(sets, () => new ResidualModels(false));
  }

  /** @returns {number[]} the value of a wedge */
  value(wedge) {
    return Array.from(this.numbers.array.subarray(wedge * this.size, (wedge + 1) * this.size));
  }

  add(value, valueClass) {
    this.numbers.append(value);
    this.classes.append([valueClass]);
  }
}

/** The values of all wedges, and their models. */
export class WedgeValues {
  #normals;
  #uvs;
  #colours;
  #most;
  #lattice;
  #taken;

  /** @param {import('./pmesh.mjs').PmeshHeader} header the header */
  constructor(header) {
    const { normals, uvs, colours } = header.attributes;
    this.#normals = normals ? new Kind(2, 1) : null;
    this.#uvs = uvs ? new Kind(2, 1) : null;
    this.#colours = colours ? new Kind(4, 3) : null;
    this.#most = 2 ** (header.normalBits - 1) - 1;
    this.#lattice = uvs ? new Lattice(header.uvMin, header.uvMax, header.uvBits) : null;
  }

  /** Begins a packet. */
  begin() {
    this.#taken = {
      normals: new Column(Float32Array),
      uvs: new Column(Float32Array),
      colours: new Column(Uint8Array),
    };
  }

  /** @returns {{normals: Float32Array | null, uvs: Float32Array | null, colours: Uint8Array | null}} those of the packet */
  taken() {
    const of = (kind, column) => (kind === null ? null : column.array.slice(0, column.length));
    return {
      normals: of(this.#normals, this.#taken.normals),
      uvs: of(this.#uvs, this.#taken.uvs),
      colours: of(this.#colours, this.#taken.colours),
    };
  }

  /** PMESH-COD-17, 3: judges and adds a normal. */
  #addNormal(code, turn, valueClass, offset) {
    if (code.some((number) => Math.abs(number) > this.#most)) refuse('ATTRIBUTE', offset);
    const value = turn ? turned(code, this.#most) : code;
    this.#normals.add(value, valueClass);
    this.#taken.normals.append(normalOf(value, this.#most));
  }

  #addUv(point, valueClass, offset) {
    const { greatest } = this.#lattice;
    if (point.some((number, axis) => number < 0 || number > greatest[axis])) refuse('ATTRIBUTE', offset);
    const uv = point.map((number, axis) => this.#lattice.coordinate(axis, number));
    if (!uv.every(Number.isFinite)) refuse('ATTRIBUTE', offset);
    this.#uvs.add(point, valueClass);
    this.#taken.uvs.append(uv);
  }

  #addColour(colour, valueClass, offset) {
    if (colour.some((number) => number < 0 || number > 255)) refuse('ATTRIBUTE', offset);
    this.#colours.add(colour, valueClass);
    this.#taken.colours.append(colour);
  }

  /** PMESH-COD-13, 3 of the base: the values of the next wedge as raw numbers. */
  readBase(symbols, offset) {
    if (this.#normals !== null) {
      const bits = bitLength(2 * this.#most);
      const code = [symbols.raw(bits) - this.#most, symbols.raw(bits) - this.#most];
      this.#addNormal(code, false, BASE_CLASS, offset);
    }
    if (this.#uvs !== null) {
      const point = this.#lattice.greatest.map((greatest) => symbols.raw(bitLength(greatest)));
      this.#addUv(point, BASE_CLASS, offset);
    }
    if (this.#colours !== null) {
      this.#addColour([symbols.raw(8), symbols.raw(8), symbols.raw(8), symbols.raw(8)], BASE_CLASS, offset);
    }
  }

  /**
   * Reads the values of the next wedge.
   * @param {import('./pmesh-symbols.mjs').Symbols} symbols the symbols
   * @param {number} offset where the payload lies in the file
   * @param {number[][]} around for each of the first 16 slots of its vertex that have it, the two wedges that follow
   * @param {number} target the wedge that it becomes
   * @param {ArrayLike<number>} cell the cell of its vertex
   * @param {(wedge: number) => ArrayLike<number>} cellOf the cell of another wedge's vertex
   * @throws {FormatError} ATTRIBUTE
   */
  read(symbols, offset, around, target, cell, cellOf) {
    const normal = [0, 0, 0];
    for (const [out, back] of around) addCross(normal, cell, cellOf(out), cellOf(back));
    const neighbours = around.length > 0 ? around.flat() : [target];
    const weights = weightsOf(neighbours.map(cellOf), cell, normal);
    if (this.#normals !== null) {
      this.#readKind(this.#normals, symbols, neighbours, target, (values, residual, exact) => {
        let code = this.#expectedNormal(values, weights, target);
        // Turned there and back even without a residual: on the rim that may be another code (PMESH-COD-16, 5).
        const turn = Math.abs(code[0]) + Math.abs(code[1]) > this.#most;
        if (turn) code = turned(code, this.#most);
        if (!exact) code = code.map((number) => (number + residual(0)) | 0);
        return (valueClass) => this.#addNormal(code, turn, valueClass, offset);
      });
    }
    if (this.#uvs !== null) {
      this.#readKind(this.#uvs, symbols, neighbours, target, (values, residual, exact) => {
        const point = this.#lattice.greatest.map((greatest, axis) => {
          const expected = clamp(expectedOf(values.map((value) => value[axis]), weights), greatest);
          return exact ? expected : (expected + residual(0)) | 0;
        });
        return (valueClass) => this.#addUv(point, valueClass, offset);
      });
    }
    if (this.#colours !== null) {
      this.#readKind(this.#colours, symbols, neighbours, target, (values, residual, exact) => {
        const colour = [0, 1, 2, 3].map((part) => clamp(expectedOf(values.map((value) => value[part]), weights), 255));
        if (!exact) {
          const green = residual(0);
          const [red, blue, alpha] = [residual(1), residual(1), residual(2)];
          const off = [red + green, green, blue + green, alpha];
          off.forEach((number, part) => {
            colour[part] = (colour[part] + number) | 0;
          });
        }
        return (valueClass) => this.#addColour(colour, valueClass, offset);
      });
    }
  }

  /** PMESH-COD-17: what is alike for all kinds. `make` gives a function that adds the value with its class. */
  #readKind(kind, symbols, neighbours, target, make) {
    const classes = kind.classes.array;
    const mean = Math.floor(neighbours.reduce((sum, wedge) => sum + classes[wedge], 0) / neighbours.length);
    const values = neighbours.map((wedge) => kind.value(wedge));
    const alike = values.every((value) => value.every((number, part) => number === values[0][part]));
    const exact = symbols.binary(kind.exact[2 * Math.min(Math.floor(mean / 4), 7) + (alike ? 1 : 0)]);
    let total = 0;
    const residual = (set) => {
      const number = symbols.residual(kind.residuals[set], mean);
      total += Math.abs(number);
      return number;
    };
    const add = make(values, residual, exact);
    const valueClass = classOf(1 + total) % 256;
    add(valueClass);
    const after = kind.classes.array;
    after[target] = Math.floor((valueClass + after[target]) / 2);
  }

  /** PMESH-COD-16, 4. */
  #expectedNormal(codes, weights, target) {
    const most = this.#most;
    const points = codes.map((code) => pointOf(code, most));
    const [x, y, z] = [0, 1, 2].map((axis) => expectedOf(points.map((point) => 16 * point[axis]), weights));
    const sum = Math.abs(x) + Math.abs(y) + Math.abs(z);
    if (sum === 0) return this.#normals.value(target);
    const code = [x, y].map((number) => Math.floor((2 * number * most + sum) / (2 * sum)));
    return z < 0 ? turned(code, most) : code;
  }
}
