/* placeholder; placeholder.d.ts describes it. */
import {decode, info} from './gscl.js';

const DEFAULT_WIDTH = 16; /* pixels, as blurs of other packages; 32 take two to three times the bytes */
const MAX_ASPECT = 4; /* height by width: higher pictures get a smaller width */

/* ---- PNG ---- */

const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10];

const crc32 = bytes => {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++)
      crc = crc >>> 1 ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc;
};

const word = number => [number >>> 24, number >>> 16 & 255, number >>> 8 & 255, number & 255];

const chunk = (name, data) => {
  const body = [...name].map(letter => letter.charCodeAt()).concat(...data);
  return [...word(data.length), ...body, ...word(crc32(body))];
};

/* Node has a function of its own (placeholder-node.js). */
let deflate = bytes => new Response(new Blob([bytes]).stream().pipeThrough(new CompressionStream('deflate'))).arrayBuffer();
export const useDeflate = it => deflate = it;

const paeth = (left, above, corner) => {
  const [a, b, c] = [above - corner, left - corner, left + above - 2 * corner].map(Math.abs);
  return a <= b && a <= c ? left : b <= c ? above : corner;
};
/* The filters of PNG, by number. */
const FILTERS = [() => 0, left => left, (left, above) => above, (left, above) => left + above >> 1, paeth];

const filtered = (row, above, channels, filter) =>
  row.map((value, i) => value - FILTERS[filter](row[i - channels] ?? 0, above[i] ?? 0, above[i - channels] ?? 0) & 255);
const effort = bytes => bytes.reduce((sum, byte) => sum + Math.min(byte, 256 - byte), 0);

/* Samples of `channels` channels as a PNG file; each row by the filter that leaves the smallest numbers. */
const png = async (samples, width, height, channels) => {
  const lines = [];
  let above = [];
  for (let y = 0; y < height; y++) {
    const row = samples.slice(y * width * channels, (y + 1) * width * channels);
    const tries = FILTERS.map((_, filter) => [filter, ...filtered(row, above, channels, filter)]);
    lines.push(...tries.reduce((best, it) => effort(it.slice(1)) < effort(best.slice(1)) ? it : best));
    above = row;
  }
  const header = [...word(width), ...word(height), 8, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0];
  return Uint8Array.from([...SIGNATURE, ...chunk('IHDR', header), ...chunk('IDAT', [...new Uint8Array(await deflate(Uint8Array.from(lines)))]), ...chunk('IEND', [])]);
};

/* ---- Placeholders ---- */

/* The mean colour of what is opaque, as in style sheets. */
const meanColour = data => {
  const sums = [0, 0, 0, 0];
  for (let i = 0; i < data.length; i += 4)
    for (let k = 0; k < 4; k++)
      sums[k] += k < 3 ? data[i + k] * data[i + 3] : data[i + 3];
  return '#' + sums.slice(0, 3).map(sum => Math.round(sum / (sums[3] || 1)).toString(16).padStart(2, '0')).join('');
};

const channelsOf = data => {
  let isGrey = true;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 255)
      return 4;
    isGrey &&= data[i] == data[i + 1] && data[i] == data[i + 2];
  }
  return isGrey ? 1 : 3;
};

export const placeholder = async (source, {width = DEFAULT_WIDTH, ...options} = {}) => {
  const {width: ownWidth, height: ownHeight} = await info(source, options), scale = Math.min(width / ownWidth, MAX_ASPECT * width / ownHeight);
  const [w, h] = [ownWidth, ownHeight].map(side => Math.max(1, Math.round(side * scale)));
  const {data} = await decode(source, {...options, width: w, height: h});
  const channels = channelsOf(data), samples = [...data].filter((_, i) => i % 4 < channels);
  const text = String.fromCharCode(...await png(samples, w, h, channels));
  return {url: `data:image/png;base64,${btoa(text)}`, width: ownWidth, height: ownHeight, aspectRatio: ownWidth / ownHeight, colour: meanColour(data), hasAlpha: channels == 4};
};
