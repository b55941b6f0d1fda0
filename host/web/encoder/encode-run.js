/* Runs an encode in an instance of the module, which goes when the encode ends; for workers.  The messages are those of encode.js. */

const PROGRESS_MS = 50; /* between two reports */
const ENOSYS = 52; /* of WASI: the module has no files */

/* Of encoder.c, in its order. */
const SETTINGS = ['width', 'height', 'channels', 'sample', 'premultiplied', 'target', 'targetValue', 'effort', 'tune', 'seed', 'bare', 'progressive',
  'packetSize', 'packetCount', 'packetIdentity', 'packetLoss', 'threads'];
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

/* Imports of which only some functions are called. */
const importsOf = functions => new Proxy(functions, {get: (it, name) => it[name] || (() => ENOSYS)});

const instanceOf = (module, memory, gscl) => {
  const clock_time_get = (id, precision, at) => {
    new DataView(memory.buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
    return 0;
  };
  const imports = {env: {memory}, gscl: importsOf(gscl), wasi_snapshot_preview1: importsOf({clock_time_get})};
  return new WebAssembly.Instance(module, imports).exports;
};

/* ---- Memory ---- */

const PAGES = {initial: 64, maximum: 65536}; /* of 64 KiB, as build_encoder.py links the module */
const MAX_SHARED = 1 << 26; /* bytes */

/* Bytes of shared memory that this worker has had.  Collectors do not count them, but they go with the worker. */
let shared = 0;

/* ---- Threads ---- */

/* Starts a thread for the C code: a worker of encode.js that gets a port with this job.  The page hands the port on unread, and so
 * never has the memory, which would stay until its collector runs. */
const starter = (module, memory, send) => stack => {
  const {port1, port2} = new MessageChannel;
  port1.postMessage({module, memory, stack});
  send({port: port2}, [port2]);
};

/* Works for another worker's encode until that ends. */
const help = ({module, memory, stack}, send) => {
  const wasm = instanceOf(module, memory, {});
  wasm.__stack_pointer.value = stack;
  send({isUp: true});
  wasm.help();
  shared += memory.buffer.byteLength;
  return {};
};

/* ---- An encode ---- */

const textAt = (memory, at) => {
  const bytes = new Uint8Array(memory.buffer, at);
  return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
};

/* `processors`: those that the encodes which run, running[0], share. */
const encode = ({module, pixels, settings, processors, running}, send) => {
  const memory = new WebAssembly.Memory({...PAGES, shared: settings.threads > 1}), threads = () => processors / Atomics.load(running, 0);
  const wasm = instanceOf(module, memory, {progress: reporter(send), start: starter(module, memory, send), threads});
  const at = wasm.allocate(pixels.byteLength);
  if (!at)
    return {code: 2, message: `out of memory: the pixels take ${pixels.byteLength} bytes`};
  new Uint8Array(memory.buffer, at).set(pixels);
  new Float64Array(memory.buffer, wasm.settings(), SETTINGS.length).set(SETTINGS.map(name => +settings[name]));
  const code = wasm.encode(at), values = new Float64Array(memory.buffer, wasm.values(), VALUES.length);
  wasm.close();
  if (settings.threads > 1)
    shared += memory.buffer.byteLength;
  const result = Object.fromEntries(VALUES.map((name, i) => [name, values[i]]));
  return code ? {code, message: textAt(memory, result.message)} : {...result, bytes: new Uint8Array(memory.buffer, result.at, result.size).slice()};
};

/* The result of a function for a message.  One that has failed is the last of its worker, as one after much shared memory. */
const resultOf = work => {
  try {
    return {...work(), isLast: shared > MAX_SHARED};
  } catch (error) {
    return {code: -1, message: error.message, isLast: true};
  }
};

/* Does a job: an encode, for which it sends {progress} some times, {port} for each thread that is to be started, and {result} once; or the
 * work of such a thread, with {isUp} before and {result} after it. */
export const run = (job, send) => {
  if (!job.port)
    return send({result: resultOf(() => encode(job, send))});
  job.port.onmessage = ({data}) => {
    job.port.close();
    send({result: resultOf(() => help(data, send))});
  };
};
