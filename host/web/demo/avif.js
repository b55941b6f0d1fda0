/* A worker that encodes AVIF: takes {image, quality}, an ImageData and a number from 0 to 100, and gives the bytes; undefined where it fails. */
import encode from '@jsquash/avif/encode.js';

const SPEED = 8; /* of 10 */

onmessage = async ({data: {image, quality}}) => postMessage(await encode(image, {quality, speed: SPEED}).catch(() => undefined));
