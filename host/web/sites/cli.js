#!/usr/bin/env node
/* The command gscl of the package: images as placeholders for pages, or as .gscl files. */
import {mkdir, readFile, writeFile} from 'node:fs/promises';
import {basename, join, parse} from 'node:path';
import {parseArgs} from 'node:util';

import {encode} from '../encode-node.js';
import {readImage, refuse} from './image_file.js';
import {DEFAULT_BYTES, describeImage} from './site_image.js';

const HELP = `usage: gscl [OPTION]... IMAGE...

Prints what a page shows until an image has loaded, a line for each: the attributes of a <gscl-image>.  With -o or
--out-dir writes images as .gscl files.  Reads PNG and JPEG, and with sharp installed also WebP, AVIF, TIFF, GIF and
SVG.  Images are turned upright by their EXIF.  IMAGE may be -, standard input.

      --html          print whole elements
      --json          print objects: file, data, width, height, aspectRatio, colour, and placeholder, a PNG in a data: URL
  -o, --output FILE   write a .gscl file of one image; - is standard output
      --out-dir DIR   write a .gscl file of each image into DIR, which is made
      --bytes N       largest size of a file (default for pages ${DEFAULT_BYTES})
      --bpp R         largest size in bits per pixel (default for files 0.125, or 256 bytes if that is more)
      --effort N      0 is fastest, 9 has the best quality (default 2; for files 5)
      --width N       reduce images to a width of N pixels before they are encoded (default 128; for files: do not)
      --help, --version

A photograph of a camera takes minutes as a file: give --width.  Exits with 1 where an image failed, 2 where the
command line is wrong.
`;

const OPTIONS = {
  html: {type: 'boolean'}, json: {type: 'boolean'}, output: {type: 'string', short: 'o'}, 'out-dir': {type: 'string'}, bytes: {type: 'string'},
  bpp: {type: 'string'}, effort: {type: 'string'}, width: {type: 'string'}, help: {type: 'boolean', short: 'h'}, version: {type: 'boolean'},
};
/* Least and most; those of bpp need not be whole. */
const RANGES = {bytes: [1, 2 ** 32 - 1], bpp: [0.0001, 64], effort: [0, 9], width: [1, 16384]};

/* ---- Command line ---- */

const misuse = message => {
  process.stderr.write(`gscl: ${message}; see gscl --help\n`);
  process.exit(2);
};

const parsed = () => {
  try {
    return parseArgs({options: OPTIONS, allowPositionals: true});
  } catch (error) {
    return misuse(error.message.split(/[.;] /)[0]);
  }
};

const numberOf = (name, text) => {
  const [least, most] = RANGES[name], number = text.trim() ? Number(text) : NaN;
  if (!(number >= least && number <= most) || name != 'bpp' && number % 1)
    misuse(`--${name} must be a ${name == 'bpp' ? '' : 'whole '}number from ${least} to ${most}, it is "${text}"`);
  return number;
};

const {values, positionals: names} = parsed(), {html, json, output, 'out-dir': folder, help, version} = values;
const options = Object.fromEntries(Object.keys(RANGES).filter(name => name in values).map(name => [name, numberOf(name, values[name])]));
const modes = ['html', 'json', 'output', 'out-dir'].filter(name => name in values);

/* ---- Images ---- */

/* Those of system calls in words. */
const REASONS = {ENOENT: 'no such file or folder', EISDIR: 'is a folder', EEXIST: 'is there, and not a folder', ENOTDIR: 'not a folder', EACCES: 'permission denied'};
const reasonOf = ({code, message}) => REASONS[code] || message;

const fail = (name, error) => {
  process.stderr.write(`gscl: ${name}: ${reasonOf(error)}\n`);
  process.exitCode = 1;
};

const standardInput = async () => {
  const parts = [];
  for await (const part of process.stdin)
    parts.push(part);
  return Buffer.concat(parts);
};
const read = name => name == '-' ? standardInput() : readFile(name);

const print = (name, {data, width, height, ...rest}) => {
  const attributes = `data="${data}" bare width="${width}" height="${height}"`;
  const line = json ? JSON.stringify({file: name, data, width, height, ...rest}) : html ? `<gscl-image ${attributes} alt=""></gscl-image>` : attributes;
  process.stdout.write(`${line}\n`);
};

const writeFileOf = async (name, bytes) => {
  const {width, ...settings} = options, {picture} = await readImage(bytes, width), {bytes: file} = await encode(picture, settings);
  if (output == '-')
    return process.stdout.write(file);
  const path = output ?? join(folder, `${name == '-' ? 'stdin' : parse(basename(name)).name}.gscl`);
  return writeFile(path, file).catch(error => refuse(true, `cannot write ${path}: ${reasonOf(error)}`));
};

const take = async name => {
  const bytes = await read(name);
  await (output || folder ? writeFileOf(name, bytes) : print(name, await describeImage(bytes, options)));
};

const takeAll = async () => {
  if (folder)
    await mkdir(folder, {recursive: true});
  for (const name of names)
    await take(name).catch(error => fail(name, error));
};

/* ---- Run ---- */

if (help) {
  process.stdout.write(HELP);
} else if (version) {
  process.stdout.write(`gscl ${JSON.parse(await readFile(new URL('../package.json', import.meta.url))).version}\n`);
} else {
  if (!names.length)
    misuse('no image is given');
  if (modes.length > 1)
    misuse(`--${modes.join(' and --')} exclude each other`);
  if (options.bytes && options.bpp)
    misuse('--bytes and --bpp exclude each other');
  if (output && names.length > 1)
    misuse('--output takes one image; --out-dir takes several');
  await takeAll().catch(error => fail(folder, error));
}
