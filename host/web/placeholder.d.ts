import type {PartialOptions, Source} from './gscl.js';

export interface PlaceholderOptions extends PartialOptions {
  /** Pixels of the small picture, less where it would be more than four times as high; default 16. */
  width?: number;
}

export interface Placeholder {
  /** The picture, a few pixels wide, as a PNG in a data: URL, for pages without a script. */
  url: string;
  /** Encoded size, pixels. */
  width: number;
  height: number;
  /** width / height */
  aspectRatio: number;
  /** The mean colour of what is opaque, as #rrggbb. */
  colour: string;
  hasAlpha: boolean;
}

/** Draws a file, mostly a bare one of 100 to 300 bytes, as a blur that needs no script where it is shown. Rejects with a GsclError. */
export function placeholder(source: Source, options?: PlaceholderOptions): Promise<Placeholder>;
