// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Symbols, raw bits and models of coded packets (`spec/pmesh.md`, section 8.2).
 * @module
 */

import { refuse } from './errors.mjs';
import { HEIGHT_STARTS, SURFACE_STARTS } from './pmesh-starts.mjs';
import { viewOf } from './wire.mjs';

const PROBABILITIES = 0x8000;
const FINAL_STATE = 0x10000;

/** PMESH-COD-04: the shares r of a binary model, by the number of values seen. */
const RATES = Uint32Array.from({ length: 61 }, (_, seen) => Math.floor(655360 / (10 * seen + 16)));

/** A binary model (PMESH-COD-04). */
export class BinaryModel {
  /** @param {number} first first probability of true, of 2^15 */
  constructor(first) {
    this.probability = first;
    this.seen = 0;
  }

  /** Learns a value. */
  learn(value) {
    const target = value ? PROBABILITIES - 32 : 32;
    // The product has 31 bits and a sign; >> is ⌊ / 2^16⌋.
    this.probability += ((target - this.probability) * RATES[this.seen]) >> 16;
    if (this.seen < 60) this.seen += 1;
  }
}

/** A model of 16 symbols (PMESH-COD-04). */
export class SymbolModel {
  /** @param {number[]} starts first starts 1 to 15 */
  constructor(starts) {
    this.starts = Int32Array.of(0, ...starts, PROBABILITIES);
    this.seen = 0;
  }

  /** Learns a symbol. */
  learn(symbol) {
    const shift = this.seen < 20 ? 4 : this.seen < 80 ? 5 : 6;
    for (let i = 1; i <= 15; i += 1) {
      const target = i <= symbol ? 8 * i : PROBABILITIES - 8 * (16 - i);
      this.starts[i] += (target - this.starts[i]) >> shift;
    }
    if (this.seen < 80) this.seen += 1;
  }
}

/**
 * Models of the same kind.
 * @param {number} count how many
 * @param {(index: number) => object} make makes the model of an index
 * @returns {object[]} the models
 */
export function models(count, make) {
  return Array.from({ length: count }, (_, index) => make(index));
}

/** The models of residuals of one kind (PMESH-COD-10): classes 0 to 23; greater ones, whose low bits are raw, share the last 4. */
export class ResidualModels {
  /** @param {boolean} surface first starts along the surface; otherwise those of heights */
  constructor(surface) {
    this.models = (surface ? SURFACE_STARTS : HEIGHT_STARTS).map((starts) => new SymbolModel(starts));
  }
}

/** The symbols and raw bits of a payload (PMESH-COD-02). */
export class Symbols {
  #payload;
  #offset;
  #x;
  #y;
  #word = 8;
  #rawBits = 0;

  /**
   * @param {Uint8Array} payload the payload
   * @param {number} offset where it lies in the file
   * @throws {FormatError} CODED_LENGTH if it is shorter than the states (PMESH-COD-03, 1)
   */
  constructor(payload, offset) {
    if (payload.length < 8) refuse('CODED_LENGTH', offset);
    this.#payload = payload;
    this.#offset = offset;
    this.#x = viewOf(payload).getUint32(0, true);
    this.#y = viewOf(payload).getUint32(4, true);
  }

  /** Takes the symbol with the range [start, start + range) off the state. */
  #take(start, range) {
    const x = (range * (this.#x >>> 15) + (this.#x & 0x7fff) - start) >>> 0;
    this.#x = this.#y;
    this.#y = x < 0x10000 ? ((x << 16) | this.#nextWord()) >>> 0 : x;
  }

  #nextWord() {
    const at = this.#word;
    this.#word += 2;
    return at + 2 <= this.#payload.length ? this.#payload[at] | (this.#payload[at + 1] << 8) : 0;
  }

  /** @param {BinaryModel} model a model, which learns @returns {boolean} the next value */
  binary(model) {
    const { probability } = model;
    const value = (this.#x & 0x7fff) < probability;
    this.#take(value ? 0 : probability, value ? probability : PROBABILITIES - probability);
    model.learn(value);
    return value;
  }

  /** @param {SymbolModel} model a model, which learns @returns {number} the next symbol, 0 to 15 */
  symbol(model) {
    const { starts } = model;
    const low = this.#x & 0x7fff;
    let symbol = 0;
    while (starts[symbol + 1] <= low) symbol += 1;
    this.#take(starts[symbol], starts[symbol + 1] - starts[symbol]);
    model.learn(symbol);
    return symbol;
  }

  /** @param {number} count bits, at most 32 @returns {number} the next raw number */
  raw(count) {
    const payload = this.#payload;
    let value = 0;
    for (let done = 0; done < count; ) {
      const bit = this.#rawBits + done;
      const from = bit % 8;
      const taken = Math.min(8 - from, count - done);
      const at = payload.length - 1 - Math.floor(bit / 8);
      const byte = at >= 0 ? payload[at] : 0;
      value += ((byte >>> from) & ((1 << taken) - 1)) * 2 ** done;
      done += taken;
    }
    this.#rawBits += count;
    return value;
  }

  /**
   * A symbol of which 15 stands for 15 and more (PMESH-COD-09).
   * @param {SymbolModel} model a model, which learns
   * @returns {number} the number
   */
  count(model) {
    const symbol = this.symbol(model);
    return symbol < 15 ? symbol : 15 + this.raw(5);
  }

  /**
   * A residual (PMESH-COD-10).
   * @param {ResidualModels} residuals models of its kind
   * @param {number} residualClass its class
   * @returns {number} the residual, of 32 bits
   */
  residual(residuals, residualClass) {
    const shift = Math.max(Math.floor(residualClass / 4) - 5, 0);
    const symbol = this.symbol(residuals.models[shift === 0 ? residualClass : 20 + (residualClass % 4)]);
    let magnitude = symbol;
    if (symbol === 14) magnitude = 128 + this.raw(7);
    else if (symbol === 15) {
      const bits = Math.min(this.raw(5), 27);
      magnitude = 2 ** bits + this.raw(bits);
    } else if (symbol >= 4) {
      const bits = Math.floor(symbol / 2) - 1;
      magnitude = (2 + (symbol % 2)) * 2 ** bits + this.raw(bits);
    }
    const low = this.raw(shift);
    const high = magnitude !== 0 && this.raw(1) === 1 ? -magnitude : magnitude;
    return (Math.imul(high, 2 ** shift) + low - Math.floor(2 ** shift / 2)) | 0;
  }

  #rawBytes() {
    return Math.ceil(this.#rawBits / 8);
  }

  /** PMESH-COD-03, 2: what has been read is no more than the payload. */
  judgeLength() {
    if (this.#word + this.#rawBytes() > this.#payload.length) refuse('CODED_LENGTH', this.#offset);
  }

  /**
   * The end of the payload (PMESH-COD-03, 2 to 5).
   * @param {number} least the length that PMESH-COD-12 demands
   * @throws {FormatError} CODED_LENGTH, CODED_PADDING
   */
  judgeEnd(least) {
    const payload = this.#payload;
    this.judgeLength();
    if (this.#x !== FINAL_STATE || this.#y !== FINAL_STATE) refuse('CODED_LENGTH', this.#offset);
    const rawAt = payload.length - this.#rawBytes();
    if (payload.length > least && this.#word < rawAt) refuse('CODED_LENGTH', this.#offset + this.#word);
    for (let at = this.#word; at < rawAt; at += 1) {
      if (payload[at] !== 0) refuse('CODED_PADDING', this.#offset + this.#word);
    }
    const used = this.#rawBits % 8;
    if (used !== 0 && payload[rawAt] >>> used !== 0) refuse('CODED_PADDING', this.#offset + this.#word);
  }
}
