/* Drawing by the GPU in Chromium, whose WebGL is drawn by software here, compared with the decoder.
 *
 *     node test_gpu.mjs FOLDER [SCREENSHOTS]    FOLDER: host/web of the build folder; SCREENSHOTS: a folder for pictures
 *
 * CHROMIUM names the browser. */
import assert from 'node:assert/strict';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

import {Chromium, SOFTWARE_WEBGL, serve} from './chromium.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), screenshots = process.argv[3];
const set = fileURLToPath(new URL('../conformance/', import.meta.url));
const index = JSON.parse(readFileSync(join(set, 'index.json'))).filter(({packets, result}) => !packets && result == 'valid');
const TOLERANCE = 2; /* of 255, of colours multiplied by alpha */

/* What the tests call in the page.  GPUs that are drawn by software count as none, but for these tests. */
const tools = `
  const getContext = HTMLCanvasElement.prototype.getContext;
  window.hasWebgl = location.hash != '#none';
  if (location.hash == '#half') {
    const {getExtension} = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.getExtension = function (name) { return name == 'EXT_float_blend' ? null : getExtension.call(this, name); };
  }
  window.contexts = new Set; /* of WebGL */
  HTMLCanvasElement.prototype.getContext = function (kind, {failIfMajorPerformanceCaveat, ...options} = {}) {
    const context = kind != 'webgl2' || hasWebgl ? getContext.call(this, kind, options) : null;
    if (kind == 'webgl2' && context)
      contexts.add(context);
    return context;
  };
  window.copies = 0; /* of pixels that the decoder has drawn */
  const {putImageData} = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.putImageData = function (...all) {
    copies++;
    return putImageData.apply(this, all);
  };
  window.events = [];
  for (const name of ['load', 'error'])
    document.addEventListener(name, ({target, error}) => target.matches('gscl-image') && events.push([target.id, name, error?.code]), true);
  window.bytesOf = async name => new Uint8Array(await (await fetch('/files/' + name + '.gscl')).arrayBuffer());
  /* Samples multiplied by alpha. */
  window.premultiplied = ({data}) => data.map((sample, i) => i % 4 < 3 ? Math.round(sample * data[i | 3] / 255) : sample);
  window.samplesOf = canvas => {
    const gl = canvas.getContext('webgl2'), {width, height} = canvas, rows = new Uint8Array(4 * width * height), data = new Uint8Array(rows.length);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
    for (let y = 0; y < height; y++)
      data.set(rows.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)), 4 * width * y);
    return data;
  };
  window.largest = (a, b) => a.length == b.length ? a.reduce((most, sample, i) => Math.max(most, Math.abs(sample - b[i])), 0) : 'size';
  /* Compares a view with the decoder, both at whole pixels of the whole drawn picture. */
  window.compare = async (viewer, bytes, zoom, x, y, options = {}) => {
    const {width, height} = canvas, crop = {x, y, width, height};
    viewer.draw({scale: zoom, x: x / zoom, y: y / zoom});
    return largest(samplesOf(canvas), premultiplied(await decode(bytes, {...options, width: viewer.width * zoom, height: viewer.height * zoom, crop})));
  };
  window.resized = (canvas, width, height) => Object.assign(canvas, {width, height});
`;
const page = body => `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><style>body{margin:0}</style><script>${tools}</script>
  <script type="module">import {view} from '/web/gpu.js'; import {decode, info, GsclImage} from '/web/gscl.js'; Object.assign(window, {view, decode, info, GsclImage});</script>
  <canvas id="canvas"></canvas>${body}`;
let shown, count = 0;
const site = await serve({'/web/': folder, '/files/': join(set, 'files')}, {
  '/page': (_, response) => response.writeHead(200, {'content-type': 'text/html'}).end(page(shown)),
});
const browser = await Chromium.start(SOFTWARE_WEBGL);
/* `gpu`: "none" for a browser without WebGL 2, "half" for one that adds floats of 16 bits only. */
const show = async (body = '', gpu = '') => {
  shown = body;
  await browser.open(`${site.url}/page?${++count}#${gpu}`);
  await browser.until('window.view');
};

/* The largest differences of each file, by its name. */
const compareFiles = files => browser.evaluate(`(async () => {
  const differences = {};
  for (const {file, bare} of ${JSON.stringify(files)}) {
    const bytes = await bytesOf(file), {width, height} = await info(bytes, {bare});
    if (width * height > 2 ** 18)
      continue;
    resized(canvas, Math.min(width, 100), Math.min(height, 80));
    const viewer = await view(canvas, bytes, {bare}), half = {bare, width: Math.ceil(width / 2), height: Math.ceil(height / 2)};
    const reduced = (await GsclImage.draw(bytes, half)).getContext('2d').getImageData(0, 0, half.width, half.height);
    differences[file] = [await compare(viewer, bytes, 1, 0, 0, {bare}), await compare(viewer, bytes, 4, 2 * canvas.width, canvas.height, {bare}),
      largest(premultiplied(reduced), premultiplied(await decode(bytes, half)))];
    viewer.free();
  }
  return differences;
})()`);
const assertAlike = differences => Object.entries(differences).forEach(([file, all]) => assert(all.every(it => it <= TOLERANCE), `${file}: ${all}`));

test('all files of the conformance set, enlarged, reduced and in part', async () => {
  await show();
  const differences = await compareFiles(index);
  assert(Object.keys(differences).length > 100);
  assert.deepEqual(await browser.evaluate('[...contexts].map(gl => gl.getError())'), [0, 0]);
  assertAlike(differences);
  assert.deepEqual(browser.errors, []);
});

test('floats of 16 bits, where they are exact enough', async () => {
  await show('', 'half');
  assertAlike(await compareFiles(index.filter(({file}) => /^(photograph|scalar-.*-rgb-alpha|waves|layers-8|codebook-ranges)$/.test(file))));
  assert(!await browser.evaluate(`bytesOf('seven-classes').then(bytes => view(canvas.cloneNode(), bytes)).then(({isGpu}) => isGpu)`));
  assert.deepEqual(browser.errors, []);
});

test('prefixes, and views far inside a picture', async () => {
  await show();
  const [prefixes, zooms, flat] = await browser.evaluate(`(async () => {
    const layers = await bytesOf('layers-8'), photograph = await bytesOf('photograph'), {width} = await info(photograph), prefixes = [], zooms = [];
    resized(canvas, 24, 16);
    for (const length of [60, 120, 200]) {
      const part = layers.subarray(0, length), viewer = await view(canvas, part, {partial: true});
      prefixes.push(await compare(viewer, part, 1, 0, 0, {partial: true}));
      viewer.free();
    }
    const viewer = await view(canvas, photograph);
    for (const zoom of [30, 1000, 10000])
      zooms.push(await compare(viewer, photograph, zoom, 11.3 * zoom, 7.8 * zoom));
    viewer.draw({scale: 1e12, x: 11.3, y: 7.8});
    const far = samplesOf(canvas);
    viewer.draw({scale: 1000, x: 11.3, y: 7.8});
    return [prefixes, zooms, largest(far, far.map((_, i) => samplesOf(canvas)[i % 4]))];
  })()`);
  assert(prefixes.every(it => it <= TOLERANCE), `prefixes: ${prefixes}`);
  assert(zooms.every(it => it <= TOLERANCE), `zooms: ${zooms}`);
  assert(flat <= TOLERANCE, `farther than the decoder: ${flat}`);
  assert.deepEqual(browser.errors, []);
});

/* At an edge far from the corner of a picture, the samples of the second view are those of the first one, some pixels on. */
test('a view moves by less than a float can tell', async () => {
  await show();
  const [steps, differing] = await browser.evaluate(`(async () => {
    const FROM = 300, SCALE = 4e5, MOVED = 7, bytes = await bytesOf('priors'), {data} = await decode(bytes, {crop: {x: FROM, y: 4, width: 100, height: 1}});
    const viewer = await view(resized(canvas, 1000, 1), bytes), drawnAt = x => (viewer.draw({scale: SCALE, x, y: 4.5}), samplesOf(canvas));
    const slopes = Array.from({length: 99}, (_, i) => Math.abs(data[4 * i + 4] - data[4 * i]));
    let low = FROM + slopes.indexOf(Math.max(...slopes)) + .5, high = low + 1;
    const [first] = drawnAt(low);
    while (high - low > 100 / SCALE) {
      const middle = (low + high) / 2;
      drawnAt(middle)[0] == first ? low = middle : high = middle;
    }
    const x = low - 500 / SCALE, before = drawnAt(x).subarray(4 * MOVED), after = drawnAt(x + MOVED / SCALE);
    return [before.slice(4).filter((sample, i) => sample != before[i]).length, before.filter((sample, i) => sample != after[i]).length];
  })()`);
  assert(steps > 0 && differing <= 2 * steps, `${steps} steps, ${differing} samples differ`);
});

test('what is outside the picture is transparent, and large canvases are drawn in parts', async () => {
  const [inside, outside, parts] = await browser.evaluate(`(async () => {
    const bytes = await bytesOf('photograph'), {width, height} = await info(bytes);
    resized(canvas, width + 30, height + 20);
    const viewer = await view(canvas, bytes);
    viewer.draw({scale: 1, x: -10, y: -5});
    const pixels = samplesOf(canvas), expected = await decode(bytes), at = (x, y) => 4 * ((y + 5) * (width + 30) + x + 10);
    let inside = 0;
    for (let y = 0; y < height; y++)
      inside = Math.max(inside, largest(pixels.subarray(at(0, y), at(width, y)), expected.data.subarray(4 * width * y, 4 * width * (y + 1))));
    for (let y = 0; y < height; y++)
      pixels.fill(0, at(0, y), at(width, y));
    resized(canvas, 2100, 40);
    return [inside, largest(pixels, pixels.map(() => 0)), await compare(viewer, bytes, 100, 0, 500)];
  })()`);
  assert(inside <= TOLERANCE && parts <= TOLERANCE, `inside: ${inside}, parts: ${parts}`);
  assert.equal(outside, 0);
});

test('errors and limits', async () => {
  const codes = await browser.evaluate(`(async () => {
    const codeOf = promise => promise.then(() => 'none', error => [error.name, error.code, error.message].join()), bytes = await bytesOf('photograph');
    const taken = document.createElement('canvas'), viewer = await view(canvas, bytes, {maxWork: 1000}), small = await view(canvas, bytes, {maxPixels: 1000});
    taken.getContext('bitmaprenderer');
    return [await codeOf(view(canvas, await bytesOf('damaged-bit'))), await codeOf(viewer.draw({scale: 0})), await codeOf(viewer.draw({scale: 1, x: NaN})),
      await codeOf(viewer.draw()), await codeOf(small.draw()), await codeOf(small.draw(small.free())), await codeOf(view(taken, bytes))];
  })()`);
  assert.match(codes[0], /^GsclError,damaged,/);
  assert.match(codes[1], /^GsclError,invalid-argument,scale, x and y must be numbers, and scale above 0$/);
  assert.match(codes[2], /invalid-argument/);
  assert.match(codes[3], /^GsclError,limit,drawing takes \d+ evaluations; max_work is 1000$/);
  assert.match(codes[4], /^GsclError,limit,the image has 2100x40 pixels; max_pixels is 1000$/);
  assert.equal(codes[5], 'none');
  assert.match(codes[6], /^GsclError,invalid-argument,the canvas has a context that is neither 2d nor webgl2$/);
});

test('a lost context comes back with the last view', async () => {
  await show();
  const difference = await browser.evaluate(`(async () => {
    const bytes = await bytesOf('photograph'), happens = name => new Promise(resolve => canvas.addEventListener(name, resolve, {once: true}));
    resized(canvas, 60, 40);
    const viewer = await view(canvas, bytes), extension = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
    await viewer.draw({scale: 1});
    const lost = happens('webglcontextlost');
    extension.loseContext();
    await lost.then(() => new Promise(setTimeout)); /* only then it may be restored */
    await viewer.draw({scale: 4, x: 5, y: 4});
    const restored = happens('webglcontextrestored').then(() => samplesOf(canvas));
    extension.restoreContext();
    const pixels = await restored;
    return largest(pixels, (await decode(bytes, {width: viewer.width * 4, height: viewer.height * 4, crop: {x: 20, y: 16, width: 60, height: 40}})).data);
  })()`);
  assert(difference <= TOLERANCE, `difference: ${difference}`);
});

test('elements draw by one context, and by the decoder while it is lost', async () => {
  const names = ['photograph', 'scalar-normalized-rgb-alpha', 'layers-8', 'waves', 'codebook-alpha-rgb-alpha', 'portrait'];
  await show(Array.from({length: 30}, (_, i) => `<gscl-image id="e${i}" src="/files/${names[i % names.length]}.gscl" alt="" width="${150 + i}" height="${100 + i}"></gscl-image>`).join('\n'));
  await browser.until('events.length == 30');
  const check = async id => {
    const difference = await browser.evaluate(`(async () => {
      const drawn = ${id}.shadowRoot.querySelector('canvas'), {width, height} = drawn;
      const bytes = new Uint8Array(await (await fetch(${id}.src)).arrayBuffer()), expected = await decode(bytes, {width, height});
      return largest(premultiplied(drawn.getContext('2d').getImageData(0, 0, width, height)), premultiplied(expected));
    })()`);
    assert(difference <= TOLERANCE, `${id}: ${difference}`);
  };
  const widthOf = id => `${id}.shadowRoot.querySelector('canvas').width`;
  for (let i = 0; i < 30; i += 5)
    await check(`e${i}`);
  assert.deepEqual(await browser.evaluate('[new Set(events.map(it => it[1])).size, events[0][1], contexts.size, copies]'), [1, 'load', 1, 0]);
  if (screenshots)
    mkdirSync(screenshots, {recursive: true}), writeFileSync(join(screenshots, 'elements.png'), await browser.screenshot());
  await browser.evaluate(`e0.width = 220`);
  await browser.until(`${widthOf('e0')} == 220`);
  await check('e0');
  await browser.evaluate(`window.extension = [...contexts][0].getExtension('WEBGL_lose_context'), extension.loseContext(), e1.src = e0.src, e1.width = 230`);
  await browser.until(`${widthOf('e1')} == 230 && events.length == 31`);
  await check('e1');
  assert(await browser.evaluate('copies') > 0);
  await browser.evaluate(`new Promise(resolve => { [...contexts][0].canvas.addEventListener('webglcontextrestored', resolve); extension.restoreContext(); })`);
  await browser.evaluate(`copies = 0, e2.width = 240`);
  await browser.until(`${widthOf('e2')} == 240`);
  await check('e2');
  assert.equal(await browser.evaluate('copies'), 0);
  assert.deepEqual(browser.errors, []);
});

test('packets, where the page has the module for them', async () => {
  await show();
  const difference = await browser.evaluate(`(async () => {
    const {decode} = await import('/web/packets.js'), bytes = await (await fetch('/files/packets-3.gsclp')).arrayBuffer(), viewer = await view(canvas, bytes);
    resized(canvas, viewer.width, viewer.height);
    viewer.draw();
    return largest(samplesOf(canvas), (await decode(bytes)).data);
  })()`);
  assert(difference <= TOLERANCE, `difference: ${difference}`);
});

test('a damaged file fails as without the GPU', async () => {
  await show('<gscl-image id="a" src="/files/damaged-bit.gscl" alt="A picture"></gscl-image>');
  await browser.until('events.length == 1');
  assert.deepEqual(await browser.evaluate('[events, a.shadowRoot.textContent]'), [[['a', 'error', 'damaged']], 'A picture']);
});

test('without WebGL 2 the decoder draws', async () => {
  await show('<gscl-image id="a" src="/files/photograph.gscl" width="90"></gscl-image>', 'none');
  await browser.until('events.length == 1');
  const [isGpu, near, last, far] = await browser.evaluate(`(async () => {
    const bytes = await bytesOf('photograph'), viewer = await view(resized(canvas, 60, 40), bytes), pixels = () => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    const expected = (zoom, x, y) => decode(bytes, {width: viewer.width * zoom, height: viewer.height * zoom, crop: {x, y, width: 60, height: 40}});
    await viewer.draw({scale: 4, x: 5, y: 4});
    const near = largest(pixels(), (await expected(4, 20, 16)).data);
    await Promise.all([viewer.draw({scale: 1}), viewer.draw({scale: 2}), viewer.draw({scale: 5, x: 6, y: 6})]);
    const last = largest(pixels(), (await expected(5, 30, 30)).data);
    await viewer.draw({scale: 1e8, x: 11.3, y: 7.8});
    const far = largest(pixels(), (await expected(1000, 11300, 7800)).data.map((_, i, all) => all[i % 4]));
    viewer.free();
    return [viewer.isGpu, near, last, far];
  })()`);
  assert.deepEqual([isGpu, near, last], [false, 0, 0]);
  assert(far <= TOLERANCE, `far: ${far}`);
  assert.equal(await browser.evaluate(`a.shadowRoot.querySelector('canvas').width`), 90);
  assert.deepEqual(browser.errors, []);
});

try {
  process.exitCode = await runTests() ? 0 : 1;
} finally {
  await browser.close();
  site.close();
}
