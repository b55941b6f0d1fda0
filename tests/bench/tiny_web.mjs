/* The decoder in plain JavaScript beside those of ThumbHash and BlurHash, as a Markdown table: node tiny_web.mjs BUILD FOLDER MODULES
 *
 * BUILD: the build folder; FOLDER: photographs as PNG; MODULES: a folder in which `npm install thumbhash blurhash` has run.  The pictures
 * are reduced to 128 pixels on their longer side, with which what a decoder draws is compared: a ThumbHash enlarged by bilinear
 * interpolation, as browsers do, the others drawn at that size.  Times are those of Node for a picture of 64 pixels width, or 32 of a
 * ThumbHash: the least of many decodes of each picture, and the mean of these.  tiny.py compares other codecs with ThumbHash. */
import {execFileSync} from 'node:child_process';
import {readdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {readPng} from '../web/png.mjs';

const [build, folder, modules] = process.argv.slice(2).map(name => resolve(name)), web = join(build, 'host/web');
const LONGER_SIDE = 128, THUMB_HASH_SIDE = 100, DRAWN_SIDE = 64; /* pixels */
const SIZES = [30, 60, 100, 200]; /* bytes */
const COMPONENTS = [4, 3]; /* of a BlurHash, as its page proposes */
const REPEATS = 40;

const {decode} = await import(pathToFileURL(join(web, 'tiny.js'))), {encode} = await import(pathToFileURL(join(web, 'encode-node.js')));
const importFrom = name => import(pathToFileURL(createRequire(join(modules, 'index.js')).resolve(name)));
const thumbHash = await importFrom('thumbhash'), {default: blurHash} = await importFrom('blurhash');

/* ---- Pictures: {data: RGBA, width, height} ---- */

/* Means over the area of each pixel. */
const reduce = ({data, width, height}, longerSide) => {
  const scale = Math.min(1, longerSide / Math.max(width, height)), w = Math.round(width * scale), h = Math.round(height * scale);
  const overlap = (first, length, at) => Math.min(at + 1, (first + 1) * length) - Math.max(at, first * length);
  const small = new Uint8ClampedArray(4 * w * h), a = width / w, b = height / h;
  for (let j = 0; j < h; j++)
    for (let i = 0; i < w; i++)
      for (let k = 0; k < 4; k++) {
        let sum = 0;
        for (let y = Math.floor(j * b); y < (j + 1) * b; y++)
          for (let x = Math.floor(i * a); x < (i + 1) * a; x++)
            sum += Math.max(0, overlap(j, b, y)) * Math.max(0, overlap(i, a, x)) * (data[4 * (y * width + x) + k] ?? 0);
        small[4 * (j * w + i) + k] = sum / (a * b);
      }
  return {data: small, width: w, height: h};
};

const enlarge = ({data, width, height}, w, h) => {
  const large = new Uint8ClampedArray(4 * w * h), place = (at, length, count) => Math.min(Math.max((at + .5) * count / length - .5, 0), count - 1);
  for (let j = 0; j < h; j++)
    for (let i = 0; i < w; i++) {
      const x = place(i, w, width), y = place(j, h, height), x0 = Math.floor(x), y0 = Math.floor(y), x1 = Math.ceil(x), y1 = Math.ceil(y);
      for (let k = 0; k < 4; k++) {
        const at = (column, row) => data[4 * (row * width + column) + k];
        large[4 * (j * w + i) + k] = (at(x0, y0) * (1 - x + x0) + at(x1, y0) * (x - x0)) * (1 - y + y0) + (at(x0, y1) * (1 - x + x0) + at(x1, y1) * (x - x0)) * (y - y0);
      }
    }
  return large;
};

const psnr = (data, picture) => {
  let sum = 0;
  for (let i = 0; i < data.length; i++)
    sum += i % 4 < 3 ? (data[i] - picture.data[i]) ** 2 : 0;
  return 10 * Math.log10(255 ** 2 * .75 * data.length / sum);
};

const load = name => {
  const {samples, channels, width, height} = readPng(readFileSync(join(folder, name)));
  const data = Uint8ClampedArray.from({length: 4 * width * height}, (_, i) => i % 4 < 3 ? samples[(i >> 2) * channels + Math.min(i % 4, channels - 1)] : 255);
  return reduce({data, width, height}, LONGER_SIDE);
};

/* ---- Measures ---- */

/* Milliseconds. */
const leastTime = draw => Math.min(...Array.from({length: REPEATS}, () => {
  const start = performance.now();
  draw();
  return performance.now() - start;
}));

const gzipped = source => execFileSync('gzip', ['-9', '-c'], {input: source}).length;
const bundled = text => gzipped(execFileSync('esbuild', ['--bundle', '--minify', '--format=esm', '--log-level=error'], {input: text, cwd: modules}));

const measureGscl = async (picture, bytes) => {
  const {width, height} = picture, scale = DRAWN_SIDE / Math.max(width, height), size = {width: Math.round(width * scale), height: Math.round(height * scale)};
  const file = (await encode(picture, {bytes, bare: true, effort: 5, tune: 'psnr'})).bytes;
  return {bytes: file.length, psnr: psnr(decode(file, {width, height}).data, picture), time: leastTime(() => decode(file, size))};
};

const measureThumbHash = picture => {
  const {data, width, height} = reduce(picture, THUMB_HASH_SIDE), hash = thumbHash.rgbaToThumbHash(width, height, data), {w, h, rgba} = thumbHash.thumbHashToRGBA(hash);
  return {bytes: hash.length, psnr: psnr(enlarge({data: rgba, width: w, height: h}, picture.width, picture.height), picture), time: leastTime(() => thumbHash.thumbHashToRGBA(hash))};
};

const measureBlurHash = ({data, width, height}) => {
  const components = width < height ? [...COMPONENTS].reverse() : COMPONENTS, hash = blurHash.encode(data, width, height, ...components), scale = DRAWN_SIDE / Math.max(width, height);
  return {bytes: hash.length, psnr: psnr(blurHash.decode(hash, width, height), {data}), time: leastTime(() => blurHash.decode(hash, Math.round(width * scale), Math.round(height * scale)))};
};

const pictures = readdirSync(folder).filter(name => name.endsWith('.png')).map(load), rows = [];
const addRow = async (name, size, measure) => {
  const measured = [];
  for (const picture of pictures)
    measured.push(await measure(picture));
  const mean = key => measured.reduce((sum, it) => sum + it[key], 0) / measured.length;
  rows.push(`| ${name} | ${size} | ${mean('bytes').toFixed(0)} | ${mean('psnr').toFixed(1)} | ${mean('time').toFixed(2)} ms |`);
};
await addRow('ThumbHash', bundled(`export {thumbHashToRGBA} from 'thumbhash'`), measureThumbHash);
await addRow(`BlurHash, ${COMPONENTS.join('x')}`, bundled(`export {decode} from 'blurhash'`), measureBlurHash);
for (const bytes of SIZES)
  await addRow('gscl/tiny', gzipped(readFileSync(join(web, 'tiny.js'))), picture => measureGscl(picture, bytes));
console.log(`${pictures.length} pictures\n\n| | decoder, bytes gzipped | bytes of a picture | PSNR dB | decode |\n|---|---|---|---|---|\n${rows.join('\n')}`);
process.exit();
