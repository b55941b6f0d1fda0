/** Decoder of bare files of 20 to 400 bytes in plain JavaScript, for pages without WebAssembly. It draws what the encoders of gscl write by
 * default: up to 255 splats of the blend normalized, without opacities, codebooks and layers, of sources of 8 bits. */

import type {Bytes} from './gscl.js';

/** An Error with the name GsclError. */
export interface TinyError extends Error {
  readonly name: 'GsclError';
  /** `unsupported`: a file that is not bare, or of another kind, which 'gscl' draws; `limit`: more pixels than 2^16. */
  readonly code: 'truncated' | 'corrupt' | 'unsupported' | 'limit' | 'invalid-argument';
}

export interface TinySize {
  /** Size at which the picture is drawn, pixels, at most 2^16 in all; both or neither. Default: the encoded size, reduced to 64 pixels on its
   * longer side where it is larger. */
  width?: number;
  height?: number;
}

/** Draws a bare file: its bytes, or base64 or base64url of them. The result is that of `decode` of "gscl" at the same size, but for
 * rounding: 4 bytes a pixel, R, G, B and alpha, not premultiplied; in Node, which has no ImageData, in an object with the same fields.
 * Throws a TinyError. */
export function decode(source: Bytes | string, size?: TinySize): ImageData;
/** The encoded size, of which only the header is read. Throws a TinyError. */
export function info(source: Bytes | string): {width: number; height: number};
