// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The encodings of .ivg vertices: what is forbidden in them, and their numbers bit by bit (`spec/ivg.md`, section 6).
 * @module
 */

import { refuse } from './errors.mjs';
import { powerOfTwo, viewOf } from './wire.mjs';

/**
 * The encodings by their id: name, bytes a vertex, numbers a vertex (54 of vectors, 27 of harmonics).
 * @type {Readonly<Record<number, {name: string, bytes: number, numbers: number}>>}
 */
export const ENCODINGS = Object.freeze({
  1: { name: 'packed-oct24', bytes: 42, numbers: 54 },
  2: { name: 'packed-xyz24', bytes: 42, numbers: 54 },
  3: { name: 'pair-f16', bytes: 72, numbers: 54 },
  4: { name: 'pair-f16x4', bytes: 96, numbers: 54 },
  5: { name: 'pair-f32', bytes: 144, numbers: 54 },
  6: { name: 'vectors-f32', bytes: 216, numbers: 54 },
  7: { name: 'sh2-28', bytes: 28, numbers: 27 },
});

const HEMISPHERES = 6;

/** IVG-SH-05: K for coefficients 1 to 8; for number 6 the K of codes from 0 on. */
const RATIO_K = Float32Array.of(...floats(0x3c5f72bd, 0x3c5f72bd, 0x3c5f72bd, 0x3c79d29b, 0x3c79d29b, 0x3c903c35, 0x3c79d29b, 0x3c79d29b));
const [RATIO_K6_NEGATIVE] = floats(0x3c103c35);

function floats(...bits) {
  return new Float32Array(Uint32Array.from(bits).buffer);
}

/**
 * A component of a colour in RGB9E5 (IVG-RGB-01, -02); exact.
 * @param {number} code the colour's code, a u32
 * @param {number} channel 0 red, 1 green, 2 blue
 * @param {number} [scaleExponent] the file's scale exponent
 * @returns {number} the component
 */
export function rgb9e5(code, channel, scaleExponent = 0) {
  return ((code >>> (9 * channel)) & 0x1ff) * powerOfTwo((code >>> 27) - 24 + scaleExponent);
}

/** Writes a point divided by its length, each component rounded to binary32 (IVG-DIR-03, IVG-XYZ-03). */
function writeDirection(into, at, x, y, z) {
  const length = Math.sqrt(x * x + y * y + z * z);
  // Adding 0 makes +0 of -0, which products with signs may give.
  into[at] = (x + 0) / length;
  into[at + 1] = (y + 0) / length;
  into[at + 2] = (z + 0) / length;
}

/**
 * The direction of a code of `packed-oct24` (IVG-DIR-01, -03).
 * @param {number} code 24 bits, neither half of which is 4095
 * @param {Float32Array} into receives x, y, z
 * @param {number} [at] where
 */
export function directionOct24(code, into, at = 0) {
  const u = (code & 0xfff) - 2047;
  const v = (code >>> 12) - 2047;
  const z = 2047 - Math.abs(u) - Math.abs(v);
  if (z >= 0) writeDirection(into, at, u, v, z);
  else writeDirection(into, at, (2047 - Math.abs(v)) * Math.sign(u), (2047 - Math.abs(u)) * Math.sign(v), z);
}

/**
 * The direction of a code of `packed-xyz24` (IVG-XYZ-03).
 * @param {number} x from -127 to 127, as y and z; not all 0
 * @param {number} y along y
 * @param {number} z along z
 * @param {Float32Array} into receives the direction
 * @param {number} [at] where
 */
export function directionXyz24(x, y, z, into, at = 0) {
  writeDirection(into, at, x, y, z);
}

/**
 * A number of binary16 (IVG-PAIR-01).
 * @param {number} code its 16 bits
 * @returns {number} its value, exactly
 */
export function half(code) {
  const exponent = (code >>> 10) & 0x1f;
  const mantissa = code & 0x3ff;
  const sign = code & 0x8000 ? -1 : 1;
  if (exponent === 31) return mantissa === 0 ? sign * Infinity : NaN;
  if (exponent === 0) return sign * mantissa * powerOfTwo(-24);
  return sign * (1024 + mantissa) * powerOfTwo(exponent - 25);
}

/** The layout of the encodings with a direction and a colour in floating point (IVG-PAIR-01). */
function pairLayout(encoding, view) {
  const bytes = encoding === 5 ? 4 : 2;
  const components = encoding === 4 ? 4 : 3;
  const read = encoding === 5 ? (at) => view.getFloat32(at, true) : (at) => half(view.getUint16(at, true));
  return { bytes, components, read };
}

/** IVG-PAIR-02 to -04: all numbers of a payload in stored order. */
function judgePairs(encoding, scale, payload, count, offset) {
  const view = viewOf(payload);
  const { bytes, components, read } = pairLayout(encoding, view);
  const half1 = count * HEMISPHERES * components;
  for (let number = 0; number < 2 * half1; number += 1) {
    const at = number * bytes;
    if (number % components === 3) {
      if (view.getUint16(at, true) !== 0) refuse('RESERVED', offset + at);
      continue;
    }
    const value = read(at);
    if (number < half1) {
      if (!(value >= 0 && Number.isFinite(value) && Number.isFinite(Math.fround(value * scale)))) {
        refuse('PAIR_COLOUR', offset + at);
      }
    } else if (!(value >= -1 && value <= 1)) refuse('PAIR_DIRECTION', offset + at);
  }
}

/**
 * Judges the values of vertices.
 * @param {number} encoding id of the encoding
 * @param {number} scaleExponent the file's scale exponent
 * @param {Uint8Array} payload the values, without a list of vertices before them
 * @param {number} count number of vertices
 * @param {number} offset where the payload lies in the file
 * @throws {FormatError} DIRECTION_CODE (IVG-DIR-02, IVG-XYZ-02), PAIR_COLOUR, PAIR_DIRECTION, RESERVED (IVG-PAIR-02 to
 *   -04), NOT_FINITE (IVG-VEC-02), RATIO_CODE (IVG-SH-04)
 */
export function judgeValues(encoding, scaleExponent, payload, count, offset) {
  const scale = powerOfTwo(scaleExponent);
  const codes = count * HEMISPHERES;
  if (encoding === 1) {
    for (let at = codes * 4; at < codes * 7; at += 3) {
      const code = payload[at] | (payload[at + 1] << 8) | (payload[at + 2] << 16);
      if ((code & 0xfff) === 0xfff || code >>> 12 === 0xfff) refuse('DIRECTION_CODE', offset + at);
    }
  } else if (encoding === 2) {
    for (let at = codes * 4; at < codes * 7; at += 3) {
      const [x, y, z] = [payload[at], payload[at + 1], payload[at + 2]];
      if (x === 0x80 || y === 0x80 || z === 0x80 || (x | y | z) === 0) refuse('DIRECTION_CODE', offset + at);
    }
  } else if (encoding <= 5) {
    judgePairs(encoding, scale, payload, count, offset);
  } else if (encoding === 6) {
    const view = viewOf(payload);
    for (let at = 0; at < count * 216; at += 4) {
      const value = view.getFloat32(at, true);
      if (!Number.isFinite(value) || !Number.isFinite(Math.fround(value * scale))) refuse('NOT_FINITE', offset + at);
    }
  } else {
    for (let at = count * 4; at < count * 28; at += 1) if (payload[at] === 0x80) refuse('RATIO_CODE', offset + at);
  }
}

/** IVG-SH-02, -05. */
function harmonics(scaleExponent, view, count, into) {
  for (let vertex = 0; vertex < count; vertex += 1) {
    const code = view.getUint32(vertex * 4, true);
    for (let channel = 0; channel < 3; channel += 1) {
      const at = vertex * 27 + channel * 9;
      const first = rgb9e5(code, channel, scaleExponent);
      into[at] = first;
      for (let k = 1; k <= 8; k += 1) {
        const ratio = view.getInt8(count * 4 + vertex * 24 + channel * 8 + k - 1);
        const factor = k === 6 && ratio < 0 ? RATIO_K6_NEGATIVE : RATIO_K[k - 1];
        into[at + k] = first * Math.fround(ratio * factor);
      }
    }
  }
}

/**
 * The numbers of vertices that have been judged (IVG-ENC-03), the same bits in every reader.
 * @param {number} encoding id of the encoding
 * @param {number} scaleExponent the file's scale exponent
 * @param {Uint8Array} payload the values, without a list of vertices before them
 * @param {number} count number of vertices
 * @returns {Float32Array} for each vertex 6 hemispheres × 3 channels × 3 coordinates of irradiance vectors in W/m² or
 *   lux, or 3 channels × 9 coefficients of the radiance in W/(m² sr) or cd/m²
 */
export function decodeValues(encoding, scaleExponent, payload, count) {
  const view = viewOf(payload);
  const values = new Float32Array(count * ENCODINGS[encoding].numbers);
  const scale = powerOfTwo(scaleExponent);
  if (encoding === 7) {
    harmonics(scaleExponent, view, count, values);
    return values;
  }
  if (encoding === 6) {
    for (let number = 0; number < values.length; number += 1) values[number] = view.getFloat32(number * 4, true) * scale;
    return values;
  }
  const codes = count * HEMISPHERES;
  const direction = new Float32Array(3);
  const colour = new Float32Array(3);
  const pair = encoding >= 3 ? pairLayout(encoding, view) : null;
  for (let code = 0; code < codes; code += 1) {
    if (pair !== null) {
      for (let k = 0; k < 3; k += 1) {
        // Adding 0 reads -0 as +0 (IVG-PAIR-02).
        colour[k] = pair.read((code * pair.components + k) * pair.bytes) * scale + 0;
        direction[k] = pair.read(((codes + code) * pair.components + k) * pair.bytes);
      }
    } else {
      const bits = view.getUint32(code * 4, true);
      for (let k = 0; k < 3; k += 1) colour[k] = rgb9e5(bits, k, scaleExponent);
      const at = codes * 4 + code * 3;
      if (encoding === 1) directionOct24(view.getUint16(at, true) | (payload[at + 2] << 16), direction);
      else directionXyz24(view.getInt8(at), view.getInt8(at + 1), view.getInt8(at + 2), direction);
    }
    // A product of two numbers of binary32 is exact in binary64: storing it rounds once (IVG-PACK-05, IVG-PAIR-05).
    for (let channel = 0; channel < 3; channel += 1) {
      for (let axis = 0; axis < 3; axis += 1) values[code * 9 + channel * 3 + axis] = colour[channel] * direction[axis];
    }
  }
  return values;
}
