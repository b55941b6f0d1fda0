/** Decoder of gscl pictures. In Node all of it is exported by "gscl"; in browsers `splats` is in "gscl/splats", and `decode`,
 * `info` and `splats` of packets are in "gscl/packets". "gscl/inline" has all but packets, and the module in itself. */

export interface ReadOptions {
  /** Whether the file is of the bare form, which its bytes do not tell. Default false. */
  bare?: boolean;
}

export interface PartialOptions extends ReadOptions {
  /** Whether the file may be cut off: only the splats that it holds for certain are drawn or listed, and damage is not
   * detected. Default false: a file that is cut off is refused. */
  partial?: boolean;
}

export interface Rectangle {
  /** Top left corner, pixels of the drawn image; default 0. */
  x?: number;
  y?: number;
  /** Size in pixels; default 0: up to the right and bottom edges. */
  width?: number;
  height?: number;
}

export interface DecodeOptions extends PartialOptions {
  /** Size at which the whole picture is drawn, pixels, at most 2^24 where `crop` is at most 16384 a side; both or neither.
   * Default 0: the encoded size. */
  width?: number;
  height?: number;
  /** The part of the drawn picture that is returned. Default: all of it. */
  crop?: Rectangle;
  /** Largest number of pixels to return. Default 2^26. */
  maxPixels?: number;
  /** Largest number of evaluations of a splat at a pixel. Default 2^33, some 30 seconds. */
  maxWork?: number;
}

export interface Info {
  /** Encoded size, pixels. */
  width: number;
  height: number;
  /** Of the source: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA. */
  channels: number;
  bitDepth: 8 | 16;
  splats: number;
  /** Of a progressive file; else 1. */
  layers: number;
}

/** A Gaussian as it is drawn. Lengths are pixels of the encoded size. */
export interface Splat {
  x: number;
  y: number;
  /** Standard deviations along the axes. */
  sigma1: number;
  sigma2: number;
  /** Direction of the axis of sigma1, radians from +x towards +y. */
  theta: number;
  /** 0..1 */
  opacity: number;
  /** R, G, B and alpha; about 0..1, premultiplied. */
  colour: [number, number, number, number];
  /** Of a splat that has one: to R, G and B at the place (dx, dy) from the centre it adds
   * amplitude * cos(2 pi (x dx + y dy - phase)); x and y are cycles per pixel, phase is cycles. */
  wave?: {x: number; y: number; phase: number; amplitude: number};
}

export type GsclErrorCode =
  | 'not-a-gscl-file' | 'newer-version' | 'truncated' | 'damaged' | 'corrupt' | 'unknown-block'
  | 'invalid-argument' | 'image-size' | 'limit' | 'out-of-memory'
  /** ("gscl/encode") Samples are NaN or infinite; no file is as small, or as good; options exclude each other. */
  | 'not-finite' | 'budget-too-small' | 'target-unreachable' | 'conflict'
  /** The module was not found, the engine lacks SIMD, or the decoder or the encoder stopped at a fault of its own. */
  | 'failed'
  /** (gscl-image) the answer of the server was no file. */
  | 'not-found';

export class GsclError extends Error {
  readonly code: GsclErrorCode;
}

export type Bytes = ArrayBuffer | ArrayBufferView;
/** A file; with "gscl/packets" and in Node also packets: a list of them, as `gscl encode --packets` writes it, or an array, in
 * any order. Those that have come are drawn, and those that repair packets replace, without those that are damaged, repeated or
 * of another picture than the first good one. The error is "truncated" where none has come, "damaged" where none is good. */
export type Source = Bytes | readonly Bytes[];

/** Decodes a file or packets. The result has 4 bytes a pixel, R, G, B and alpha, not premultiplied. In Node, which has no
 * ImageData, it is an object with the same fields. Rejects with a GsclError. */
export function decode(source: Source, options?: DecodeOptions): Promise<ImageData>;
/** Reads the header of a file. Succeeds where only the check at the end does not match. Of packets `splats` is an upper bound.
 * Rejects with a GsclError. */
export function info(source: Source, options?: ReadOptions): Promise<Info>;
/** Lists the splats in drawing order. Rejects with a GsclError. */
export function splats(source: Source, options?: PartialOptions): Promise<Splat[]>;
/** Takes the module from elsewhere than beside the script: the bytes of gscl.wasm, or of gscl-packets.wasm, which also reads
 * packets; or the compiled module; or a promise of them. */
export function load(source: BufferSource | WebAssembly.Module | PromiseLike<BufferSource | WebAssembly.Module>): Promise<WebAssembly.Module>;

/** `<gscl-image src="picture.gscl" alt="..." width="300" height="200">`
 *
 * Attributes: `src`, a URL, also a data: URL; `data`, a file as text, in place of src: base64 or base64url, with or without
 * padding and white space; `bare`, whether the file is bare; `alt`, the name of the picture for assistive programs, and text
 * in its place where it fails; `width` and `height` in CSS pixels, default the encoded size, at most the width of what is
 * around it; style sheets of the page count more. The picture is drawn while its bytes arrive, and again whenever its size
 * on the screen changes; with fewer pixels where `maxPixels` and `maxWork` of decode do not allow those of the screen. It
 * stays until the next file is drawn, or fails. Events: `load`, once the whole file is drawn; `error`, an ErrorEvent with a
 * GsclError or a TypeError of fetch. */
export class GsclImage extends HTMLElement {
  src: string | null;
  data: string | null;
  alt: string | null;
  bare: boolean;
  get width(): string | null;
  set width(value: string | number | null);
  get height(): string | null;
  set height(value: string | number | null);
}

/** What <gscl-image> has in JSX beside what all elements have. */
export interface GsclImageAttributes {
  src?: string | undefined;
  data?: string | undefined;
  alt?: string | undefined;
  bare?: boolean | undefined;
  width?: string | number | undefined;
  height?: string | number | undefined;
  class?: string | undefined;
}

declare global {
  interface HTMLElementTagNameMap {
    'gscl-image': GsclImage;
  }
}

/* JSX of React, Preact and Solid.  Where one of them is not installed, its part is to mean nothing, and to be no error.  React
 * does not call onLoad and onError of elements that it does not know. */
// @ts-ignore
declare module 'react' {
  namespace JSX {
    interface IntrinsicElements {
      // @ts-ignore
      'gscl-image': Omit<import('react').DetailedHTMLProps<import('react').HTMLAttributes<GsclImage>, GsclImage>, 'onLoad' | 'onError'> & GsclImageAttributes;
    }
  }
}
// @ts-ignore
declare module 'preact' {
  namespace JSX {
    interface IntrinsicElements {
      // @ts-ignore
      'gscl-image': import('preact').HTMLAttributes<GsclImage> & GsclImageAttributes;
    }
  }
}
// @ts-ignore
declare module 'solid-js' {
  namespace JSX {
    interface IntrinsicElements {
      // @ts-ignore
      'gscl-image': import('solid-js').JSX.HTMLAttributes<GsclImage> & GsclImageAttributes;
    }
  }
}
