/** Plug-in of Vite and Rollup: `import hero from './hero.jpg?gscl'`; gscl/client describes what that gives. */

export interface SiteOptions {
  /** Largest size of a file, bytes; default 200. */
  bytes?: number;
  /** 0 (fastest) to 9 (best). Default 2. */
  effort?: number;
  /** Pixels to which the width of an image is reduced before it is encoded; default 128. */
  width?: number;
}

/** `options` are the defaults of those in queries, as './hero.jpg?bytes=300&gscl'. */
export default function gscl(options?: SiteOptions): {name: string};
