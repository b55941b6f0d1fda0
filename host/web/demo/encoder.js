/* The encoder, with its modules and the script of its workers inside the page. */
import {encode, useHost} from '../encode.js';
import opaque from '../gscl-encode.wasm.gz';
import withAlpha from '../gscl-encode-alpha.wasm.gz';
import worker from '../worker.txt';

const MODULES = {'gscl-encode.wasm': opaque, 'gscl-encode-alpha.wasm': withAlpha};

useHost({
  read: name => new Response(new Blob([MODULES[name]]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer(),
  open: () => new Worker(URL.createObjectURL(new Blob([worker], {type: 'text/javascript'}))),
});

export {encode};
