/* Splats of a file as the shaders read them, and how much work they are. */
import {GsclError, open} from './gscl.js';

const OUT_OF_MEMORY = 7; /* gsf_result (format/types.h) */
const PARAMS = 14; /* numbers of a splat (cl/constants.h) */
export const SPLAT = 16; /* numbers of a splat for the shaders */
export const REACH = Math.sqrt(14); /* of a splat, in axes: beyond it the weight is 0 */
const CELLS = 64; /* a side of the grid in which work is estimated */

export const refuse = (isRefused, message, code = 'invalid-argument') => {
  if (isRefused)
    throw Object.assign(new GsclError(message), {code});
};

/* place: x, y, sigma1, sigma2; form: cosine and sine of theta, opacity, amplitude of the wave; colour: R, G, B, alpha; wave:
 * cycles per pixel along x and y, phase in cycles. */
const splatsOf = (params, count, colours, hasAlpha, hasOpacity) => {
  const splats = new Float32Array(count * SPLAT), [red, green, blue] = colours > 1 ? [6, 7, 8] : [6, 6, 6];
  for (let i = 0; i < count; i++) {
    const at = i * PARAMS, theta = params[at + 4];
    splats.set([
      params[at], params[at + 1], Math.exp(params[at + 2]), Math.exp(params[at + 3]),
      Math.cos(theta), Math.sin(theta), hasOpacity ? 1 / (1 + Math.exp(-params[at + 5])) : 1, params[at + 13],
      params[at + red], params[at + green], params[at + blue], hasAlpha ? params[at + 6 + colours] : 1,
      params[at + 10], params[at + 11], params[at + 12], 0,
    ], i * SPLAT);
  }
  return splats;
};

/* How many splats may touch each cell of a grid over the picture, row by row: first the differences between neighbours,
 * CELLS + 1 a row, then their sums. */
const depthsOf = (splats, width, height) => {
  const depths = new Float64Array((CELLS + 1) ** 2), cell = (at, side) => Math.max(0, Math.min(CELLS - 1, Math.floor(at / side * CELLS)));
  for (let i = 0; i < splats.length; i += SPLAT) {
    const x = splats[i], y = splats[i + 1], sigma1 = splats[i + 2], sigma2 = splats[i + 3], cosine = splats[i + 4], sine = splats[i + 5];
    const halfWidth = REACH * Math.hypot(cosine * sigma1, sine * sigma2), halfHeight = REACH * Math.hypot(sine * sigma1, cosine * sigma2);
    const left = cell(x - halfWidth, width), right = cell(x + halfWidth, width) + 1;
    const top = cell(y - halfHeight, height) * (CELLS + 1), bottom = (cell(y + halfHeight, height) + 1) * (CELLS + 1);
    depths[top + left]++, depths[top + right]--, depths[bottom + left]--, depths[bottom + right]++;
  }
  for (let i = 1; i < depths.length; i++)
    depths[i] += i % (CELLS + 1) && depths[i - 1];
  for (let i = CELLS + 1; i < depths.length; i++)
    depths[i] += depths[i - CELLS - 1];
  return depths;
};

/* Pixels of a view along an axis that lie in each cell. */
const overlaps = (at, scale, side, pixels) => Array.from({length: CELLS}, (_, i) =>
  Math.max(0, Math.min(pixels, ((i + 1) * side / CELLS - at) * scale) - Math.max(0, (i * side / CELLS - at) * scale)));

/* {width, height, splats, count, background, blend, hasAlpha, depth}, where `depth` is the largest number of the grid, and work(view, columns, rows): about as many evaluations of a
 * splat at a pixel as drawing so many pixels takes.  A view is {x, y, scaleX, scaleY}: the place in the picture of its top left
 * corner, and pixels per pixel of the picture. */
export const readPicture = (source, options = {}) => open(source, options, (wasm, header, check) => {
  check(wasm.read(!!options.partial));
  const at = wasm.splats(), [width, height, count, , , , colours, hasAlpha, hasOpacity, blend] = header();
  check(at ? 0 : OUT_OF_MEMORY);
  const params = new Float32Array(wasm.memory.buffer, at, count * PARAMS + 4), [...own] = params.subarray(count * PARAMS);
  const splats = splatsOf(params, count, colours, hasAlpha, hasOpacity), depths = depthsOf(splats, width, height);
  const work = ({x, y, scaleX, scaleY}, columns, rows) => {
    const across = overlaps(x, scaleX, width, columns);
    return overlaps(y, scaleY, height, rows).reduce((sum, pixels, row) =>
      sum + pixels * (pixels && across.reduce((line, it, column) => line + it * depths[row * (CELLS + 1) + column], 0)), count);
  };
  const background = [...colours > 1 ? own.slice(0, 3) : [own[0], own[0], own[0]], own[colours]];
  return {width, height, splats, count, background, blend, hasAlpha, depth: depths.reduce((most, it) => Math.max(most, it)), work};
});
