/* The plug-ins for sites in projects of frameworks, which take npm minutes to install: sh tests/run.sh --whole.
 *
 *     node test_frameworks.mjs FOLDER WORK    FOLDER: host/web of the build folder; WORK: a folder for packages of npm */
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {readFileSync, rmSync} from 'node:fs';
import {resolve} from 'node:path';

import {projectsIn} from './projects.mjs';
import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), work = resolve(process.argv[3]);
const {at, write, installAll} = projectsIn(work, folder);
const READERS = ['pngjs@7', 'jpeg-js@0.4'];
installAll({
  astro: ['astro@5', ...READERS],
  sveltekit: ['@sveltejs/kit@2', '@sveltejs/adapter-static@3', '@sveltejs/vite-plugin-svelte@7', 'svelte@5', 'vite@8', ...READERS],
  next: ['next@16', 'react@19', 'react-dom@19', ...READERS],
});
const {default: {PNG}} = await import(at('astro', 'node_modules/pngjs/lib/png.js'));
const scene = sceneOf(300, 200), image = PNG.sync.write(Object.assign(new PNG(scene), {data: Buffer.from(scene.data)}), {deflateLevel: 0}); /* too large for a data: URL */
const REQUEST = 'hero.png?bytes=150&gscl';

const README = readFileSync(resolve(folder, 'README.md'), 'utf8');
const PAGE = `<main><gscl-image data={hero.data} bare width={hero.width} height={hero.height}></gscl-image><img src={hero.url} alt="" /></main>`;
const projects = {
  astro: {
    'astro.config.mjs': `import gscl from 'gscl/vite'; export default {vite: {plugins: [gscl()]}};`,
    'src/pages/index.astro': `---\nimport hero from './${REQUEST}';\n---\n<html><body>${PAGE}</body></html>`,
    'src/pages/hero.png': image,
  },
  sveltekit: {
    'vite.config.js': `import {sveltekit} from '@sveltejs/kit/vite'; import gscl from 'gscl/vite'; export default {plugins: [gscl(), sveltekit()]};`,
    'svelte.config.js': `import adapter from '@sveltejs/adapter-static'; export default {kit: {adapter: adapter()}};`,
    'src/app.html': `<html><head>%sveltekit.head%</head><body>%sveltekit.body%</body></html>`,
    'src/routes/+layout.js': `export const prerender = true;`,
    'src/routes/+page.svelte': `<script>import hero from './${REQUEST}';</script>${PAGE}`,
    'src/routes/hero.png': image,
  },
  next: {
    'next.config.mjs': README.match(/\/\/ next\.config\.mjs\n([^`]*)```/)[1].replace('export default {', `export default {output: 'export',`),
    'app/layout.jsx': `export default function Layout({children}) { return <html><body>{children}</body></html>; }`,
    'app/page.jsx': `import hero from './${REQUEST}'; export default function Page() { return ${PAGE}; }`,
    'app/hero.png': image,
  },
};
for (const [project, files] of Object.entries(projects))
  for (const [name, content] of Object.entries(files))
    write(project, name, content);

const builds = {
  'astro': ['astro', 'dist', 'astro', 'build'],
  'sveltekit': ['sveltekit', 'build', 'vite', 'build'],
  'next with turbopack': ['next', 'out', 'next', 'build', '--turbopack'],
  'next with webpack': ['next', 'out', 'next', 'build', '--webpack'],
};
for (const [name, [project, output, program, ...options]] of Object.entries(builds))
  test(`${name} builds a page with a placeholder`, async () => {
    const {describeImage} = await import(at(project, 'node_modules/gscl/sites/site_image.js')); /* Astro and Next bring sharp */
    for (const old of [output, '.next', 'node_modules/.cache/gscl', 'node_modules/.vite'])
      rmSync(at(project, old), {recursive: true, force: true});
    const {status, stdout, stderr} = spawnSync(at(project, 'node_modules/.bin', program), options,
      {cwd: at(project), encoding: 'utf8', env: {...process.env, ASTRO_TELEMETRY_DISABLED: '1', NEXT_TELEMETRY_DISABLED: '1'}});
    assert.equal(status, 0, stdout + stderr);
    const html = readFileSync(at(project, output, 'index.html'), 'utf8');
    assert.equal(html.match(/<gscl-image data="([\w-]+)" bare/)?.[1], (await describeImage(image, {bytes: 150})).data);
    assert(readFileSync(at(project, output, html.match(/<img src="([^"]*)"/)[1])).equals(image));
  });

process.exitCode = await runTests() ? 0 : 1;
