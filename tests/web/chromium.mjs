/* Drives Chromium through its debugging pipe, without further packages, and serves files to it. */
import {spawn} from 'node:child_process';
import {createReadStream, existsSync, mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {createServer} from 'node:http';
import {tmpdir} from 'node:os';
import {extname, join, normalize} from 'node:path';

const TYPES = {'.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.json': 'application/json', '.svg': 'image/svg+xml'};
export const TIMEOUT = 600000; /* ms for one command: it ends what hangs, however loaded the machine */

/* Flags of Chromium.start with which WebGL is there, without a GPU. */
export const SOFTWARE_WEBGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];

export const pause = ms => new Promise(resolve => setTimeout(resolve, ms));

/* Serves the files of folders {prefix: folder}; `handlers` {path: (request, response) => ...} come first. */
export const serve = async (folders, handlers = {}) => {
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://host').pathname));
    const prefix = Object.keys(folders).find(it => path.startsWith(it)), file = prefix && join(folders[prefix], path.slice(prefix.length));
    if (handlers[path])
      return handlers[path](request, response);
    if (!file || !existsSync(file))
      return response.writeHead(404).end();
    response.writeHead(200, {'content-type': TYPES[extname(file)] || 'application/octet-stream'});
    createReadStream(file).pipe(response);
  });
  await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
  return {url: `http://127.0.0.1:${server.address().port}`, close: () => server.close()};
};

/* A browser with one page. */
export class Chromium {
  #replies = new Map;
  #number = 0;
  #session;
  errors = []; /* exceptions and console errors of the page */

  /* `drawing`: flags by which it draws, by default without WebGL. */
  static async start(drawing = ['--disable-gpu']) {
    const browser = new Chromium;
    browser.folder = mkdtempSync(join(tmpdir(), 'gscl-chromium-'));
    browser.process = spawn(process.env.CHROMIUM || 'chromium', ['--headless=new', '--no-sandbox', ...drawing, '--disable-dev-shm-usage', '--no-first-run', '--remote-debugging-pipe',
      `--user-data-dir=${browser.folder}`, '--window-size=1200,900', 'about:blank'], {stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe']});
    browser.process.stderr.resume();
    browser.process.on('error', error => browser.#end(error));
    browser.process.on('exit', code => browser.#end(Error(`chromium has ended with ${code}`)));
    browser.#read(browser.process.stdio[4]);
    const {targetInfos} = await browser.send('Target.getTargets');
    const {targetId} = targetInfos.find(it => it.type == 'page') || await browser.send('Target.createTarget', {url: 'about:blank'});
    browser.#session = (await browser.send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'DOM'])
      await browser.send(`${domain}.enable`);
    return browser;
  }
  #end(error) {
    for (const {reject} of this.#replies.values())
      reject(error);
    this.#replies.clear();
  }
  #read(pipe) {
    let text = '';
    pipe.setEncoding('utf8').on('data', data => {
      const messages = (text + data).split('\0');
      text = messages.pop();
      messages.map(it => JSON.parse(it)).forEach(it => this.#take(it));
    });
  }
  #take({id, error, result, method, params}) {
    if (id) {
      const {resolve, reject, name} = this.#replies.get(id);
      this.#replies.delete(id);
      error ? reject(Error(`${name}: ${error.message}`)) : resolve(result);
    } else if (method == 'Runtime.exceptionThrown') {
      this.errors.push(params.exceptionDetails.exception?.description || params.exceptionDetails.text);
    } else if (method == 'Log.entryAdded' && params.entry.level == 'error') {
      this.errors.push(`${params.entry.text} ${params.entry.url || ''}`);
    }
  }
  send(name, params = {}) {
    const id = ++this.#number;
    this.process.stdio[3].write(JSON.stringify({id, method: name, params, sessionId: this.#session}) + '\0');
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(Error(`${name}: no reply`)), TIMEOUT);
      this.#replies.set(id, {name, reject: it => (clearTimeout(timer), reject(it)), resolve: it => (clearTimeout(timer), resolve(it))});
    });
  }

  async open(url) {
    this.errors.length = 0;
    await this.send('Page.navigate', {url});
    await this.until(`document.readyState == 'complete' && location.href.startsWith(${JSON.stringify(url)})`);
  }
  /* The value of an expression, or of its promise. */
  async evaluate(expression) {
    const {result, exceptionDetails} = await this.send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails)
      throw Error(exceptionDetails.exception?.description || exceptionDetails.text);
    return result.value;
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
  async choose(selector, file) {
    const {root} = await this.send('DOM.getDocument'), {nodeId} = await this.send('DOM.querySelector', {nodeId: root.nodeId, selector});
    await this.send('DOM.setFileInputFiles', {nodeId, files: [file]});
  }
  mouse(type, x, y, more = {}) {
    return this.send('Input.dispatchMouseEvent', {type, x, y, ...more});
  }
  /* Size of the window in CSS pixels. */
  resize(width, height, deviceScaleFactor = 1) {
    return this.send('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor, mobile: false});
  }
  async screenshot() {
    return Buffer.from((await this.send('Page.captureScreenshot', {format: 'png'})).data, 'base64');
  }
  async close() {
    const ended = new Promise(resolve => this.process.on('exit', resolve));
    await this.send('Browser.close').catch(() => this.process.kill());
    await ended;
    rmSync(this.folder, {recursive: true, force: true, maxRetries: 5});
  }
}
