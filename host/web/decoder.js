/* decode, info and load; gscl.d.ts describes them.
 *
 * Each call has an instance of the WebAssembly module of its own: its memory goes when the call ends, and a trap ends one call
 * only.  The build joins this file, element.js and module.js to gscl.js, without comments and with short names; and with
 * inline_module.js in place of the last to what inline.js exports. */

/* Messages and codes by the numbers of gsf_result (format/types.h); the messages are those of gscl_decode. */
const failuresOf = bytes => [
  [],
  ['not a gscl file', 'not-a-gscl-file'],
  [`the file has format version ${bytes[4] & 15}; this program reads version 2`, 'newer-version'],
  [`the file is incomplete: it has ${bytes.length} bytes`, 'truncated'],
  ['the file is damaged: its check does not match', 'damaged'],
  ['the file is not valid', 'corrupt'],
  ['the file has an unknown mandatory block', 'unknown-block'],
  ['out of memory', 'out-of-memory'],
];
const MAX_DIMENSION = 16384;

export class GsclError extends Error {
  name = 'GsclError';
}

const refuse = (isRefused, message, code = 'invalid-argument') => {
  if (isRefused)
    throw Object.assign(new GsclError(message), {code});
};

const allocated = at => (refuse(!at, 'out of memory', 'out-of-memory'), at);

const fetchFile = async (url, code, options) => {
  const answer = await fetch(url, options);
  refuse(!answer.ok, `${answer.url}: status ${answer.status}`, code);
  return answer;
};

const compile = async source => (source = await source) instanceof WebAssembly.Module ? source : WebAssembly.compile(source);
let found; /* promise of the module, by find() of module.js or inline_module.js */
const moduleOf = () => found ||= compile(find()).catch(error => {
  found = 0; /* the next call tries again */
  throw error;
});
export const load = source => (find = () => source, found = 0, moduleOf());

/* Calls use(wasm, header, check) with an instance that has read the header of the file.  header() is the list of
 * decoder.c; check(result) throws unless the result is 0. */
export const open = async (source, {bare}, use) => {
  try {
    const bytes = new Uint8Array(source?.buffer || source, source?.byteOffset, source?.byteLength); /* a view has a buffer */
    const wasm = (await WebAssembly.instantiate(await moduleOf(), {Math})).exports;
    const check = result => refuse(result, ...failuresOf(bytes)[result]);
    const at = allocated(wasm.file(bytes.length, !!bare));
    new Uint8Array(wasm.memory.buffer, at).set(bytes);
    check(wasm.header());
    return use(wasm, () => new Uint32Array(wasm.memory.buffer, wasm.info(), 10), check);
  } catch (error) {
    refuse(!(error instanceof GsclError), `the decoder failed: ${error.message}`, 'failed');
    throw error;
  }
};

export const info = (source, options = {}) => open(source, options, (wasm, header) => {
  const [width, height, splats, layout, enhancement, isHigh] = header();
  return {width, height, channels: layout + 1, bitDepth: isHigh ? 16 : 8, splats, layers: enhancement + 1};
});

const limitSize = (width, height, most) =>
  refuse(width > most || height > most, `cannot draw ${width}x${height} pixels; at most ${most}x${most}`, 'image-size');

/* The same checks as gscl_decode, in the same order, but that only the returned rectangle is limited to MAX_DIMENSION. */
export const decode = (source, options = {}) => open(source, options, (wasm, header, check) => {
  const {width = 0, height = 0, crop = {}, maxPixels = 2 ** 26, maxWork = 2 ** 33} = options;
  const {x = 0, y = 0, width: cropWidth = 0, height: cropHeight = 0} = crop;
  const [ownWidth, ownHeight, count] = header(), fullWidth = width || ownWidth, fullHeight = height || ownHeight;
  const w = cropWidth || fullWidth - x, h = cropHeight || fullHeight - y;
  refuse([width, height, x, y, cropWidth, cropHeight].some(number => !(number >= 0) || number % 1), 'width, height and crop must be whole numbers');
  refuse(!width != !height, 'give both width and height, or neither');
  limitSize(w, h, MAX_DIMENSION);
  limitSize(fullWidth, fullHeight, 2 ** 24); /* where a float still has whole pixels */
  refuse(w <= 0 || h <= 0 || x + w > fullWidth || y + h > fullHeight,
    `crop ${x},${y},${cropWidth},${cropHeight} is not inside ${fullWidth}x${fullHeight}`);
  refuse(w * h > maxPixels, `the image has ${w}x${h} pixels; max_pixels is ${maxPixels}`, 'limit');
  refuse(count > maxWork, `the file has ${count} splats; max_work is ${maxWork}`, 'limit');
  check(wasm.read(!!options.partial));
  const work = wasm.frame(fullWidth, fullHeight, x, y, w, h);
  refuse(work > maxWork, `drawing takes ${work} evaluations; max_work is ${maxWork}`, 'limit');
  const at = allocated(wasm.draw());
  const data = new Uint8ClampedArray(wasm.memory.buffer, at, 4 * w * h).slice();
  return globalThis.ImageData ? new ImageData(data, w) : {width: w, height: h, data};
});
