// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Numbers and checksums that both formats share (`spec/common.md`, section 2).
 * @module
 */

const CRC_TABLE = new Uint32Array(256).map((_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit += 1) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc;
});

/**
 * CRC-32 of bytes (COM-CRC-01).
 * @param {Uint8Array} bytes the bytes, or the next piece of them
 * @param {number} [before] CRC-32 of the pieces before
 * @returns {number} the checksum, a u32
 */
export function crc32(bytes, before = 0) {
  let crc = ~before;
  for (let at = 0; at < bytes.length; at += 1) crc = (crc >>> 8) ^ CRC_TABLE[(crc ^ bytes[at]) & 0xff];
  return ~crc >>> 0;
}

/**
 * A view of the numbers in some bytes. All numbers are little-endian (COM-INT-01), so readers pass `true`.
 * @param {Uint8Array} bytes the bytes
 * @returns {DataView} a view of the same memory
 */
export function viewOf(bytes) {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

/** The high 32 bits of the product of two u32. */
function highProduct(a, b) {
  const a0 = a & 0xffff;
  const a1 = a >>> 16;
  const b0 = b & 0xffff;
  const b1 = b >>> 16;
  const middle = a1 * b0 + ((a0 * b0) >>> 16);
  const other = a0 * b1 + (middle & 0xffff);
  return a1 * b1 + (middle >>> 16) + (other >>> 16);
}

/**
 * The SplitMix64 generator (COM-INT-02). Its numbers of 64 bits are pairs of 32, which is many times faster than BigInt.
 */
export class SplitMix64 {
  /** @param {bigint} seed the seed, a u64 */
  constructor(seed) {
    this.seedHigh = Number(BigInt.asUintN(64, seed) >> 32n);
    this.seedLow = Number(BigInt.asUintN(32, seed));
    /** High 32 bits of the number that `at` made last. */
    this.high = 0;
    /** Low 32 bits of it. */
    this.low = 0;
  }

  /** Multiplies the current number by a constant, modulo 2^64. */
  #multiply(high, low) {
    const productHigh = highProduct(this.low, low) + Math.imul(this.high, low) + Math.imul(this.low, high);
    this.low = Math.imul(this.low, low) >>> 0;
    this.high = productHigh >>> 0;
  }

  /** z = z XOR (z >> count), for counts below 32. */
  #fold(count) {
    this.low = (this.low ^ ((this.low >>> count) | (this.high << (32 - count)))) >>> 0;
    this.high = (this.high ^ (this.high >>> count)) >>> 0;
  }

  /**
   * Output number n of the generator, to be read from `high` and `low`.
   * @param {number} nHigh high 32 bits of n
   * @param {number} nLow low 32 bits of n
   * @returns {this} the generator
   */
  at(nHigh, nLow) {
    this.low = (nLow + 1) >>> 0;
    this.high = (nHigh + (this.low === 0 ? 1 : 0)) >>> 0;
    this.#multiply(0x9e3779b9, 0x7f4a7c15);
    const sum = this.low + this.seedLow;
    this.high = (this.high + this.seedHigh + (sum > 0xffffffff ? 1 : 0)) >>> 0;
    this.low = sum >>> 0;
    this.#fold(30);
    this.#multiply(0xbf58476d, 0x1ce4e5b9);
    this.#fold(27);
    this.#multiply(0x94d049bb, 0x133111eb);
    this.#fold(31);
    return this;
  }
}

/**
 * Two to a whole power, exactly.
 * @param {number} exponent from -1022 to 1023
 * @returns {number} 2^exponent
 */
export function powerOfTwo(exponent) {
  const view = new DataView(new ArrayBuffer(8));
  view.setUint16(0, (exponent + 1023) << 4);
  return view.getFloat64(0);
}

/**
 * How many binary digits a number has.
 * @param {number} value a whole number from 0 to 2^53 - 1
 * @returns {number} 0 for 0, 1 for 1, 2 for 2 and 3 …
 */
export function bitLength(value) {
  if (value < 0x100000000) return 32 - Math.clz32(value);
  return 64 - Math.clz32(Math.floor(value / 0x100000000));
}

/**
 * Whether bytes are text in UTF-8 as in RFC 3629: no surrogates, nothing beyond U+10FFFF, shortest forms (COM-INT-01).
 * @param {Uint8Array} bytes the bytes
 * @returns {boolean} whether they are
 */
export function isUtf8(bytes) {
  let at = 0;
  while (at < bytes.length) {
    const first = bytes[at];
    at += 1;
    if (first < 0x80) continue;
    let more;
    // What the second byte may be: shortest forms, no surrogates, the end of Unicode.
    let least = 0x80;
    let most = 0xbf;
    if (first >= 0xc2 && first <= 0xdf) more = 1;
    else if (first >= 0xe0 && first <= 0xef) {
      more = 2;
      if (first === 0xe0) least = 0xa0;
      if (first === 0xed) most = 0x9f;
    } else if (first >= 0xf0 && first <= 0xf4) {
      more = 3;
      if (first === 0xf0) least = 0x90;
      if (first === 0xf4) most = 0x8f;
    } else return false;
    for (; more > 0; more -= 1) {
      if (at >= bytes.length || bytes[at] < least || bytes[at] > most) return false;
      at += 1;
      least = 0x80;
      most = 0xbf;
    }
  }
  return true;
}

/**
 * Text in UTF-8 as a string, a byte order mark included.
 * @param {Uint8Array} bytes the bytes
 * @returns {string} the text
 */
export function textOf(bytes) {
  return new TextDecoder('utf-8', { ignoreBOM: true }).decode(bytes);
}
