/* The demonstration page in a browser, from a server and from a file.
 *
 *     node test_demo.mjs FOLDER [SCREENSHOTS]    FOLDER: host/web of the build folder, with the encoder; SCREENSHOTS: a folder for pictures
 *
 * BROWSER names the browser: chromium or firefox. */
import assert from 'node:assert/strict';
import {mkdirSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {pause, serve, startBrowser} from './browsers.mjs';
import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), screenshots = process.argv[3], made = mkdtempSync(join(tmpdir(), 'gscl-demo-'));
const {decode} = await import(pathToFileURL(join(folder, 'node.js'))), {encode} = await import(pathToFileURL(join(folder, 'encode-node.js')));
const {bytes: scene} = await encode(sceneOf(320, 240), {bytes: 2000, effort: 0});
const {bytes: bare} = await encode(sceneOf(64, 48), {bytes: 150, effort: 0, bare: true});
const damaged = scene.slice();
damaged[damaged.length - 1] ^= 1;
writeFileSync(join(made, 'scene.gscl'), scene), writeFileSync(join(made, 'damaged.gscl'), damaged);

/* In place of the worker with @jsquash/avif: JPEG, whose size depends on the quality, too. */
const CODEC = `onmessage = async ({data: {image, quality}}) => {
  const canvas = new OffscreenCanvas(image.width, image.height);
  canvas.getContext('2d').putImageData(image, 0, 0);
  postMessage(await (await canvas.convertToBlob({type: 'image/jpeg', quality: quality / 100})).arrayBuffer());
};`;
let hasCodec = false;
const site = await serve({'/web/': folder, '/files/': made}, {
  '/web/demo/avif.js': (_, response) => hasCodec ? response.writeHead(200, {'content-type': 'text/javascript', 'cache-control': 'no-store'}).end(CODEC) : response.writeHead(404).end(),
  '/web/demo/samples/samples.json': (_, response) => response.writeHead(200, {'content-type': 'application/json'}).end('[{"file": "scene.gscl", "title": "A scene"}]'),
  '/web/demo/samples/scene.gscl': (_, response) => response.writeHead(200).end(scene),
});
const served = `${site.url}/web/demo/index.html`, local = pathToFileURL(join(folder, 'demo/index.html')).href;
const browser = await startBrowser();
const shoot = async name => screenshots && (mkdirSync(screenshots, {recursive: true}), writeFileSync(join(screenshots, `${browser.name}-${name}.png`), await browser.screenshot()));
const open = async url => (await browser.open('about:blank'), browser.open(url)); /* also where only the fragment differs */
const slide = (id, value) => browser.evaluate(`(it => { it.value = '${value}'; it.dispatchEvent(new Event('input')); it.dispatchEvent(new Event('change')); })(document.getElementById('${id}'))`);
/* Drops a photograph, whose pixels are painted in the page. */
const dropPhoto = () => browser.evaluate(`(async () => {
  const canvas = document.createElement('canvas'), context = canvas.getContext('2d'), transfer = new DataTransfer;
  canvas.width = 320, canvas.height = 240;
  const slope = context.createLinearGradient(0, 0, 320, 240);
  slope.addColorStop(0, '#249'), slope.addColorStop(1, '#fc8');
  context.fillStyle = slope, context.fillRect(0, 0, 320, 240), context.fillStyle = '#d33', context.fillRect(60, 50, 120, 90);
  const blob = await new Promise(resolve => canvas.toBlob(resolve));
  transfer.items.add(new File([blob], 'photo.png', {type: 'image/png'}));
  document.dispatchEvent(new DragEvent('drop', {dataTransfer: transfer, bubbles: true, cancelable: true}));
})()`);
const isEncoded = name => browser.until(`document.getElementById('name').textContent == '${name}' && !photo.hidden && progress.hidden`);

await browser.resize(1200, 900);

const drawn = async action => {
  const before = await browser.evaluate('+(stage.dataset.drawn || 0)');
  await action();
  await browser.until(`+(stage.dataset.drawn || 0) > ${before}`);
};
const textOf = id => browser.evaluate(`document.getElementById('${id}').textContent`);
const stageBox = () => browser.evaluate('(({x, y, width, height}) => ({x, y, width, height}))(stage.getBoundingClientRect())');

/* Of node.js, in the form of png.mjs. */
const expectedOf = async (width, height) => {
  const {data} = await decode(scene, {width, height});
  return {width, height, channels: 4, depth: 8, samples: data};
};

test('the demonstration page opens a file', async () => {
  await open(served);
  await browser.until('stage.dataset.drawn');
  await drawn(() => browser.choose('#chooser', join(made, 'scene.gscl')));
  assert.equal(await textOf('name'), 'scene.gscl');
  assert.match(await textOf('pixels'), /320 × 240/);
  const {width, height} = await browser.pixels('picture'), scale = Math.min(width / 320, height / 240);
  const size = [320 * scale, 240 * scale].map(Math.round);
  const crop = await browser.pixels(`(() => { const c = document.createElement('canvas'); c.width = ${size[0]}; c.height = ${size[1]};
    c.getContext('2d').drawImage(picture, -Math.round((${width} - 320 * ${scale}) / 2), -Math.round((${height} - 240 * ${scale}) / 2)); return c; })()`);
  const {samples} = await expectedOf(...size), mean = crop.data.reduce((sum, sample, i) => sum + Math.abs(sample - samples[i]), 0) / samples.length;
  assert(crop.data.length == samples.length && mean < 1, `samples differ by ${mean}`); /* WebGL draws at places between pixels, too */
  await shoot('file');
});

test('the slider shows the first part of the file', async () => {
  await drawn(() => browser.evaluate(`part.value = 30, part.dispatchEvent(new Event('input'))`));
  const [shown, all] = (await textOf('splats')).split(' of ').map(text => +text.replace(',', ''));
  assert(shown > 5 && shown < all / 2, `${shown} of ${all}`);
  assert.match(await textOf('partText'), /of [12],[0-9]+ bytes/);
  await shoot('part');
  await drawn(() => browser.evaluate(`part.value = 100, part.dispatchEvent(new Event('input'))`));
  assert.equal((await textOf('splats')).split(' of ')[0], all.toLocaleString('en'));
});

test('the wheel zooms without limit, drawn anew', async () => {
  const {x, y, width, height} = await stageBox(), before = await browser.pixels('picture');
  const percent = async () => parseFloat((await textOf('scale')).replaceAll(',', ''));
  const fitted = await percent();
  await drawn(() => browser.mouse('mouseWheel', x + width / 2, y + height / 2, {deltaX: 0, deltaY: -480}));
  await browser.until(`parseFloat(scale.textContent.replaceAll(',', '')) > ${fitted * 3.9}`);
  const after = await browser.pixels('picture'), middle = (after.height >> 1) * after.width + (after.width >> 1);
  for (let k = 0; k < 3; k++) /* the place under the mouse stays, but for half a pixel */
    assert(Math.abs(after.data[4 * middle + k] - before.data[4 * middle + k]) < 24);
  await shoot('zoom');
  for (let i = 0; i < 14; i++)
    await browser.mouse('mouseWheel', x + width / 2, y + height / 2, {deltaX: 0, deltaY: -480});
  await browser.until(`parseFloat(scale.textContent.replaceAll(',', '')) > 1e9`);
  const far = await browser.pixels('picture');
  assert(far.data.every((value, i) => i % 4 < 3 || value == 255));
  assert(await browser.evaluate('message.hidden'));
  await drawn(() => browser.evaluate('fit.click()'));
  assert.equal(await percent(), fitted);
});

test('dragging moves the picture', async () => {
  const {x, y, width, height} = await stageBox(), before = await browser.pixels('picture');
  await browser.mouse('mousePressed', x + width / 2, y + height / 2, {button: 'left', clickCount: 1});
  await drawn(() => browser.mouse('mouseMoved', x + width / 2 + 40, y + height / 2 + 10, {button: 'left', buttons: 1}));
  await browser.mouse('mouseReleased', x + width / 2 + 40, y + height / 2 + 10, {button: 'left', clickCount: 1});
  const after = await browser.pixels('picture'), at = (px, py) => 4 * (py * after.width + px);
  const px = after.width >> 1, py = after.height >> 1;
  for (let k = 0; k < 3; k++)
    assert(Math.abs(after.data[at(px + 40, py + 10) + k] - before.data[at(px, py) + k]) <= 2);
  await drawn(() => browser.evaluate('fit.click()'));
});

test('splats are shown as ellipses', async () => {
  const drawnPixels = pixels => pixels.data.reduce((sum, value, i) => sum + (i % 4 == 3 && value > 0), 0);
  assert.equal(drawnPixels(await browser.pixels('outlines')), 0);
  await drawn(() => browser.evaluate('showOutlines.click()'));
  const shown = await browser.pixels('outlines');
  assert.equal(drawnPixels(shown), shown.width * shown.height);
  const bright = shown.data.reduce((sum, value, i) => sum + (i % 4 < 3 && value > 100), 0);
  assert(bright > 1000, `${bright} bright samples`);
  await shoot('ellipses');
  await drawn(() => browser.evaluate('showOutlines.click()'));
});

test('a file that is not valid is named, and the page goes on', async () => {
  await browser.choose('#chooser', join(made, 'damaged.gscl'));
  await browser.until('!message.hidden');
  assert.match(await textOf('message'), /damaged/);
  await drawn(() => browser.choose('#chooser', join(made, 'scene.gscl')));
  assert(await browser.evaluate('message.hidden'));
  assert.deepEqual(browser.errors, []);
});

test('a photograph is encoded on the page, and shown beside other codecs', async () => {
  await slide('effort', 0);
  await dropPhoto();
  await isEncoded('photo.png');
  const sizeOf = async id => +(await textOf(id)).replace(',', '').split(' ')[0], size = await sizeOf('size');
  assert(size > 500 && size <= 1300, `${size} bytes`); /* an eighth of a bit for each pixel */
  await shoot('photo');
  hasCodec = true;
  for (const type of ['image/jpeg', 'image/webp', 'image/avif']) {
    await slide('other', type);
    await browser.until(`/bytes/.test(otherText.textContent)`);
    assert(await sizeOf('otherText') <= size, type);
    await slide('other', '');
    await browser.until(`!otherText.textContent`);
  }
  await slide('bytes', 9);
  await browser.until(`parseInt(document.getElementById('size').textContent) <= 512 && progress.hidden`);
  assert.equal(await textOf('bytesText'), '512 bytes');
});

test('a codec that is not there is named', async () => {
  hasCodec = false;
  await open(served);
  await browser.until('stage.dataset.drawn'); /* the sample, which would come in the place of the photograph */
  await dropPhoto();
  await isEncoded('photo.png');
  await slide('other', 'image/avif');
  await browser.until(`otherText.textContent == 'not here'`);
});

test('a slider stops the encode that goes on', async () => {
  await slide('effort', 9), await slide('effort', 0), await slide('bytes', 8);
  await browser.until(`parseInt(document.getElementById('size').textContent) <= 256 && progress.hidden`);
  assert(await browser.evaluate('message.hidden'));
});

test('a link is the picture', async () => {
  await browser.evaluate('link.click()');
  await browser.until(`location.hash.startsWith('#gscl=') && !link.disabled`);
  const fragment = await browser.evaluate('location.hash');
  assert(fragment.length > 200 && fragment.length <= 300, `${fragment.length} characters`);
  await shoot('link');
  for (const url of [served, local]) {
    await open(url + fragment);
    await browser.until('stage.dataset.drawn');
    assert.equal(await textOf('name'), 'the link');
    assert(await browser.evaluate('message.hidden'));
    assert.deepEqual(browser.errors, []);
  }
});

test('a file of a few bytes is the link as it is', async () => {
  await open(`${served}#gscl=${Buffer.from(bare).toString('base64url')}`);
  await browser.until('stage.dataset.drawn');
  await browser.evaluate('link.click()');
  await browser.until(`linkText.textContent && !link.disabled`);
  assert.equal(await browser.evaluate('location.hash'), `#gscl=${Buffer.from(bare).toString('base64url')}`);
});

test('a link that is no picture is one line', async () => {
  for (const [fragment, line] of [['#gscl=***', /^the link: it is not base64$/], ['#gscl=%3Cb%3E', /^the link: it is not base64$/], ['#gscl=', /^the link: /],
    ['#gscl-file=AAAA', /^the link: not a gscl file$/], [`#gscl=${'_'.repeat(5000)}`, /^the link: |^the file is /]]) {
    await open(served + fragment);
    await browser.until('!message.hidden');
    assert.match(await textOf('message'), line, fragment.slice(0, 20));
  }
});

test('the page works from a file, with the encoder', async () => {
  await open(local);
  await slide('effort', 0);
  await dropPhoto();
  await isEncoded('photo.png');
  assert.deepEqual(browser.errors, []);
  await browser.resize(390, 844);
  await pause(200);
  assert(await browser.evaluate('document.documentElement.scrollWidth <= innerWidth'), 'the page is wider than a phone');
  await shoot('phone');
  await browser.resize(1200, 900);
});

try {
  process.exitCode = await runTests() ? 0 : 1;
} finally {
  await browser.close();
  site.close();
  rmSync(made, {recursive: true});
}
