/* Reads PNG files without palette and interlacing, of 8 or 16 bits a sample. */
import assert from 'node:assert/strict';
import {inflateSync} from 'node:zlib';

const CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}; /* by colour type */

const paeth = (left, above, corner) => {
  const p = left + above - corner, [a, b, c] = [left, above, corner].map(value => Math.abs(p - value));
  return a <= b && a <= c ? left : b <= c ? above : corner;
};

/* The rows of a PNG file without their filters. */
const unfilter = (raw, height, rowSize, step) => {
  const rows = new Uint8Array(height * rowSize);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (rowSize + 1)], at = y * rowSize;
    for (let i = 0; i < rowSize; i++) {
      const left = i >= step ? rows[at + i - step] : 0, above = y > 0 ? rows[at + i - rowSize] : 0;
      const corner = i >= step && y > 0 ? rows[at + i - rowSize - step] : 0;
      const predicted = [0, left, above, left + above >> 1, paeth(left, above, corner)][filter];
      rows[at + i] = raw[y * (rowSize + 1) + 1 + i] + predicted;
    }
  }
  return rows;
};

/* {width, height, channels, depth, samples} */
export const readPng = bytes => {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), data = [];
  let width, height, depth, channels;
  for (let at = 8; at < bytes.length; at += view.getUint32(at) + 12) {
    const name = Buffer.from(bytes.subarray(at + 4, at + 8)).toString(), content = bytes.subarray(at + 8, at + 8 + view.getUint32(at));
    if (name == 'IHDR') {
      [width, height, depth, channels] = [view.getUint32(at + 8), view.getUint32(at + 12), content[8], CHANNELS[content[9]]];
      assert(channels && (depth == 8 || depth == 16) && content[12] == 0);
    } else if (name == 'IDAT') {
      data.push(content);
    }
  }
  const step = channels * depth / 8, rows = unfilter(inflateSync(Buffer.concat(data)), height, width * step, step);
  const samples = depth == 8 ? rows : Uint16Array.from({length: rows.length / 2}, (_, i) => rows[2 * i] * 256 + rows[2 * i + 1]);
  return {width, height, channels, depth, samples};
};
