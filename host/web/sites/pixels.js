/* Pixels: pictures are {data, width, height}, of 8 bits a sample. */

/* By orientation of EXIF, from 1 to 8: whether rows become columns, and then what of the source is mirrored. */
const turns = {
  2: {mirrorX: true}, 3: {mirrorX: true, mirrorY: true}, 4: {mirrorY: true},
  5: {swap: true}, 6: {swap: true, mirrorY: true}, 7: {swap: true, mirrorX: true, mirrorY: true}, 8: {swap: true, mirrorX: true},
};

export const isTurned = orientation => orientation >= 5;

export const upright = (picture, orientation) => {
  const {swap, mirrorX, mirrorY} = turns[orientation] || {}, {data, width, height} = picture;
  const channels = data.length / (width * height), out = new Uint8ClampedArray(data.length), [w, h] = swap ? [height, width] : [width, height];
  for (let y = 0, to = 0; y < h; y++)
    for (let x = 0; x < w; x++) {
      const [column, row] = swap ? [y, x] : [x, y];
      const from = ((mirrorY ? height - 1 - row : row) * width + (mirrorX ? width - 1 - column : column)) * channels;
      for (let k = 0; k < channels; k++)
        out[to++] = data[from + k];
    }
  return {data: out, width: w, height: h};
};

/* ---- Reduction ---- */

/* By new pixel of a side: the old ones that it covers, each with its share. */
const shares = (size, newSize) => Array.from({length: newSize}, (_, i) => {
  const start = i * size / newSize, end = (i + 1) * size / newSize, first = Math.floor(start);
  return Array.from({length: Math.ceil(end) - first}, (_, k) => [first + k, (Math.min(end, first + k + 1) - Math.max(start, first + k)) / (end - start)]);
});

/* Means along one side of `size` slices, each of `step` samples. */
const averaged = (samples, size, step, newSize) => {
  const parts = shares(size, newSize), out = new Float32Array(samples.length / size * newSize);
  for (let from = 0, to = 0; from < samples.length; from += size * step)
    for (let i = 0; i < newSize; i++, to += step)
      for (const [slice, share] of parts[i])
        for (let k = 0; k < step; k++)
          out[to + k] += share * samples[from + slice * step + k];
  return out;
};

/* The colours multiplied by alpha, the last of 4 channels; or divided by it. */
const scaledByAlpha = (data, scale) => data.map((value, i) => i % 4 < 3 ? value * scale(data[i | 3]) : value);
const premultiplied = data => scaledByAlpha(Float32Array.from(data), alpha => alpha / 255);
const straight = data => scaledByAlpha(data, alpha => alpha && 255 / alpha);

/* The picture with fewer pixels, each the mean of the area that it covers.  The means are of samples as they are, in sRGB, as those
 * of sharp; alpha weighs them. */
export const reduced = ({data, width, height}, newWidth, newHeight) => {
  const channels = data.length / (width * height), hasAlpha = channels == 4;
  const rows = averaged(hasAlpha ? premultiplied(data) : data, width, channels, newWidth);
  const means = averaged(rows, height, newWidth * channels, newHeight);
  return {data: Uint8ClampedArray.from(hasAlpha ? straight(means) : means), width: newWidth, height: newHeight};
};
