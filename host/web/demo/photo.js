/* A photograph on the demonstration page: encoded in the browser, and beside it what other codecs make of as many bytes. */
import {encode} from './encoder.js';

const MAX_PIXELS = 2 ** 19; /* larger photographs are reduced, so that an encode takes seconds */
const QUALITY_STEPS = 9; /* of a search for a quality, each by half */

/* A picture at another size, at least one pixel. */
const drawn = (source, ...size) => {
  const canvas = document.createElement('canvas'), [width, height] = size.map(side => Math.max(1, Math.round(side)));
  Object.assign(canvas, {width, height});
  const context = canvas.getContext('2d');
  context.imageSmoothingQuality = 'high';
  context.drawImage(source, 0, 0, width, height);
  return canvas;
};

/* A picture with at most so many pixels. */
export const reduced = (source, pixels) => {
  const factor = Math.min(1, Math.sqrt(pixels / (source.width * source.height)));
  return drawn(source, source.width * factor, source.height * factor);
};

export const readPhoto = async blob => reduced(await createImageBitmap(blob), MAX_PIXELS);

export const encodePhoto = (canvas, options) => encode(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), options);

/* ---- Other codecs: functions (canvas, quality from 0 to 1) of a Blob -------------------------------- */

const byBrowser = type => (canvas, quality) => new Promise(resolve => canvas.toBlob(blob => resolve(blob?.type == type ? blob : undefined), type, quality));

/* @jsquash/avif in a worker, which host/web/serve.sh puts beside the page; none where it does not lie there. */
let avif;
const byAvif = (canvas, quality) => new Promise(resolve => {
  avif ||= new Worker('avif.js', {type: 'module'});
  avif.onmessage = ({data}) => resolve(data && new Blob([data], {type: 'image/avif'}));
  avif.onerror = event => {
    event.preventDefault();
    avif = undefined;
    resolve();
  };
  avif.postMessage({image: canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), quality: Math.round(100 * quality)});
});
const encoderOf = type => type != 'image/avif' ? byBrowser(type) : location.protocol == 'file:' ? () => undefined : byAvif;

/* The best file of at most `bytes` bytes; undefined where none is as small. */
const within = async (canvas, encodeAt, bytes) => {
  let low = 0, high = 1, best;
  for (let i = 0; i < QUALITY_STEPS; i++) {
    const quality = i ? (low + high) / 2 : 0, blob = await encodeAt(canvas, quality);
    if (blob?.size <= bytes)
      best = blob, low = quality;
    else if (i)
      high = quality;
    else
      return undefined;
  }
  return best;
};

/* A file of another codec of at most as many bytes, reduced by half until it fits: {bitmap, bytes, size}, or nothing in it
 * where none fits; undefined where there is no encoder of this type. */
export const encodeBy = async (canvas, type, bytes) => {
  const encodeAt = encoderOf(type);
  if (!await encodeAt(drawn(canvas, 16, 16), 0))
    return undefined;
  for (let factor = 1; factor < 256; factor *= 2) {
    const small = drawn(canvas, canvas.width / factor, canvas.height / factor), blob = await within(small, encodeAt, bytes);
    if (blob)
      return {bitmap: await createImageBitmap(blob), bytes: blob.size, size: `${small.width} × ${small.height}`};
  }
  return {};
};
