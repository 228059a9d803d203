// SPDX-License-Identifier: MIT OR Apache-2.0
// Fuzzes a decoder in JavaScript with nothing but Node: `node fuzz/examples/loop.mjs SECONDS [SEED]`, in the folder above `fuzz/`.
// Changes bytes of the seeds and makes the checksums anew, so that no switch is needed in the decoder. Replace `decode`.

import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { FormatError, IvgDecoder } from '../../conformance/ports/js/ivg.mjs';
import { crc32 } from '../../conformance/ports/js/wire.mjs';

/** Reads a file in pieces that end at `ends`: the events, values included, and the verdict, as texts. Throws nothing but mistakes. */
function decode(bytes, ends) {
  const decoder = new IvgDecoder({ vertices: 1 << 16 });
  const events = [];
  const note = (event) => {
    const values = event.values ? crc32(new Uint8Array(event.values().buffer)) : '';
    events.push(`${event.kind} ${event.id ?? ''} ${values}`);
  };
  try {
    let from = 0;
    for (const to of [...ends, bytes.length]) {
      decoder.push(bytes.subarray(from, to), note);
      from = to;
    }
    decoder.finish();
    return { events, verdict: 'ok' };
  } catch (error) {
    if (!(error instanceof FormatError)) throw error;
    return { events, verdict: `${error.verdict} ${error.code} ${error.offset}` };
  }
}

/** What is not the same of a file (`whole`), of that file in two pieces, and of its first piece alone; nothing if all is well. */
function contradiction(bytes, whole, cut) {
  const [split, first] = [decode(bytes, [cut]), decode(bytes.subarray(0, cut), [])];
  const [events, begins] = [whole, first].map((seen) => seen.events.join('; '));
  if (split.verdict !== whole.verdict || split.events.join('; ') !== events) return ['in pieces', split, whole];
  const short = first.verdict.startsWith('need-more');
  if (!events.startsWith(begins) || (!short && first.verdict !== whole.verdict)) return ['the first piece', first, whole];
  if (whole.verdict === 'ok' && cut < bytes.length && !short) return ['a prefix of a whole file', first, whole];
}

/** The ends of the header, of each chunk and of each record of an accepted file. */
function partsOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const decoder = new IvgDecoder();
  decoder.push(bytes, () => {});
  const ends = [view.getUint32(20, true)];
  const data = Number(view.getBigUint64(40, true));
  while (ends.at(-1) < data) ends.push(ends.at(-1) + Math.ceil((Number(view.getBigUint64(ends.at(-1) + 8, true)) + 20) / 8) * 8);
  for (let place = 0; place <= decoder.recordCount; place++) {
    const { offset, bytes: length } = decoder.rangeOf(place);
    ends.push(offset + length);
  }
  return ends;
}

/** Makes the checksums of the parts anew (COM-CRC-01, COM-CRC-02). */
function seal(bytes, ends) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  view.setUint32(28, crc32(bytes.subarray(32, ends[0]), crc32(bytes.subarray(0, 28))), true);
  const content = crc32(bytes.subarray(32, 40));
  for (let i = 1; i < ends.length; i++) view.setUint32(ends[i] - 4, crc32(bytes.subarray(ends[i - 1], ends[i] - 4), content), true);
}

const seconds = Number(process.argv[2] ?? 20);
let state = BigInt(process.argv[3] ?? 1);
const random = (below) => {
  state = BigInt.asUintN(64, state * 6364136223846793005n + 1442695040888963407n);
  return Number(state >> 33n) % below;
};
const folder = 'fuzz/corpus/ivg_decode';
const seeds = readdirSync(folder).map((name) => new Uint8Array(readFileSync(`${folder}/${name}`)));
const parts = seeds.map(partsOf);
const verdicts = {};
let runs = 0;
for (const end = Date.now() + 1000 * seconds; Date.now() < end; runs++) {
  const which = random(seeds.length);
  const bytes = seeds[which].slice();
  for (let n = 1 + random(3); n > 0; n--) bytes[random(bytes.length)] = random(4) ? random(256) : 255 * random(2);
  seal(bytes, parts[which]);
  const cut = random(bytes.length);
  try {
    const whole = decode(bytes, []);
    const found = contradiction(bytes, whole, cut);
    if (found) throw new Error(`cut at ${cut}: ${JSON.stringify(found)}`);
    const [verdict] = whole.verdict.split(' ');
    verdicts[verdict] = (verdicts[verdict] ?? 0) + 1;
  } catch (error) {
    writeFileSync('finding.ivg', bytes);
    console.error('finding.ivg:', error);
    process.exit(1);
  }
}
console.log(`${runs} files, nothing found`, verdicts);
