/* gscl/webpack-loader: the same as gscl/vite for webpack and what takes its loaders.  Its work is that of the first phase, pitch, so that no
 * loader of images is called after it. */
import {readFile} from 'node:fs/promises';
import {basename, join} from 'node:path';

import {checkedOptions, describeRequest, moduleText} from './site_image.js';

const describe = async ({resourcePath, resourceQuery, rootContext}, options) => {
  const bytes = await readFile(resourcePath), cache = join(rootContext, 'node_modules/.cache/gscl');
  const image = await describeRequest(resourcePath + resourceQuery, bytes, checkedOptions(options), cache);
  /* the address as the rules for images give it: a text, or an object of Next */
  const address = `import image from ${JSON.stringify(`./${basename(resourcePath)}`)};`;
  return moduleText(image, `${address}\nexport const url = image.src ?? image;`);
};

export const pitch = function () {
  const done = this.async();
  this.addDependency(this.resourcePath);
  describe(this, this.getOptions()).then(text => done(null, text), done);
};

export default text => text;
