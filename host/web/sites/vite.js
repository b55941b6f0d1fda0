/* gscl/vite, gscl/rollup: the plug-in that makes `import hero from './hero.jpg?gscl'` what a page shows until the image has loaded. */
import {readFile} from 'node:fs/promises';
import {basename, join} from 'node:path';

import {checkedOptions, describeRequest, isOurs, moduleText} from './site_image.js';

const gscl = (given = {}) => {
  const defaults = checkedOptions(given);
  let cache = 'node_modules/.cache/gscl', isVite = false;
  return {
    name: 'gscl',
    enforce: 'pre', /* before Vite takes the import for one of the address alone */
    configResolved(config) {
      cache = join(config.cacheDir, 'gscl');
      isVite = true;
    },
    /* The bundler finds the file, without the query. */
    async resolveId(request, importer, options) {
      const [path, query] = request.split('?'), found = isOurs(request) && await this.resolve(path, importer, {...options, skipSelf: true});
      return found ? `${found.id}?${query}` : null;
    },
    async load(id) {
      if (!isOurs(id))
        return null;
      const [path] = id.split('?'), bytes = await readFile(path);
      this.addWatchFile(path);
      const image = await describeRequest(id, bytes, defaults, cache);
      const url = isVite ? `import url from ${JSON.stringify(`${path}?url`)};\nexport {url};` :
        `export const url = import.meta.ROLLUP_FILE_URL_${this.emitFile({type: 'asset', name: basename(path), originalFileName: path, source: bytes})};`;
      return {code: moduleText(image, url), map: null, moduleSideEffects: false, moduleType: 'js'};
    },
  };
};

export default gscl;
