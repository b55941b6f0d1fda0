/* The package in Node, which reads the module from the disk. */
import {readFile} from 'node:fs/promises';
import {load} from './gscl.js';

load(readFile(new URL('gscl.wasm', import.meta.url))).catch(() => {}); /* a call reports the failure */

export {decode, info, load, GsclError, GsclImage} from './gscl.js';
export {splats} from './splats.js';
