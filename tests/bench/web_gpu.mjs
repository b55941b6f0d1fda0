/* Times drawing by the GPU in Chromium: node web_gpu.mjs BUILD_FOLDER FILE.gscl [FRAMES [FLAG...]]
 *
 * Each frame (default 300 of them) draws another view of the picture to a canvas of 1280x720: `pan` moves, `zoom` doubles the scale ten
 * times.  `script` is the time of the call of draw, and `frames` how many a second were shown; both medians.  FLAGs say how
 * Chromium draws; by default by its software renderer, whose threads share the processor with the script, so that the frames
 * say nothing of a GPU. */
import {readFileSync} from 'node:fs';
import {resolve} from 'node:path';

import {Chromium, SOFTWARE_WEBGL, serve} from '../web/chromium.mjs';

const [build, file, frames = 300, ...flags] = process.argv.slice(2), folder = resolve(build, 'host/web');
const page = `<!doctype html><link rel="icon" href="data:,"><canvas id="canvas" width="1280" height="720"></canvas><script>
  const {getContext} = HTMLCanvasElement.prototype; /* software renderers count, too */
  HTMLCanvasElement.prototype.getContext = function (kind, {failIfMajorPerformanceCaveat, ...options} = {}) { return getContext.call(this, kind, options); };
</script><script type="module">import {view} from '/web/gpu.js'; window.view = view;</script>`;

/* Runs in the page. */
const measure = async (viewer, viewOf, count) => {
  const scripts = [], spans = [], median = list => list.sort((a, b) => a - b)[list.length >> 1];
  for (let i = 0, before; i < count; i++) {
    await new Promise(requestAnimationFrame);
    const start = performance.now();
    viewer.draw(viewOf(i / count));
    scripts.push(performance.now() - start);
    if (before)
      spans.push(start - before);
    before = start;
  }
  return {largest: Math.max(...scripts), script: median(scripts), frames: 1000 / median(spans)};
};

const site = await serve({'/web/': folder}, {
  '/': (_, response) => response.writeHead(200, {'content-type': 'text/html', 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp'}).end(page),
  '/file': (_, response) => response.writeHead(200).end(readFileSync(file)),
});
const browser = await Chromium.start(flags.length ? flags : SOFTWARE_WEBGL);
await browser.open(`${site.url}/`);
await browser.until('window.view');
const results = await browser.evaluate(`(async () => {
  const viewer = await view(canvas, await (await fetch('/file')).arrayBuffer()), {width, height, isGpu} = viewer, measure = ${measure};
  const renderer = canvas.getContext('webgl2')?.getExtension('WEBGL_debug_renderer_info'), fit = Math.min(canvas.width / width, canvas.height / height);
  return {
    renderer: isGpu ? canvas.getContext('webgl2').getParameter(renderer.UNMASKED_RENDERER_WEBGL) : 'the decoder',
    pan: await measure(viewer, t => ({scale: 2 * fit, x: width / 2 * t, y: height / 2 * t}), ${+frames}),
    zoom: await measure(viewer, t => ({scale: fit * 2 ** (10 * t), x: width / 2 * (1 - 2 ** (-10 * t)), y: height / 2 * (1 - 2 ** (-10 * t))}), ${+frames}),
  };
})()`);
console.log(results.renderer);
for (const name of ['pan', 'zoom'])
  console.log(`${name.padEnd(5)} script ${results[name].script.toFixed(3)} ms a frame, at most ${results[name].largest.toFixed(1)} ms; ${results[name].frames.toFixed(1)} frames/s`);
await browser.close();
site.close();
