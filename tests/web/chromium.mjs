/* Drives Chromium through its debugging pipe, without further packages. */
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

import {Browser} from './browsers.mjs';

export {TIMEOUT, pause, serve} from './browsers.mjs';

/* Flags of Chromium.start with which WebGL is there, without a GPU. */
export const SOFTWARE_WEBGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];

export class Chromium extends Browser {
  name = 'chromium';
  #session;

  /* `drawing`: flags by which it draws, by default without WebGL. */
  static async start(drawing = ['--disable-gpu']) {
    const browser = new Chromium;
    browser.folder = mkdtempSync(join(tmpdir(), 'gscl-chromium-'));
    browser.process = spawn(process.env.CHROMIUM || 'chromium', ['--headless=new', '--no-sandbox', ...drawing, '--disable-dev-shm-usage', '--no-first-run', '--remote-debugging-pipe',
      `--user-data-dir=${browser.folder}`, '--window-size=1200,900', 'about:blank'], {stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe']});
    browser.process.stderr.resume();
    browser.process.on('error', error => browser.fail(error));
    browser.process.on('exit', code => browser.fail(Error(`chromium has ended with ${code}`)));
    browser.#read(browser.process.stdio[4]);
    const {targetInfos} = await browser.send('Target.getTargets');
    const {targetId} = targetInfos.find(it => it.type == 'page') || await browser.send('Target.createTarget', {url: 'about:blank'});
    browser.#session = (await browser.send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'DOM'])
      await browser.send(`${domain}.enable`);
    return browser;
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
    if (id)
      this.reply(id, result, error?.message);
    else if (method == 'Runtime.exceptionThrown')
      this.errors.push(params.exceptionDetails.exception?.description || params.exceptionDetails.text);
    else if (method == 'Log.entryAdded' && params.entry.level == 'error')
      this.errors.push(`${params.entry.text} ${params.entry.url || ''}`);
  }
  write(text) {
    this.process.stdio[3].write(`${text}\0`);
  }
  send(method, params) {
    return super.send(method, params, {sessionId: this.#session});
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
