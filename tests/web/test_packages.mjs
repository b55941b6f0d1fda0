/* The package among those that people use it with: bundlers without configuration, and TypeScript and JSX of frameworks.
 *
 *     node test_packages.mjs FOLDER WORK    FOLDER: host/web of the build folder; WORK: a folder for packages of npm
 *
 * It needs npm, its registry, and Chromium (CHROMIUM names it). */
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import {cpSync, readFileSync, rmSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

import {Chromium, serve} from './chromium.mjs';
import {projectsIn, REACT, TOOLS} from './projects.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), work = resolve(process.argv[3]);
const picture = fileURLToPath(new URL('../conformance/files/photograph.gscl', import.meta.url));
const PACKAGES = {
  tools: TOOLS,
  react18: ['react@18', 'react-dom@18', '@types/react@18'],
  react19: REACT,
  preact10: ['preact@10'],
  preact11: ['preact@11'],
  solid: ['solid-js@1'],
  alone: [],
};

const {at, write, tool, installAll} = projectsIn(work, folder);
installAll(PACKAGES);

/* ---- TypeScript ---- */

const check = (project, jsx, name, text) => {
  write(project, name, text);
  const {status, stdout} = spawnSync(at('tools', 'node_modules/.bin/tsc'), ['--noEmit', '--strict', '--target', 'es2022', '--module', 'esnext', '--moduleResolution', 'bundler',
    '--lib', 'es2022,dom,dom.iterable', ...jsx ? ['--jsx', 'react-jsx', '--jsxImportSource', jsx] : [], name], {cwd: at(project), encoding: 'utf8'});
  return status ? stdout : '';
};

for (const [project, jsx] of Object.entries({react18: 'react', react19: 'react', preact10: 'preact', preact11: 'preact', solid: 'solid-js'}))
  test(`JSX of ${project} knows the element and its attributes`, () => {
    const page = attributes => `import {GsclImage} from 'gscl'; export const use = (it: GsclImage | null) => {}; export const page = <gscl-image ${attributes} />;`;
    assert.equal(check(project, jsx, 'good.tsx', page('src="a.gscl" data="AAAA" alt="A" bare={false} width={300} height="200" class="c" id="i" style={{}} ref={it => { use(it); }}')), '');
    assert.match(check(project, jsx, 'kind.tsx', page('src={3}')), /TS2322.*number/);
    assert.match(check(project, jsx, 'name.tsx', page('source="a.gscl"')), /TS2322.*source/);
    if (jsx == 'react')
      assert.match(check(project, jsx, 'event.tsx', page('onLoad={() => {}}')), /TS2322.*onLoad/);
  });

test('the types need no framework', () => {
  assert.equal(check('alone', '', 'good.ts', `import {decode, GsclError} from 'gscl'; import {splats} from 'gscl/splats'; import {info} from 'gscl/inline'; import {decode as packets} from 'gscl/packets'; import {encode, type Encoded} from 'gscl/encode'; import {placeholder} from 'gscl/placeholder'; import {decode as decodeTiny, info as infoTiny} from 'gscl/tiny'; import {view, type Viewer} from 'gscl/gpu';
    const image = document.createElement('gscl-image'); image.src = 'a.gscl', image.width = 3, image.bare = true; export const width: string | null = image.width; export const all = [decode, GsclError, splats, info, packets];
    export const encoded: Promise<Encoded> = encode(new ImageData(2, 2), {bytes: 100, tune: 'psnr', threads: 2, packets: {size: 100}, signal: AbortSignal.timeout(1000), onProgress: ({fraction}) => { fraction.toFixed(); }});
    export const tiny: ImageData = decodeTiny('AdHt+lRqfz+RU4ZA', {width: 64, height: 43}); export const aspect: number = infoTiny(new Uint8Array(9)).width;
    export const url: Promise<string> = placeholder(new Uint8Array(9), {bare: true, width: 20}).then(it => it.url);
    export const viewer: Promise<Viewer> = view(document.createElement('canvas'), new Uint8Array(9), {bare: true, maxWork: 1e9}); viewer.then(it => it.draw({scale: it.width, x: 1})); export const bytes = async (): Promise<Blob> => new Blob([(await encoded).bytes]);`), '');
  assert.match(check('alone', '', 'bad_encode.ts', `import {encode} from 'gscl/encode'; encode({data: [1], width: 1, height: 1});`), /TS2322/);
  assert.match(check('alone', '', 'bad_options.ts', `import {encode} from 'gscl/encode'; encode(new ImageData(1, 1), {byte: 1});`), /TS(2353|2561)/);
  assert.match(check('alone', '', 'bad_view.ts', `import {view} from 'gscl/gpu'; view(document.createElement('canvas'), new Uint8Array(9)).then(it => it.draw({x: 1}));`), /TS2741.*scale/);
  assert.match(check('alone', '', 'bad.ts', `import 'gscl'; document.createElement('gscl-image').src = 3;`), /TS2322/);
});

/* ---- Bundlers ---- */

const site = await serve({'/files/': dirname(picture), '/': work}, {
  '/page': (request, response) => {
    const {searchParams} = new URL(request.url, 'http://host'), html = searchParams.get('html');
    response.writeHead(200, {'content-type': 'text/html'}).end(`<!doctype html><link rel="icon" href="data:,"><script>
      window.events = [], window.complaints = []; for (const name of ['error', 'warn']) console[name] = (...parts) => complaints.push(parts.join(' '));
      </script><div id="root">${html ? readFileSync(join(work, html)) : ''}</div><script type="module" src="/${searchParams.get('script')}"></script>`);
  },
});
const browser = await Chromium.start();
const open = (script, html = '') => browser.open(`${site.url}/page?script=${script}&html=${html}`);

/* A page that draws a picture by the element and by a function. */
const drawBy = {'gscl/gpu': `import {view} from 'gscl/gpu'; const decode = bytes => view(document.createElement('canvas'), bytes);`};
for (const entry of ['gscl', 'gscl/inline', 'gscl/packets', 'gscl/gpu']) {
  const name = entry.replace('/', '-');
  write('tools', `src/${name}.js`, `${drawBy[entry] || `import {decode} from '${entry}';`} const image = document.createElement('gscl-image'); image.src = '/files/photograph.gscl'; image.id = 'image';
    image.addEventListener('load', () => events.push('load')); document.body.append(image); fetch(image.src).then(it => it.arrayBuffer()).then(decode).then(it => events.push(it.width), it => events.push(String(it)));`);
  write('tools', `${name}.html`, `<!doctype html><script>window.events = []</script><body><script type="module" src="/src/${name}.js"></script>`);
}
const bundlers = {
  'esbuild, a module': name => tool('esbuild', 'tools', `src/${name}.js`, '--bundle', '--format=esm', `--outfile=out/esbuild/${name}.js`),
  'esbuild, a script': name => tool('esbuild', 'tools', `src/${name}.js`, '--bundle', `--outfile=out/esbuild/${name}.js`),
  rollup: name => tool('rollup', 'tools', `src/${name}.js`, '-p', 'node-resolve', '--dir', 'out/rollup'),
  webpack: name => tool('webpack', 'tools', '--mode', 'production', '--entry', `./src/${name}.js`, '-o', `out/webpack/${name}`, '--output-filename', `../${name}.js`),
  vite: name => tool('vite', 'tools', 'build', '--base', './', '--outDir', `out/vite/${name}`, '--config', 'vite.config.mjs'),
};
/* Where the module that a script names is beside it: some take it along, for others it is copied. */
const copyModules = bundler => ['gscl.wasm', 'gscl-packets.wasm'].forEach(name => cpSync(join(folder, name), at('tools/out', bundler, name)));
for (const [bundler, build] of Object.entries(bundlers))
  for (const name of bundler == 'esbuild, a script' ? ['gscl-inline'] : ['gscl-inline', 'gscl', 'gscl-packets', 'gscl-gpu'])
    test(`${bundler} makes a page of ${name}`, async () => {
      write('tools', 'vite.config.mjs', `export default {build: {rollupOptions: {input: '${name}.html'}}};`); /* as the name of index.html */
      build(name);
      const output = bundler.split(',')[0];
      if (/esbuild|rollup/.test(bundler))
        copyModules(output);
      await (bundler == 'vite' ? browser.open(`${site.url}/tools/out/vite/${name}/${name}.html`) : open(`tools/out/${output}/${name}.js`));
      await browser.until('events.length == 2');
      assert.deepEqual((await browser.evaluate('events')).sort(), [await browser.evaluate(`image.shadowRoot.querySelector('canvas').width`), 'load'].sort());
    });

const ENCODER = ['encode-worker.js', 'encode-run.js', 'gscl-encode.wasm', 'gscl-encode-alpha.wasm'];
for (const [bundler, build] of Object.entries(bundlers).filter(([name]) => name != 'esbuild, a script'))
  test(`${bundler} makes a page that encodes`, async () => {
    write('tools', 'src/encode.js', `import {encode} from 'gscl/encode';
      encode({data: new Uint8Array(4 * 64).fill(200), width: 8, height: 8}, {bytes: 60}).then(({width}) => events.push(width), error => events.push(error.message));`);
    write('tools', 'encode.html', `<!doctype html><script>window.events = []</script><body><script type="module" src="/src/encode.js"></script>`);
    write('tools', 'vite.config.mjs', `export default {build: {rollupOptions: {input: 'encode.html'}}};`);
    build('encode');
    const output = bundler.split(',')[0];
    if (/esbuild|rollup/.test(bundler))
      ENCODER.forEach(name => cpSync(join(folder, name), at('tools/out', output, name)));
    await (bundler == 'vite' ? browser.open(`${site.url}/tools/out/vite/encode/encode.html`) : open(`tools/out/${output}/encode.js`));
    await browser.until('events.length == 1');
    assert.deepEqual(await browser.evaluate('events'), [8]);
  });

test('esbuild makes a script of gscl/tiny alone', () => {
  write('tools', 'src/tiny.js', `import {decode, info} from 'gscl/tiny'; const text = 'AdHt+lRqfz+RU4ZA'; console.log(JSON.stringify([info(text), decode(text, {width: 6, height: 4}).data.length]));`);
  tool('esbuild', 'tools', 'src/tiny.js', '--bundle', '--format=iife', '--minify', '--outfile=out/esbuild/tiny.js');
  assert.equal(execFileSync('node', [at('tools/out/esbuild/tiny.js')], {encoding: 'utf8'}), '[{"width":12,"height":8},96]\n');
  assert(readFileSync(at('tools/out/esbuild/tiny.js')).length < 7500);
});

/* ---- The tarball ---- */

test('the tarball of npm installs, works, and bundles', async () => {
  rmSync(at('tarball'), {recursive: true, force: true});
  write('tarball', 'package.json', JSON.stringify({private: true, type: 'module'}));
  const run = (program, ...options) => execFileSync(program, options, {cwd: at('tarball'), encoding: 'utf8', stdio: 'pipe'});
  const [{filename}] = JSON.parse(run('npm', 'pack', '--json', folder));
  run('npm', 'install', '--no-audit', '--no-fund', '--ignore-scripts', '--prefer-offline', `./${filename}`);
  write('tarball', 'code.js', `import {decode} from 'gscl'; import {encode} from 'gscl/encode'; import {info} from 'gscl/tiny';
    const {bytes} = await encode({data: new Uint8Array(4 * 64).fill(200), width: 8, height: 8}, {bytes: 60}); console.log((await decode(bytes)).width, info('AdHt+lRqfz+RU4ZA').width);`);
  assert.equal(run('node', 'code.js'), '8 12\n');
  cpSync(fileURLToPath(new URL('../conformance/pictures/photograph.png', import.meta.url)), at('tarball', 'photo.png'));
  assert.match(run('npx', 'gscl', '--html', 'photo.png'), /^<gscl-image data="[\w-]+" bare width="\d+" height="\d+" alt=""><\/gscl-image>\n$/);
  write('tarball', 'page.js', `import {decode} from 'gscl/inline'; import hero from './photo.png?gscl';
    const bytes = Uint8Array.from(atob(hero.data.replace(/-/g, '+').replace(/_/g, '/')), it => it.charCodeAt()); globalThis.result = decode(bytes, {bare: true}).then(it => it.width);`);
  write('tarball', 'vite.config.mjs', `import gscl from 'gscl/vite'; export default {build: {rollupOptions: {input: 'page.js', output: {entryFileNames: 'page.js'}}}, plugins: [gscl({width: 12})]};`);
  tool('vite', 'tarball', 'build');
  await open('tarball/dist/page.js');
  assert.equal(await browser.evaluate('result'), 12);
  write('tarball', 'plain.js', `import {info} from 'gscl/inline'; globalThis.result = fetch('/files/photograph.gscl').then(it => it.arrayBuffer()).then(info).then(it => it.splats > 0);`);
  tool('esbuild', 'tarball', 'plain.js', '--bundle', '--outfile=dist/plain.js');
  await open('tarball/dist/plain.js');
  assert.equal(await browser.evaluate('result'), true);
});

/* ---- Frameworks ---- */

const bundle = (project, name, text, ...options) => {
  write(project, `src/${name}`, text);
  tool('esbuild', project, `src/${name}`, '--bundle', '--format=esm', '--jsx=automatic', `--outfile=out/${name.replace('.jsx', '.js')}`, '--define:process.env.NODE_ENV="development"', ...options);
};
const drawn = `document.querySelector('gscl-image')?.shadowRoot.querySelector('canvas')?.width == 200`;
const failed = `document.querySelector('gscl-image').shadowRoot.textContent == 'A picture'`;
const attributes = `alt="A picture" width={200} height="100" class="c"`;

for (const project of ['react18', 'react19'])
  test(`${project} draws pictures, and takes over those that a server wrote`, async () => {
    bundle(project, 'server.jsx', `import 'gscl'; import 'gscl/inline'; import {renderToString} from 'react-dom/server';
      process.stdout.write(renderToString(<gscl-image src="/files/photograph.gscl" ${attributes} />));`, '--platform=node', '--packages=external');
    const html = execFileSync('node', [at(project, 'out/server.js')], {encoding: 'utf8'});
    assert.equal(html, '<gscl-image src="/files/photograph.gscl" alt="A picture" width="200" height="100" class="c"></gscl-image>');
    write(project, 'out/server.html', html);
    bundle(project, 'page.jsx', `import 'gscl/inline'; import {useEffect, useRef, useState} from 'react'; import {createRoot, hydrateRoot} from 'react-dom/client';
      const App = () => {
        const [src, setSrc] = useState('/files/photograph.gscl'), image = useRef();
        window.setSrc = setSrc;
        useEffect(() => {
          const listen = event => events.push(event.type);
          for (const name of ['load', 'error']) image.current.addEventListener(name, listen);
        }, []);
        return <gscl-image ref={image} src={src} ${attributes} />;
      };
      root.firstChild ? hydrateRoot(root, <App />, {onRecoverableError: error => complaints.push(String(error))}) : createRoot(root).render(<App />);`);
    for (const server of ['', `${project}/out/server.html`]) {
      await open(`${project}/out/page.js`, server);
      await browser.until(`${drawn} && events == 'load'`);
      await browser.evaluate(`setSrc('/files/none.gscl')`);
      await browser.until(`${failed} && events == 'load,error'`);
      assert.deepEqual(await browser.evaluate('complaints'), []);
    }
  });

for (const project of ['preact10', 'preact11'])
  test(`${project} draws pictures and calls handlers`, async () => {
    bundle(project, 'page.jsx', `import 'gscl/inline'; import {render} from 'preact'; import {useState} from 'preact/hooks';
      const App = () => {
        const [src, setSrc] = useState('/files/photograph.gscl');
        window.setSrc = setSrc;
        return <gscl-image src={src} bare={false} ${attributes} onLoad={event => events.push(event.type)} onError={event => events.push(event.type)} />;
      };
      render(<App />, root);`, '--jsx-import-source=preact');
    await open(`${project}/out/page.js`);
    await browser.until(`${drawn} && events == 'load'`);
    await browser.evaluate(`setSrc('/files/none.gscl')`);
    await browser.until(`${failed} && events == 'load,error'`);
  });

test('solid draws pictures and calls handlers', async () => {
  bundle('solid', 'page.jsx', `import 'gscl/inline'; import {createSignal} from 'solid-js'; import {render} from 'solid-js/web';
    const [src, setSrc] = createSignal('/files/photograph.gscl');
    window.setSrc = setSrc;
    render(() => <gscl-image src={src} bare={false} ${attributes} onLoad={event => events.push(event.type)} onError={event => events.push(event.type)} />, root);`, '--jsx-import-source=solid-js/h', '--conditions=browser');
  await open('solid/out/page.js');
  await browser.until(`${drawn} && events == 'load'`);
  await browser.evaluate(`setSrc('/files/none.gscl'), 0`);
  await browser.until(`${failed} && events == 'load,error'`);
});

try {
  process.exitCode = await runTests() ? 0 : 1;
} finally {
  await browser.close();
  site.close();
}
