/** Encoder of gscl pictures for browsers and Node. */

export {GsclError} from './gscl.js';

/** A picture, as ImageData is: rows from the top, without gaps. `data` has 1 (grey), 2 (grey and alpha), 3 (RGB) or 4 (RGBA) samples a
 * pixel, in sRGB; those of a Float32Array are 0..1. */
export interface Picture {
  readonly data: Uint8Array | Uint8ClampedArray | Uint16Array | Float32Array;
  /** Pixels, 1..16384. */
  readonly width: number;
  readonly height: number;
}

export interface PacketOptions {
  /** Largest size of a packet, 40..1400 bytes. */
  size: number;
  /** Their number, 1..256; default: as many as the target needs. */
  count?: number;
  /** Share that is expected to be lost, 0..0.9, for which some become repair packets. Default 0. */
  loss?: number;
  /** Number of the picture, 1..255 but not 199. Default: one that follows from the picture. */
  identity?: number;
}

export interface Progress {
  /** Of the expected work, 0..1. */
  fraction: number;
  /** dB of the current fit, once it is known. */
  psnr?: number;
  /** Of the current fit. */
  splats: number;
  elapsedSeconds: number;
  /** An estimate; Infinity while nothing is done. */
  remainingSeconds: number;
}

export interface EncodeOptions {
  /** A target and an effort by what the file is for: tiny, a placeholder of at most 250 bytes (effort 3); preview, 0.06 bits
   * a pixel, or 256 bytes if that is more (effort 3); small, the defaults; good, a quality of 50. An effort beside it counts. */
  preset?: 'tiny' | 'preview' | 'small' | 'good';
  /* The target, at most one of these, and without `preset`. Default: 0.125 bits a pixel, or 256 bytes if that is more. */
  /** Largest size of the file. */
  bytes?: number;
  /** Largest size in bits per pixel. */
  bpp?: number;
  /** Least PSNR, dB. */
  psnr?: number;
  /** Least SSIMULACRA 2, -100..100. */
  ssimulacra2?: number;
  /** 0..100, as the quality of JPEG. */
  quality?: number;
  /** Number of Gaussians. */
  splats?: number;
  /** 0 (fastest) to 9 (best). Default 5, or that of the preset. */
  effort?: number;
  /** What errors weigh: by what people see, or squared error. Default auto: visual, and squared error for large pictures. */
  tune?: 'auto' | 'visual' | 'psnr';
  /** Writes the picture alone, for those who know that it is one and its size in bytes; readers must be told. Default false. */
  bare?: boolean;
  /** Writes layers: a part of the file draws a better picture, the whole one a worse. Default false. */
  progressive?: boolean;
  /** Writes packets for links that lose some of them, in place of a file. */
  packets?: PacketOptions;
  /** Whether colours are multiplied by alpha. Default false, as in ImageData. */
  premultiplied?: boolean;
  /** A whole number; default 1. Equal pictures, options and seeds give equal bytes. */
  seed?: number;
  /** Threads, 1 to 1024, where workers can share memory: in Node, and on pages that are `crossOriginIsolated`; else there is one. Encodes that
   * run at once divide the processors among them, and those with more threads than processors these. The bytes are the same. Default: the
   * number of processors, at most 4. */
  threads?: number;
  /** Stops the encode at once; the promise rejects with its reason. */
  signal?: AbortSignal;
  /** Called at most twenty times a second. What it throws stops the encode and is what the promise rejects with. */
  onProgress?: (progress: Progress) => void;
}

export interface Encoded {
  /** The file, or the list of packets. */
  bytes: Uint8Array<ArrayBuffer>;
  /** With the option packets: each of them. */
  packets?: Uint8Array<ArrayBuffer>[];
  width: number;
  height: number;
  /** Bits per pixel of `bytes`. */
  bpp: number;
  splats: number;
  /** dB of the decoded file against the picture. */
  psnr: number;
  /** Of the decoded file against the picture, where the target is ssimulacra2 or quality. */
  ssimulacra2?: number;
  /** Complete fits until the target was met. */
  trials: number;
}

/** Encodes a picture, whose pixels may be changed once the call has returned, in a worker: no page stands still, and there run as many at
 * once as there are processors. The bytes are those of the library on a processor without a fused multiply-add. Rejects with a GsclError, or
 * with what `signal` or `onProgress` say. */
export function encode(picture: Picture, options?: EncodeOptions): Promise<Encoded>;
