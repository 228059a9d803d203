// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The chunks `LITE` and `META` of .ivg (`spec/ivg.md`, section 8).
 * @module
 */

import { refuse } from './errors.mjs';
import { isUtf8, textOf, viewOf } from './wire.mjs';

/** Walks over the lights of a judged payload. */
function* eachLight(payload) {
  const view = viewOf(payload);
  let at = 4;
  for (let light = view.getUint32(0, true); light > 0; light -= 1) {
    const length = view.getUint16(at + 2, true);
    yield { direct: (payload[at] & 1) === 1, nameBytes: payload.subarray(at + 4, at + 4 + length) };
    at += 4 + length;
  }
}

/**
 * Judges the payload of `LITE` (IVG-LITE-02).
 * @param {Uint8Array} payload the payload
 * @param {number} offset where it lies in the file
 * @throws {FormatError} LIGHTS, RESERVED
 */
export function judgeLights(payload, offset) {
  const view = viewOf(payload);
  const end = payload.length;
  const need = (upTo) => {
    if (upTo > end) refuse('LIGHTS', offset + end);
  };
  need(4);
  let at = 4;
  for (let light = view.getUint32(0, true); light > 0; light -= 1) {
    need(at + 2);
    if (payload[at] > 1 || payload[at + 1] !== 0) refuse('RESERVED', offset + at);
    need(at + 4);
    const name = at + 4;
    at = name + view.getUint16(at + 2, true);
    need(at);
    if (!isUtf8(payload.subarray(name, at))) refuse('LIGHTS', offset + name);
  }
  if (at < end) refuse('LIGHTS', offset + at);
}

/**
 * The lights of a judged payload (IVG-LITE-01). Names are untrusted text.
 * @param {Uint8Array} payload the payload of `LITE`
 * @returns {{direct: boolean, name: string, nameBytes: Uint8Array}[]} for each whether its direct light is in the grid
 *   too, and its name
 */
export function lightsOf(payload) {
  return Array.from(eachLight(payload), (light) => ({
    ...light,
    nameBytes: light.nameBytes.slice(),
    name: textOf(light.nameBytes),
  }));
}

function isKeyByte(byte) {
  return (byte >= 0x61 && byte <= 0x7a) || (byte >= 0x30 && byte <= 0x39) || byte === 0x2d || byte === 0x5f;
}

/**
 * Judges the payload of `META` (IVG-META-02).
 * @param {Uint8Array} payload the payload
 * @param {number} offset where it lies in the file
 * @throws {FormatError} METADATA
 */
export function judgeMetadata(payload, offset) {
  let at = 0;
  let good = isUtf8(payload);
  while (good && at < payload.length) {
    const key = at;
    while (at < payload.length && isKeyByte(payload[at])) at += 1;
    const end = payload.indexOf(0x0a, at);
    good = at > key && payload[at] === 0x3d && end >= 0;
    at = end + 1;
  }
  if (!good) refuse('METADATA', offset);
}

/**
 * The pairs of a judged payload (IVG-META-01). Values are untrusted text.
 * @param {Uint8Array} payload the payload of `META`
 * @returns {[string, string][]} keys and values, in order; keys may repeat
 */
export function metadataOf(payload) {
  const lines = textOf(payload).split('\n').slice(0, -1);
  return lines.map((line) => {
    const equals = line.indexOf('=');
    return [line.slice(0, equals), line.slice(equals + 1)];
  });
}
