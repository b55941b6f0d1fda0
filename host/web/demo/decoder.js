/* The decoder and drawing by the GPU, whose module lies in the page. */
import module from '../gscl.wasm';
import {load} from '../gscl.js';

load(module);

export {decode, info} from '../gscl.js';
export {splats} from '../splats.js';
export {view} from '../gpu.js';
