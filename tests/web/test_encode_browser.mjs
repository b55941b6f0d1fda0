/* The encoder of the package in a browser: the files of Node, a page that stays alive, and what a page may forbid.
 *
 *     node test_encode_browser.mjs FOLDER    FOLDER: host/web of the build folder
 *
 * BROWSER names the browser: chromium or firefox. */
import assert from 'node:assert/strict';
import {join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

import {serve, startBrowser} from './browsers.mjs';
import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]);
const {encode} = await import(pathToFileURL(join(folder, 'encode-node.js')));
const policies = {};
const missing = new Set; /* modules that are not found */
const ISOLATING = {'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp'};
const page = (name, headers = {}) => (_, response) => response.writeHead(200, {'content-type': 'text/html', ...headers, ...policies[name] ? {'content-security-policy': policies[name]} : {}}).end(
  '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><script type="module" src="/tests/scenes.mjs"></script><canvas></canvas>');
const gone = name => (_, response) => missing.has(name) ? response.writeHead(503).end() : response.writeHead(307, {location: `/kept/${name}`}).end();
policies.strict = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; worker-src 'self'";
policies.closed = "default-src 'none'; script-src 'self'; connect-src 'self'; worker-src 'self'";
const site = await serve({'/tests/': fileURLToPath(new URL('.', import.meta.url)), '/web/': folder, '/kept/': folder}, {
  '/page': page('open'), '/isolated': page('open', ISOLATING), '/strict': page('strict'), '/closed': page('closed'), '/web/gscl-encode.wasm': gone('gscl-encode.wasm'), '/web/gscl-encode-alpha.wasm': (request, response) => isSlow ? slow = response : gone('gscl-encode-alpha.wasm')(request, response),
}, ISOLATING);
let isSlow = false, slow; /* the answer to a request for the module for alpha, in a test */
const browser = await startBrowser();
const open = path => browser.open(site.url + path);
/* The value of a body of an async function, which has encode, sceneOf and, for errors, failure. */
const inPage = body => browser.evaluate(`(async () => {
  const {encode} = await import('/web/encode.js'), {sceneOf} = await import('/tests/scenes.mjs');
  const failure = promise => promise.then(() => 'encoded', error => [error.name, error.code, error.message].join(': '));
  ${body}
})()`);

test('pictures of all kinds become the bytes that Node writes', async () => {
  await open('/page');
  for (const [channels, alpha, options] of [[4, 255, {bytes: 300, effort: 2}], [4, 90, {bytes: 300, effort: 1}], [3, 255, {bpp: 0.5, effort: 1, tune: 'psnr'}],
    [1, 255, {psnr: 24, effort: 0}], [2, 30, {bytes: 200, effort: 0, bare: true}], [3, 255, {bytes: 700, effort: 0, packets: {size: 150}}]]) {
    const bytes = await inPage(`const {bytes} = await encode(sceneOf(80, 60, ${channels}, ${alpha}), ${JSON.stringify(options)}); return Array.from(bytes);`);
    assert.deepEqual(Uint8Array.from(bytes), Uint8Array.from((await encode(sceneOf(80, 60, channels, alpha), options)).bytes), JSON.stringify(options));
  }
  assert.deepEqual(browser.errors, []);
});

test('the pixels of a canvas are a picture', async () => {
  assert.deepEqual(await inPage(`const canvas = document.querySelector('canvas'), context = canvas.getContext('2d');
    canvas.width = 64, canvas.height = 48, context.fillStyle = '#37f', context.fillRect(0, 0, 64, 48), context.fillStyle = '#fc3', context.fillRect(20, 10, 20, 20);
    const image = context.getImageData(0, 0, 64, 48), {bytes, width, height} = await encode(image, {bytes: 200, effort: 0});
    const {decode} = await import('/web/gscl.js'), {data} = await decode(bytes);
    return [width, height, image.data.length == 64 * 48 * 4, data[2] > 200, data[4 * (20 * 64 + 30)] > 200];`), [64, 48, true, true, true]);
});

test('the page stays alive, is told of the progress, and stops an encode at once', async () => {
  const {ticks, fractions, name, late} = await inPage(`let ticks = 0; const timer = setInterval(() => ticks++, 5), fractions = [], controller = new AbortController;
    await encode(sceneOf(300, 200), {bytes: 600, effort: 0, onProgress: ({fraction}) => fractions.push(fraction)});
    clearInterval(timer);
    const stopped = encode(sceneOf(600, 400), {effort: 9, signal: controller.signal, onProgress: () => controller.abort()});
    const name = await stopped.catch(({name}) => name), late = (await encode(sceneOf(16, 16), {bytes: 60, effort: 0})).bytes.length;
    return {ticks, fractions, name, late};`);
  assert(ticks >= 5, `${ticks}`);
  assert(fractions.length >= 2 && fractions.every((it, i) => !i || it >= fractions[i - 1]), fractions.join());
  assert.equal(name, 'AbortError');
  assert(late > 10);
});

test('an encode is stopped while its module is on the way', async () => {
  isSlow = true;
  await open('/page');
  assert.equal(await inPage(`const controller = new AbortController, stopped = encode(sceneOf(20, 20, 4, 90), {signal: controller.signal});
    setTimeout(() => controller.abort(), 100);
    return stopped.catch(({name}) => name);`), 'AbortError');
  slow.writeHead(503).end();
  isSlow = false;
});

test('threads, where the page is isolated from other origins, give the same bytes', async () => {
  for (const [path, workers] of [['/isolated', 2], ['/page', 1]]) {
    await open(path);
    const {bytes, started} = await inPage(`let started = 0;
      window.Worker = class extends Worker { constructor(...of) { super(...of), started++; } };
      const {bytes} = await encode(sceneOf(120, 90), {bytes: 300, effort: 1, threads: 2});
      return {bytes: Array.from(bytes), started};`);
    assert.deepEqual(Uint8Array.from(bytes), Uint8Array.from((await encode(sceneOf(120, 90), {bytes: 300, effort: 1, threads: 1})).bytes), path);
    assert.equal(started, workers, path);
  }
});

test('an encode with threads is stopped at once, and goes on without those that cannot be started', async () => {
  await open('/isolated');
  assert.deepEqual(await inPage(`const controller = new AbortController, stopped = encode(sceneOf(300, 200), {effort: 9, threads: 4, signal: controller.signal, onProgress: () => controller.abort()});
    const name = await stopped.catch(({name}) => name);
    let started = 0;
    window.Worker = class extends Worker { constructor(script, options) { super(started++ ? '/no-worker.js' : script, options); } };
    const {width} = await encode(sceneOf(300, 200), {effort: 1, threads: 4});
    return [name, width, started > 1];`), ['AbortError', 300, true]);
});

test('errors have the code and the message of Node', async () => {
  assert.equal(await inPage(`return failure(encode(sceneOf(16, 16), {bytes: 3}))`), 'GsclError: budget-too-small: a budget of 3 bytes is too small; the smallest file of this image has 14 bytes');
  assert.match(await inPage(`return failure(encode(document.querySelector('canvas')))`), /^GsclError: invalid-argument: data must be/);
});

test('a policy of the page that allows WebAssembly is enough, and one that does not is an error', async () => {
  await open('/strict');
  assert.equal(await inPage(`return (await encode(sceneOf(16, 16), {bytes: 60, effort: 0})).width`), 16);
  await open('/closed');
  assert.match(await inPage(`return failure(encode(sceneOf(16, 16), {bytes: 60, effort: 0}))`), /^GsclError: failed: the encoder failed: .*(wasm|WebAssembly)/i);
});

test('a module that is not found is an error, and the next call asks again', async () => {
  missing.add('gscl-encode.wasm');
  await open('/page');
  assert.match(await inPage(`return failure(encode(sceneOf(16, 16), {bytes: 60, effort: 0}))`), /^GsclError: failed: .*gscl-encode.wasm: status 503/);
  missing.clear();
  assert.equal(await inPage(`return (await encode(sceneOf(16, 16), {bytes: 60, effort: 0})).width`), 16);
});

try {
  process.exitCode = await runTests() ? 0 : 1;
} finally {
  await browser.close();
  site.close();
}
