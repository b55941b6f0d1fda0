/* The package in Node, which reads the module from the disk: the one for packets, which reads all files. */
import {readFile} from 'node:fs/promises';
import {load} from './gscl.js';

load(readFile(new URL('gscl-packets.wasm', import.meta.url))).catch(() => {}); /* a call reports the failure */

export {load, GsclError, GsclImage} from './gscl.js';
export {decode, info, splats} from './packets.js';
