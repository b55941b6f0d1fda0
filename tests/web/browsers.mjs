/* What the drivers of browsers share, and a server of files for them.  BROWSER names the browser of the tests: chromium or firefox. */
import {spawnSync} from 'node:child_process';
import {createReadStream, existsSync} from 'node:fs';
import {createServer} from 'node:http';
import {extname, join, normalize} from 'node:path';

const TYPES = {'.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.json': 'application/json', '.svg': 'image/svg+xml'};
export const TIMEOUT = 600000; /* ms for one command: it ends what hangs, however loaded the machine */

export const pause = ms => new Promise(resolve => setTimeout(resolve, ms));

/* Serves the files of folders {prefix: folder}, with `headers`; `handlers` {path: (request, response) => ...} come first. */
export const serve = async (folders, handlers = {}, headers = {}) => {
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://host').pathname));
    const prefix = Object.keys(folders).find(it => path.startsWith(it)), file = prefix && join(folders[prefix], path.slice(prefix.length));
    if (handlers[path])
      return handlers[path](request, response);
    if (!file || !existsSync(file))
      return response.writeHead(404).end();
    response.writeHead(200, {'content-type': TYPES[extname(file)] || 'application/octet-stream', ...headers});
    createReadStream(file).pipe(response);
  });
  await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
  return {url: `http://127.0.0.1:${server.address().port}`, close: () => server.close()};
};

/* A browser with one page.  Drivers add start, evaluate, open, choose, mouse, resize, screenshot and close, and write(text), which sends a
 * command. */
export class Browser {
  #replies = new Map;
  #number = 0;
  errors = []; /* exceptions and errors that the page logs; in Chromium also requests that fail or that a policy refuses */

  send(method, params = {}, more = {}) {
    const id = ++this.#number;
    this.write(JSON.stringify({id, method, params, ...more}));
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(Error(`${method}: no reply`)), TIMEOUT);
      this.#replies.set(id, {method, reject: it => (clearTimeout(timer), reject(it)), resolve: it => (clearTimeout(timer), resolve(it))});
    });
  }
  /* Ends a command, by its result or by what went wrong. */
  reply(id, result, failure) {
    const {resolve, reject, method} = this.#replies.get(id);
    this.#replies.delete(id);
    failure ? reject(Error(`${method}: ${failure}`)) : resolve(result);
  }
  /* Ends all commands, where the browser has ended. */
  fail(error) {
    for (const {reject} of this.#replies.values())
      reject(error);
    this.#replies.clear();
  }

  /* Waits until an expression is true. */
  async until(expression) {
    for (const end = Date.now() + TIMEOUT; ; await pause(20)) {
      if (await this.evaluate(expression).catch(() => false))
        return;
      if (Date.now() > end)
        throw Error(`in ${TIMEOUT} ms this did not become true: ${expression}`);
    }
  }
  /* Samples of a canvas, 4 bytes a pixel: {width, height, data}.  `find` is an expression. */
  async pixels(find) {
    const [width, height, text] = await this.evaluate(`(() => {
      const canvas = ${find}, {width, height} = canvas, data = canvas.getContext('2d').getImageData(0, 0, width, height).data;
      let text = '';
      for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
      return [width, height, btoa(text)];
    })()`);
    return {width, height, data: Buffer.from(text, 'base64')};
  }
}

/* Starts a browser, by default that of the tests. */
export const startBrowser = async (name = process.env.BROWSER || 'chromium') => {
  const {Chromium, Firefox} = await import(`./${name}.mjs`);
  return (Chromium || Firefox).start();
};

/* Names of those browsers that are installed. */
export const installedBrowsers = () => Object.entries({chromium: process.env.CHROMIUM || 'chromium', firefox: process.env.FIREFOX || 'firefox-esr'})
  .filter(([, program]) => spawnSync(program, ['--version']).status == 0).map(([name]) => name);
