// SPDX-License-Identifier: MIT OR Apache-2.0

// node --test test.mjs

import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import test from 'node:test';
import { FormatError, IvgDecoder } from './ivg.mjs';
import { IvgGrid } from './ivg-grid.mjs';
import { corners, OctreeOrder, SlicePermutation, SlicesOrder } from './ivg-order.mjs';
import { decodeValues, directionOct24, rgb9e5 } from './ivg-values.mjs';
import { PmeshDecoder } from './pmesh.mjs';
import { BinaryModel, SymbolModel, Symbols } from './pmesh-symbols.mjs';
import { classOf } from './pmesh-cells.mjs';
import { normalOf, pointOf } from './pmesh-values.mjs';
import { crc32, isUtf8, SplitMix64 } from './wire.mjs';

const SEED = 0x0123456789abcdefn;
const vectors = new URL('../../vectors/', import.meta.url);
const bitsOf = (numbers) => Array.from(new Uint32Array(Float32Array.from(numbers).buffer));
const read = (path) => new Uint8Array(readFileSync(new URL(path, vectors)));

test('checksum and generator (COM-CRC-01, COM-INT-02)', () => {
  assert.equal(crc32(new TextEncoder().encode('123456789')), 0xcbf43926);
  const outputs = [[0n, 0], [0n, 1], [SEED, 42]].map(([seed, n]) => {
    const { high, low } = new SplitMix64(seed).at(0, n);
    return (BigInt(high) << 32n) | BigInt(low);
  });
  assert.deepEqual(outputs, [0xe220a8397b1dcdafn, 0x6e789e6aa1b965f4n, 0x537a638df1af2be9n]);
});

test('text (COM-INT-01)', () => {
  assert.ok(isUtf8(new TextEncoder().encode('a\u00e9\u20ac\u{10ffff}\0')));
  for (const bytes of [[0xc0, 0x80], [0xed, 0xa0, 0x80], [0xf4, 0x90, 0x80, 0x80], [0xe2, 0x82], [0x80]]) {
    assert.ok(!isUtf8(Uint8Array.from(bytes)));
  }
});

test('orders (IVG-ORD-11, IVG-OCT-06)', () => {
  const permutation = new SlicePermutation(SEED, 7, 1000);
  assert.deepEqual([0, 1, 2, 3, 4, 5, 6, 7].map((rank) => permutation.at(rank)), [553, 232, 215, 354, 811, 825, 500, 56]);
  const slices = new SlicesOrder([4, 3, 2], 2, 0n);
  assert.deepEqual([1, 2, 3].map((bundle) => [...slices.vertices(bundle)]), [
    [4, 16, 1, 13, 6, 2, 19, 7],
    [17, 21, 14, 22],
    [5, 9, 18, 10],
  ]);
  const tie = new SlicesOrder([2, 3, 3], 2, 1n);
  assert.deepEqual([...corners([2, 3, 3])], [0, 1, 4, 5, 12, 13, 16, 17]);
  assert.deepEqual([1, 2, 3].map((bundle) => [...tie.vertices(bundle)]), [[6, 7, 2, 14, 11, 10], [8, 9], [15, 3]]);
  const octree = new OctreeOrder([3, 3, 3], 100, SEED);
  assert.deepEqual([...octree.vertices(1)], [23, 25, 4, 17, 16, 11, 22, 12, 7, 5, 19, 10, 15, 14, 21, 9, 13, 1, 3]);
  const large = new OctreeOrder([65535, 40000, 1000], 1, 1n);
  assert.deepEqual([0, 1, 1e12, 2621399999991].map((rank) => large.vertex(rank)), [
    524691690850, 964353436566, 1222016595314, 1987473750134,
  ]);
});

test('colours, directions, ratios (sections 6.1 and 6.5 of ivg.md)', () => {
  assert.deepEqual([0, 1, 2].map((channel) => rgb9e5(0x81010100, channel)), [1, 0.5, 0.25]);
  const direction = (code) => {
    const into = new Float32Array(3);
    directionOct24(code, into);
    return bitsOf(into);
  };
  assert.deepEqual(direction(0x7ff7ff), [0, 0, 0x3f800000]);
  assert.deepEqual(direction(0x000000), [0, 0, 0xbf800000]);
  assert.deepEqual(direction(0x9f3be7), [0x3f4dad38, 0x3ecdad38, 0x3ee1029f]);
  assert.deepEqual(direction(0x223be7), [0x3edd5dde, 0xbf53db3d, 0xbeb7535a]);
  assert.deepEqual(direction(0x0007fe), [0, 0xbf7ffffe, 0xba002007]);
  const payload = new Uint8Array(28);
  new DataView(payload.buffer).setUint32(0, 0x80000100, true);
  payload.set([127, -127, 1, 127, -127, 127, 127, -127], 4);
  assert.deepEqual(bitsOf(decodeValues(7, 0, payload, 1).subarray(0, 9)), [
    0x3f800000, 0x3fddb3d8, 0xbfddb3d8, 0x3c5f72bd, 0x3ff7def6, 0xbff7def6, 0x400f1bbd, 0x3ff7def6, 0xbff7def6,
  ]);
});

test('symbols, classes, normals of coded packets (PMESH-COD-04, -05, -16)', () => {
  const bytes = Uint8Array.of(0x8e, 0x9b, 0x9e, 0x04, 0x55, 0xf9, 0x75, 0x00, 0x01, 0x55);
  const symbols = new Symbols(bytes, 0);
  const binary = new BinaryModel(0x4000);
  const sixteen = new SymbolModel(Array.from({ length: 15 }, (_, i) => 2048 * (i + 1)));
  assert.deepEqual([0, 0, 0, 0].map(() => symbols.binary(binary)), [true, false, false, true]);
  assert.deepEqual([0, 0, 0].map(() => symbols.symbol(sixteen)), [3, 3, 15]);
  assert.equal(symbols.raw(9), 0x155);
  symbols.judgeEnd(0);
  assert.deepEqual([0, 1, 2, 3, 5, 8].map(classOf), [0, 0, 4, 6, 9, 12]);
  assert.deepEqual(pointOf([-300, 400], 511), [-111, 211, -189]);
  assert.deepEqual(bitsOf(normalOf([100, -200], 511)), [0x3ea688fd, 0xbf2688fd, 0x3f2fb1cd]);
});

/** Events and error of a file that arrives in pieces of one size. */
function trace(Decoder, bytes, size) {
  const decoder = new Decoder();
  const events = [];
  const receive = (event) => {
    if (event.kind === 'vertices') events.push(['vertices', event.id, event.indices(), event.values()]);
    else events.push([event.kind, event.level]);
  };
  try {
    for (let at = 0; at < bytes.length; at += size) decoder.push(bytes.slice(at, at + size), receive);
    decoder.finish();
  } catch (error) {
    assert.ok(error instanceof FormatError, error.stack);
    events.push([error.code, error.offset]);
  }
  return events;
}

for (const [folder, Decoder] of [['ivg', IvgDecoder], ['pmesh', PmeshDecoder]]) {
  test(`any split of a .${folder} file gives the same (COM-STR-03)`, () => {
    for (const name of readdirSync(new URL(`${folder}/`, vectors))) {
      const bytes = read(`${folder}/${name}`);
      if (bytes.length > 8192) continue;
      const whole = trace(Decoder, bytes, bytes.length);
      for (const size of [1, 7]) assert.deepEqual(trace(Decoder, bytes, size), whole, name);
    }
  });
}

test('records fetched alone (COM-REC-06)', () => {
  const bytes = read('ivg/0018-explicit-small.ivg');
  const decoder = new IvgDecoder();
  let grid = null;
  decoder.push(bytes.subarray(0, new DataView(bytes.buffer).getUint32(40, true)), (event) => {
    grid ??= new IvgGrid(event.header);
  });
  for (let place = decoder.recordCount - 1; place >= 0; place -= 1) {
    const { offset, bytes: length } = decoder.rangeOf(place);
    const record = bytes.slice(offset, offset + length);
    assert.ok(grid.take(decoder.readRecord(place, record)));
    assert.ok(!grid.take(decoder.readRecord(place, record)));
    assert.throws(() => decoder.readRecord(place, record.subarray(1)), { name: 'TRUNCATED' });
    assert.throws(() => decoder.readRecord(place, bytes.subarray(offset, offset + length + 1)), { name: 'RECORD_LENGTH' });
  }
  const whole = trace(IvgDecoder, bytes, bytes.length).filter(([kind]) => kind === 'vertices');
  const count = whole.reduce((sum, [, , indices]) => sum + indices.length, 0);
  assert.equal(grid.light().indices.length, count);
});

test('bytes behind the end, and input behind an error (COM-REC-08, COM-VERD-03)', () => {
  const bytes = new Uint8Array([...read('ivg/0003-packed.ivg'), 0, 1, 2]);
  const stream = new IvgDecoder({}, { stream: true });
  assert.equal(stream.push(bytes), bytes.length - 3);
  assert.equal(stream.push(bytes), 0);
  stream.finish();
  const file = new IvgDecoder();
  for (const more of [bytes, bytes, new Uint8Array(0)]) {
    assert.throws(() => file.push(more), { name: 'TRAILING_BYTES', code: 115, offset: bytes.length - 3 });
  }
  assert.throws(() => new IvgDecoder().finish(), { name: 'TRUNCATED', verdict: 'need-more' });
});

test('levels are the same from above and from below (PMESH-LVL-01)', () => {
  for (const name of ['0011-raw-attributes', '0017-raw-out-of-order', '0018-raw-deep', '0051-coded-attributes']) {
    const decoder = new PmeshDecoder();
    decoder.push(read(`pmesh/${name}.pmesh`));
    decoder.finish();
    const { mesh } = decoder;
    const copy = (level, replay) => structuredClone(replay.goTo(level));
    const up = mesh.replay();
    const shown = [];
    for (let level = mesh.coarsest; level <= mesh.finest; level += 1) shown.push(copy(level, up));
    for (const { corners: list, wedgeVertices, wedges, faces } of shown) {
      for (let face = 0; face < faces; face += 1) {
        const three = list.subarray(3 * face, 3 * face + 3);
        assert.ok(three.every((wedge) => wedge < wedges), name);
        assert.equal(new Set(three.map((wedge) => wedgeVertices[wedge])).size, 3, name);
      }
    }
    for (let level = mesh.finest; level >= mesh.coarsest; level -= 1) {
      assert.deepEqual(copy(level, up), shown[level - mesh.coarsest], name);
    }
    assert.throws(() => up.goTo(mesh.finest + 1), RangeError);
  }
});

test('a header that announces more than the limits is refused, one within them costs nothing', () => {
  const bytes = read('ivg/x-605-vertices.ivg');
  assert.throws(() => new IvgDecoder().push(bytes), { name: 'LIMIT_VERTICES' });
  const decoder = new IvgDecoder({ vertices: 2 ** 48, recordBytes: 2 ** 31 });
  decoder.push(bytes);
  assert.equal(decoder.verdict, 'need-more');
});
