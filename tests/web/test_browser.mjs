/* The element in a browser, on files that the tool encodes.
 *
 *     node test_browser.mjs FOLDER    FOLDER: host/web of the build folder
 *
 * GSCL names the tool, BROWSER the browser: chromium or firefox. */
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

import {TIMEOUT, pause, serve, startBrowser} from './browsers.mjs';
import {assertPicture} from './compare.mjs';
import {readPng} from './png.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), gscl = process.env.GSCL;
const conformance = fileURLToPath(new URL('../conformance/', import.meta.url));
const made = mkdtempSync(join(tmpdir(), 'gscl-web-')), fileOf = name => readFileSync(join(made, name));

/* Real files: a picture of the set, encoded anew, and the same progressive and bare. */
const encode = (name, ...options) => execFileSync(gscl, ['encode', join(made, 'scene.png'), '-o', join(made, name), '--effort', '0', '--quiet', ...options]);
execFileSync(gscl, ['decode', '--device', 'host', join(conformance, 'files/photograph.gscl'), '--size', '320x240', '-o', join(made, 'scene.png')]);
encode('scene.gscl', '--bytes', '3000');
encode('progressive.gscl', '--bytes', '3000', '--progressive');
encode('bare.gscl', '--bytes', '150', '--bare');
encode('scene.gsclp', '--bytes', '3000', '--packets', '400', '--packet-loss', '0.1');
execFileSync(gscl, ['decode', '--device', 'host', join(conformance, 'files/photograph.gscl'), '--size', '160x40', '-o', join(made, 'wide.png')]);
execFileSync(gscl, ['encode', join(made, 'wide.png'), '-o', join(made, 'wide.gscl'), '--effort', '0', '--quiet', '--bytes', '1000']);
copyFileSync(join(conformance, 'files/damaged-bit.gscl'), join(made, 'damaged.gscl'));

/* A line of text with the picture, as the tool writes it. */
const textBy = (...options) => execFileSync(gscl, ['encode', join(made, 'scene.png'), '--base64', '--effort', '0', '--quiet', ...options]).toString();

const decodeBy = (name, ...options) => {
  execFileSync(gscl, ['decode', '--device', 'host', join(made, name), '-o', join(made, 'out.png'), ...options]);
  return readPng(fileOf('out.png'));
};

let hasModule = true; /* whether modules are found */
const asked = new Set; /* modules that were asked for */
const module = name => (_, response) => {
  asked.add(name);
  return hasModule ? response.writeHead(200).end(readFileSync(join(folder, name))) : response.writeHead(503).end();
};
let slow; /* the answer to /slow.gscl, which the tests write to */
const page = ({body, script}) => `<!doctype html><meta charset="utf-8"><style>body{margin:0}</style><script>
  delete String.prototype.at, delete Element.prototype.role, delete Element.prototype.ariaLabel; /* which older browsers lack */
  window.events = []; for (const name of ['load', 'error']) document.addEventListener(name, event => events.push([event.target.id, name, event.error?.code || event.message, event.message]), true);
  </script><script type="module" src="/web/${script}"></script>${body}`;
const pages = {};
const site = await serve({'/web/': folder, '/files/': made}, {
  '/slow.gscl': (_, response) => slow = response,
  '/web/gscl.wasm': module('gscl.wasm'),
  '/web/gscl-packets.wasm': module('gscl-packets.wasm'),
  '/page': (request, response) => {
    const shown = pages[new URL(request.url, 'http://host').searchParams.get('name')];
    response.writeHead(200, {'content-type': 'text/html', 'content-security-policy': shown.policy}).end(page(shown));
  },
});
const browser = await startBrowser();
let count = 0;
const show = async (body, script = 'gscl.js', policy = '') => {
  pages[++count] = {body, script, policy};
  await browser.open(`${site.url}/page?name=${count}`);
};
/* Waits until /slow.gscl was asked for; the limit of the whole program ends it. */
const slowRequest = async () => { while (!slow) await pause(20); };
const canvasOf = id => `document.getElementById('${id}').shadowRoot.querySelector('canvas')`;
/* Checks role and name of what assistive programs find in the page, which WebDriver BiDi does not tell of Firefox. */
const assertAccessible = async (expected, name) => browser.name == 'firefox' || assert.deepEqual((await browser.send('Accessibility.getFullAXTree')).nodes.filter(({ignored, role}) => !ignored && /^(image|button|StaticText)$/.test(role.value))
  .map(({role, name}) => [role.value, name.value]), expected, name);
const loaded = id => browser.until(`events.some(([id, name]) => id == '${id}' && name == 'load')`);

await browser.resize(1200, 900);

test('decode returns an ImageData with the pixels of the tool', async () => {
  await show('');
  const [kind, width, height, text] = await browser.evaluate(`(async () => {
    const {decode} = await import('/web/gscl.js'), bytes = await (await fetch('/files/scene.gscl')).arrayBuffer(), image = await decode(bytes, {width: 200, height: 150});
    return [image.constructor.name, image.width, image.height, Array.from(image.data).join()];
  })()`);
  assert.equal(kind, 'ImageData');
  assertPicture({width, height, data: text.split(',').map(Number)}, decodeBy('scene.gscl', '--size', '200x150'), 'decode');
});

test('an element draws a file at its size', async () => {
  await show('<gscl-image id="a" src="/files/scene.gscl" alt="A scene" width="200" height="150"></gscl-image><gscl-image id="b" src="/files/scene.gscl"></gscl-image>');
  await loaded('a'), await loaded('b');
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gscl', '--size', '200x150'), 'given size');
  assertPicture(await browser.pixels(canvasOf('b')), decodeBy('scene.gscl'), 'own size');
  await assertAccessible([['image', 'A scene'], ['image', '']]);
  assert.equal(await browser.evaluate('events.filter(([id]) => id).length'), 2);
  assert.deepEqual(browser.errors, []);
});

test('an element follows its size and the pixels of the screen', async () => {
  await browser.evaluate(`a.style.width = '300px', a.style.height = '225px'`);
  await browser.until(`${canvasOf('a')}.width == 300`);
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gscl', '--size', '300x225'), 'resized');
  await browser.resize(600, 450, 2); /* as a browser zooms */
  await browser.until(`${canvasOf('a')}.width == 600`);
  await browser.resize(1200, 900);
  await browser.until(`${canvasOf('a')}.width == 300`);
});

test('files inside the page', async () => {
  const whole = fileOf('scene.gscl').toString('base64'), bare = fileOf('bare.gscl').toString('base64');
  await show(`<gscl-image id="a" data="${bare}" bare></gscl-image><gscl-image id="b" src="data:image/x-gscl;base64,${whole}"></gscl-image>`);
  await loaded('a'), await loaded('b');
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('bare.gscl', '--bare'), 'bare');
  assertPicture(await browser.pixels(canvasOf('b')), decodeBy('scene.gscl'), 'data URL');
});

test('the text of the tool, as it is and as other programs write base64', async () => {
  const text = textBy('--bytes', '3000'), bare = textBy('--bytes', '150', '--bare'), file = fileOf('scene.gscl'), whole = file.toString('base64');
  assert.match(text, /^[\w-]*[-_][\w-]*\n$/); /* base64url, whose letters occur */
  assert.deepEqual(Buffer.from(text, 'base64url'), file);
  const texts = {tool: text, trimmed: text.trim(), lines: whole.replace(/.{64}/g, '$&\r\n'), spaces: `\t ${text} `, base64: whole, unpadded: whole.replace(/=*$/, ''),
    padded: text.trim() + '='.repeat(-text.trim().length & 3)};
  await show(Object.entries(texts).map(([id, data]) => `<gscl-image id="${id}" data="${data}"></gscl-image>`).join('') + `<gscl-image id="bare" data="${bare}" bare></gscl-image>`);
  for (const id in texts)
    await loaded(id), assertPicture(await browser.pixels(canvasOf(id)), decodeBy('scene.gscl'), id);
  await loaded('bare');
  assertPicture(await browser.pixels(canvasOf('bare')), decodeBy('bare.gscl', '--bare'), 'bare');
});

test('files of the tool of every kind of picture', async () => {
  const kinds = {grey: [], 'layout-grey-alpha': [], 'scalar-normalized-rgb-alpha': [], 'plain-alpha': [], 'bits-16': [], blocks: ['--metadata', 'all', '--keep-profile'],
    photograph: ['--profile', 'paper'], waves: ['--blend', 'sum'], 'layers-8': ['--progressive', '--blend', 'alpha']};
  await show('');
  for (const [name, options] of Object.entries(kinds)) {
    execFileSync(gscl, ['decode', '--device', 'host', join(conformance, `files/${name}.gscl`), '--size', '80x60', '-o', join(made, 'kind.png')], {stdio: 'pipe'});
    execFileSync(gscl, ['encode', join(made, 'kind.png'), '-o', join(made, 'kind.gscl'), '--bytes', '700', '--effort', '0', '--quiet', ...options]);
    const [width, height, text] = await browser.evaluate(`(async () => {
      const {decode} = await import('/web/gscl.js'), image = await decode(await (await fetch('/files/kind.gscl')).arrayBuffer());
      return [image.width, image.height, Array.from(image.data).join()];
    })()`);
    assertPicture({width, height, data: text.split(',').map(Number)}, decodeBy('kind.gscl'), name);
  }
});

test('a picture over the background of the page is that of the tool over it', async () => {
  execFileSync(gscl, ['decode', '--device', 'host', join(conformance, 'files/scalar-normalized-rgb-alpha.gscl'), '--size', '80x60', '-o', join(made, 'clear.png')]);
  execFileSync(gscl, ['encode', join(made, 'clear.png'), '-o', join(made, 'clear.gscl'), '--effort', '0', '--quiet']);
  await show('<gscl-image id="a" src="/files/clear.gscl"></gscl-image>');
  await loaded('a');
  const samples = decodeBy('clear.gscl').samples;
  assert(samples.some((sample, i) => i % 4 == 3 && sample > 20 && sample < 235)); /* the sources of alpha blend */
  for (const colour of ['white', 'rebeccapurple', '#f80']) {
    const page = await browser.pixels(`(() => { const c = document.createElement('canvas'), {width, height} = ${canvasOf('a')}, it = c.getContext('2d'); [c.width, c.height] = [width, height];
      it.fillStyle = '${colour}'; it.fillRect(0, 0, width, height); it.drawImage(${canvasOf('a')}, 0, 0); return c; })()`);
    const tool = decodeBy('clear.gscl', '--background', colour);
    assert.equal(tool.channels, 3);
    for (let i = 0; i < page.width * page.height; i++)
      for (let k = 0; k < 3; k++) /* canvases keep colours multiplied by alpha, in 8 bits */
        assert(Math.abs(page.data[4 * i + k] - tool.samples[3 * i + k]) <= 3, `${colour}: sample ${k} of pixel ${i}: ${page.data[4 * i + k]}, ${tool.samples[3 * i + k]}`);
  }
});

test('a browser draws the SVG image of the tool', async () => {
  execFileSync(gscl, ['export', join(made, 'scene.gscl'), '-o', join(made, 'scene.svg')]);
  await show('');
  const page = await browser.pixels(await browser.evaluate(`new Promise((resolve, reject) => {
    const image = new Image, canvas = window.drawnSvg = document.createElement('canvas');
    image.onload = () => { canvas.width = image.naturalWidth; canvas.height = image.naturalHeight; canvas.getContext('2d').drawImage(image, 0, 0); resolve('drawnSvg'); };
    image.onerror = reject, image.src = '/files/scene.svg';
  })`));
  const tool = decodeBy('scene.gscl');
  assert.deepEqual([page.width, page.height], [tool.width, tool.height]);
  let sum = 0;
  for (let i = 0; i < page.width * page.height; i++)
    for (let k = 0; k < 3; k++)
      sum += (page.data[4 * i + k] - tool.samples[3 * i + k]) ** 2;
  const psnr = 10 * Math.log10(255 ** 2 * 3 * page.width * page.height / sum);
  assert(psnr > 24, `${psnr} dB`);
});

test('data URLs with the text of the tool and of other programs', async () => {
  const text = textBy('--bytes', '3000').trim(), whole = fileOf('scene.gscl').toString('base64');
  const sources = {tool: `data:image/x-gscl;base64,${text}`, base64: `data:image/x-gscl;base64,${whole}`, kind: `data:;a=b;base64,${text}`,
    escaped: `data:;base64,${encodeURIComponent(whole)}`, fragment: `data:;base64,${whole}#a`, bytes: `data:,${[...fileOf('scene.gscl')].map(it => '%' + it.toString(16).padStart(2, 0)).join('')}`};
  await show(Object.entries(sources).map(([id, src]) => `<gscl-image id="${id}" src="${src}"></gscl-image>`).join(''));
  for (const id in sources)
    await loaded(id), assertPicture(await browser.pixels(canvasOf(id)), decodeBy('scene.gscl'), id);
});

test('text that is not base64 is named', async () => {
  const text = textBy('--bytes', '3000').trim(), texts = ['***', text.slice(0, 9) + '=' + text.slice(9), text.slice(0, 5), text.slice(0, 9) + '\u00a0' + text.slice(9), '\u{1f600}'];
  await show(texts.map((it, i) => `<gscl-image id="i${i}" data="${it}"></gscl-image>`).join('') + `<gscl-image id="url" src="data:;base64,***"></gscl-image>`);
  await browser.until(`events.filter(([id, name]) => id && name == "error").length == ${texts.length + 1}`);
  assert.deepEqual(new Set((await browser.evaluate('events')).filter(([id]) => id).map(([, , code, message]) => `${code}: ${message}`)), new Set(['invalid-argument: data is not base64']));
});

test('an element that is larger than a picture may be draws fewer pixels', async () => {
  const data = textBy('--bytes', '150', '--bare').trim();
  await browser.resize(1200, 900, 2);
  try { /* twice as wide and high these are more than 2^26 pixels */
    await show(`<gscl-image id="a" data="${data}" bare width="4112" height="4096"></gscl-image>`);
    await loaded('a');
    assert.deepEqual(await browser.evaluate(`[${canvasOf('a')}.width, ${canvasOf('a')}.height]`), [4112, 4096]);
    const [x, y] = [1500, 2500], part = await browser.pixels(`(() => { const c = document.createElement('canvas'); c.width = c.height = 9; c.getContext('2d').drawImage(${canvasOf('a')}, -${x}, -${y}); return c; })()`);
    assertPicture(part, decodeBy('bare.gscl', '--bare', '--size', '4112x4096', '--crop', `${x},${y},9,9`), 'part');
    const {width, height} = await browser.evaluate(`(({width, height}) => ({width, height}))(${canvasOf('a')}.getBoundingClientRect())`);
    assert.deepEqual([width, height], [4112, 4096]); /* the page enlarges the canvas */
  } finally {
    await browser.resize(1200, 900);
  }
});

test('no picture stays in sight that the element no longer has', async () => {
  const whole = fileOf('scene.gscl').toString('base64');
  const changes = {'no base64': `a.setAttribute('data', '*')`, 'no file': `a.setAttribute('data', 'AAAA')`, 'damaged': `a.removeAttribute('data'), a.setAttribute('src', '/files/damaged.gscl')`,
    'not found': `a.removeAttribute('data'), a.setAttribute('src', '/files/none.gscl')`, 'other form': `a.setAttribute('bare', '')`, 'removed': `a.removeAttribute('data')`, 'empty': `a.setAttribute('data', '')`};
  for (const [name, change] of Object.entries(changes))
    for (const size of ['', 'width="100" height="80"']) {
      await show(`<gscl-image id="a" data="${whole}" ${size}></gscl-image><br><gscl-image id="b" ${size}></gscl-image>`);
      await loaded('a');
      assert(await browser.evaluate(`${canvasOf('a')}.width > 0`));
      await browser.evaluate(`events.length = 0, ${change}`);
      await browser.until(`!(${canvasOf('a')}?.width > 0)`);
      assert.deepEqual(await browser.evaluate(`new Promise(resolve => setTimeout(() => resolve(events.map(([, name]) => name)), 50))`), /removed|empty/.test(name) ? [] : ['error'], name);
      const [box, empty] = await browser.evaluate(`[a, b].map(it => it.getBoundingClientRect()).map(({width, height}) => [width, height])`);
      assert.deepEqual(box, empty, name);
      await browser.evaluate(`events.length = 0, a.removeAttribute('bare'), a.removeAttribute('src'), a.setAttribute('data', '${whole}')`);
      await loaded('a');
      assert(await browser.evaluate(`${canvasOf('a')}.width > 0`), name);
    }
});

test('the old picture stays until the new one is there', async () => {
  await show(`<gscl-image id="a" src="/files/wide.gscl"></gscl-image>`);
  await loaded('a');
  await browser.evaluate(`events.length = 0, a.setAttribute('src', '/slow.gscl'), 0`);
  await slowRequest();
  assert.equal(await browser.evaluate(`${canvasOf('a')}.width`), 160);
  slow.writeHead(200, {'content-type': 'application/octet-stream'}).end(fileOf('scene.gscl')), slow = undefined;
  await loaded('a');
  assert.equal(await browser.evaluate(`${canvasOf('a')}.width`), 320);
});

test('an element draws while bytes arrive', async () => {
  for (const name of ['scene.gscl', 'progressive.gscl']) {
    const file = fileOf(name);
    await show('<gscl-image id="a" src="/slow.gscl"></gscl-image>');
    await browser.until('document.querySelector("gscl-image").shadowRoot');
    await slowRequest();
    slow.writeHead(200, {'content-type': 'application/octet-stream'});
    const draws = [];
    let sent = 0;
    for (const size of [1200, 2200]) {
      slow.write(file.subarray(sent, size)), sent = size;
      writeFileSync(join(made, 'part.gscl'), file.subarray(0, size));
      const expected = decodeBy('part.gscl', '--partial');
      await browser.until(`${canvasOf('a')}.width == 320`);
      for (const end = Date.now() + TIMEOUT; ; ) /* until the bytes have come */
        try {
          assertPicture(await browser.pixels(canvasOf('a')), expected, `${name}: ${size} bytes`);
          break;
        } catch (error) {
          if (Date.now() > end)
            throw error;
          await pause(50);
        }
      draws.push(size);
      assert.equal(await browser.evaluate('events.filter(([id]) => id).length'), 0);
    }
    slow.end(file.subarray(sent));
    slow = undefined;
    await loaded('a');
    assertPicture(await browser.pixels(canvasOf('a')), decodeBy(name), name);
  }
});

test('errors are events', async () => {
  await show('<gscl-image id="a" src="/files/damaged.gscl"></gscl-image><gscl-image id="b" src="/files/none.gscl"></gscl-image><gscl-image id="c" data="***"></gscl-image><gscl-image id="d" data="AAAA"></gscl-image>');
  await browser.until('events.filter(([id, name]) => id && name == "error").length == 4');
  const codes = Object.fromEntries((await browser.evaluate('events')).map(([id, , code]) => [id, code]));
  assert.equal(codes.a, 'damaged');
  assert.equal(codes.b, 'not-found');
  assert.equal(codes.d, 'not-a-gscl-file');
  await browser.evaluate(`events.length = 0, a.setAttribute('src', '/files/scene.gscl')`);
  await loaded('a');
});

test('an element changes its file, and the last one counts', async () => {
  await show('<gscl-image id="a"></gscl-image>');
  await browser.evaluate(`customElements.whenDefined('gscl-image').then(() => { a.setAttribute('src', '/slow.gscl'); })`);
  await browser.evaluate(`new Promise(resolve => setTimeout(resolve, 100)).then(() => a.setAttribute('src', '/files/progressive.gscl'))`);
  await loaded('a');
  slow?.end(fileOf('scene.gscl')), slow = undefined;
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('progressive.gscl'), 'last file');
});

test('an element drops what arrives of a file that it no longer shows', async () => {
  for (const change of [`a.setAttribute('data', '${fileOf('progressive.gscl').toString('base64')}')`, `a.removeAttribute('src')`]) {
    await show('<gscl-image id="a"></gscl-image>');
    /* The first bytes are joined late, after the change. */
    await browser.evaluate(`customElements.whenDefined('gscl-image').then(() => {
      const join = Blob.prototype.arrayBuffer;
      Blob.prototype.arrayBuffer = async function() {
        const bytes = await join.call(this);
        window.isJoining = true;
        await new Promise(resolve => window.finish = resolve);
        return bytes;
      };
      a.setAttribute('src', '/slow.gscl'); })`);
    await slowRequest();
    slow.writeHead(200, {'content-type': 'application/octet-stream'});
    slow.write(fileOf('scene.gscl').subarray(0, 2200));
    await browser.until('window.isJoining');
    await browser.evaluate(change);
    if (change.includes('data'))
      await loaded('a');
    await browser.evaluate('finish(), new Promise(resolve => setTimeout(resolve, 300))');
    slow.end(), slow = undefined;
    if (change.includes('data')) {
      await browser.evaluate(`a.style.width = '160px'`);
      await browser.until(`${canvasOf('a')}.width == 160`);
      assertPicture(await browser.pixels(canvasOf('a')), decodeBy('progressive.gscl', '--size', '160x120'), 'data');
    } else {
      assert.equal(await browser.evaluate(`${canvasOf('a')}.width`), 0);
    }
  }
});

test('the encoded size is the default of the element, whatever it was before', async () => {
  const sizeOf = id => browser.evaluate(`[${id}.getBoundingClientRect(), ${canvasOf(id)}.getBoundingClientRect()].map(({width, height}) => [width, height].map(Math.round).join('x')).join(' ')`);
  const drawnAt = (id, width, height) => browser.until(`${canvasOf(id)}.width == ${width} && ${canvasOf(id)}.height == ${height}`);
  const scene = 'src="/files/scene.gscl"'; /* of 320x240 pixels */
  const sizes = {none: '320x240', width: '200x150', height: '200x150', both: '100x200', css: '160x120', narrow: '80x60', flex: '320x240', row: '80x60'};
  await show(`<style>#css{height:120px}</style><div id="all" style="display:none"><gscl-image id="none" ${scene}></gscl-image>
    <gscl-image id="width" width="200" ${scene}></gscl-image><gscl-image id="height" height="150" ${scene}></gscl-image>
    <gscl-image id="both" width="100" height="200" ${scene}></gscl-image><gscl-image id="css" ${scene}></gscl-image>
    <div style="width:80px"><gscl-image id="narrow" ${scene}></gscl-image></div>
    <div style="display:flex;align-items:flex-start"><gscl-image id="flex" ${scene}></gscl-image></div>
    <div style="display:flex;align-items:flex-start;width:80px"><gscl-image id="row" ${scene}></gscl-image></div></div>`);
  for (const id in sizes)
    await loaded(id);
  await browser.evaluate(`all.style.display = ''`);
  for (const [id, size] of Object.entries(sizes)) {
    await drawnAt(id, ...size.split('x'));
    assert.equal(await sizeOf(id), `${size} ${size}`, id);
  }
  await browser.evaluate(`for (const id of ['none', 'width', 'height', 'css']) document.getElementById(id).setAttribute('src', '/files/wide.gscl')`);
  for (const [id, size] of Object.entries({none: '160x40', width: '200x50', height: '600x150', css: '480x120'})) {
    await drawnAt(id, ...size.split('x'));
    assert.equal(await sizeOf(id), `${size} ${size}`, id);
  }
  await browser.evaluate(`document.getElementById('width').removeAttribute('width')`);
  await drawnAt('width', 160, 40);
});

test('the alternative is the name of a picture for assistive programs', async () => {
  await show('<gscl-image id="a" alt="A scene"></gscl-image><gscl-image id="b" role="button" alt="B"></gscl-image><gscl-image alt=""></gscl-image>');
  await browser.until('a.shadowRoot');
  await assertAccessible([['button', 'B'], ['image', 'A scene'], ['image', 'B']]);
  assert.equal(await browser.evaluate('a.outerHTML'), '<gscl-image id="a" alt="A scene"></gscl-image>'); /* no attributes but those of the page */
  await browser.evaluate(`a.alt = 'Another'`);
  await assertAccessible([['button', 'B'], ['image', 'Another'], ['image', 'B']]);
  await browser.evaluate(`a.removeAttribute('alt')`);
  await assertAccessible([['button', 'B'], ['image', ''], ['image', 'B']]);
});

test('the alternative stands in the place of a picture that fails', async () => {
  const sources = {damaged: 'src="/files/damaged.gscl"', missing: 'src="/files/none.gscl"', text: 'data="***"'};
  for (const [name, source] of Object.entries(sources)) {
    await show(`<p>Before</p><gscl-image id="a" ${source} alt="A scene" width="200" height="100"></gscl-image><gscl-image id="b" ${source} alt=""></gscl-image>`);
    await browser.until('events.filter(([id, name]) => id && name == "error").length == 2');
    await assertAccessible([['StaticText', 'Before'], ['StaticText', 'A scene']], name);
    assert.equal(await browser.evaluate('getSelection().selectAllChildren(a.shadowRoot), a.shadowRoot.textContent'), 'A scene');
    assert.deepEqual(await browser.evaluate('(({width, height}) => [width, height])(a.getBoundingClientRect())'), [200, 100], name);
    const ink = await browser.evaluate('(range => (range.selectNodeContents(a.shadowRoot), range.getBoundingClientRect().height))(document.createRange())');
    assert(ink > 10, `${name}: the text is ${ink} pixels high`);
    await browser.evaluate(`a.setAttribute('alt', 'Another')`);
    assert.equal(await browser.evaluate('a.shadowRoot.textContent'), 'Another');
    await browser.evaluate(`events.length = 0, a.removeAttribute('data'), a.setAttribute('src', '/files/scene.gscl')`);
    await loaded('a');
    await assertAccessible([['StaticText', 'Before'], ['image', 'Another']], name);
    assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gscl', '--size', '200x100'), name);
  }
});

test('properties are attributes', async () => {
  await show('<gscl-image id="a"></gscl-image>');
  await browser.until('a.shadowRoot');
  await browser.evaluate(`a.src = '/files/scene.gscl', a.alt = 'A', a.width = 200, a.height = '150', a.bare = false, a.data = null`);
  await loaded('a');
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gscl', '--size', '200x150'), 'properties');
  assert.equal(await browser.evaluate('a.outerHTML'), '<gscl-image id="a" src="/files/scene.gscl" alt="A" width="200" height="150"></gscl-image>');
  assert.deepEqual(await browser.evaluate('[a.src, a.alt, a.width, a.height, a.bare, a.data]'), ['/files/scene.gscl', 'A', '200', '150', false, null]);
  await browser.evaluate(`events.length = 0, a.src = undefined, a.data = '${fileOf('bare.gscl').toString('base64')}', a.bare = true, a.alt = ''`);
  await loaded('a');
  assert.deepEqual(await browser.evaluate(`[a.bare, a.hasAttribute('src'), a.getAttribute('alt')]`), [true, false, '']);
});

test('a page gives sizes that attributes do not override', async () => {
  await show('<style>gscl-image{width:50px}</style><gscl-image id="a" src="/files/scene.gscl" width="200"></gscl-image>');
  await loaded('a');
  assert.deepEqual(await browser.evaluate('(({width, height}) => [width, height])(a.getBoundingClientRect())'), [50, 37.5]);
});

test('the entry with the module in it fetches nothing but pictures', async () => {
  asked.clear();
  await show('<gscl-image id="a" src="/files/scene.gscl"></gscl-image>', 'inline.js');
  await loaded('a');
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gscl'), 'inline');
  assert.deepEqual([...asked], []);
  assert.deepEqual(browser.errors, []);
});

test('a page may import several entries', async () => {
  await show('<script type="module">import "/web/packets.js"; import "/web/inline.js";</script><gscl-image id="a" src="/files/scene.gscl"></gscl-image>');
  await loaded('a');
  assert.deepEqual(browser.errors, []);
});

test('a content security policy', async () => {
  const policy = (script, wasm) => `default-src 'none'; script-src 'self' ${wasm ? "'wasm-unsafe-eval'" : ''}; connect-src ${script == 'inline.js' ? `${site.url}/files/` : "'self'"}`;
  for (const script of ['gscl.js', 'inline.js']) {
    const text = fileOf('scene.gscl').toString('base64'), bytes = [...fileOf('scene.gscl')].map(it => '%' + it.toString(16).padStart(2, 0)).join('');
    await show(`<gscl-image id="a" src="/files/scene.gscl" width="200"></gscl-image><gscl-image id="b" data="${text}"></gscl-image>
      <gscl-image id="c" src="data:;base64,${text}"></gscl-image><gscl-image id="d" src="data:,${bytes}" alt="No origin"></gscl-image>`, script, policy(script, true));
    for (const [id, width] of Object.entries({a: 200, b: 320, c: 320}))
      await browser.until(`${canvasOf(id)}.width == ${width}`);
    await browser.until('d.shadowRoot.textContent == "No origin"');
    assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gscl', '--size', '200x150'), script);
    assert.deepEqual(browser.errors.filter(text => !/inline|data:|favicon/.test(text)), []); /* those of the page of the tests, and of d; Firefox asks for an icon */
  }
  /* Without WebAssembly bare files are drawn all the same, by gscl/tiny.  After the pages above, as Firefox may tell of what it
   * blocked when the next page is there. */
  for (const script of ['gscl.js', 'inline.js']) {
    await show(`<gscl-image id="a" src="/files/scene.gscl" alt="A scene"></gscl-image><gscl-image id="b" data="${fileOf('bare.gscl').toString('base64')}" bare></gscl-image>
      <gscl-image id="c" data="AAAA" bare alt="Damaged"></gscl-image>`, script, policy(script, false));
    await browser.until('a.shadowRoot?.textContent == "A scene" && c.shadowRoot?.textContent == "Damaged"');
    await browser.until(`${canvasOf('b')}.width == 160`); /* gscl/tiny has a lower limit of pixels */
    assertPicture(await browser.pixels(canvasOf('b')), decodeBy('bare.gscl', '--bare', '--size', '160x120'), `${script}, bare`);
  }
  assert.match(await browser.evaluate(`import('/web/inline.js').then(({info}) => info(new Uint8Array(9))).catch(error => error.code + ': ' + error.message)`), /^failed: .*(unsafe-eval|CSP)/); /* the words of Chromium and of Firefox */
});

test('a call loads the module again after a failure', async () => {
  await show('');
  hasModule = false;
  const call = `import('/web/gscl.js').then(async ({decode}) => decode(await (await fetch('/files/scene.gscl')).arrayBuffer())).then(image => image.width, ({code, message}) => [code, message])`;
  try {
    const answer = await browser.evaluate(call);
    assert.deepEqual(answer, ['failed', `${site.url}/web/gscl.wasm: status 503`]);
  } finally {
    hasModule = true;
  }
  assert.equal(await browser.evaluate(call), 320);
});

test('packets', async () => {
  const list = '(await (await fetch("/files/scene.gsclp")).arrayBuffer())', call = (source, ...steps) => `(async () => {
    const {decode} = await import('/web/packets.js'), list = new Uint8Array${list};
    ${steps.join(';')}
    const image = await decode(${source}, {width: 200, height: 150});
    return [image.constructor.name, image.width, image.height, Array.from(image.data).join()];
  })().catch(({code, message}) => [code, message])`;
  asked.clear();
  await show('<gscl-image id="a" src="/files/scene.gscl"></gscl-image>');
  await loaded('a');
  assert.deepEqual([...asked], ['gscl.wasm']);
  asked.clear();
  await show('<gscl-image id="a" src="/files/scene.gsclp"></gscl-image><gscl-image id="b" src="/files/scene.gscl"></gscl-image>', 'packets.js');
  await loaded('a'), await loaded('b');
  assert.deepEqual([...asked], ['gscl-packets.wasm']);
  assertPicture(await browser.pixels(canvasOf('a')), decodeBy('scene.gsclp'), 'element');
  assertPicture(await browser.pixels(canvasOf('b')), decodeBy('scene.gscl'), 'a file beside packets');
  const taken = `const packets = []; for (let at = 4, size; at < list.length; packets.push(list.subarray(at, at += size)))
    (size = list[at++]) > 127 && (size += 128 * (list[at++] - 1))`;
  await show('', 'packets.js');
  hasModule = false;
  assert.deepEqual(await browser.evaluate(call('list')), ['failed', `${site.url}/web/gscl-packets.wasm: status 503`]);
  hasModule = true;
  for (const source of ['list', 'packets.reverse()', 'packets.slice(1)']) { /* with repair packets */
    const [kind, width, height, text] = await browser.evaluate(call(source, taken));
    assert.equal(kind, 'ImageData', width);
    assertPicture({width, height, data: text.split(',').map(Number)}, decodeBy('scene.gsclp', '--size', '200x150'), source);
  }
});

try {
  process.exitCode = await runTests() ? 0 : 1;
} finally {
  await browser.close();
  site.close();
  rmSync(made, {recursive: true});
}
