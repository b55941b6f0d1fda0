/* What the package has for those who build sites: plug-ins of bundlers, the command, and the component of the README.
 *
 *     node test_sites.mjs FOLDER WORK    FOLDER: host/web of the build folder; WORK: a folder for packages of npm
 *
 * It needs npm, its registry, and Chromium (CHROMIUM names it). */
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {crc32} from 'node:zlib';

import {Chromium, serve} from './chromium.mjs';
import {projectsIn, REACT, TOOLS} from './projects.mjs';
import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), work = resolve(process.argv[3]);
const {at, write, tool, installAll} = projectsIn(work, folder);
installAll({tools: TOOLS, sites: ['pngjs@7', 'jpeg-js@0.4'], sharp: ['sharp@0.35'], react19: REACT});
for (const name of ['node_modules/.cache', 'node_modules/.vite', 'out'])
  rmSync(at('sites', name), {recursive: true, force: true});

const moduleIn = (project, name) => import(at(project, 'node_modules', name));
const {default: jpeg} = await moduleIn('sites', 'jpeg-js/index.js'), {default: {PNG}} = await moduleIn('sites', 'pngjs/lib/png.js');
const sharp = (await moduleIn('sharp', 'sharp/dist/index.mjs').catch(() => moduleIn('sharp', 'sharp/lib/index.js'))).default;
const readers = {'pngjs and jpeg-js': 'sites', sharp: 'sharp'};
for (const [name, project] of Object.entries(readers))
  readers[name] = (await moduleIn(project, 'gscl/sites/image_file.js')).readImage;
const {reduced} = await moduleIn('sites', 'gscl/sites/pixels.js'), {checkedOptions, describeImage} = await moduleIn('sites', 'gscl/sites/site_image.js');
const {decode} = await moduleIn('sites', 'gscl/node.js');

/* ---- Image files ---- */

const pngOf = picture => PNG.sync.write(Object.assign(new PNG(picture), {data: Buffer.from(picture.data)}));
const jpegOf = picture => jpeg.encode(picture, 90).data;
const uint32 = number => Buffer.from([number >>> 24, number >>> 16, number >>> 8, number]);

/* EXIF of an orientation alone. */
const exifOf = orientation => Buffer.from([77, 77, 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0, 0, 0, 0, 0]);
const jpegWith = (bytes, exif) => Buffer.concat([bytes.subarray(0, 2), Buffer.from([0xff, 0xe1, 0, exif.length + 8]), Buffer.from('Exif\0\0'), exif, bytes.subarray(2)]);
const pngWith = (bytes, exif) => {
  const body = Buffer.concat([Buffer.from('eXIf'), exif]);
  return Buffer.concat([bytes.subarray(0, 33), uint32(exif.length), body, uint32(crc32(body)), bytes.subarray(33)]);
};

/* What is shown at column x and row y of the upright picture, by orientation: where it lies in a file of w x h pixels. */
const STORED = [
  undefined, (x, y) => [x, y], (x, y, w) => [w - 1 - x, y], (x, y, w, h) => [w - 1 - x, h - 1 - y], (x, y, w, h) => [x, h - 1 - y],
  (x, y) => [y, x], (x, y, w, h) => [y, h - 1 - x], (x, y, w, h) => [w - 1 - y, h - 1 - x], (x, y, w) => [w - 1 - y, x],
];
const stored = ({data, width, height}, orientation) => {
  const [w, h] = orientation > 4 ? [height, width] : [width, height], out = new Uint8ClampedArray(data.length);
  for (let i = 0; i < width * height; i++) {
    const [x, y] = STORED[orientation](i % width, Math.floor(i / width), w, h);
    out.set(data.subarray(4 * i, 4 * i + 4), 4 * (y * w + x));
  }
  return {data: out, width: w, height: h};
};

/* The three colours of a picture in a list. */
const coloursOf = ({data, width, height}) => {
  const channels = data.length / (width * height);
  return [...data].filter((_, i) => i % channels < 3);
};
const meanDifference = (a, b) => a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;

const scene = sceneOf(300, 200), image = jpegOf(scene);
write('sites', 'hero.jpg', image);

for (const [name, readImage] of Object.entries(readers)) {
  test(`${name}: images are reduced to areas' means and turned upright`, async () => {
    const expected = coloursOf(reduced(scene, 60, 40));
    const files = [pngOf(scene), pngWith(pngOf(stored(scene, 6)), exifOf(6)), ...[1, 2, 3, 4, 5, 6, 7, 8].map(it => jpegWith(jpegOf(stored(scene, it)), exifOf(it)))];
    for (const [i, bytes] of files.entries()) {
      const {picture, width, height} = await readImage(bytes, 60);
      assert.deepEqual([width, height, picture.width, picture.height], [300, 200, 60, 40], `file ${i}`);
      assert(meanDifference(coloursOf(picture), expected) < 1.5, `file ${i}: ${meanDifference(coloursOf(picture), expected)}`);
    }
    const {picture} = await readImage(pngOf(sceneOf(30, 20)), 60);
    assert.deepEqual([picture.width, picture.height], [30, 20]); /* not enlarged */
  });
  test(`${name}: what cannot be read is said in one line`, async () => {
    for (const bytes of [image.subarray(0, 1000), pngOf(scene).subarray(0, 1000), Buffer.from('text'), Buffer.alloc(0)])
      await assert.rejects(readImage(bytes), error => error.code == 'failed' && /^[^\n]{10,120}$/.test(error.message));
  });
}

test('formats beyond PNG and JPEG take sharp', async () => {
  const bytes = await sharp(Buffer.from(scene.data), {raw: {width: 300, height: 200, channels: 4}}).webp().toBuffer();
  const {width, height} = await readers.sharp(bytes, 60);
  assert.deepEqual([width, height], [300, 200]);
  await assert.rejects(readers['pngjs and jpeg-js'](bytes, 60), {name: 'GsclError', code: 'failed', message: 'is neither PNG nor JPEG; for other formats install sharp (npm install sharp)'});
});

test('means are of areas, which alpha weighs', () => {
  const line = values => ({data: Uint8Array.from(values), width: values.length, height: 1});
  assert.deepEqual([...reduced(line([30, 60, 90]), 2, 1).data], [40, 80]);
  assert.deepEqual([...reduced({data: Uint8Array.from([200, 0, 0, 255, 0, 200, 0, 0, 90, 0, 0, 85, 10, 0, 0, 255]), width: 2, height: 2}, 1, 1).data], [103, 0, 0, 149]);
});

test('options are checked', () => {
  assert.deepEqual(checkedOptions({bytes: '300', effort: 0}), {bytes: 300, effort: 0});
  for (const [name, value] of [['bytes', ''], ['bytes', '0'], ['effort', 10], ['width', '1.5'], ['width', 'x']])
    assert.throws(() => checkedOptions({[name]: value}), {name: 'GsclError', code: 'invalid-argument', message: RegExp(`^${name} must be a whole number from \\d+ to \\d+, it is "${value}"$`)});
});

test('an image is described for a page', async () => {
  const {data, ...rest} = await describeImage(pngOf(sceneOf(300, 200, 4, 0)), {bytes: 150}), bytes = Buffer.from(data, 'base64url');
  assert.deepEqual({...rest, colour: '', placeholder: ''}, {width: 300, height: 200, aspectRatio: 1.5, colour: '', placeholder: ''});
  assert(bytes.length > 75 && bytes.length <= 150);
  assert.match(rest.colour, /^#[0-9a-f]{6}$/);
  assert.match(rest.placeholder, /^data:image\/png;base64,/);
  assert.equal((await decode(bytes, {bare: true})).width, 128);
});

/* ---- Bundlers ---- */

const site = await serve({'/': work}, {
  '/photo.jpg': async (request, response) => (await photo.wanted, response.writeHead(200, {'content-type': 'image/jpeg'}).end(image)),
  '/component': (request, response) => response.writeHead(200, {'content-type': 'text/html'}).end(`<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">${page}`),
  '/page': (request, response) => response.writeHead(200, {'content-type': 'text/html'}).end(`<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
    <script type="module" src="${new URL(request.url, 'http://host').searchParams.get('script')}"></script>`),
});
let page = ''; /* the body of /component */
const photo = {}; /* the photograph of that page, which the server holds back until answer() is called */
photo.wanted = new Promise(resolve => photo.answer = resolve);
const browser = await Chromium.start();

write('sites', 'main.js', `import hero, {placeholder} from './hero.jpg?bytes=150&gscl'; globalThis.result = {...hero, placeholder};`);
write('sites', 'index.html', `<!doctype html><link rel="icon" href="data:,"><script type="module" src="./main.js"></script>`);
write('sites', 'vite.config.mjs', `import gscl from 'gscl/vite'; export default {base: './', build: {outDir: 'out/vite'}, plugins: [gscl({width: 96})]};`);
write('sites', 'rollup.config.mjs', `import gscl from 'gscl/rollup'; export default {input: 'main.js', output: {dir: 'out/rollup'}, plugins: [gscl({width: 96})]};`);
write('sites', 'webpack.config.mjs', `export default {mode: 'production', entry: './main.js', output: {path: ${JSON.stringify(at('sites', 'out/webpack'))}}, module: {rules: [
  {test: /\\.jpg$/, type: 'asset/resource'},
  {resourceQuery: /gscl/, type: 'javascript/auto', enforce: 'post', use: {loader: 'gscl/webpack-loader', options: {width: 96}}}]}};`);
const builds = {
  vite: () => (tool('vite', 'sites', 'build'), '/sites/out/vite/index.html'),
  rollup: () => (tool('rollup', 'sites', '-c', 'rollup.config.mjs'), '/page?script=/sites/out/rollup/main.js'),
  webpack: () => (tool('webpack', 'sites'), '/page?script=/sites/out/webpack/main.js'),
};
const caches = {vite: 'node_modules/.vite/gscl', rollup: 'node_modules/.cache/gscl', webpack: 'node_modules/.cache/gscl'};
for (const [bundler, build] of Object.entries(builds))
  test(`${bundler} makes a placeholder of an import, once`, async () => {
    rmSync(at('sites', caches[bundler]), {recursive: true, force: true});
    const expected = await describeImage(image, {bytes: 150, width: 96}), path = build();
    await browser.open(site.url + path);
    await browser.until('globalThis.result');
    const {url, ...result} = await browser.evaluate('result');
    assert.deepEqual(result, expected);
    assert.equal(await browser.evaluate(`fetch(result.url).then(it => it.arrayBuffer()).then(it => it.byteLength)`), image.length);
    const [file, ...others] = readdirSync(at('sites', caches[bundler]));
    assert.deepEqual(others, []);
    writeFileSync(at('sites', caches[bundler], file), JSON.stringify({...expected, colour: '#010203'}));
    await browser.open(site.url + build());
    await browser.until('globalThis.result');
    assert.equal(await browser.evaluate('result.colour'), '#010203');
  });

for (const [bundler, build] of Object.entries(builds))
  test(`${bundler} says which image it cannot take, and why`, () => {
    write('sites', 'text.jpg', 'text');
    const main = readFileSync(at('sites', 'main.js'), 'utf8');
    const complaint = request => {
      write('sites', 'main.js', `import '${request}';`);
      try {
        build();
        return '';
      } catch ({stdout, stderr}) {
        return stdout + stderr;
      }
    };
    try {
      assert.match(complaint('./text.jpg?gscl'), /text\.jpg: is neither PNG nor JPEG/);
      assert.match(complaint('./hero.jpg?gscl&byte=3'), /hero\.jpg: unknown option "byte"; there are bytes, effort, width/);
    } finally {
      write('sites', 'main.js', main);
    }
  });

test('the development server of vite makes it anew when the image changes', async () => {
  const {createServer} = await moduleIn('tools', 'vite/dist/node/index.js');
  const server = await createServer({root: at('sites'), configFile: at('sites', 'vite.config.mjs'), logLevel: 'silent', server: {port: 0, host: '127.0.0.1'}});
  try {
    await server.listen();
    await browser.open(`http://127.0.0.1:${server.httpServer.address().port}/index.html`);
    await browser.until('globalThis.result?.width == 300');
    assert.equal(await browser.evaluate(`fetch(result.url).then(it => it.arrayBuffer()).then(it => it.byteLength)`), image.length);
    write('sites', 'hero.jpg', jpegOf(sceneOf(200, 200)));
    await browser.until('globalThis.result?.width == 200'); /* the page loads itself again */
  } finally {
    write('sites', 'hero.jpg', image);
    await server.close();
  }
});

test('types know the imports', () => {
  const check = text => {
    write('sites', 'types.ts', `/// <reference types="gscl/client" />\n${text}`);
    return spawnSync(at('tools', 'node_modules/.bin/tsc'), ['--noEmit', '--strict', '--target', 'es2022', '--module', 'esnext', '--moduleResolution', 'bundler', '--types', '', 'types.ts'],
      {cwd: at('sites'), encoding: 'utf8'}).stdout;
  };
  assert.equal(check(`import hero, {placeholder} from './hero.jpg?gscl'; import {width} from './hero.jpg?bytes=300&gscl'; import gscl from 'gscl/vite';
    export const all: [string, number, number, string] = [hero.data, hero.aspectRatio, width, placeholder]; export const plugin: {name: string} = gscl({bytes: 300});`), '');
  assert.match(check(`import hero from './hero.jpg?gscl'; export const it: number = hero.data;`), /TS2322/);
  assert.match(check(`import gscl from 'gscl/vite'; gscl({byte: 3});`), /TS(2353|2561)/);
});

/* ---- The component of the README ---- */

test('the component shows the placeholder, then the photograph, and moves nothing', async () => {
  const [, component] = readFileSync(join(folder, 'README.md'), 'utf8').match(/```jsx\n([^`]*?useState(?:[^`]|`(?!``))*)```/);
  assert(component.trim().split('\n').length <= 20);
  const {data, width, height, colour} = await describeImage(image), bundle = (name, text, ...options) => {
    write('react19', `src/${name}.jsx`, text);
    tool('esbuild', 'react19', `src/${name}.jsx`, '--bundle', '--format=esm', '--jsx=automatic', `--outfile=out/${name}.js`, '--define:process.env.NODE_ENV="development"', ...options);
  };
  write('react19', 'src/photo.jsx', component);
  write('react19', 'src/app.jsx', `import {Photo} from './photo.jsx'; export const app = <main><Photo url="/photo.jpg" {...${JSON.stringify({data, width, height, colour})}} alt="A disc" /><p>below</p></main>;`);
  bundle('render', `import {renderToString} from 'react-dom/server'; import {app} from './app.jsx'; process.stdout.write(renderToString(app));`, '--platform=node', '--packages=external');
  bundle('hydrate', `import {hydrateRoot} from 'react-dom/client'; import {app} from './app.jsx'; hydrateRoot(root, app, {onRecoverableError: error => complaints.push(String(error))});`);
  const rendered = spawnSync('node', [at('react19', 'out/render.js')], {encoding: 'utf8'});
  assert.deepEqual([rendered.status, rendered.stderr], [0, '']);
  page = `<body style="margin: 0"><script>
    window.complaints = []; for (const name of ['error', 'warn']) console[name] = (...parts) => complaints.push(parts.join(' '));
    window.shift = 0; new PerformanceObserver(list => list.getEntries().forEach(it => shift += it.value)).observe({type: 'layout-shift', buffered: true});
    </script><div id="root">${rendered.stdout}</div><script type="module" src="/react19/out/hydrate.js"></script>`;
  await browser.send('Page.navigate', {url: `${site.url}/component`});
  const canvas = `document.querySelector('gscl-image')?.shadowRoot?.querySelector('canvas')`, below = `document.querySelector('p').getBoundingClientRect().top`;
  await browser.until(`${canvas}?.width == 300`);
  const top = await browser.evaluate(below);
  photo.answer();
  await browser.until(`!document.querySelector('gscl-image') && document.querySelector('img').naturalWidth == 300`);
  await browser.evaluate('new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve)))'); /* drawn */
  assert.deepEqual([await browser.evaluate(below), await browser.evaluate('shift'), await browser.evaluate('complaints')], [top, 0, []]);
  await browser.open(`${site.url}/component`); /* the photograph is there before the component */
  await browser.until(`!document.querySelector('gscl-image')`);
  assert.deepEqual([await browser.evaluate('shift'), await browser.evaluate('complaints')], [0, []]);
});

/* ---- The command ---- */

const run = (options, input) => {
  const {status, stdout, stderr} = spawnSync('node', [at('sites', 'node_modules/gscl/sites/cli.js'), ...options], {cwd: at('sites'), input});
  return {status, stdout: stdout.toString('latin1'), stderr: stderr.toString()};
};

test('the command prints attributes, elements and objects', async () => {
  const {data} = await describeImage(image), attributes = `data="${data}" bare width="300" height="200"`;
  assert.deepEqual(run(['hero.jpg']), {status: 0, stdout: `${attributes}\n`, stderr: ''});
  assert.deepEqual(run(['--html', '-'], image), {status: 0, stdout: `<gscl-image ${attributes} alt=""></gscl-image>\n`, stderr: ''});
  const small = ['--bytes', '60', '--effort', '0', '--width', '20'], {status, stdout} = run(['--json', ...small, 'hero.jpg', '-'], image), lines = stdout.trim().split('\n').map(it => JSON.parse(it));
  const expected = await describeImage(image, {bytes: 60, effort: 0, width: 20});
  assert.equal(status, 0);
  assert.deepEqual(lines, ['hero.jpg', '-'].map(file => ({file, ...expected})));
});

test('the command writes files', async () => {
  const info = async file => (await decode(file)).width, small = ['--bytes', '100', '--effort', '0'];
  write('sites', 'other.png', pngOf(sceneOf(40, 30)));
  assert.deepEqual(run(['hero.jpg', '-o', 'hero.gscl', '--width', '50', ...small]), {status: 0, stdout: '', stderr: ''});
  assert.equal(await info(readFileSync(at('sites', 'hero.gscl'))), 50);
  assert.equal(run(['--out-dir', 'out/files', 'hero.jpg', 'other.png', '--effort', '0', '--bpp', '0.5', '--width', '64']).status, 0);
  assert.deepEqual(await Promise.all(['hero', 'other'].map(name => info(readFileSync(at('sites', `out/files/${name}.gscl`))))), [64, 40]);
  assert.equal(await info(Buffer.from(run(['-o', '-', 'other.png', ...small]).stdout, 'latin1')), 40);
});

test('the command names what fails, goes on, and exits with 1', () => {
  const {status, stdout, stderr} = run(['none.jpg', 'text.jpg', 'hero.jpg', '--effort', '0']);
  assert.deepEqual([status, stdout.split('\n').length], [1, 2]);
  assert.equal(stderr, 'gscl: none.jpg: no such file or folder\ngscl: text.jpg: is neither PNG nor JPEG; for other formats install sharp (npm install sharp)\n');
  assert.deepEqual(run(['hero.jpg', '-o', 'none/a.gscl', '--width', '20', '--effort', '0']), {status: 1, stdout: '', stderr: 'gscl: hero.jpg: cannot write none/a.gscl: no such file or folder\n'});
});

test('the command refuses wrong command lines with 2', () => {
  const cases = [[], ['--wrong', 'a'], ['--bytes', '0', 'a'], ['--effort', 'x', 'a'], ['--html', '--json', 'a'], ['-o', 'b', 'a', 'c'], ['--bytes', '1', '--bpp', '1', 'a'], ['a', '-o']];
  for (const options of cases) {
    const {status, stdout, stderr} = run(options);
    assert.deepEqual([status, stdout], [2, ''], options.join(' '));
    assert.match(stderr, /^gscl: [^\n]+; see gscl --help\n$/);
  }
  assert.deepEqual([run(['--help']).status, run(['--version']).stdout], [0, `gscl ${JSON.parse(readFileSync(join(folder, 'package.json'))).version}\n`]);
});

try {
  process.exitCode = await runTests() ? 0 : 1;
} finally {
  await browser.close();
  site.close();
}
