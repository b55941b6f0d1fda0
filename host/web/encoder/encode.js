/* encode; gscl.d.ts describes it.
 *
 * Each encode runs in a worker, which ends where the encode is aborted or stops at a fault, and else waits for the next one. */
import {GsclError} from './gscl.js';

const OPAQUE = 'gscl-encode.wasm', WITH_ALPHA = 'gscl-encode-alpha.wasm';

/* What differs in Node (encode-node.js). */
let host = {
  read: async name => {
    const answer = await fetch(name == OPAQUE ? new URL('./gscl-encode.wasm', import.meta.url) : new URL('./gscl-encode-alpha.wasm', import.meta.url));
    refuse(!answer.ok, `${answer.url}: status ${answer.status}`, 'failed');
    return answer.arrayBuffer();
  },
  start: ({onMessage, onError}) => {
    const worker = new Worker(new URL('./encode-worker.js', import.meta.url), {type: 'module'});
    worker.onmessage = ({data}) => onMessage(data);
    worker.onerror = worker.onmessageerror = event => onError(Error(event.message || 'the worker cannot be started'));
    return worker;
  },
  workers: globalThis.navigator?.hardwareConcurrency || 1,
};
export const useHost = it => host = it;

const refuse = (isRefused, message, code = 'invalid-argument') => {
  if (isRefused)
    throw Object.assign(new GsclError(message), {code});
};

const failed = error => error instanceof GsclError ? error : Object.assign(new GsclError(`the encoder failed: ${error.message}`), {code: 'failed'});

/* ---- Modules ---- */

const modules = {}; /* promises, by name */
const moduleOf = name => modules[name] ||= Promise.resolve(host.read(name)).then(WebAssembly.compile).catch(error => {
  delete modules[name]; /* the next call tries again */
  throw error;
});

/* ---- Arguments ---- */

/* By array: gscl_sample and the value of an opaque pixel's alpha. */
const SAMPLES = [[Uint8Array, 1, 255], [Uint8ClampedArray, 1, 255], [Uint16Array, 2, 65535], [Float32Array, 3, 1]];
/* gscl_target */
const TARGETS = {bpp: 1, bytes: 2, psnr: 3, splats: 4, ssimulacra2: 5, quality: 6};
const TUNES = {auto: 0, psnr: 1, visual: 3}; /* gscl_tune */
const OPTIONS = [...Object.keys(TARGETS), 'effort', 'tune', 'seed', 'bare', 'progressive', 'packets', 'premultiplied', 'signal', 'onProgress'];
const PACKETS = ['size', 'count', 'loss', 'identity'];

const isWhole = number => Number.isSafeInteger(number) && number >= 0;

const checkNames = (it, names, what) => {
  for (const name of Object.keys(it))
    refuse(!names.includes(name), `unknown ${what} "${name}"; there are ${names.join(', ')}`);
};

/* The settings that are whole numbers, or the default of the library. */
const whole = (value, fallback, name) => {
  refuse(value !== undefined && !isWhole(value), `${name} must be a whole number from 0 on, it is ${value}`);
  return value ?? fallback;
};

const imageOf = image => {
  const {data, width, height} = image || {}, sample = SAMPLES.find(([type]) => data instanceof type);
  refuse(!sample, 'data must be a Uint8Array, Uint8ClampedArray, Uint16Array or Float32Array');
  refuse(!isWhole(width) || !isWhole(height) || !width || !height, `width and height must be whole numbers from 1 on, they are ${width} and ${height}`);
  const channels = data.length / (width * height);
  refuse(![1, 2, 3, 4].includes(channels), `data has ${data.length} samples; ${width}x${height} pixels have 1 to 4 for each`);
  return {data, width, height, channels, sample: sample[1], opaque: sample[2]};
};

const hasAlpha = ({data, channels, opaque}) => {
  if (channels % 2 == 0)
    for (let i = channels - 1; i < data.length; i += channels)
      if (data[i] < opaque)
        return true;
  return false;
};

const settingsOf = (image, options) => {
  checkNames(options, OPTIONS, 'option');
  const {effort, tune = 'auto', seed, bare, progressive, packets, premultiplied} = options;
  const targets = Object.keys(TARGETS).filter(name => options[name] !== undefined), [target] = targets;
  refuse(targets.length > 1, `${targets.join(' and ')} exclude each other`, 'conflict');
  refuse(target && !Number.isFinite(options[target]), `${target} must be a number, it is ${options[target]}`);
  refuse(!(tune in TUNES), `unknown tune "${tune}"; there are ${Object.keys(TUNES).join(', ')}`);
  refuse(packets !== undefined && !isWhole(packets?.size), 'packets must be an object with a size in bytes');
  checkNames(packets || {}, PACKETS, 'option of packets');
  return {
    width: image.width, height: image.height, channels: image.channels, sample: image.sample, premultiplied: !!premultiplied,
    target: TARGETS[target] || 0, targetValue: options[target] || 0, effort: whole(effort, 5, 'effort'), tune: TUNES[tune], seed: whole(seed, 1, 'seed'),
    bare: !!bare, progressive: !!progressive, packetSize: packets?.size || 0, packetCount: whole(packets?.count, 0, 'the count of packets'),
    packetIdentity: whole(packets?.identity, 0, 'the identity of packets'), packetLoss: packets?.loss || 0,
  };
};

/* ---- Workers ---- */

const idle = [];
const waiting = []; /* calls when one is free */
let busy = 0;

/* Waits until one worker more may run, or the call is aborted. */
const turn = signal => new Promise(resolve => {
  const leave = () => {
    waiting.splice(waiting.indexOf(go) >>> 0, 1);
    resolve();
  };
  const go = () => {
    signal?.removeEventListener('abort', leave);
    resolve();
  };
  waiting.push(go);
  signal?.addEventListener('abort', leave, {once: true});
});

const acquire = async signal => {
  while (busy >= host.workers && !signal?.aborted)
    await turn(signal);
  signal?.throwIfAborted();
  busy++;
};

const release = worker => {
  busy--;
  if (worker) {
    worker.unref?.(); /* in Node: the process may end */
    idle.push(worker);
  }
  waiting.shift()?.();
};

/* Starts a worker, or takes one that waits.  Its listeners are those of the latest job. */
const workerFor = job => {
  const worker = idle.pop() || host.start({onMessage: message => worker.job.onMessage(message), onError: error => worker.job.onError(error)});
  worker.job = job;
  worker.ref?.();
  return worker;
};

/* Runs a job; its worker is kept unless it failed or was aborted. */
const work = (job, transfer, {signal, onProgress}) => new Promise((resolve, reject) => {
  let worker, hasEnded;
  const end = kept => {
    if (hasEnded) /* a message was under way when the worker was stopped */
      return;
    hasEnded = true;
    signal?.removeEventListener('abort', abort);
    if (!kept)
      worker?.terminate();
    release(kept ? worker : undefined);
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
  signal?.addEventListener('abort', abort);
  try {
    worker = workerFor({
      onMessage: ({progress, result}) => {
        if (progress)
          return hasEnded || report(progress);
        end(result.code !== -1);
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
    let size = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = list[at++];
      size |= (byte & 127) << shift;
      if (byte < 128)
        break;
    }
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

export const encode = async (source, options = {}) => {
  const image = imageOf(source), settings = settingsOf(image, options), {signal} = options;
  /* The caller may change the pixels while the worker is not yet there. */
  const pixels = new Uint8Array(image.data.buffer, image.data.byteOffset, image.data.byteLength).slice();
  let module;
  await acquire(signal);
  try {
    module = await moduleOf(hasAlpha(image) ? WITH_ALPHA : OPAQUE);
    signal?.throwIfAborted();
  } catch (error) {
    release();
    throw signal?.aborted ? signal.reason : failed(error);
  }
  const result = await work({module, pixels, settings}, [pixels.buffer], options);
  return reportOf(result, image, options);
};
