// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * Which corners of earlier faces a raw packet switches, and to which wedges (`spec/pmesh.md`, section 7).
 * @module
 */

import { refuse } from './errors.mjs';
import { judgeUnusedBits, packedNumber } from './pmesh-raw.mjs';
import { bitLength } from './wire.mjs';

/** PMESH-SWI-05: the smallest number of low bits for which the two parts are shortest. */
function lowBits(count, slots) {
  let best = 0;
  let least = Infinity;
  for (let bits = 0; bits <= 32; bits += 1) {
    const total = count * bits + count + Math.floor((slots - 1) / 2 ** bits);
    if (total < least) {
      best = bits;
      least = total;
    }
  }
  return best;
}

/** PMESH-SWI-05: the slots, in the form of Elias and Fano. */
function readSlots(count, slotCount, parts) {
  const { payload, offset } = parts;
  const low = lowBits(count, slotCount);
  const lowAt = parts.at;
  const highAt = lowAt + Math.ceil((count * low) / 8);
  const highBits = count + Math.floor((slotCount - 1) / 2 ** low);
  const end = highAt + Math.ceil(highBits / 8);
  if (end > payload.length) refuse('PACKET_LENGTH', offset + lowAt);
  const slots = new Uint32Array(count);
  let found = 0;
  for (let bit = 0; bit < highBits; bit += 1) {
    if (((payload[highAt + Math.floor(bit / 8)] >>> (bit % 8)) & 1) === 0) continue;
    if (found === count) refuse('SWITCH_SLOTS', offset + lowAt);
    const slot = (bit - found) * 2 ** low + packedNumber(payload, lowAt, found * low, low);
    if (slot >= slotCount || (found > 0 && slot <= slots[found - 1])) refuse('SWITCH_SLOTS', offset + lowAt);
    slots[found] = slot;
    found += 1;
  }
  if (found < count) refuse('SWITCH_SLOTS', offset + lowAt);
  judgeUnusedBits(payload, lowAt, count * low, offset);
  judgeUnusedBits(payload, highAt, highBits, offset);
  parts.at = end;
  return slots;
}

/**
 * The wedges of a packet by the wedge of an earlier packet from which they descend (PMESH-SWI-04): `groups` has the
 * number of each group, which holds the wedges from `begins[group]` to `begins[group + 1]` of `wedges`, ascending.
 */
function descendants(packet) {
  const { startWedge, collapse } = packet;
  const roots = new Uint32Array(collapse.length);
  const groups = new Map();
  const counts = new Uint32Array(collapse.length + 1);
  collapse.forEach((target, wedge) => {
    roots[wedge] = target < startWedge ? target : roots[target - startWedge];
    if (!groups.has(roots[wedge])) groups.set(roots[wedge], groups.size);
    counts[groups.get(roots[wedge]) + 1] += 1;
  });
  const begins = counts;
  for (let group = 0; group < groups.size; group += 1) begins[group + 1] += begins[group];
  const filled = begins.slice();
  const wedges = new Uint32Array(collapse.length);
  roots.forEach((root, wedge) => {
    const group = groups.get(root);
    wedges[filled[group]] = startWedge + wedge;
    filled[group] += 1;
  });
  return { groups, begins, wedges };
}

/**
 * Reads what follows the faces of a raw packet, to the payload's end (PMESH-SWI-05, -06).
 * @param {object} packet the packet, as `RawPackets` knows it
 * @param {number} count slots that switch, as the payload says
 * @param {Uint32Array} finest the wedge of each slot of earlier packets, as mapped before the packet
 * @param {object} parts the payload
 * @returns {{slots: Uint32Array, wedges: Uint32Array}} the slots, ascending, and the wedges that they become
 * @throws {FormatError} SWITCH_SLOTS, SWITCH, PACKET_LENGTH, PACKET_PADDING
 */
export function readSwitches(packet, count, finest, parts) {
  const { payload, offset } = parts;
  const slotCount = 3 * packet.startFace;
  if (count > slotCount) refuse('SWITCH_SLOTS', offset);
  packet.payloadBytes = payload.length;
  let slots = new Uint32Array(0);
  let wedges = slots;
  if (count > 0) {
    slots = readSlots(count, slotCount, parts);
    wedges = new Uint32Array(count);
    const { groups, begins, wedges: descending } = descendants(packet);
    const at = parts.at;
    const room = (payload.length - at) * 8;
    let bit = 0;
    slots.forEach((slot, place) => {
      const group = groups.get(finest[slot]);
      if (group === undefined) refuse('SWITCH', offset + at);
      const choices = begins[group + 1] - begins[group];
      const bits = bitLength(choices - 1);
      if (bit + bits > room) refuse('PACKET_LENGTH', offset + at);
      const choice = packedNumber(payload, at, bit, bits);
      if (choice >= choices) refuse('SWITCH', offset + at);
      wedges[place] = descending[begins[group] + choice];
      bit += bits;
    });
    judgeUnusedBits(payload, at, bit, offset);
    parts.at = at + Math.ceil(bit / 8);
  }
  if (parts.at < payload.length) refuse('PACKET_LENGTH', offset + parts.at);
  return { slots, wedges };
}
