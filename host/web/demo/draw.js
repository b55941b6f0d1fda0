/* Draws the part of a picture that the stage shows: useDrawing() puts another way, as one by a GPU, in the place of the decoder.
 *
 * A drawing is a function (context, {bytes, bare, partial, width, height}, {scale, x, y}) of a canvas's 2D context, a file with its encoded
 * size, and the view: pixels of the canvas per pixel of the picture, and the place of the picture in the canvas's corner. */
import {decode} from '../inline.js';

const LARGEST = 2 ** 23; /* pixels of a side of the picture that the decoder draws a part of; beyond, that part is enlarged */

const byDecoder = async (context, {bytes, bare, partial, ...size}, view) => {
  const {width, height} = context.canvas, scale = Math.min(view.scale, LARGEST / Math.max(size.width, size.height)), factor = view.scale / scale;
  const full = [size.width, size.height].map(side => Math.max(1, Math.round(side * scale))), start = [view.x, view.y].map(it => Math.floor(it * scale));
  const from = start.map(it => Math.max(0, it)), end = [width, height].map((side, i) => Math.min(full[i], start[i] + Math.ceil(side / factor) + 2));
  const [w, h] = end.map((it, i) => it - from[i]);
  const image = w > 0 && h > 0 && await decode(bytes, {width: full[0], height: full[1], crop: {x: from[0], y: from[1], width: w, height: h}, bare, partial});
  context.clearRect(0, 0, width, height);
  if (!image)
    return;
  if (factor == 1)
    return context.putImageData(image, Math.round(from[0] - view.x * scale), Math.round(from[1] - view.y * scale));
  context.drawImage(await createImageBitmap(image), (from[0] - view.x * scale) * factor, (from[1] - view.y * scale) * factor, w * factor, h * factor);
};

let drawing = byDecoder;
export const useDrawing = it => drawing = it;
export const drawPicture = (...args) => drawing(...args);
