/* The decoder without WebAssembly: pictures beside those of the decoder of node.js, and what it refuses.
 *
 *     node test_tiny.mjs FOLDER [CHANGED]    FOLDER: host/web of the build folder; CHANGED: number of changed files, default 1000 */
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, readFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), changed = Number(process.argv[3] ?? 1000);
const entry = name => import(pathToFileURL(join(folder, name)));
const tiny = await entry('tiny.js'), full = await entry('node.js');
const set = fileURLToPath(new URL('../conformance/', import.meta.url));
const index = JSON.parse(readFileSync(join(set, 'index.json')));
const fileOf = ({file, packets}) => Uint8Array.from(readFileSync(join(set, 'files', file + (packets ? '.gsclp' : '.gscl'))));

const MAX_GZIPPED = 4000; /* bytes */
const MAGIC_AND_VERSION = 5, CHECK = 2; /* bytes around a picture without blocks */

/* The bare form of all files of the set that have no blocks, whatever is wrong with them. */
const bareFiles = index.filter(({packets}) => !packets).map(entry => ({...entry, bytes: fileOf(entry)}))
  .filter(({bare, bytes}) => bare || bytes[4] == 2).map(({bare, bytes, ...rest}) => ({...rest, bytes: bare ? bytes : bytes.slice(MAGIC_AND_VERSION, -CHECK)}));
const photograph = bareFiles.find(({file}) => file == 'bare-photograph').bytes;

/* The code of what decode throws, which must be one of ours. */
const codeOf = (source, size) => {
  try {
    const {width, height, data} = tiny.decode(source, size);
    assert.equal(data.length, 4 * width * height);
    return 'valid';
  } catch (error) {
    assert(error.name == 'GsclError' && error instanceof Error, error.stack);
    assert.match(error.message, /^[^\n]{10,60}$/);
    return error.code;
  }
};

/* Compares with the other decoder. */
const assertSame = async (bytes, size, name) => {
  const own = tiny.decode(bytes, size), {width, height, data} = await full.decode(bytes, {...size, bare: true});
  assert.deepEqual([own.width, own.height], [width, height], name);
  assert(own.data instanceof Uint8ClampedArray && own.data.length == data.length, name);
  data.forEach((sample, i) => assert(Math.abs(sample - own.data[i]) <= 1, `${name} at ${width}x${height}: sample ${i} is ${own.data[i]}, not ${sample}`));
};

test('the script is small gzipped', () => {
  const size = execFileSync('gzip', ['-9', '-c', join(folder, 'tiny.js')]).length; /* Node compresses less */
  console.log(`# ${size} bytes`);
  assert(size <= MAX_GZIPPED, `${size} bytes`);
});

test('conformance set', async () => {
  const counts = {};
  for (const {file, bytes} of bareFiles) {
    const size = {width: 48, height: 37};
    const expected = await full.decode(bytes, {...size, bare: true}).then(() => 'valid', error => error.code), code = codeOf(bytes, size);
    assert(code == expected || code == 'unsupported', `${file}: ${code}, not ${expected}`);
    if (code == 'valid')
      await assertSame(bytes, size, file);
    counts[code] = (counts[code] ?? 0) + 1;
  }
  assert(counts.valid > 50 && counts.truncated > 5 && counts.corrupt > 2, JSON.stringify(counts));
});

test('files that are not bare are refused', () => {
  for (const entry of index.filter(({bare}) => !bare)) {
    const bytes = fileOf(entry), isWhole = String.fromCharCode(...bytes.subarray(1, 3)) == 'gs' && bytes[0] == 199;
    assert(isWhole ? codeOf(bytes) == 'unsupported' : codeOf(bytes) != 'valid', entry.file);
  }
});

test('sizes', async () => {
  const {width, height} = await full.info(photograph, {bare: true});
  assert.deepEqual(tiny.info(photograph), {width, height});
  for (const size of [{width: 1, height: 1}, {width: 64, height: 40}, {width: 64, height: 7}, {width: 3, height: 90}, {width: 200, height: 130}, {width, height}])
    await assertSame(photograph, size, 'photograph');
  const {width: w, height: h} = tiny.decode(photograph), scale = Math.min(1, 64 / Math.max(width, height));
  assert.deepEqual([w, h], [Math.round(width * scale), Math.round(height * scale)]);
  assert.deepEqual([photograph].map(tiny.decode)[0].data, tiny.decode(photograph).data);
});

test('bytes, views, base64 and base64url give the same picture', () => {
  const {data} = tiny.decode(photograph), text = Buffer.from(photograph).toString('base64');
  const copy = new Uint8Array(photograph.length + 9).fill(7);
  copy.set(photograph, 5);
  for (const source of [photograph.buffer, new DataView(copy.buffer, 5, photograph.length), text, text.replace(/=/g, ''), ` ${text}\n`, Buffer.from(photograph).toString('base64url')])
    assert.deepEqual(tiny.decode(source).data, data);
});

test('arguments that are refused', () => {
  for (const source of [undefined, null, 0, 1e12, {}, [], '*', 'AAAAA'])
    assert.equal(codeOf(source), 'invalid-argument', String(source));
  for (const size of [{width: 5}, {height: 5}, {width: 1.5, height: 2}, {width: -1, height: 4}, {width: NaN, height: 3}])
    assert.equal(codeOf(photograph, size), 'invalid-argument', JSON.stringify(size));
  assert.equal(codeOf(photograph, {width: 257, height: 256}), 'limit');
  assert.equal(codeOf(photograph, {width: 2 ** 40, height: 2 ** 40}), 'limit');
  assert.equal(codeOf(''), 'truncated');
});

/* Pictures of colours and shapes, all seen by the channels of a layout: width x height. */
const pictureOf = (channels, width, height) => ({width, height, data: Uint8Array.from({length: channels * width * height}, (_, at) => {
  const k = at % channels, i = Math.floor(at / channels), x = i % width / width, y = Math.floor(i / width) / height;
  const isAlpha = channels % 2 == 0 && k == channels - 1, isInside = (x - .4) ** 2 + (y - .6) ** 2 < .09;
  return isAlpha ? isInside ? 255 : 60 : 127 + 80 * Math.sin(5 * x + 2 * k) + (isInside ? 40 - 30 * k : 20 * Math.cos(90 * y));
})});

if (existsSync(join(folder, 'encode-node.js')))
  test('files of the encoder', async () => {
    const {encode} = await entry('encode-node.js');
    for (const [channels, width, height, bytes] of [[1, 64, 64, 60], [2, 50, 31, 90], [3, 128, 85, 30], [3, 128, 85, 100], [3, 85, 128, 200], [4, 60, 40, 120], [3, 200, 20, 400]]) {
      const file = (await encode(pictureOf(channels, width, height), {bytes, bare: true, effort: 1})).bytes;
      for (const size of [{width, height}, {width: 64, height: 43}])
        await assertSame(file, size, `${channels} channels, ${bytes} bytes`);
    }
  });

test('changed and random bytes give a picture or an error, soon', () => {
  let state = 1;
  const random = n => (state = state * 48271 % 2147483647) % n, codes = {};
  const originals = bareFiles.filter(({bytes}) => bytes.length < 500 && codeOf(bytes) == 'valid'), begin = Date.now();
  for (let i = 0; i < changed; i++) {
    const bytes = i % 4 ? Uint8Array.from(originals[random(originals.length)].bytes) : Uint8Array.from({length: random(300)}, () => random(256));
    for (let n = random(3) + 1; n-- && bytes.length;)
      bytes[random(bytes.length)] ^= 1 + random(255);
    const code = codeOf(bytes.subarray(0, random(8) ? bytes.length : random(bytes.length + 1)), {width: 1 + random(9), height: 1 + random(9)});
    codes[code] = (codes[code] ?? 0) + 1;
  }
  console.log(`# ${JSON.stringify(codes)} in ${Date.now() - begin} ms`);
  assert.deepEqual(Object.keys(codes).sort(), ['corrupt', 'truncated', 'unsupported', 'valid']);
});

process.exitCode = await runTests() ? 0 : 1;
