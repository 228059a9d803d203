// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Points of a lattice in a box (`spec/pmesh.md`, PMESH-POS-03): quantised positions and texture coordinates.
 * @module
 */

/** A lattice of 2^bits points along the longest side of a box. */
export class Lattice {
  /**
   * @param {number[]} least the box's least coordinates
   * @param {number[]} most its greatest coordinates
   * @param {number} bits bits along the longest side
   */
  constructor(least, most, bits) {
    const all = 2 ** bits - 1;
    const sides = least.map((number, axis) => most[axis] - number);
    this.least = least;
    /** Distance of neighbouring points. */
    this.step = Math.max(...sides) / all;
    /** The greatest number along each axis (PMESH-POS-04). */
    this.greatest = sides.map((side) => (this.step === 0 ? 0 : Math.min(all, Math.floor(side / this.step + 0.5))));
  }

  /**
   * @param {number} axis number of an axis
   * @param {number} number the point's number along it
   * @returns {number} its coordinate, rounded to binary32; infinite if that has none
   */
  coordinate(axis, number) {
    return Math.fround(this.least[axis] + number * this.step);
  }
}
