/* Times the decoder for web pages in Node, Chromium and Firefox beside the tool: node web.mjs BUILD_FOLDER FILE.gscl [RUNS]
 *
 * Each time is the median of RUNS (default 10) decodes at the encoded size, after 3 that do not count: the engines compile
 * the module in the background at first.  `first` is the first decode of all, with loading the module.  The tool's time is that of
 * its process. */
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, basename, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {gzipSync} from 'node:zlib';

import {installedBrowsers, serve, startBrowser} from '../web/browsers.mjs';

const [build, file, runs = 10] = process.argv.slice(2), folder = resolve(build, 'host/web');
const WARM_UP = 3;

/* Runs in all engines. */
const measure = async (decode, bytes, count, warmUp) => {
  const times = [];
  for (let i = 0; i < count + warmUp; i++) {
    const start = performance.now();
    await decode(bytes);
    times.push(performance.now() - start);
  }
  const sorted = times.slice(warmUp).sort((a, b) => a - b);
  return {first: times[0], median: sorted[sorted.length >> 1], least: sorted[0]};
};
const print = (name, {first, median, least}) => console.log(`${name.padEnd(12)} first ${first.toFixed(1)} ms, median ${median.toFixed(1)} ms, least ${least.toFixed(1)} ms`);

for (const name of ['gscl.wasm', 'gscl.js'])
  console.log(`${name.padEnd(12)} ${gzipSync(readFileSync(join(folder, name)), {level: 9}).length} bytes gzipped`);
const {decode} = await import(pathToFileURL(join(folder, 'node.js')));
print('Node', await measure(decode, readFileSync(file), +runs, WARM_UP));

const site = await serve({'/web/': folder, '/files/': dirname(resolve(file))}, {'/': (_, response) => response.writeHead(200, {'content-type': 'text/html'}).end('')});
for (const name of installedBrowsers()) {
  const browser = await startBrowser(name);
  await browser.open(`${site.url}/`);
  print(name, await browser.evaluate(`(async () => {
    const {decode} = await import('/web/gscl.js'), bytes = await (await fetch('/files/${encodeURIComponent(basename(file))}')).arrayBuffer();
    return (${measure})(decode, bytes, ${+runs}, ${WARM_UP});
  })()`));
  await browser.close();
}
site.close();

const made = mkdtempSync(join(tmpdir(), 'gscl-web-'));
print('gscl decode', await measure(bytes => execFileSync(join(build, 'gscl'), ['decode', '--device', 'host', file, '-o', join(made, 'out.png')]), null, +runs, WARM_UP));
rmSync(made, {recursive: true});
