/* The scripts of the tutorials run in Node: test_tutorials.mjs FOLDER    (host/web of the build folder) */
import assert from 'node:assert/strict';
import {cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {sceneOf} from './scenes.mjs';
import {runTests, test} from './tap.mjs';

const folder = resolve(process.argv[2]), tutorials = new URL('../../host/site/tutorials/', import.meta.url);
const work = mkdtempSync(join(tmpdir(), 'gscl-tutorials-'));
mkdirSync(join(work, 'node_modules'));
cpSync(folder, join(work, 'node_modules/gscl'), {recursive: true});
writeFileSync(join(work, 'package.json'), '{"type": "module"}');
globalThis.picture = sceneOf(64, 48);

/* Each page is one script, which exports nothing and must end without an error. */
for (const name of readdirSync(tutorials)) {
  const blocks = [...readFileSync(new URL(name, tutorials), 'utf8').matchAll(/^```js\n([^]*?)^```$/gm)].map(([, code]) => code);
  if (!blocks.length)
    continue;
  test(`${name}: its scripts run`, async () => {
    const script = join(work, `${name}.mjs`);
    writeFileSync(script, blocks.join('\n') + '\nexport {html, width, height};\n');
    const {html, width, height} = await import(pathToFileURL(script));
    assert.match(html, /^<gscl-image data="[\w-]+" bare /);
    assert.deepEqual([width, height], [64, 48]);
  });
}

const passed = await runTests();
rmSync(work, {recursive: true, force: true});
process.exit(passed ? 0 : 1);
