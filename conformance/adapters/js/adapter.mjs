#!/usr/bin/env node
// SPDX-License-Identifier: MIT OR Apache-2.0

// The adapter of the conformance suite for JavaScript (`conformance/PROTOCOL.md`), for the decoders in `ports/js`:
//
//   node adapters/js/adapter.mjs decode ivg IN OUT
//
// To test a decoder of your own, copy this file and replace what stands between the two lines of equal signs:
// `capabilities`, and for each format a function that makes a *reader*, an object with
//
//   push(bytes)    takes in the next bytes of the file; throws nothing
//   verdict()      { verdict, code, offset }: 'ok', 'need-more', 'invalid', 'unsupported' or 'limit' for what was taken
//                  in so far; number and offset of the error with the last three
//   records()      how many records were read whole and accepted, without the end record
//   show(level)    the pieces of OUT (Uint8Array), one after the other; a level of a mesh, or undefined
//
// and `TABLES`, which may be empty. A decoder that takes whole files only collects what is pushed and reads it at the first
// call of another function; let it claim `decode` alone.

import { closeSync, openSync, readFileSync, writeSync } from 'node:fs';

// =====================================================================================================================

import { FormatError, IvgDecoder } from '../../ports/js/ivg.mjs';
import { IvgGrid } from '../../ports/js/ivg-grid.mjs';
import { directionOct24, directionXyz24, half, rgb9e5 } from '../../ports/js/ivg-values.mjs';
import { PmeshDecoder } from '../../ports/js/pmesh.mjs';

const capabilities = `name ivg and pmesh in JavaScript
ivg decode prefix prefixes chunks
pmesh decode prefix prefixes chunks lod
encodings packed-oct24 packed-xyz24 pair-f16 pair-f16x4 pair-f32 vectors-f32 sh2-28
orders slices octree explicit
modes raw coded
numeric rgb9e5 oct24 xyz24 f16
codes
`;

/** What readers of both formats have in common. */
function readerOf(decoder, receive, show) {
  return {
    push(bytes) {
      try {
        decoder.push(bytes, receive);
      } catch (error) {
        if (!(error instanceof FormatError)) throw error;
      }
    },
    verdict: () => ({ verdict: decoder.verdict, code: decoder.error?.code, offset: decoder.error?.offset }),
    records: () => decoder.records,
    show,
  };
}

function ivgReader() {
  let grid = null;
  const receive = (event) => {
    if (event.kind === 'header') grid = new IvgGrid(event.header);
    else grid.take(event);
  };
  return readerOf(new IvgDecoder(), receive, function* show() {
    if (grid === null) return;
    const { header, lights, metadata } = grid;
    yield u32(...header.dims);
    yield f64(...header.origin, ...header.step);
    yield u32(header.unitsId, header.quantity === 'harmonics' ? 1 : 0, lights?.length ?? 0xffffffff);
    for (const { direct, nameBytes } of lights ?? []) {
      yield u32(direct ? 1 : 0, nameBytes.length);
      yield nameBytes;
    }
    yield u32(metadata?.length ?? 0xffffffff);
    if (metadata !== null) yield metadata;
    yield grid.received();
    yield grid.validity();
    yield grid.blocked();
    yield bytesOf(grid.light().values);
  });
}

function pmeshReader() {
  const decoder = new PmeshDecoder();
  let materialNames = null;
  const receive = (event) => {
    if (event.kind === 'materials') materialNames = event.names().map((name) => name.bytes);
  };
  return readerOf(decoder, receive, function* show(level) {
    const { header, mesh } = decoder;
    if (header === null) return;
    yield f64(...header.origin);
    yield u32(header.attributeBits, header.vertexCount, header.wedgeCount, header.faceCount, header.baseVertices);
    yield u32(header.packetCount);
    for (let packet = 0; packet < header.packetCount; packet += 1) {
      const entry = decoder.packet(packet);
      yield u32(entry.endVertex, entry.endWedge, entry.endFace, entry.payloadBytes);
      yield bytesOf(Float32Array.of(entry.error));
    }
    yield u32(materialNames?.length ?? 0xffffffff);
    for (const name of materialNames ?? []) {
      yield u32(name.length);
      yield name;
    }
    if (mesh.finest === null) {
      yield u32(0xffffffff);
      return;
    }
    // By way of the finest level: levels are gone through in both directions.
    const replay = mesh.replay();
    replay.goTo(mesh.finest);
    const shown = replay.goTo(level ?? mesh.finest);
    yield u32(shown.level, shown.vertices, shown.wedges, shown.faces);
    const { positions, wedgeVertices, normals, uvs, colours, corners, materials } = shown;
    for (const array of [positions, wedgeVertices, normals, uvs, colours, corners, materials]) {
      if (array !== null) yield bytesOf(array);
    }
  });
}

const READERS = { ivg: ivgReader, pmesh: pmeshReader };

const TABLES = {
  *rgb9e5() {
    const table = new Float32Array(32 * 512);
    for (let at = 0; at < table.length; at += 1) table[at] = rgb9e5(((at >>> 9) << 27) | (at & 511), 0);
    yield bytesOf(table);
  },
  *f16() {
    const bits = new Uint32Array(65536);
    const numbers = new Float32Array(bits.buffer);
    for (let code = 0; code < bits.length; code += 1) {
      const value = half(code);
      if (Number.isFinite(value)) numbers[code] = value;
      else bits[code] = 0xffffffff;
    }
    yield bytesOf(bits);
  },
  *oct24() {
    for (let v = 0; v <= 4094; v += 1) {
      const row = new Float32Array(4095 * 3);
      for (let u = 0; u <= 4094; u += 1) directionOct24(u | (v << 12), row, u * 3);
      yield bytesOf(row);
    }
  },
  *xyz24() {
    for (let z = -127; z <= 127; z += 1) {
      const plane = new Float32Array(255 * 255 * 3);
      let at = 0;
      for (let y = -127; y <= 127; y += 1) {
        for (let x = -127; x <= 127; x += 1, at += 3) {
          if (x !== 0 || y !== 0 || z !== 0) directionXyz24(x, y, z, plane, at);
          else new Uint32Array(plane.buffer).fill(0xffffffff, at, at + 3);
        }
      }
      yield bytesOf(plane);
    }
  },
};

// =====================================================================================================================

const STATUS = { ok: 0, 'need-more': 40, invalid: 41, unsupported: 42, limit: 43 };
const CRASH = 1;

/** Numbers are little-endian; so are the arrays of every machine that runs this. */
function bytesOf(array) {
  return new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
}

function u32(...numbers) {
  return bytesOf(Uint32Array.from(numbers));
}

function f64(...numbers) {
  return bytesOf(Float64Array.from(numbers));
}

function writeFile(path, pieces) {
  const file = openSync(path, 'w');
  for (const piece of pieces) for (let at = 0; at < piece.length; ) at += writeSync(file, piece, at);
  closeSync(file);
}

/** Gives a reader a file in pieces: the last size repeats. */
function pushPieces(reader, bytes, sizes) {
  let at = 0;
  for (let piece = 0; at < bytes.length; piece += 1) {
    const size = sizes[Math.min(piece, sizes.length - 1)];
    reader.push(bytes.subarray(at, at + size));
    at += size;
  }
}

/** Writes OUT and says the verdict. */
function answer(reader, out, level) {
  const { verdict, code, offset } = reader.verdict();
  if (verdict === 'ok' || verdict === 'need-more') writeFile(out, reader.show(level));
  else process.stdout.write(`${code} ${offset}\n`);
  return STATUS[verdict];
}

const COMMANDS = {
  capabilities() {
    process.stdout.write(capabilities);
    return 0;
  },
  decode(format, path, out) {
    const reader = READERS[format]();
    reader.push(readFileSync(path));
    return answer(reader, out);
  },
  prefix(format, path, out, length) {
    const reader = READERS[format]();
    reader.push(readFileSync(path).subarray(0, Number(length)));
    return answer(reader, out);
  },
  chunks(format, path, out, sizes) {
    const reader = READERS[format]();
    const numbers = sizes.split(',').map(Number);
    if (!numbers.every((size) => size >= 1)) throw new Error('sizes are numbers from 1 on');
    pushPieces(reader, readFileSync(path), numbers);
    return answer(reader, out);
  },
  prefixes(format, path, out) {
    const reader = READERS[format]();
    const rows = [u32(STATUS[reader.verdict().verdict], reader.records())];
    // What is known after n bytes is known of the prefix of n bytes (COM-STR-02), so one reader tells of all prefixes.
    for (const byte of readFileSync(path)) {
      reader.push(Uint8Array.of(byte));
      rows.push(u32(STATUS[reader.verdict().verdict], reader.records()));
    }
    writeFile(out, [Buffer.concat(rows)]);
    return 0;
  },
  lod(format, path, out, level) {
    const reader = READERS[format]();
    reader.push(readFileSync(path));
    return answer(reader, out, Number(level));
  },
  numeric(table, out) {
    writeFile(out, TABLES[table]());
    return 0;
  },
};

try {
  const [command, ...words] = process.argv.slice(2);
  if (!Object.hasOwn(COMMANDS, command ?? '')) throw new Error(`unknown command ${command}`);
  process.exitCode = COMMANDS[command](...words);
} catch (error) {
  process.stderr.write(`${error.stack}\n`);
  process.exitCode = CRASH;
}
