/* placeholder in Node, where node.js finds the module. */
import './node.js';

export {placeholder} from './placeholder.js';
