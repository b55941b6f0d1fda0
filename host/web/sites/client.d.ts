/* What `import hero from './hero.jpg?gscl'` gives, by gscl/vite, gscl/rollup or gscl/webpack-loader:
 *
 *     /// <reference types="gscl/client" />
 *
 * Further options come before the last: './hero.jpg?bytes=300&gscl'. */

declare module '*?gscl' {
  /** The image reduced, as a bare file in base64url: `data` of <gscl-image bare>. */
  export const data: string;
  /** Size of the image, upright, pixels. */
  export const width: number;
  export const height: number;
  /** width / height */
  export const aspectRatio: number;
  /** Address of the image, as the bundler writes it. */
  export const url: string;
  /** The mean colour of what is opaque, as #rrggbb. */
  export const colour: string;
  /** A PNG of 16 pixels width in a data: URL, for pages without a script. It is larger than the rest, and no part of the default export. */
  export const placeholder: string;
  const image: {data: string; width: number; height: number; aspectRatio: number; url: string; colour: string};
  export default image;
}

declare module '*&gscl' {
  export * from '*?gscl';
  export {default} from '*?gscl';
}
