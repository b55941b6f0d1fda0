/* Decodes files by the decoder for web pages: node decode_all.mjs WEB FOLDER < LIST
 *
 * WEB: host/web of the build folder.  Each line of LIST is `whole|bare read|draw FILE`.  Writes the RGBA samples of each
 * file that is drawn to FOLDER/N.rgba, N from 0, and prints a line for each file: `valid` or the name of the error. */
import {readFileSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [web, folder] = process.argv.slice(2).map(name => resolve(name));
const {decode, splats} = await import(pathToFileURL(join(web, 'node.js')));

const lines = readFileSync(0, 'utf8').trim().split('\n');
for (const [number, line] of lines.entries()) {
  const [form, what, ...name] = line.split(' '), bytes = readFileSync(name.join(' ')), bare = form == 'bare';
  try {
    await splats(bytes, {bare});
    if (what == 'draw')
      writeFileSync(join(folder, `${number}.rgba`), (await decode(bytes, {bare})).data);
    console.log('valid');
  } catch (error) {
    console.log(error.code);
  }
}
