/* encode in Node, which reads modules from the disk and has workers of its own. */
import {readFile} from 'node:fs/promises';
import {availableParallelism, cpus} from 'node:os';
import {Worker} from 'node:worker_threads';

import {useHost} from './encode.js';

useHost({
  read: name => readFile(new URL(name, import.meta.url)),
  start: ({onMessage, onError}) => {
    const worker = new Worker(new URL('./encode-worker-node.js', import.meta.url), {execArgv: []}); /* not those of the process, as --input-type */
    worker.on('message', onMessage).on('error', onError).on('messageerror', onError);
    return worker;
  },
  workers: availableParallelism ? availableParallelism() : cpus().length,
});

export {encode, GsclError} from './encode.js';
