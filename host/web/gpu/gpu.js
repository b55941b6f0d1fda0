/* view, and <gscl-image> by the GPU; gpu.d.ts describes them. */
import {GsclImage, decode} from './gscl.js';
import {painterOf, partsOf} from './painter.js';
import {readPicture, refuse} from './picture.js';

const MAX_WORK = 2 ** 31; /* evaluations of a splat at a pixel: a second of a slow GPU, which does nothing else meanwhile */
const MAX_PIXELS = 2 ** 26; /* of decode */
const MAX_SIDE = 2 ** 24; /* of a whole picture that decode draws, pixels */

/* All elements share one context, because browsers have few, and so does the question whether there is one at all. */
let shared;
const sharedPainter = () => shared === undefined ? shared = painterOf(document.createElement('canvas')) : shared;

/* ---- Views ---- */

const viewOf = ({scale, x = 0, y = 0}) => {
  refuse(!(scale > 0 && [scale, x, y].every(Number.isFinite)), 'scale, x and y must be numbers, and scale above 0');
  return {x, y, scaleX: scale, scaleY: scale};
};

const drawByGpu = (painter, picture, view, {maxWork = MAX_WORK, maxPixels = MAX_PIXELS}) => {
  const {width, height} = painter.canvas, work = Math.round(picture.work(view, width, height));
  refuse(width * height > maxPixels, `the image has ${width}x${height} pixels; max_pixels is ${maxPixels}`, 'limit');
  refuse(work > maxWork, `drawing takes ${work} evaluations; max_work is ${maxWork}`, 'limit');
  painter.clear();
  for (const part of partsOf(picture, view, width, height))
    painter.draw(picture, view, part, part.left, part.top);
};

/* Along an axis: `side` pixels of the whole picture, of which decode draws `length` from `first` on, and where they lie among
 * those of the canvas.  Beyond MAX_SIDE fewer are drawn and enlarged. */
const axisOf = (at, scale, side, pixels, reduction) => {
  const whole = Math.max(1, Math.round(side * scale * reduction)), drawn = whole / side, place = reduction < 1 ? it => it : Math.round;
  const first = Math.max(0, Math.floor(at * drawn)), length = Math.min(whole, Math.ceil((at + pixels / scale) * drawn)) - first;
  return {whole, first, length, to: place((first / drawn - at) * scale), size: place(length / drawn * scale)};
};

const drawByWasm = async (canvas, source, {width, height}, {x, y, scaleX: scale}, options) => {
  const reduction = Math.min(1, MAX_SIDE / (scale * Math.max(width, height)));
  const across = axisOf(x, scale, width, canvas.width, reduction), down = axisOf(y, scale, height, canvas.height, reduction);
  const isShown = across.length > 0 && down.length > 0, buffer = document.createElement('canvas'), context = canvas.getContext('2d');
  if (isShown) {
    const crop = {x: across.first, y: down.first, width: across.length, height: down.length};
    const image = await decode(source, {...options, width: across.whole, height: down.whole, crop});
    buffer.width = image.width;
    buffer.height = image.height;
    buffer.getContext('2d').putImageData(image, 0, 0);
  }
  return () => {
    context.clearRect(0, 0, canvas.width, canvas.height);
    if (isShown)
      context.drawImage(buffer, across.to, down.to, across.size, down.size);
  };
};

export const view = async (canvas, source, options = {}) => {
  const picture = await readPicture(source, options), {width, height} = picture;
  let last, drawing, isFree;
  const painter = sharedPainter()?.takes(picture) && painterOf(canvas, () => last && draw(last));
  refuse(!painter && !canvas.getContext('2d'), 'the canvas has a context that is neither 2d nor webgl2');
  /* By the decoder only the last view is drawn of those that are asked for meanwhile. */
  const drawLast = async () => {
    try {
      for (let drawn; drawn != last && !isFree;) {
        const show = await drawByWasm(canvas, source, picture, drawn = last, options);
        isFree || show();
      }
    } finally {
      drawing = null;
    }
  };
  const draw = async it => {
    last = it;
    if (isFree || painter?.isLost())
      return;
    if (painter)
      return drawByGpu(painter, picture, it, options);
    return drawing ||= drawLast();
  };
  return {
    width, height, isGpu: !!painter,
    draw: async (it = {scale: Math.min(canvas.width / width, canvas.height / height)}) => draw(viewOf(it)),
    free: () => {
      isFree = true;
      painter?.free();
    },
  };
};

/* ---- Elements ---- */

GsclImage.draw = async (source, options) => {
  const painter = sharedPainter(), {width, height} = options;
  if (!painter || width * height > MAX_PIXELS)
    return decode(source, options);
  const picture = await readPicture(source, options), whole = {x: 0, y: 0, scaleX: width / picture.width, scaleY: height / picture.height};
  if (!painter.takes(picture) || picture.work(whole, width, height) > MAX_WORK)
    return decode(source, options);
  const canvas = Object.assign(document.createElement('canvas'), {width, height}), context = canvas.getContext('2d');
  for (const part of partsOf(picture, whole, width, height)) {
    for (const side of ['width', 'height'])
      if (painter.canvas[side] < part[side])
        painter.canvas[side] = part[side];
    painter.draw(picture, whole, part, 0, 0);
    context.drawImage(painter.canvas, 0, 0, part.width, part.height, part.left, part.top, part.width, part.height);
  }
  painter.forget(picture);
  return painter.isLost() ? decode(source, options) : canvas;
};
