/* placeholder in Node, where node.js finds the module. */
import {deflateSync} from 'node:zlib';

import './node.js';
import {useDeflate} from './placeholder.js';

useDeflate(bytes => deflateSync(bytes, {level: 9}));

export {placeholder} from './placeholder.js';
