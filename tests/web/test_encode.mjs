/* The encoder of the package in Node: the files of the library with all numbers of threads, arguments, errors, progress, aborting and many
 * calls at once.
 *
 *     node test_encode.mjs FOLDER GOLDEN_FILES    FOLDER: host/web of the build folder; GOLDEN_FILES: the program golden_files, or '' */
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {availableParallelism, tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {setTimeout as pause} from 'node:timers/promises';
import {pathToFileURL} from 'node:url';
import {runInNewContext} from 'node:vm';
import {Worker} from 'node:worker_threads';
import {gzipSync} from 'node:zlib';

import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), program = process.argv[3];
const entry = name => import(pathToFileURL(join(folder, name)));
const {encode} = await entry('encode-node.js'), {decode, info, GsclError} = await entry('node.js');
const made = mkdtempSync(join(tmpdir(), 'gscl-encode-'));

const MAX_GZIPPED = 150000; /* bytes of a module and the scripts of a page */

const failure = (source, options) => encode(source, options).then(() => 'encoded', error => {
  assert(error instanceof GsclError, error.stack);
  return `${error.code}: ${error.message}`;
});

/* An encoder of its own with `workers` processors, whose workers `start` starts; `ordinary` is how they are started in Node. */
const encoderWith = async (workers, start) => {
  const {encode, useHost} = await import(`${pathToFileURL(join(folder, 'encode.js'))}?${Math.random()}`);
  const ordinary = ({onMessage, onError}) => new Worker(join(folder, 'encode-worker-node.js')).on('message', onMessage).on('error', onError);
  useHost({workers, read: async name => readFileSync(join(folder, name)), start: listeners => start(listeners, ordinary)});
  return encode;
};

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
  assert(Math.max(...modules) + scripts.reduce((sum, size) => sum + size) <= MAX_GZIPPED);
});

/* Each case on its own, so that one that differs is named. */
if (hasGoldens) {
  const goldens = readGoldens(execFileSync(program, [made], {encoding: 'utf8'}));
  test('there are files of the library to compare with', () => assert(goldens.length >= 20, `${goldens.length}`));
  for (const {name, source, options, file} of goldens)
    test(`${name}: the bytes of the library on a processor without a fused multiply-add`, async () => {
      let result;
      for (const threads of [1, 2, 4]) {
        result = await encode(source, {...options, threads});
        assert.deepEqual(Buffer.from(result.bytes), file, `${threads} threads`);
      }
      const {packets, width, height} = result;
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

/* The table of the library, as its source has it. */
const presetsOfLibrary = () => {
  const source = readFileSync(new URL('../../host/lib/encode/presets.c', import.meta.url), 'utf8');
  const rows = [...source.matchAll(/\{"(\w+)", GSCL_TARGET_(\w+), ([\d.]+), (\w+)\}/g)];
  return rows.map(([, name, target, value, effort]) => {
    if (target == 'RATE') /* of a small picture */
      return {name, options: {bytes: 256, effort: Number(effort)}};
    const options = {effort: effort == 'GSCL_DEFAULT_EFFORT' ? undefined : Number(effort)};
    return {name, options: target == 'AUTO' ? options : {...options, [target.toLowerCase()]: Number(value)}};
  });
};

test('presets are those of the library, and an effort beside one counts', async () => {
  const source = sceneOf(40, 30), presets = presetsOfLibrary();
  assert.equal(presets.length, 4);
  for (const {name, options} of presets) {
    for (const effort of [undefined, 0])
      assert.deepEqual((await encode(source, {preset: name, effort})).bytes, (await encode(source, {...options, ...effort === 0 ? {effort} : {}})).bytes, name);
  }
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
  const source = sceneOf(16, 16), message = async (pattern, picture, options) => assert.match(await failure(picture, options), pattern);
  await message(/^invalid-argument: data must be a Uint8Array/, {});
  await message(/^invalid-argument: data must be/, undefined);
  await message(/^invalid-argument: data must be/, {...source, data: Array.from(source.data)});
  await message(/^invalid-argument: data has 1024 samples; 17x16 pixels/, {...source, width: 17});
  await message(/^invalid-argument: width and height must be whole numbers from 1 on, they are 0 and 16/, {...source, width: 0});
  await message(/^invalid-argument: width and height .* "16" and 16/, {...source, width: '16'});
  for (const options of [null, 5, [], 'x'])
    await message(/^invalid-argument: options must be an object, it is /, source, options);
  await message(/^invalid-argument: unknown option "byte"; there are preset, bytes, bpp/, source, {byte: 3});
  await message(/^invalid-argument: unknown option "toString"/, source, {toString: 3});
  await message(/^conflict: bytes and psnr exclude each other/, source, {bytes: 300, psnr: 30});
  await message(/^conflict: preset and bytes exclude each other/, source, {preset: 'small', bytes: 300});
  await message(/^invalid-argument: preset must be tiny, preview, small, good, it is "large"/, source, {preset: 'large'});
  await message(/^invalid-argument: bytes must be a whole number from 0 on, it is "300"/, source, {bytes: '300'});
  await message(/^invalid-argument: bytes must be a whole number from 0 on, it is NaN/, source, {bytes: NaN});
  await message(/^invalid-argument: effort 10 is not in 0..9/, source, {effort: 10});
  await message(/^invalid-argument: effort must be a whole number from 0 on, it is 1.5/, source, {effort: 1.5});
  for (const tune of ['ssim', 'toString', '__proto__', 3])
    await message(/^invalid-argument: tune must be auto, psnr, visual, it is /, source, {tune});
  await message(/^invalid-argument: bare must be true or false, it is "false"/, source, {bare: 'false'});
  await message(/^invalid-argument: packets must be an object, it is 3/, source, {packets: 3});
  await message(/^invalid-argument: size must be a whole number from 1 on, it is 100.5/, source, {packets: {size: 100.5}});
  await message(/^invalid-argument: loss must be a number, it is NaN/, source, {packets: {size: 100, loss: NaN}});
  await message(/^invalid-argument: packets must have a size/, source, {packets: {}});
  await message(/^invalid-argument: /, source, {packets: {size: 3}});
  await message(/^conflict: /, source, {packets: {size: 300}, bare: true});
  for (const signal of [5, {}, {aborted: true}])
    await message(/^invalid-argument: signal must be an AbortSignal/, source, {signal});
  await message(/^invalid-argument: onProgress must be a function, it is 5/, source, {onProgress: 5});
  await message(/^invalid-argument: threads must be a whole number from 1 on, it is 0/, source, {threads: 0});
  await message(/^invalid-argument: 1025 threads: there may be 1 to 1024/, source, {threads: 1025});
  await message(/^budget-too-small: a budget of 3 bytes is too small; the smallest file of this image has 14 bytes/, source, {bytes: 3});
  await message(/^target-unreachable: /, source, {psnr: 190});
  await message(/^not-finite: /, {data: Float32Array.of(1, NaN, 0), width: 1, height: 1});
  await message(/^image-size: /, {data: new Uint8Array(16385), width: 16385, height: 1});
});

test('pixels of another realm, and options without a value, are taken', async () => {
  const data = runInNewContext('new Uint8Array(16 * 16 * 3).fill(90)');
  assert((await encode({data, width: 16, height: 16}, {bytes: 60, effort: undefined, packets: undefined})).bytes.length > 10);
});

test('pixels and options may be changed once the call has returned', async () => {
  const source = sceneOf(40, 30, 4, 90), options = {bytes: 300, effort: 0}, {bytes} = await encode(sceneOf(40, 30, 4, 90), options);
  const first = encode(source, options);
  source.data.fill(255);
  Object.assign(options, {packets: {size: 100}, effort: 9});
  const result = await first;
  assert.deepEqual(result.bytes, bytes);
  assert.equal(result.packets, undefined);
  const moved = sceneOf(40, 30, 4, 90), second = encode(moved, {bytes: 300, effort: 0});
  structuredClone(moved.data.buffer, {transfer: [moved.data.buffer]});
  assert.deepEqual((await second).bytes, bytes);
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
  const large = sceneOf(400, 300), controllers = Array.from({length: 3 * availableParallelism()}, () => new AbortController);
  const running = controllers.map(({signal}) => encode(large, {effort: 9, signal}).catch(({name}) => name));
  const last = encode(sceneOf(16, 16), {bytes: 60, effort: 0});
  controllers.at(-1).abort(); /* it waits */
  assert.equal(await running.at(-1), 'AbortError');
  await pause(100);
  for (const controller of controllers)
    controller.abort();
  assert.deepEqual(new Set(await Promise.all(running)), new Set(['AbortError']));
  assert((await last).bytes.length > 10);
});

test('one signal stops those that run and those that wait', async () => {
  const controller = new AbortController, large = sceneOf(400, 300), all = Array.from({length: 3 * availableParallelism()}, () => encode(large, {effort: 9, signal: controller.signal}).catch(({name}) => name));
  const last = encode(sceneOf(16, 16), {bytes: 60, effort: 0});
  await pause(100);
  controller.abort();
  assert.deepEqual(new Set(await Promise.all(all)), new Set(['AbortError']));
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

/* ---- Threads ---- */

/* Large enough for launches that are worth several threads. */
const shared = sceneOf(120, 90), OPTIONS = {bytes: 300, effort: 1}, {bytes: alone} = await encode(shared, {...OPTIONS, threads: 1});

test('threads are workers, which are kept, and end where they have had much memory', async () => {
  let started = 0, running = 0;
  const encode = await encoderWith(4, (listeners, ordinary) => {
    started++, running++;
    return ordinary(listeners).on('exit', () => running--);
  });
  for (let i = 0; i < 30; i++)
    assert.deepEqual((await encode(shared, {...OPTIONS, threads: 3})).bytes, alone);
  assert(started >= 5 && started <= 20, `${started}`);
  assert(running <= 4, `${running}`);
});

test('small pictures have the same bytes with four threads, each time', async () => {
  for (let i = 0; i < 10; i++) {
    const source = sceneOf(30 + i, 25), options = {bytes: 200, effort: 0};
    assert.deepEqual((await encode(source, {...options, threads: 4})).bytes, (await encode(source, {...options, threads: 1})).bytes);
  }
});

test('encodes at once divide the processors', async () => {
  let started = 0;
  const encode = await encoderWith(2, (listeners, ordinary) => (started++, ordinary(listeners)));
  const both = [encode(shared, OPTIONS), encode(shared, OPTIONS)];
  await Promise.race(both);
  assert.equal(started, 2);
  for (const {bytes} of await Promise.all(both))
    assert.deepEqual(bytes, alone);
});

test('an encode with threads is stopped at once, and so are its workers', async () => {
  let running = 0;
  const encode = await encoderWith(4, (listeners, ordinary) => (running++, ordinary(listeners).on('exit', () => running--)));
  const controller = new AbortController, stopped = encode(sceneOf(300, 200), {effort: 9, threads: 4, signal: controller.signal});
  while (running < 4)
    await pause(5);
  controller.abort();
  await assert.rejects(stopped, {name: 'AbortError'});
  for (let i = 0; running > 0 && i < 1000; i++)
    await pause(5);
  assert.equal(running, 0);
  assert.deepEqual((await encode(shared, {...OPTIONS, threads: 4})).bytes, alone);
});

test('an encode goes on without threads that cannot be started', async () => {
  let started = 0;
  const throwing = await encoderWith(4, (listeners, ordinary) => {
    assert(++started == 1, 'there is no worker');
    return ordinary(listeners);
  });
  assert.deepEqual((await throwing(shared, {...OPTIONS, threads: 4})).bytes, alone);
  assert(started > 1);
  started = 0;
  const failing = await encoderWith(4, (listeners, ordinary) => {
    if (++started == 1)
      return ordinary(listeners);
    setTimeout(() => listeners.onError(Error('there is no worker')));
    return {postMessage() {}, terminate() {}};
  });
  assert.deepEqual((await failing(shared, {...OPTIONS, threads: 4})).bytes, alone);
  assert(started > 1);
});

test('an encode fails where one of its threads does', async () => {
  const encode = await encoderWith(4, ({onMessage, onError}, ordinary) =>
    ordinary({onError, onMessage: message => message.isUp ? onMessage(message) || onError(Error('of a thread')) : onMessage(message)}));
  await assert.rejects(encode(sceneOf(300, 200), {effort: 9, threads: 2}), {code: 'failed', message: 'the encoder failed: of a thread'});
});

test('a process whose encodes are done ends', () => {
  const script = `import {encode} from ${JSON.stringify(pathToFileURL(join(folder, 'encode-node.js')).href)};
    const {bytes} = await encode({data: new Uint8Array(48).fill(9), width: 4, height: 4}, {bytes: 60}); console.log(bytes.length > 5);`;
  assert.equal(execFileSync(process.execPath, ['--input-type=module', '-e', script], {encoding: 'utf8', timeout: 120000}), 'true\n');
});

process.exitCode = await runTests() ? 0 : 1;
rmSync(made, {recursive: true});
