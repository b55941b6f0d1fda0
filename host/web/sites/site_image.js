/* What a page needs of an image until it has loaded, for bundlers and the command. */
import {createHash} from 'node:crypto';
import {readFileSync} from 'node:fs';
import {mkdir, readFile, rename, writeFile} from 'node:fs/promises';
import {basename, join} from 'node:path';

import {encode} from '../encode-node.js';
import {placeholder} from '../placeholder-node.js';
import {readImage, refuse} from './image_file.js';

/* Not by await, which modules that Turbopack calls cannot have outside functions. */
const {version} = JSON.parse(readFileSync(new URL('../package.json', import.meta.url)));

/* ---- Options ---- */

export const DEFAULT_BYTES = 200;
const DEFAULTS = {effort: 2, width: 128};
const RANGES = {bytes: [1, 2 ** 32 - 1], effort: [0, 9], width: [1, 16384]};
/* What bundlers add to the queries of their own requests. */
const FOREIGN = ['gscl', 'import', 't', 'v'];

/* Options of a plug-in, or texts of a query, as numbers. */
export const checkedOptions = given => Object.fromEntries(Object.entries(given).map(([name, value]) => {
  refuse(!Object.hasOwn(RANGES, name), `unknown option "${name}"; there are ${Object.keys(RANGES).join(', ')}`);
  const [least, most] = RANGES[name], number = value === '' ? NaN : Number(value);
  refuse(!Number.isInteger(number) || number < least || number > most, `${name} must be a whole number from ${least} to ${most}, it is "${value}"`);
  return [name, number];
}));

const queryOf = request => new URLSearchParams(request.split('?')[1]);

/* Whether a request of a bundler, a path with a query, is one for this package. */
export const isOurs = request => queryOf(request).has('gscl');

const optionsOf = request => checkedOptions(Object.fromEntries([...queryOf(request)].filter(([name]) => !FOREIGN.includes(name))));

/* ---- Images ---- */

/* {data, width, height, aspectRatio, colour, placeholder} of the bytes of an image file; gscl/client describes it. */
export const describeImage = async (bytes, options = {}) => {
  const {width: most, ...settings} = {...DEFAULTS, ...options.bpp ? {} : {bytes: DEFAULT_BYTES}, ...options};
  const {picture, width, height} = await readImage(bytes, most), {bytes: file} = await encode(picture, {...settings, bare: true});
  const {url, colour} = await placeholder(file, {bare: true});
  return {data: Buffer.from(file).toString('base64url'), width, height, aspectRatio: width / height, colour, placeholder: url};
};

/* ---- Bundlers ---- */

/* What make() gives, which is kept in a file.  Where there is no place for it, it is made each time. */
const kept = async (folder, key, make) => {
  const file = join(folder, `${createHash('sha256').update(key).digest('hex')}.json`);
  try {
    return JSON.parse(await readFile(file));
  } catch {
    /* not yet */
  }
  const value = await make(), draft = `${file}.${process.pid}`;
  try {
    await mkdir(folder, {recursive: true});
    await writeFile(draft, JSON.stringify(value));
    await rename(draft, file); /* whole, or not at all */
  } catch {
    /* a disk that is full, or that may not be written */
  }
  return value;
};

/* describeImage of what a request names, whose file has these bytes; from the cache in `folder` where it is there. */
export const describeRequest = async (request, bytes, defaults, folder) => {
  try {
    const options = {...defaults, ...optionsOf(request)};
    const key = JSON.stringify([version, createHash('sha256').update(bytes).digest('hex'), Object.entries(options).sort()]);
    return await kept(folder, key, () => describeImage(bytes, options));
  } catch (error) {
    throw Object.assign(error, {message: `${basename(request.split('?')[0])}: ${error.message}`});
  }
};

/* The module of an image; `url` is the statement that exports its address.  The default export is without `placeholder`, which is larger
 * than the rest, and which bundlers would not leave out. */
export const moduleText = ({placeholder, ...image}, url) => [
  url,
  ...Object.entries({...image, placeholder}).map(([name, value]) => `export const ${name} = ${JSON.stringify(value)};`),
  `export default {${['url', ...Object.keys(image)].join(', ')}};`,
].join('\n');
