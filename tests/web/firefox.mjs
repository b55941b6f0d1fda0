/* Drives Firefox through WebDriver BiDi, without further packages. */
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

import {Browser} from './browsers.mjs';
import {connect} from './web_socket.mjs';

/* The browser asks nothing of the network, and opens no pages of its own. */
const PREFERENCES = {'browser.aboutwelcome.enabled': false, 'datareporting.policy.dataSubmissionEnabled': false, 'app.normandy.enabled': false};
const BUTTONS = {left: 0, middle: 1, right: 2};

/* The value of what a script returned (BiDi, "script.RemoteValue"); {} for what is no plain value, as an element. */
const valueOf = ({type, value}) => {
  if (type == 'null' || type == 'undefined')
    return type == 'null' ? null : undefined;
  if (type == 'number')
    return Number(value); /* NaN and Infinity come as text */
  if (type == 'array')
    return value.map(valueOf);
  if (type == 'object')
    return Object.fromEntries(value.map(([key, it]) => [key, valueOf(it)]));
  return ['string', 'boolean'].includes(type) ? value : {};
};

export class Firefox extends Browser {
  name = 'firefox';
  #socket;
  #context;

  static async start(program = process.env.FIREFOX || 'firefox-esr') {
    const browser = new Firefox;
    browser.folder = mkdtempSync(join(tmpdir(), 'gscl-firefox-'));
    writeFileSync(join(browser.folder, 'user.js'), Object.entries(PREFERENCES).map(([name, value]) => `user_pref("${name}", ${value});\n`).join(''));
    browser.process = spawn(program, ['--headless', '--no-remote', '--remote-debugging-port=0', '--profile', browser.folder, 'about:blank'], {stdio: ['ignore', 'ignore', 'pipe']});
    browser.#socket = await connect(`${await browser.#address()}/session`, text => browser.#take(JSON.parse(text)));
    await browser.send('session.new', {capabilities: {}});
    await browser.send('session.subscribe', {events: ['log.entryAdded']});
    browser.#context = (await browser.send('browsingContext.getTree')).contexts[0].context;
    await browser.resize(1200, 900);
    return browser;
  }
  #address() {
    return new Promise((resolve, reject) => {
      let text = '';
      const end = error => (reject(error), this.fail(error));
      this.process.stderr.setEncoding('utf8').on('data', data => {
        text += data;
        const address = text.match(/^WebDriver BiDi listening on (\S+)\n/m);
        address && resolve(address[1]);
      });
      this.process.on('error', end).on('exit', code => end(Error(`firefox has ended with ${code}`)));
    });
  }
  #take({type, id, result, error, message, params}) {
    if (type != 'event')
      this.reply(id, result, type == 'error' && `${error}: ${message}`);
    else if (params.level == 'error')
      this.errors.push(params.text);
  }
  write(text) {
    this.#socket.send(text);
  }
  #inPage(method, params) {
    return this.send(method, {context: this.#context, ...params});
  }
  #perform(actions) {
    return this.#inPage('input.performActions', {actions: [actions]});
  }

  async open(url) {
    this.errors.length = 0;
    await this.#inPage('browsingContext.navigate', {url, wait: 'complete'});
  }
  /* The value of an expression, or of its promise. */
  async evaluate(expression) {
    const {type, result, exceptionDetails} = await this.send('script.evaluate', {expression, target: {context: this.#context}, awaitPromise: true, userActivation: true});
    if (type == 'exception')
      throw Error(exceptionDetails.text);
    return valueOf(result);
  }
  async choose(selector, file) {
    const {nodes: [element]} = await this.#inPage('browsingContext.locateNodes', {locator: {type: 'css', value: selector}});
    await this.#inPage('input.setFiles', {element: {sharedId: element.sharedId}, files: [file]});
  }
  /* The events of Chromium's debugging protocol. */
  mouse(type, x, y, {deltaX = 0, deltaY = 0, button = 'left'} = {}) {
    [x, y] = [x, y].map(Math.round);
    if (type == 'mouseWheel')
      return this.#perform({type: 'wheel', id: 'wheel', actions: [{type: 'scroll', x, y, deltaX, deltaY}]});
    const step = {mousePressed: 'pointerDown', mouseReleased: 'pointerUp'}[type], move = {type: 'pointerMove', x, y};
    return this.#perform({type: 'pointer', id: 'mouse', actions: step ? [move, {type: step, button: BUTTONS[button]}] : [move]});
  }
  /* Size of the window in CSS pixels. */
  resize(width, height, devicePixelRatio = 1) {
    return this.#inPage('browsingContext.setViewport', {viewport: {width, height}, devicePixelRatio});
  }
  async screenshot() {
    return Buffer.from((await this.#inPage('browsingContext.captureScreenshot')).data, 'base64');
  }
  async close() {
    const ended = new Promise(resolve => this.process.on('exit', resolve));
    await this.send('browser.close').catch(() => this.process.kill());
    await ended;
    rmSync(this.folder, {recursive: true, force: true, maxRetries: 5});
  }
}
