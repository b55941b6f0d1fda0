/* Encodes an image within its budget with the installed package, and decodes it. */
import assert from 'node:assert/strict';

import {decode} from 'gscl';
import {encode} from 'gscl/encode';

const width = 64, height = 48, data = new Uint8ClampedArray(width * height * 4);
for (let y = 0; y < height; y++)
  for (let x = 0; x < width; x++)
    data.set([4 * x, 5 * y, 255 - 2 * x, 255], 4 * (y * width + x));
const {bytes, psnr} = await encode({data, width, height}, {bytes: 300, effort: 0});
const image = await decode(bytes);
assert.ok(bytes.length <= 300 && psnr > 30, `${bytes.length} bytes, ${psnr} dB`);
assert.deepEqual([image.width, image.height, image.data.length], [width, height, data.length]);
console.log(`${bytes.length} bytes, ${psnr.toFixed(2)} dB`);
