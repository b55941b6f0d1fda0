/* A worker of encode.js in Node. */
import {parentPort} from 'node:worker_threads';

import {run} from './encode-run.js';

parentPort.on('message', job => run(job, (...message) => parentPort.postMessage(...message)));
