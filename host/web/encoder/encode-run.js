/* Runs an encode in an instance of the module, which goes when the encode ends; for workers.  The messages are those of encode.js. */

const PROGRESS_MS = 50; /* between two reports */
const ENOSYS = 52; /* of WASI: the module has no files */

/* Of encoder.c, in its order. */
const SETTINGS = ['width', 'height', 'channels', 'sample', 'premultiplied', 'target', 'targetValue', 'effort', 'tune', 'seed', 'bare', 'progressive',
  'packetSize', 'packetCount', 'packetIdentity', 'packetLoss'];
const VALUES = ['at', 'size', 'splats', 'psnr', 'ssimulacra2', 'trials', 'message'];

const reporter = send => {
  let last = 0;
  return (fraction, psnr, splats, elapsed, remaining) => {
    const now = performance.now();
    if (now - last < PROGRESS_MS && fraction < 1)
      return;
    last = now;
    send({progress: {fraction, psnr: psnr || undefined, splats, elapsedSeconds: elapsed, remainingSeconds: remaining}});
  };
};

const instanceOf = (module, progress) => {
  const clock_time_get = (id, precision, at) => {
    new DataView(instance.exports.memory.buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
    return 0;
  };
  const wasi_snapshot_preview1 = new Proxy({clock_time_get}, {get: (it, name) => it[name] || (() => ENOSYS)});
  const instance = new WebAssembly.Instance(module, {gscl: {progress}, wasi_snapshot_preview1});
  return instance.exports;
};

const textAt = (memory, at) => {
  const bytes = new Uint8Array(memory.buffer, at);
  return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
};

const encode = ({module, pixels, settings}, send) => {
  const wasm = instanceOf(module, reporter(send)), at = wasm.allocate(pixels.byteLength);
  if (!at)
    return {code: 2, message: `out of memory: the pixels take ${pixels.byteLength} bytes`};
  new Uint8Array(wasm.memory.buffer, at).set(pixels);
  new Float64Array(wasm.memory.buffer, wasm.settings(), SETTINGS.length).set(SETTINGS.map(name => +settings[name]));
  const code = wasm.encode(at), values = new Float64Array(wasm.memory.buffer, wasm.values(), VALUES.length);
  const result = Object.fromEntries(VALUES.map((name, i) => [name, values[i]]));
  return code ? {code, message: textAt(wasm.memory, result.message)} : {...result, bytes: new Uint8Array(wasm.memory.buffer, result.at, result.size).slice()};
};

/* Sends {progress} some times and {result} once. */
export const run = (job, send) => {
  let result;
  try {
    result = encode(job, send);
  } catch (error) {
    result = {code: -1, message: error.message};
  }
  send({result});
};
