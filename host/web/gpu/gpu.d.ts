import type {Bytes, PartialOptions} from './gscl.js';

export interface ViewerOptions extends PartialOptions {
  /** Largest number of pixels of the canvas. Default 2^26. */
  maxPixels?: number;
  /** Largest number of evaluations of a splat at a pixel in one draw, estimated. Default 2^31 by the GPU, 2^33 without it. */
  maxWork?: number;
}

export interface View {
  /** Pixels of the canvas for each pixel of the encoded size; above 0, without a limit. */
  scale: number;
  /** The place in the picture, pixels of the encoded size, that is at the top left corner of the canvas; default 0. */
  x?: number;
  y?: number;
}

export interface Viewer {
  /** Encoded size, pixels. */
  readonly width: number;
  readonly height: number;
  /** Whether the GPU draws. */
  readonly isGpu: boolean;
  /** Draws a part of the picture to the whole canvas; default: all of the picture, as large as the canvas allows. What is
   * outside the picture is transparent. By the GPU the canvas is drawn when the call returns, and its pixels are to be read in the
   * same task; without it when the promise resolves, and of views that are asked for meanwhile only the last one is drawn.
   * Rejects with a GsclError. */
  draw(view?: View): Promise<void>;
  /** Ends drawing and releases the memory of the GPU. The canvas keeps its pixels, and may be given to another viewer. */
  free(): void;
}

/** Reads a file and draws views of it to a canvas that has no context yet, or one of an earlier viewer. Where the context was
 * lost, the last view is drawn again once it is back. Rejects with a GsclError. Importing "gscl/gpu" makes each <gscl-image> draw by
 * the GPU, too. */
export function view(canvas: HTMLCanvasElement, source: Bytes, options?: ViewerOptions): Promise<Viewer>;
