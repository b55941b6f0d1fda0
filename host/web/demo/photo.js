/* A photograph on the demonstration page: encoded in the browser, and beside it what other codecs make of as many bytes. */
import {encode} from '../encode.js';

const MAX_PIXELS = 2 ** 19; /* larger photographs are reduced, so that an encode takes seconds */
const QUALITY_STEPS = 7; /* of a search for a quality, each by half */

/* The pixels of an image file, reduced to MAX_PIXELS. */
export const readPhoto = async blob => {
  const bitmap = await createImageBitmap(blob), factor = Math.min(1, Math.sqrt(MAX_PIXELS / (bitmap.width * bitmap.height)));
  const canvas = document.createElement('canvas');
  Object.assign(canvas, {width: Math.max(1, Math.round(bitmap.width * factor)), height: Math.max(1, Math.round(bitmap.height * factor))});
  const context = canvas.getContext('2d');
  context.imageSmoothingQuality = 'high';
  context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
  return canvas;
};

export const encodePhoto = (canvas, options) => encode(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), options);

const scaled = (canvas, factor) => {
  const small = document.createElement('canvas');
  Object.assign(small, {width: Math.max(1, canvas.width >> factor), height: Math.max(1, canvas.height >> factor)});
  const context = small.getContext('2d');
  context.imageSmoothingQuality = 'high';
  context.drawImage(canvas, 0, 0, small.width, small.height);
  return small;
};

const toBlob = (canvas, type, quality) => new Promise(resolve => canvas.toBlob(resolve, type, quality));

/* The best file of at most `bytes` bytes by the browser's encoder of this type; null where none is as small. */
const within = async (canvas, type, bytes) => {
  let best = null, low = 0, high = 1;
  for (let i = 0; i < QUALITY_STEPS; i++) {
    const quality = i ? (low + high) / 2 : 0, blob = await toBlob(canvas, type, quality);
    if (blob?.type != type || (!i && blob.size > bytes))
      return null;
    if (blob.size <= bytes)
      best = blob, low = quality;
    else
      high = quality;
  }
  return best;
};

/* A file of another codec of at most as many bytes, reduced by half until it fits: {bitmap, bytes, size}; null where the browser has no
 * encoder of this type. */
export const encodeBy = async (canvas, type, bytes) => {
  for (let factor = 0; factor < 8; factor++) {
    const small = scaled(canvas, factor), blob = await within(small, type, bytes);
    if (blob)
      return {bitmap: await createImageBitmap(blob), bytes: blob.size, size: `${small.width} × ${small.height}`};
    if ((await toBlob(small, type, 0))?.type != type)
      return null;
  }
  return null;
};
