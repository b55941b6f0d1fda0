/* Times of the encoder of the package for web pages: node web_encode.mjs BUILD IMAGE.png
 *
 * BUILD: the build folder.  Encodes the image with 0.125 bits per pixel and the default effort, and a thumbnail of it, 128 pixels wide, into
 * 100, 200 and 300 bytes at effort 2, each in one thread and in two, in Node and in those browsers that are installed: the first encode,
 * with loading the module, and the median of those that follow. */
import {readFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {installedBrowsers, serve, startBrowser} from '../web/browsers.mjs';
import {readPng} from '../web/png.mjs';

const [build, image] = process.argv.slice(2), folder = join(resolve(build), 'host/web');
const REPEATS = {large: 3, small: 9};

/* Means of squares of pixels. */
const shrink = ({data, width, height}, to) => {
  const factor = Math.floor(width / to), w = Math.floor(width / factor), h = Math.floor(height / factor), channels = data.length / (width * height);
  const small = new Uint8Array(w * h * channels);
  for (let y = 0; y < h; y++)
    for (let x = 0; x < w; x++)
      for (let k = 0; k < channels; k++) {
        let sum = 0;
        for (let j = 0; j < factor; j++)
          for (let i = 0; i < factor; i++)
            sum += data[((y * factor + j) * width + x * factor + i) * channels + k];
        small[(y * w + x) * channels + k] = sum / factor ** 2 + 0.5;
      }
  return {data: small, width: w, height: h};
};

/* Runs in Node and in the page: milliseconds of each encode. */
const measure = async (encode, picture, options, count) => {
  const times = [];
  let result;
  for (let i = 0; i < count; i++) {
    const start = performance.now();
    result = await encode(picture, options);
    times.push(performance.now() - start);
  }
  return {times, bytes: result.bytes.length, psnr: result.psnr};
};

const {width, height, samples} = readPng(readFileSync(image)), picture = {data: Uint8Array.from(samples), width, height}, thumbnail = shrink(picture, 128);
const jobs = [[picture, {bpp: 0.125}, REPEATS.large], ...[100, 200, 300].map(bytes => [thumbnail, {bytes, effort: 2}, REPEATS.small])]
  .flatMap(([source, options, count]) => [1, 2].map(threads => [source, {...options, threads}, count]));
const median = list => [...list].sort((a, b) => a - b)[list.length >> 1];
const rows = [];
const row = (where, [{width, height}, options], {times: [first, ...later], bytes, psnr}) =>
  rows.push(`| ${where} | ${width}x${height}, ${bytes} bytes, effort ${options.effort ?? 5} | ${options.threads} | ${first.toFixed(0)} ms | ${median(later).toFixed(0)} ms | ${psnr.toFixed(2)} |`);

const {encode} = await import(pathToFileURL(join(folder, 'encode-node.js')));
for (const job of jobs)
  row(`Node ${process.versions.node}`, job, await measure(encode, ...job));

for (const name of installedBrowsers()) {
  const isolating = {'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp'};
  const page = (_, response) => response.writeHead(200, {'content-type': 'text/html', ...isolating}).end('<link rel="icon" href="data:,">');
  const site = await serve({'/web/': folder}, {'/page': page}, isolating);
  const browser = await startBrowser(name);
  await browser.open(`${site.url}/page`);
  for (const job of jobs) {
    const [{data, width, height}, options, count] = job;
    row(name, job, await browser.evaluate(`(async () => {
      const {encode} = await import('/web/encode.js'), data = Uint8Array.from(atob('${Buffer.from(data).toString('base64')}'), it => it.charCodeAt());
      return (${measure})(encode, {data, width: ${width}, height: ${height}}, ${JSON.stringify(options)}, ${count});
    })()`));
  }
  await browser.close();
  site.close();
}
console.log(['| | picture | threads | first | median | dB |', '|---|---|---|---|---|---|', ...rows].join('\n'));
