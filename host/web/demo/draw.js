/* Draws the part of a picture that the stage shows: by the GPU where there is one, at any zoom. */
import {view} from './decoder.js';

const canvas = document.createElement('canvas'); /* of the viewer, which draws nothing else */
let viewer, source; /* of the file, or of the part of it, that was drawn last */

const isSource = ({bytes, bare, partial}) => source?.bytes.buffer == bytes.buffer && source.bytes.length == bytes.length && source.bare == bare && source.partial == partial;

const viewerOf = async ({bytes, bare, partial}) => {
  if (!isSource({bytes, bare, partial})) {
    viewer?.free();
    viewer = source = undefined;
    viewer = await view(canvas, bytes, {bare, partial});
    source = {bytes, bare, partial};
  }
  return viewer;
};

/* Draws to a canvas's 2D context a file, {bytes, bare, partial}, as the view {scale, x, y} shows it: pixels of the canvas per pixel of the
 * picture, and the place of the picture in the canvas's corner. */
export const drawPicture = async (context, file, shown) => {
  const {width, height} = context.canvas, drawn = await viewerOf(file);
  if (canvas.width != width || canvas.height != height)
    Object.assign(canvas, {width, height});
  await drawn.draw(shown);
  context.clearRect(0, 0, width, height);
  context.drawImage(canvas, 0, 0);
};
