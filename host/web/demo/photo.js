/* A photograph on the demonstration page: encoded in the browser, and beside it what other codecs make of as many bytes. */
import {encode} from '../encode.js';

const MAX_PIXELS = 2 ** 19; /* larger photographs are reduced, so that an encode takes seconds */
const QUALITY_STEPS = 7; /* of a search for a quality, each by half */

/* A picture at another size, at least one pixel. */
const drawn = (source, ...size) => {
  const canvas = document.createElement('canvas'), [width, height] = size.map(side => Math.max(1, Math.round(side)));
  Object.assign(canvas, {width, height});
  const context = canvas.getContext('2d');
  context.imageSmoothingQuality = 'high';
  context.drawImage(source, 0, 0, width, height);
  return canvas;
};

/* The pixels of an image file, reduced to MAX_PIXELS. */
export const readPhoto = async blob => {
  const bitmap = await createImageBitmap(blob), factor = Math.min(1, Math.sqrt(MAX_PIXELS / (bitmap.width * bitmap.height)));
  return drawn(bitmap, bitmap.width * factor, bitmap.height * factor);
};

export const encodePhoto = (canvas, options) => encode(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), options);

const toBlob = (canvas, type, quality) => new Promise(resolve => canvas.toBlob(resolve, type, quality));

/* The best file of at most `bytes` bytes by the browser's encoder of this type; undefined where none is as small. */
const within = async (canvas, type, bytes) => {
  let low = 0, high = 1, best;
  for (let i = 0; i < QUALITY_STEPS; i++) {
    const quality = i ? (low + high) / 2 : 0, blob = await toBlob(canvas, type, quality);
    if (blob.size <= bytes)
      best = blob, low = quality;
    else if (i)
      high = quality;
    else
      return undefined;
  }
  return best;
};

/* A file of another codec of at most as many bytes, reduced by half until it fits: {bitmap, bytes, size}; undefined where the browser has no
 * encoder of this type. */
export const encodeBy = async (canvas, type, bytes) => {
  if ((await toBlob(canvas, type, 0))?.type != type)
    return undefined;
  for (let factor = 1; factor < 256; factor *= 2) {
    const small = drawn(canvas, canvas.width / factor, canvas.height / factor), blob = await within(small, type, bytes);
    if (blob)
      return {bitmap: await createImageBitmap(blob), bytes: blob.size, size: `${small.width} × ${small.height}`};
  }
  return undefined;
};
