/* Reads image files: with sharp where it is installed; else PNG and JPEG, with pngjs and jpeg-js. */
import {GsclError} from '../node.js';
import {isTurned, reduced, upright} from './pixels.js';

export const refuse = (isRefused, message, code = 'invalid-argument') => {
  if (isRefused)
    throw Object.assign(new GsclError(message), {code});
};

/* Size of a picture of width x height at a width of at most `most` pixels. */
const sizeWithin = (width, height, most) => {
  const w = Math.min(width, most);
  return [w, Math.max(1, Math.round(height * w / width))];
};

/* ---- With sharp ---- */

const readBySharp = async (sharp, bytes, most) => {
  const {width, height, orientation} = await sharp(bytes).metadata();
  const [w, h] = isTurned(orientation) ? [height, width] : [width, height], [newWidth, newHeight] = sizeWithin(w, h, most);
  const image = sharp(bytes).rotate().resize(newWidth, newHeight, {fit: 'fill'}).toColourspace('srgb'); /* rotate: by EXIF */
  const {data, info} = await image.raw({depth: 'uchar'}).toBuffer({resolveWithObject: true});
  return {picture: {data, width: info.width, height: info.height}, width: w, height: h};
};

/* ---- Without ---- */

const MOST_PIXELS = 250; /* millions */
const MOST_MEMORY = 4096; /* MB */
const ORIENTATION = 0x112; /* tag of EXIF */

/* Of the TIFF structure of EXIF; 1, upright, where it says nothing or is damaged. */
const orientationOf = tiff => {
  try {
    const view = new DataView(tiff.buffer, tiff.byteOffset, tiff.byteLength), isLittle = tiff[0] == 73;
    const start = view.getUint32(4, isLittle), count = view.getUint16(start, isLittle);
    for (let at = start + 2; at < start + 2 + 12 * count; at += 12)
      if (view.getUint16(at, isLittle) == ORIENTATION)
        return view.getUint16(at + 8, isLittle);
  } catch {
    /* no EXIF, or it ends early */
  }
  return 1;
};

const exifOfPng = bytes => {
  for (let at = 8; at + 8 <= bytes.length; at += bytes.readUInt32BE(at) + 12)
    if (bytes.toString('latin1', at + 4, at + 8) == 'eXIf')
      return bytes.subarray(at + 8, at + 8 + bytes.readUInt32BE(at));
  return undefined;
};

const FORMATS = {
  pngjs: {
    load: () => import('pngjs'),
    isOf: bytes => bytes.subarray(0, 8).equals(Buffer.from('\x89PNG\r\n\x1a\n', 'latin1')),
    read: ({PNG}, bytes) => ({...PNG.sync.read(bytes), exif: exifOfPng(bytes)}),
  },
  'jpeg-js': {
    load: () => import('jpeg-js'),
    isOf: bytes => bytes[0] == 0xff && bytes[1] == 0xd8,
    read: ({decode}, bytes) => {
      const {exifBuffer, ...image} = decode(bytes, {formatAsRGBA: false, tolerantDecoding: false, maxResolutionInMP: MOST_PIXELS, maxMemoryUsageInMB: MOST_MEMORY});
      return {...image, exif: exifBuffer?.subarray(1)}; /* which begins within Exif\0\0 */
    },
  },
};

const readAlone = async (bytes, most) => {
  const [name, format] = Object.entries(FORMATS).find(([, {isOf}]) => isOf(bytes)) || [];
  refuse(!name, 'is neither PNG nor JPEG; for other formats install sharp (npm install sharp)', 'failed');
  const library = await loaded(format.load());
  refuse(!library, `cannot be read without ${name} or sharp (npm install sharp)`, 'failed');
  const {data, width, height, exif} = format.read(library, bytes), orientation = orientationOf(exif);
  const [w, h] = isTurned(orientation) ? [height, width] : [width, height], [newWidth, newHeight] = sizeWithin(w, h, most);
  const small = reduced({data, width, height}, ...isTurned(orientation) ? [newHeight, newWidth] : [newWidth, newHeight]);
  return {picture: upright(small, orientation), width: w, height: h};
};

/* ---- Either ---- */

/* A package that may be absent, or not made for this machine. */
const loaded = library => library.then(it => it.default, () => undefined);

/* {picture, width, height}: what the bytes of an image file hold, upright, at a width of at most `most` pixels; and its own size. */
export const readImage = async (bytes, most = Infinity) => {
  const sharp = await loaded(import('sharp'));
  try {
    return await (sharp ? readBySharp(sharp, bytes, most) : readAlone(bytes, most));
  } catch (error) {
    refuse(!(error instanceof GsclError), `cannot be read: ${error.message.split('\n')[0]}`, 'failed');
    throw error;
  }
};
