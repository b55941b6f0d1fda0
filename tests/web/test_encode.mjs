/* The encoder of the package in Node: the files of the library, arguments, errors, progress, aborting and many calls at once.
 *
 *     node test_encode.mjs FOLDER GOLDEN_FILES    FOLDER: host/web of the build folder; GOLDEN_FILES: the program golden_files, or '' */
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {gzipSync} from 'node:zlib';

import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), program = process.argv[3];
const entry = name => import(pathToFileURL(join(folder, name)));
const {encode} = await entry('encode-node.js'), {decode, info, GsclError} = await entry('node.js');
const made = mkdtempSync(join(tmpdir(), 'gscl-encode-'));

const MAX_GZIPPED = 150000; /* bytes of a module, the largest, and the scripts of a page */

const failure = (source, options) => encode(source, options).then(() => 'encoded', error => {
  assert(error instanceof GsclError, String(error));
  return `${error.code}: ${error.message}`;
});
/* ---- What golden_files writes ---- */

const TYPES = [, Uint8Array, Uint16Array, Float32Array]; /* by gscl_sample */
const TARGETS = [, 'bpp', 'bytes', 'psnr', 'splats', 'ssimulacra2', 'quality']; /* by gscl_target */
const TUNES = ['auto', 'psnr', , 'visual']; /* by gscl_tune */

/* The options of encode for a line of golden_files. */
const optionsOf = ({target, value, effort, tune, bare, progressive, packetSize}) =>
  ({...target ? {[TARGETS[target]]: value} : {}, ...packetSize ? {packets: {size: packetSize}} : {}, effort, tune: TUNES[tune], bare, progressive});

/* What golden_files printed and wrote. */
const readGoldens = lines => lines.trim().split('\n').filter(Boolean).map(line => {
  const it = JSON.parse(line), raw = readFileSync(join(made, `${it.name}.raw`)), type = TYPES[it.sample];
  const data = new type(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length));
  return {name: it.name, source: {data, width: it.width, height: it.height}, options: optionsOf(it), file: readFileSync(join(made, `${it.name}.gscl`))};
});

/* ---- Tests ---- */

const hasGoldens = program && process.arch == 'x64';

test('a module and its scripts are small gzipped', () => {
  const sizeOf = name => gzipSync(readFileSync(join(folder, name)), {level: 9}).length;
  const modules = ['gscl-encode.wasm', 'gscl-encode-alpha.wasm'].map(sizeOf), scripts = ['encode.js', 'encode-worker.js', 'encode-run.js'].map(sizeOf);
  console.log(`# ${modules.join(' or ')} + ${scripts.join(' + ')} bytes`);
  assert(Math.max(...modules) <= MAX_GZIPPED && scripts.reduce((sum, size) => sum + size) <= 5000);
});

/* Each case on its own, so that one that differs is named. */
if (hasGoldens) {
  const goldens = readGoldens(execFileSync(program, [made], {encoding: 'utf8'}));
  test('there are files of the library to compare with', () => assert(goldens.length >= 20, `${goldens.length}`));
  for (const {name, source, options, file} of goldens)
    test(`${name}: the bytes of the library on a processor without a fused multiply-add`, async () => {
      const {bytes, packets, width, height} = await encode(source, options);
      assert.deepEqual(Buffer.from(bytes), file);
      assert.deepEqual([width, height], [source.width, source.height]);
      assert.equal(packets?.every(({length}) => length <= options.packets.size), options.packets && true);
    });
}

test('an encode tells what it has written, and decode and info read it', async () => {
  const source = sceneOf(60, 40), {bytes, bpp, psnr, splats, trials, ...rest} = await encode(source, {bytes: 300, effort: 1});
  assert(bytes instanceof Uint8Array && bytes.length <= 300 && bytes.length > 200, `${bytes.length}`);
  assert.equal(bpp, 8 * bytes.length / (60 * 40));
  assert(trials == 1 && psnr > 20 && splats > 10, JSON.stringify({trials, psnr, splats}));
  assert.deepEqual(rest, {width: 60, height: 40});
  assert.equal((await info(bytes)).splats, splats);
  const {data} = await decode(bytes), mse = source.data.reduce((sum, value, i) => sum + (value - data[i]) ** 2, 0) / source.data.length;
  assert(Math.abs(10 * Math.log10(255 ** 2 / mse) - psnr) < 0.05, `${10 * Math.log10(255 ** 2 / mse)} and ${psnr} dB`);
});

test('a target of quality is met, and is in the report', async () => {
  const {ssimulacra2} = await encode(sceneOf(60, 40), {ssimulacra2: 40, effort: 0});
  assert(ssimulacra2 >= 40 && ssimulacra2 < 45, `${ssimulacra2}`);
});

test('packets come one by one, and any of them can be drawn', async () => {
  const {packets} = await encode(sceneOf(60, 40), {bytes: 600, effort: 0, packets: {size: 120, loss: 0.2}});
  assert(packets.length >= 5 && packets.every(({length}) => length >= 40 && length <= 120), packets.map(({length}) => length).join());
  assert.equal((await decode(packets.slice(1))).width, 60);
});

test('pixels may be of four types and have one to four channels, opaque or not', async () => {
  const {data} = sceneOf(32, 24);
  const as = (type, most) => ({data: type.from(data, value => value / 255 * most), width: 32, height: 24});
  const {bytes} = await encode(sceneOf(32, 24), {bytes: 200, effort: 0});
  for (const [type, most] of [[Uint8ClampedArray, 255], [Uint8Array, 255]])
    assert.deepEqual((await encode(as(type, most), {bytes: 200, effort: 0})).bytes, bytes);
  for (const [type, most] of [[Uint16Array, 65535], [Float32Array, 1]])
    assert((await encode(as(type, most), {bytes: 200, effort: 0})).psnr > 20);
  for (const channels of [1, 2, 3, 4])
    for (const alpha of [255, 100])
      assert.equal((await info((await encode(sceneOf(32, 24, channels, alpha), {bytes: 200, effort: 0})).bytes)).channels, channels);
  const view = new Uint8Array(4 + data.length).subarray(4);
  view.set(data);
  assert.deepEqual((await encode({data: view, width: 32, height: 24}, {bytes: 200, effort: 0})).bytes, bytes);
});

test('bad arguments and targets are refused in one line', async () => {
  const source = sceneOf(16, 16);
  assert.match(await failure({}), /^invalid-argument: data must be a Uint8Array/);
  assert.match(await failure(undefined), /^invalid-argument: data must be/);
  assert.match(await failure({...source, width: 17}), /^invalid-argument: data has 1024 samples; 17x16 pixels/);
  assert.match(await failure({...source, width: 0}), /^invalid-argument: width and height must be whole/);
  assert.match(await failure(source, {byte: 3}), /^invalid-argument: unknown option "byte"; there are bpp, bytes/);
  assert.match(await failure(source, {bytes: 300, psnr: 30}), /^conflict: bytes and psnr exclude each other/);
  assert.match(await failure(source, {bytes: '300'}), /^invalid-argument: bytes must be a number/);
  assert.match(await failure(source, {effort: 10}), /^invalid-argument: effort 10 is not in 0..9/);
  assert.match(await failure(source, {effort: 1.5}), /^invalid-argument: effort must be a whole number/);
  assert.match(await failure(source, {tune: 'ssim'}), /^invalid-argument: unknown tune "ssim"; there are auto, psnr, visual/);
  assert.match(await failure(source, {packets: 3}), /^invalid-argument: packets must be an object/);
  assert.match(await failure(source, {packets: {size: 3}}), /^invalid-argument: /);
  assert.match(await failure(source, {packets: {size: 300}, bare: true}), /^conflict: /);
  assert.match(await failure(source, {bytes: 3}), /^budget-too-small: a budget of 3 bytes is too small; the smallest file of this image has 14 bytes/);
  assert.match(await failure(source, {bytes: NaN}), /^invalid-argument: /);
  assert.match(await failure(source, {psnr: 190}), /^target-unreachable: /);
  assert.match(await failure({data: Float32Array.of(1, NaN, 0), width: 1, height: 1}), /^not-finite: /);
  assert.match(await failure({data: new Uint8Array(16385), width: 16385, height: 1}), /^image-size: /);
});

test('progress rises, and the page may stop an encode at once', async () => {
  const fractions = [], controller = new AbortController, source = sceneOf(400, 300);
  await encode(source, {bytes: 600, effort: 0, onProgress: ({fraction, remainingSeconds, elapsedSeconds}) => {
    assert(remainingSeconds >= 0 && elapsedSeconds >= 0 && elapsedSeconds < 1000);
    fractions.push(fraction);
  }});
  assert(fractions.length >= 2 && fractions.every((it, i) => it <= 1 && (!i || it >= fractions[i - 1])), fractions.join());
  let calls = 0;
  const stopped = encode(source, {effort: 9, signal: controller.signal, onProgress: () => (calls++, controller.abort())});
  await assert.rejects(stopped, {name: 'AbortError'});
  assert.equal(calls, 1);
  await assert.rejects(encode(source, {signal: AbortSignal.abort(Error('of the caller'))}), {message: 'of the caller'});
  assert((await encode(sceneOf(16, 16), {bytes: 60, effort: 0})).bytes.length > 10);
});

test('an encode that waits for others is stopped at once, and those behind it go on', async () => {
  const source = sceneOf(400, 300), controller = new AbortController, others = new AbortController;
  const running = Array.from({length: 8}, () => encode(source, {effort: 9, signal: others.signal}).catch(({name}) => name));
  const stopped = assert.rejects(encode(source, {signal: controller.signal}), {name: 'AbortError'});
  const last = encode(sceneOf(16, 16), {bytes: 60, effort: 0});
  controller.abort();
  await stopped;
  others.abort();
  assert.deepEqual(new Set(await Promise.all(running)), new Set(['AbortError']));
  assert((await last).bytes.length > 10);
});

test('what a caller throws in onProgress ends the encode and reaches the caller', async () => {
  await assert.rejects(encode(sceneOf(400, 300), {effort: 9, onProgress: () => { throw Error('of the caller'); }}), {message: 'of the caller'});
});

test('many encodes at once give the same bytes, with as many workers as processors', async () => {
  const all = await Promise.all(Array.from({length: 12}, () => encode(sceneOf(40, 30), {bytes: 200, effort: 0})));
  for (const {bytes} of all)
    assert.deepEqual(bytes, all[0].bytes);
});

test('a process whose encodes are done ends', () => {
  const script = `import {encode} from ${JSON.stringify(pathToFileURL(join(folder, 'encode-node.js')).href)};
    const {bytes} = await encode({data: new Uint8Array(48).fill(9), width: 4, height: 4}, {bytes: 60}); console.log(bytes.length > 5);`;
  assert.equal(execFileSync(process.execPath, ['--input-type=module', '-e', script], {encoding: 'utf8', timeout: 120000}), 'true\n');
});

process.exitCode = await runTests() ? 0 : 1;
rmSync(made, {recursive: true});
