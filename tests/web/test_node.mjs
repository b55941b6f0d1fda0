/* The decoder for web pages in Node: the conformance set, prefixes, changed bytes, arguments and limits.
 *
 *     node test_node.mjs FOLDER MODULE    FOLDER: host/web of the build folder; MODULE: gscl.wasm or gscl-packets.wasm
 *
 * GSCL names the tool, with which pictures at other sizes are compared, and which writes packets. */
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {gzipSync} from 'node:zlib';

import {assertPicture, assertPixel, rgbaOf} from './compare.mjs';
import {readPng} from './png.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), module = process.argv[3], gscl = process.env.GSCL;
const hasPackets = module == 'gscl-packets.wasm';
const entry = name => import(pathToFileURL(join(folder, name)));
const {decode, info, splats, load, GsclError} = await entry('node.js');
const set = fileURLToPath(new URL('../conformance/', import.meta.url));
const index = JSON.parse(readFileSync(join(set, 'index.json'))).filter(entry => hasPackets || !entry.packets);
const lists = new Set(index.filter(entry => entry.packets).map(entry => entry.file));
const fileOf = name => readFileSync(join(set, 'files', name + (lists.has(name) ? '.gsclp' : '.gscl')));
const loadModule = () => load(readFileSync(join(folder, module)));
await loadModule();

const MAX_GZIPPED = 15000; /* bytes of the module and its script */
const MAX_PACKETS_GZIPPED = 19500; /* the same with packets */

const codeOf = promise => promise.then(() => 'valid', error => {
  assert(error instanceof GsclError && error instanceof Error, String(error));
  assert(error.message.length > 5);
  return error.code;
});

test('the module and its scripts are small gzipped', () => {
  const scripts = hasPackets ? ['gscl.js', 'splats.js', 'packets.js'] : ['gscl.js'];
  const sizes = [module, ...scripts].map(name => gzipSync(readFileSync(join(folder, name)), {level: 9}).length);
  console.log(`# ${sizes.join(' + ')} bytes`);
  assert(sizes.reduce((sum, size) => sum + size) <= (hasPackets ? MAX_PACKETS_GZIPPED : MAX_GZIPPED), `${sizes.join(' + ')} bytes`);
});

test('the other entries of the package need neither a page nor files in Node', async () => {
  const inline = await entry('inline.js'), {GsclImage} = await entry('gscl.js'), file = fileOf('example');
  assert.deepEqual(Object.keys(inline).sort(), ['GsclError', 'GsclImage', 'decode', 'info', 'load', 'splats']);
  assert.equal(typeof GsclImage, 'function');
  assert.deepEqual((await inline.decode(file)).data, (await decode(file)).data);
  assert.deepEqual(await inline.splats(file), await splats(file));
  await assert.rejects(inline.info(file.subarray(0, 3)), inline.GsclError);
});

test('a placeholder is a small PNG of the picture, with its mean colour', async () => {
  const {placeholder} = await entry('placeholder-node.js'), width = 12, kinds = new Set;
  for (const {file, bare} of index.filter(({file, result}) => result == 'valid' && !lists.has(file)).slice(0, 40)) {
    const own = await info(fileOf(file), {bare}), it = await placeholder(fileOf(file), {bare, width});
    const {samples, channels, width: w, height: h} = readPng(Buffer.from(it.url.replace('data:image/png;base64,', ''), 'base64'));
    const {data} = await decode(fileOf(file), {bare, width: w, height: h});
    assert.deepEqual([it.width, it.height, it.aspectRatio], [own.width, own.height, own.width / own.height], file);
    assert(w == width ? h <= 4 * w : h == 4 * width && w < width, `${file}: ${w}x${h}`);
    for (let i = 0; i < w * h; i++)
      assert.deepEqual([...samples.slice(i * channels, (i + 1) * channels)], [...data.slice(4 * i, 4 * i + channels)], `${file}, pixel ${i}`);
    assert(it.hasAlpha == (channels == 4) && /^#[0-9a-f]{6}$/.test(it.colour), it.colour);
    kinds.add(channels);
  }
  assert.deepEqual([...kinds].sort(), [1, 3, 4]);
});

test('the package exports the files that it has, and has those', () => {
  const isLeftOut = name => /encode/.test(name) && !existsSync(join(folder, 'encode.js')); /* a build without the encoder */
  const {exports, files} = JSON.parse(readFileSync(join(folder, 'package.json')));
  for (const name of [...Object.values(exports).flatMap(it => typeof it == 'string' ? it : Object.values(it)), ...files]) {
    assert(isLeftOut(name) || readFileSync(join(folder, name)).length > 0, name);
    assert(name == './package.json' || files.includes(name.replace('./', '')), name); /* npm takes that along */
  }
});

test('the package has the version of the library', () => {
  const header = readFileSync(new URL('../../host/include/gscl/version.h', import.meta.url), 'utf8');
  assert.equal(JSON.parse(readFileSync(join(folder, 'package.json'))).version, /GSCL_VERSION "(.*)"/.exec(header)[1]);
});

for (const result of new Set(index.map(entry => entry.result)))
  test(`conformance set: ${result}`, async () => {
    for (const {file, bare} of index.filter(entry => entry.result == result))
      assert.equal(await codeOf(decode(fileOf(file), {bare})), result, file);
  });

test('conformance set: pictures', async () => {
  let count = 0;
  for (const {file, bare, picture, samples = []} of index.filter(entry => entry.result == 'valid')) {
    const bytes = fileOf(file), image = await decode(bytes, {bare}), {channels, bitDepth} = await info(bytes, {bare});
    if (picture)
      assertPicture(image, readPng(readFileSync(join(set, 'pictures', picture))), file);
    for (const [x, y, ...values] of samples)
      assertPixel(image.data, 4 * (y * image.width + x), rgbaOf(values.slice(0, channels), bitDepth), file);
    count += picture != null || samples.length > 0;
  }
  assert(count > 100);
});

test('splats draw the picture, with their waves', async () => {
  const file = fileOf('photograph'), list = await splats(file), {width, height, data} = await decode(file);
  assert(list.some(({wave}) => wave));
  for (let at = 0; at < width * height; at += 97) {
    const sums = [0, 0, 0, 1 / 1024];
    for (const {x, y, sigma1, sigma2, theta, opacity, colour, wave} of list) {
      const dx = at % width + 0.5 - x, dy = Math.floor(at / width) + 0.5 - y, c = Math.cos(theta), s = Math.sin(theta);
      const q = (((c * dx + s * dy) / sigma1) ** 2 + ((c * dy - s * dx) / sigma2) ** 2) / 2, weight = opacity * Math.max(0, Math.exp(-q) - Math.exp(-7));
      const added = wave ? wave.amplitude * Math.cos(2 * Math.PI * (wave.x * dx + wave.y * dy - wave.phase)) : 0;
      colour.slice(0, 3).forEach((it, k) => sums[k] += weight * (it + added));
      sums[3] += weight;
    }
    for (let k = 0; k < 3 && sums[3] > 0.2; k++) /* of which the background is at most 1 of 200 */
      assert(Math.abs(data[4 * at + k] - 255 * Math.min(Math.max(sums[k] / sums[3], 0), 1)) < 3, `pixel ${at}`);
  }
});

test('info and splats of the example of FORMAT.md', async () => {
  const file = fileOf('example');
  assert.deepEqual(await info(file), {width: 12, height: 8, channels: 3, bitDepth: 8, splats: 2, layers: 1});
  const [first, second] = await splats(file);
  const near = (value, expected) => assert(Math.abs(value - expected) < 1e-4, `${value}, not ${expected}`);
  near(first.x, 4.2402), near(first.y, 3.9141), near(first.sigma1, 8.3542), near(first.sigma2, 2.2776), near(first.theta, 1.3);
  first.colour.forEach((value, i) => near(value, [0.4818, 0.2545, 0.2091, 1][i]));
  near(second.x, 9.2695), near(second.sigma2, 1.834), near(second.opacity, 1);
});

test('prefixes', async () => {
  for (const name of ['example', 'photograph', 'layers-8', 'blocks']) {
    const file = fileOf(name), total = (await info(file)).splats;
    let before = 0, drawn = 0;
    for (let size = 0; size <= file.length; size++) {
      const part = file.subarray(0, size), code = await codeOf(decode(part, {partial: true}));
      if (code != 'valid') {
        assert.equal(before, 0, `${name}: ${size} bytes`);
        continue;
      }
      const count = (await splats(part, {partial: true})).length;
      assert(before <= count && count <= total, `${name}: ${size} bytes`);
      before = count;
      drawn++;
      assert(size == file.length || await codeOf(decode(part)) != 'valid', `${name}: ${size} bytes`);
    }
    assert.equal(before, total);
    assert(drawn > 5, `${name}: ${drawn} parts are drawn`);
  }
});

test('changed bytes neither trap nor hang', async () => {
  let state = 1, count = 0;
  const random = n => (state = state * 48271 % 2147483647) % n;
  const codes = new Set();
  for (const {file, bare} of index.filter(entry => entry.result == 'valid')) {
    const original = fileOf(file);
    for (let i = 0; i < 3 && original.length < 4000; i++, count++) {
      const bytes = Uint8Array.from(original);
      bytes[random(bytes.length)] ^= 1 + random(255);
      for (const options of [{bare}, {bare, partial: true}])
        codes.add(await codeOf(decode(bytes, {...options, maxPixels: 1e6, maxWork: 1e7})));
    }
  }
  assert(count > 300);
  assert(!codes.has('failed') && codes.has('corrupt') && codes.has('damaged') && codes.has('limit'), [...codes].join(' '));
});

test('random bytes', async () => {
  for (let i = 0; i < 300; i++) {
    const bytes = Uint8Array.from({length: 5 + i % 60}, (_, k) => (i * 7919 + k * k * 104729 >> 3) & 255);
    await codeOf(decode(bytes, {bare: true, maxPixels: 1e5, maxWork: 1e7}));
  }
});

test('sizes, crops and limits as gscl_decode', async () => {
  const file = fileOf('photograph'), {width, height} = await info(file);
  const refused = async (options, code, message) => {
    const error = await decode(file, options).then(() => assert.fail(JSON.stringify(options)), it => it);
    assert.equal(error.code, code, String(error));
    assert.match(error.message, message);
  };
  await refused({width: 10}, 'invalid-argument', /^give both width and height, or neither$/);
  await refused({width: 16385, height: 1}, 'image-size', /^cannot draw 16385x1 pixels; at most 16384x16384$/);
  await refused({width: 2 ** 25, height: 1, crop: {width: 5, height: 1}}, 'image-size', /^cannot draw 33554432x1 pixels; at most 16777216x16777216$/);
  await refused({width: 1.5, height: 2}, 'invalid-argument', /whole numbers/);
  await refused({width: -1, height: -1}, 'invalid-argument', /whole numbers/);
  await refused({width: NaN, height: 1}, 'invalid-argument', /whole numbers/);
  await refused({width: 8, height: 8, crop: {x: 1, y: 2, width: 8, height: 1}}, 'invalid-argument', /^crop 1,2,8,1 is not inside 8x8$/);
  await refused({crop: {x: width}}, 'invalid-argument', /is not inside/);
  await refused({maxPixels: 5}, 'limit', new RegExp(`^the image has ${width}x${height} pixels; max_pixels is 5$`));
  await refused({maxWork: 1}, 'limit', /max_work is 1$/);
  await refused({maxWork: 1000}, 'limit', /^drawing takes [0-9]+ evaluations; max_work is 1000$/);
  assert.equal(await codeOf(decode('text')), 'not-a-gscl-file');
  assert.equal(await codeOf(decode(undefined)), 'not-a-gscl-file');
});

test('messages need no more than the engines that the page names', async () => {
  const at = String.prototype.at;
  delete String.prototype.at;
  try {
    assert.equal(await codeOf(decode(fileOf('damaged-bit'))), 'damaged');
  } finally {
    String.prototype.at = at;
  }
});

test('messages name figures', async () => {
  const file = fileOf('example');
  await assert.rejects(decode(file.subarray(0, 10)), {code: 'truncated', message: 'the file is incomplete: it has 10 bytes'});
  const newer = Uint8Array.from(file);
  newer[4] = 3;
  await assert.rejects(decode(newer), {code: 'newer-version', message: 'the file has format version 3; this program reads version 2'});
});

test('views, buffers and crops give the same picture', async () => {
  const file = fileOf('photograph'), whole = await decode(file, {width: 300, height: 200});
  const copy = new Uint8Array(file.length + 9).fill(7);
  copy.set(file, 5);
  const view = new DataView(copy.buffer, 5, file.length);
  assert.deepEqual((await decode(view, {width: 300, height: 200})).data, whole.data);
  assert.deepEqual((await decode(Uint8Array.from(file).buffer, {width: 300, height: 200})).data, whole.data);
  const crop = await decode(file, {width: 300, height: 200, crop: {x: 250, y: 30, width: 21, height: 9}});
  for (let y = 0; y < 9; y++)
    assert.deepEqual(crop.data.subarray(y * 84, y * 84 + 84), whole.data.subarray(((y + 30) * 300 + 250) * 4, ((y + 30) * 300 + 271) * 4));
});

test('a far zoom is the picture near its place', async () => {
  const file = fileOf('photograph'), {width, height} = await info(file), zoom = 1 << 14;
  const near = await decode(file, {width: width * 64, height: height * 64, crop: {x: 64 * 5, y: 64 * 7, width: 64, height: 64}});
  for (const [x, y] of [[3, 4], [60, 33], [32, 0]]) {
    const far = await decode(file, {width: width * zoom, height: height * zoom, crop: {x: (64 * 5 + x) * zoom / 64 + zoom / 128, y: (64 * 7 + y) * zoom / 64 + zoom / 128, width: 2, height: 2}});
    assertPixel(far.data, 0, [...near.data.subarray(4 * (64 * y + x), 4 * (64 * y + x) + 4)], `${x}, ${y}`);
  }
});

if (gscl)
  test('pictures at other sizes are those of the tool', async () => {
    const made = mkdtempSync(join(tmpdir(), 'gscl-web-'));
    try {
      for (const name of ['photograph', 'layers-8', 'bits-16', 'layout-grey-alpha', 'codebook-alpha-rgb-alpha'])
        for (const [width, height] of [[97, 61], [500, 333], [7, 90]]) {
          writeFileSync(join(made, 'file.gscl'), fileOf(name));
          execFileSync(gscl, ['decode', '--device', 'host', '--size', `${width}x${height}`, '-o', join(made, 'out.png'), join(made, 'file.gscl')]);
          assertPicture(await decode(fileOf(name), {width, height}), readPng(readFileSync(join(made, 'out.png'))), `${name} at ${width}x${height}`);
        }
    } finally {
      rmSync(made, {recursive: true});
    }
  });

test('a trap is an ordinary error, and the next call works', async () => {
  /* A module whose functions have an unreachable instruction. */
  const trap = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 7, 1, 96, 2, 127, 127, 1, 127, 3, 2, 1, 0, 7, 8, 1, 4, 102, 105, 108, 101, 0, 0, 10, 5, 1, 3, 0, 0, 11);
  await load(trap);
  await assert.rejects(decode(fileOf('example')), {code: 'failed', message: /^the decoder failed: unreachable/});
  await loadModule();
  assert.equal((await decode(fileOf('example'))).width, 12);
});

test('many calls do not add up memory', async () => {
  const file = fileOf('photograph'), options = {width: 1000, height: 1000};
  await decode(file, options);
  const before = process.memoryUsage().rss;
  for (let i = 0; i < 60; i++)
    await decode(file, options);
  const grown = process.memoryUsage().rss - before;
  assert(grown < 200e6, `${grown} bytes more`); /* 60 pictures of 4 MB and their memory would be 600 MB */
});

/* ---- Packets ---- */

/* Takes a list apart. */
const packetsOf = list => {
  const packets = [];
  for (let at = 4; at < list.length;) {
    let size = list[at] & 127;
    for (let shift = 7; list[at++] > 127; shift += 7)
      size |= (list[at] & 127) << shift;
    packets.push(list.subarray(at, at += size));
  }
  return packets;
};

/* Calls use(encode, draw) with functions that write a list of packets of a picture, and its packets, with the tool, and that
 * draw a list with it. */
const withTool = async use => {
  const made = mkdtempSync(join(tmpdir(), 'gscl-web-')), path = name => join(made, name);
  const decodeBy = (file, ...options) => execFileSync(gscl, ['decode', '--device', 'host', '-o', path('out.png'), path(file), ...options]);
  const encode = (...options) => {
    execFileSync(gscl, ['encode', '--device', 'host', '--effort', '0', '--quiet', '--packets', '150', '-o', path('out.gsclp'), path('scene.png'), ...options]);
    return packetsOf(readFileSync(path('out.gsclp')));
  };
  try {
    writeFileSync(path('scene.gscl'), fileOf('photograph'));
    execFileSync(gscl, ['decode', '--device', 'host', '--size', '160x120', '-o', path('scene.png'), path('scene.gscl')]);
    await use(encode, list => {
      writeFileSync(path('in.gsclp'), list);
      decodeBy('in.gsclp');
      return readPng(readFileSync(path('out.png')));
    });
  } finally {
    rmSync(made, {recursive: true});
  }
};
const sizeField = size => size > 127 ? Buffer.of(size & 127 | 128, size >> 7) : Buffer.of(size);
const listOf = packets => Buffer.concat([Buffer.from('\u00c7gsp', 'latin1'), ...packets.flatMap(packet => [sizeField(packet.length), packet])]);

if (gscl && hasPackets) {
  test('packets draw the picture of the tool, whole or not', () => withTool(async (encode, draw) => {
    const packets = encode('--packet-count', '6'), list = listOf(packets), whole = await decode(packets);
    assert.equal(packets.length, 6);
    assertPicture(whole, draw(list), 'all');
    assert.deepEqual((await decode(list)).data, whole.data);
    assert.deepEqual((await decode(packets.map(packet => Uint8Array.from(packet).buffer).reverse())).data, whole.data);
    for (const some of [[0], [5], [1, 4], [5, 0, 2]]) {
      const part = some.map(i => packets[i]);
      assertPicture(await decode(part), draw(listOf(part)), some.join());
    }
    const small = await decode(packets, {width: 80, height: 60, crop: {x: 8, y: 4, width: 30, height: 20}});
    assert.deepEqual([small.width, small.height], [30, 20]);
    const {width, height, splats: most} = await info(packets), {length} = await splats(packets);
    assert.deepEqual([width, height], [160, 120]);
    assert(0 < length && length <= most);
    assert((await splats(packets.slice(2))).length < length);
  }));

  test('packets that are damaged, repeated or of another picture are left out', () => withTool(async encode => {
    const packets = encode('--packet-count', '4', '--packet-identity', '7'), others = encode('--packet-count', '4', '--packet-identity', '8');
    const {data} = await decode(packets), damaged = Uint8Array.from(packets[2]);
    damaged[9] ^= 4;
    const mixed = [damaged, packets[1], others[3], packets[0], new Uint8Array, packets[1], new Uint8Array(2 ** 21), packets[3], others[0], packets[2]];
    assert.deepEqual((await decode(mixed)).data, data);
    assert.equal(await codeOf(decode([])), 'truncated');
    assert.equal(await codeOf(decode([damaged])), 'damaged');
    assert.equal(await codeOf(decode([fileOf('example')])), 'damaged');
    assert.equal(await codeOf(decode(packets, {maxWork: 10})), 'limit');
    const list = listOf(packets);
    assert.equal(await codeOf(decode(list.subarray(0, list.length - 1))), 'valid'); /* without the last packet */
    assert.equal(await codeOf(decode(list.subarray(0, packets[0].length))), 'truncated');
  }));

  test('repair packets replace those that are lost', () => withTool(async encode => {
    const packets = encode('--packet-count', '12', '--packet-loss', '0.1'), {data} = await decode(packets), all = (await splats(packets)).length;
    let repairs = 0;
    while (repairs < packets.length && (await codeOf(decode(packets.slice(packets.length - repairs - 1)))) == 'damaged')
      repairs++; /* they come last, and draw nothing */
    assert(repairs > 1 && repairs < 6, `${repairs} repair packets`);
    assert.deepEqual((await decode(packets.slice(repairs))).data, data);
    assert.deepEqual((await decode([...packets.slice(repairs)].reverse())).data, data);
    assert((await splats(packets.slice(repairs + 1))).length < all);
  }));

  test('changed bytes in packets neither trap nor hang', () => withTool(async encode => {
    const packets = encode('--packet-count', '5', '--packet-loss', '0.2'), list = listOf(packets), codes = new Set;
    for (let i = 0; i < 400; i++) {
      const bytes = Uint8Array.from(list.subarray(0, i % 3 ? list.length : list.length * (i % 100) / 100));
      bytes[4 + i * 7919 % (bytes.length - 4)] ^= 1 + i % 255;
      codes.add(await codeOf(decode(bytes, {maxWork: 1e8})));
      codes.add(await codeOf(decode([bytes.subarray(i % 50, i % 50 + 100), packets[i % packets.length]], {maxWork: 1e8})));
    }
    assert(!codes.has('failed') && codes.has('valid'), [...codes].join(' '));
  }));
}

if (!hasPackets)
  test('a module without packets takes a list for no file', async () => {
    assert.equal(await codeOf(decode(listOf([new Uint8Array(50)]))), 'not-a-gscl-file');
  });

process.exitCode = await runTests() ? 0 : 1;
