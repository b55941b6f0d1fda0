/* encode; encode.d.ts describes it.
 *
 * Each encode runs in a worker, and in others that help it where memory can be shared.  They end where the encode is aborted or stops at a
 * fault, and else wait for the next one. */
import {GsclError} from './gscl.js';

const OPAQUE = 'gscl-encode.wasm', WITH_ALPHA = 'gscl-encode-alpha.wasm';

/* What differs in Node (encode-node.js) and in the demonstration page, which has all of this in itself (demo/encoder.js). */
let host = {
  read: async name => {
    const answer = await fetch(name == OPAQUE ? new URL('./gscl-encode.wasm', import.meta.url) : new URL('./gscl-encode-alpha.wasm', import.meta.url));
    refuse(!answer.ok, `${answer.url}: status ${answer.status}`, 'failed');
    return answer.arrayBuffer();
  },
  open: () => new Worker(new URL('./encode-worker.js', import.meta.url), {type: 'module'}),
  start: ({onMessage, onError}) => {
    const worker = host.open();
    worker.onmessage = ({data}) => onMessage(data);
    worker.onerror = worker.onmessageerror = event => onError(Error(event.message || 'the worker cannot be started'));
    return worker;
  },
  workers: globalThis.navigator?.hardwareConcurrency || 1,
};
export const useHost = it => host = {...host, ...it};

const refuse = (isRefused, message, code = 'invalid-argument') => {
  if (isRefused)
    throw Object.assign(new GsclError(message), {code});
};

const failed = error => error instanceof GsclError ? error : Object.assign(new GsclError(`the encoder failed: ${error.message}`), {code: 'failed'});

/* ---- Modules ---- */

/* On pages that are isolated from other origins workers can share memory, where there are addresses for as much as may be needed. */
const IS_ISOLATED = globalThis.crossOriginIsolated !== false;
let canShare; /* known from the first call on */
const tryToShare = () => {
  try {
    return IS_ISOLATED && !!new WebAssembly.Memory({initial: 1, maximum: 65536, shared: true});
  } catch {
    return false;
  }
};

/* A module declares shared memory.  The one for other memory differs in a bit, which follows the name in the import. */
const withUnshared = bytes => {
  bytes[String.fromCharCode(...bytes.subarray(0, 4096)).indexOf('memory\x02\x03') + 7] = 1;
  return bytes;
};

const modules = {}; /* promises, by name and kind of memory */
const moduleOf = (name, isShared) => modules[name + isShared] ||= Promise.resolve(host.read(name)).then(buffer => {
  const bytes = new Uint8Array(buffer);
  return WebAssembly.compile(isShared ? bytes : withUnshared(bytes));
}).catch(error => {
  delete modules[name + isShared]; /* the next call tries again */
  throw error;
});

/* ---- Arguments ---- */

/* By the name of the array's type, which is the same in all frames: gscl_sample, and the value of an opaque pixel's alpha. */
const SAMPLES = {Uint8Array: [1, 255], Uint8ClampedArray: [1, 255], Uint16Array: [2, 65535], Float32Array: [3, 1]};
/* gscl_target */
const TARGETS = {bpp: 1, bytes: 2, psnr: 3, splats: 4, ssimulacra2: 5, quality: 6, rate: 7};
const TUNES = {auto: 0, psnr: 1, visual: 3}; /* gscl_tune */
/* Those of gscl_encode_settings_preset, whose defaults are those of settingsOf. */
const PRESETS = {tiny: {bytes: 250, effort: 3}, preview: {rate: 0.06, effort: 3}, small: {}, good: {quality: 50}};
/* By option: what it must be, in words and as a function. */
const WHOLE = ['a whole number from 0 on', value => Number.isSafeInteger(value) && value >= 0];
const POSITIVE = ['a whole number from 1 on', value => Number.isSafeInteger(value) && value > 0];
const NUMBER = ['a number', Number.isFinite];
const FLAG = ['true or false', value => typeof value == 'boolean'];
const FUNCTION = ['a function', value => typeof value == 'function'];
const OBJECT = ['an object', value => typeof value == 'object' && value !== null && !Array.isArray(value)];
const oneOf = table => [Object.keys(table).join(', '), value => Object.keys(table).includes(value)];
const OPTIONS = {
  preset: oneOf(PRESETS), bytes: WHOLE, bpp: NUMBER, psnr: NUMBER, ssimulacra2: NUMBER, quality: NUMBER, splats: WHOLE, effort: WHOLE,
  tune: oneOf(TUNES),
  bare: FLAG, progressive: FLAG, packets: OBJECT, premultiplied: FLAG, seed: WHOLE, threads: POSITIVE,
  signal: ['an AbortSignal', value => typeof value?.aborted == 'boolean' && typeof value.addEventListener == 'function'], onProgress: FUNCTION,
};
const PACKETS = {size: POSITIVE, count: POSITIVE, loss: NUMBER, identity: POSITIVE};

const shown = value => typeof value == 'string' ? JSON.stringify(value) : typeof value == 'object' && value ? 'an object' : String(value);

/* A copy of the options that are given, each of which is what it must be. */
const checked = (options, kinds, what) => {
  refuse(!OBJECT[1](options), `${what} must be an object, it is ${shown(options)}`);
  const given = Object.entries(options).filter(([, value]) => value !== undefined);
  for (const [name, value] of given) {
    refuse(!Object.keys(kinds).includes(name), `unknown option "${name}"; there are ${Object.keys(kinds).join(', ')}`);
    refuse(!kinds[name][1](value), `${name} must be ${kinds[name][0]}, it is ${shown(value)}`);
  }
  return Object.fromEntries(given);
};

/* The picture as the worker takes it: a copy, since the caller may change the pixels while no worker is free. */
const imageOf = picture => {
  const {data, width, height} = picture || {}, sample = ArrayBuffer.isView(data) && SAMPLES[data[Symbol.toStringTag]];
  refuse(!sample, 'data must be a Uint8Array, Uint8ClampedArray, Uint16Array or Float32Array');
  refuse(![width, height].every(POSITIVE[1]), `width and height must be whole numbers from 1 on, they are ${shown(width)} and ${shown(height)}`);
  const channels = data.length / (width * height);
  refuse(![1, 2, 3, 4].includes(channels), `data has ${data.length} samples; ${width}x${height} pixels have 1 to 4 for each`);
  const pixels = new Uint8Array(data.byteLength);
  pixels.set(new Uint8Array(data.buffer, data.byteOffset, data.byteLength));
  return {pixels, width, height, channels, sample: sample[0], hasAlpha: hasAlpha(data, channels, sample[1])};
};

const hasAlpha = (data, channels, opaque) => {
  if (channels % 2 == 0)
    for (let i = channels - 1; i < data.length; i += channels)
      if (data[i] < opaque)
        return true;
  return false;
};

const MAX_THREADS = 4; /* by default */

/* The settings of encode-run.js. */
const settingsOf = ({width, height, channels, sample}, given) => {
  const options = {...PRESETS[given.preset], ...given};
  const {effort = 5, tune = 'auto', seed = 1, bare = false, progressive = false, premultiplied = false, packets} = options;
  const threads = (canShare ??= tryToShare()) ? options.threads || Math.min(host.workers, MAX_THREADS) : 1;
  const names = Object.keys(TARGETS), target = names.find(name => name in options), targets = ['preset', ...names].filter(name => name in given);
  refuse(targets.length > 1, `${targets.join(' and ')} exclude each other`, 'conflict');
  refuse(packets && !packets.size, 'packets must have a size in bytes');
  const {size: packetSize = 0, count: packetCount = 0, identity: packetIdentity = 0, loss: packetLoss = 0} = packets || {};
  return {
    width, height, channels, sample, premultiplied, target: TARGETS[target] || 0, targetValue: options[target] || 0, effort, tune: TUNES[tune], seed,
    bare, progressive, packetSize, packetCount, packetIdentity, packetLoss, threads,
  };
};

/* ---- Workers ---- */

const idle = []; /* workers */
const waiting = []; /* calls, each a function that lets it go on */
const running = new Int32Array(new (IS_ISOLATED ? SharedArrayBuffer : ArrayBuffer)(4)); /* the number of encodes, for their workers to read */

/* Lets those go on for which there is a worker. */
const admit = () => {
  while (running[0] < host.workers && waiting.length) {
    running[0]++;
    waiting.shift()();
  }
};

/* Waits for a worker's place.  A call that is aborted waits no longer and has none. */
const acquire = signal => new Promise((resolve, reject) => {
  const leave = () => {
    waiting.splice(waiting.indexOf(go), 1);
    reject(signal.reason);
  };
  const go = () => {
    signal?.removeEventListener('abort', leave);
    resolve();
  };
  waiting.push(go);
  signal?.addEventListener('abort', leave);
  admit();
});

const release = () => {
  running[0]--;
  admit();
};

/* Keeps a worker for later jobs, but no more than there may be encodes. */
const keep = worker => {
  worker.unref?.(); /* in Node: the process may end */
  idle.length < host.workers ? idle.push(worker) : worker.terminate();
};

/* Starts a worker, or takes one that waits.  Its listeners are those of the latest job. */
const workerFor = job => {
  const worker = idle.pop() || host.start({
    onMessage: message => worker.job.onMessage(message),
    onError: error => {
      idle.splice(idle.indexOf(worker) >>> 0, 1); /* where it was idle: it can work no more */
      worker.job.onError(error);
    },
  });
  worker.job = job;
  worker.ref?.();
  return worker;
};

/* Runs a job.  Its worker and those that help it are kept unless it failed or was aborted. */
const work = (job, transfer, {signal, onProgress}) => new Promise((resolve, reject) => {
  const helpers = new Set;
  let worker, hasEnded;
  const end = isKept => {
    if (hasEnded) /* a message was under way when the worker was stopped */
      return;
    hasEnded = true;
    signal?.removeEventListener('abort', abort);
    if (isKept) {
      keep(worker);
    } else {
      worker?.terminate();
      helpers.forEach(it => it.terminate());
      helpers.clear();
    }
    release();
  };
  const stop = error => (end(false), reject(error));
  const fail = error => stop(failed(error));
  const abort = () => stop(signal.reason);
  const report = progress => {
    try {
      onProgress?.(progress);
    } catch (error) { /* of the caller */
      stop(error);
    }
  };
  /* Starts a worker for a thread. */
  const start = port => {
    let isUp; /* from then on it may have a part of the work */
    const helper = workerFor({
      onMessage: ({result}) => {
        isUp ||= !result;
        if (!result || !helpers.delete(helper))
          return;
        result.isLast ? helper.terminate() : keep(helper);
        if (result.code && isUp)
          fail(Error(result.message));
      },
      onError: error => {
        helper.terminate();
        if (helpers.delete(helper) && isUp)
          fail(error);
      },
    });
    helpers.add(helper);
    helper.postMessage({port}, [port]);
  };
  const tryToStart = port => {
    try {
      start(port);
    } catch { /* the encode goes on without it */
    }
  };
  signal?.addEventListener('abort', abort);
  try {
    worker = workerFor({
      onMessage: ({progress, port, result}) => {
        if (hasEnded)
          return;
        if (progress)
          return report(progress);
        if (port)
          return tryToStart(port);
        end(!result.isLast);
        resolve(result);
      },
      onError: fail,
    });
    worker.postMessage(job, transfer);
  } catch (error) {
    fail(error);
  }
});

/* ---- Results ---- */

/* By gscl_result. */
const CODES = {1: 'invalid-argument', 2: 'out-of-memory', 13: 'out-of-memory', 30: 'image-size', 31: 'not-finite', 40: 'budget-too-small', 41: 'target-unreachable', 42: 'conflict'};

/* The packets of a list (FORMAT.md, "Packets"). */
const packetsOf = list => {
  const packets = [];
  for (let at = 4; at < list.length;) {
    let size = 0, shift = 0, byte;
    do {
      byte = list[at++];
      size |= (byte & 127) << shift;
      shift += 7;
    } while (byte > 127);
    packets.push(list.slice(at, at += size));
  }
  return packets;
};

const reportOf = ({code, message, bytes, splats, psnr, ssimulacra2, trials}, {width, height}, options) => {
  refuse(code, code == -1 ? `the encoder failed: ${message}` : message, CODES[code] || 'failed');
  return {
    bytes, width, height, splats, psnr, trials, bpp: 8 * bytes.length / (width * height),
    ...Number.isNaN(ssimulacra2) ? {} : {ssimulacra2}, ...options.packets ? {packets: packetsOf(bytes)} : {},
  };
};

/* Ends with the promise, or at once where the call is aborted. */
const orAborted = (promise, signal) => !signal ? promise : new Promise((resolve, reject) => {
  const abort = () => reject(signal.reason);
  signal.addEventListener('abort', abort);
  promise.then(resolve, reject).finally(() => signal.removeEventListener('abort', abort));
});

export const encode = async (picture, given = {}) => {
  const options = checked(given, OPTIONS, 'options'), {signal} = options;
  options.packets &&= checked(options.packets, PACKETS, 'packets');
  const image = imageOf(picture), settings = settingsOf(image, options);
  const throwIfAborted = () => {
    if (signal?.aborted)
      throw signal.reason;
  };
  throwIfAborted();
  await acquire(signal);
  let module;
  try {
    module = await orAborted(moduleOf(image.hasAlpha ? WITH_ALPHA : OPAQUE, settings.threads > 1), signal);
    throwIfAborted();
  } catch (error) {
    release();
    throw signal?.aborted ? signal.reason : failed(error);
  }
  return reportOf(await work({module, pixels: image.pixels, settings, running, processors: Math.max(host.workers, settings.threads)}, [image.pixels.buffer], options), image, options);
};

export {GsclError};
