/* A worker of encode.js in browsers. */
import {run} from './encode-run.js';

onmessage = ({data}) => run(data, postMessage);
