/* The package in one script that fetches nothing but pictures, for bundlers. */
export {load, decode, info, GsclError, GsclImage} from './gscl.js';
export {splats} from './splats.js';
