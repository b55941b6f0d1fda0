/* Compares decoded pixels with expected samples. */
import assert from 'node:assert/strict';

/* The RGBA pixel of 8 bits that stands for a pixel of 1 to 4 samples. */
export const rgbaOf = (samples, depth) => {
  const [r, g, b, a] = samples.length > 2 ? samples : [samples[0], samples[0], samples[0], samples[1]];
  const peak = depth == 8 ? 255 : 65535;
  return [r, g, b, a ?? peak].map(sample => sample * 255 / peak);
};

/* Fails where a sample differs by more than the page allows of every file: 1 of 255. */
export const assertPixel = (data, at, expected, name) => {
  for (let k = 0; k < 4; k++)
    assert(Math.abs(data[at + k] - expected[k]) < 1.51, `${name}: sample ${k} at byte ${at} is ${data[at + k]}, not ${expected[k]}`);
};

/* `image`: {width, height, data}; `expected`: as readPng returns it. */
export const assertPicture = (image, expected, name) => {
  assert.deepEqual([image.width, image.height], [expected.width, expected.height], name);
  assert.equal(image.data.length, 4 * image.width * image.height, name);
  for (let i = 0; i < image.width * image.height; i++)
    assertPixel(image.data, 4 * i, rgbaOf([...expected.samples.subarray(i * expected.channels, (i + 1) * expected.channels)], expected.depth), name);
};
