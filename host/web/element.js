/* <gscl-image>: draws a gscl picture in the pixels of the screen, also while its bytes arrive. */

/* The bytes of base64, or of base64url as the tool writes it, with or without padding and white space. */
const bytesOf = text => {
  try {
    text = atob(text.replace(/-/g, '+').replace(/_/g, '/'));
  } catch {
    refuse(1, 'data is not base64');
  }
  return Uint8Array.from(text, character => character.charCodeAt());
};

export class GsclImage extends (globalThis.HTMLElement || Object) {
  static observedAttributes = ['src', 'data', 'bare', 'alt', 'width', 'height'];
  #style = document.createElement('style');
  #canvas = document.createElement('canvas');
  #bytes; /* of the file that have come */
  #isWhole; /* 1: all of them have; 2: and the page knows */
  #draws = 0; /* calls of #draw since the drawing in progress began, with the one that began it */
  #loading; /* AbortController of the file */
  #redraw = () => this.#draw();
  #observer = new ResizeObserver(this.#redraw);

  constructor() {
    super();
    this.attachShadow({mode: 'open'}).append(this.#style, this.#canvas);
    this.#clear();
  }
  connectedCallback() {
    this.hasAttribute('role') || this.setAttribute('role', 'img');
    this.#observer.observe(this);
    addEventListener('resize', this.#redraw); /* the zoom of the page changes the pixels of the screen, not the element */
  }
  disconnectedCallback() {
    this.#observer.disconnect();
    removeEventListener('resize', this.#redraw);
  }
  attributeChangedCallback(name, _, value) {
    if (name == 'alt')
      this.setAttribute('aria-label', value || '');
    else if (name == 'width' || name == 'height')
      this.style[name] = value && value + 'px';
    else
      this.#load();
  }

  async #load() {
    this.#loading?.abort();
    const {signal} = this.#loading = new AbortController;
    this.#bytes = this.#isWhole = 0;
    await 0; /* attributes that are set together load one file */
    try {
      refuse(signal.aborted);
      /* base64 in a data: URL may be of the tool, too, which fetch() does not read */
      const src = this.getAttribute('src'), data = this.getAttribute('data') || src?.split(/^data:.*;base64,(?!.*[%#])/)[1];
      if (data)
        this.#take(bytesOf(data), 1);
      else if (src)
        await this.#fetch(src, signal);
      else
        this.#clear();
    } catch (error) {
      signal.aborted || this.#end(error);
    }
  }
  async #fetch(src, signal) {
    const reader = (await fetchFile(src, 'not-found', {signal})).body.getReader(), parts = [];
    for (let isWhole; !isWhole;) {
      const {value, done} = await reader.read();
      parts.push(value || '');
      const bytes = await new Blob(parts).arrayBuffer();
      refuse(signal.aborted); /* another file may have come meanwhile */
      this.#take(bytes, isWhole = done);
    }
  }
  #take(bytes, isWhole) {
    this.#bytes = bytes;
    this.#isWhole = isWhole;
    this.#draw();
  }

  /* Draws the bytes that have come, again and again until no more have come meanwhile. */
  async #draw() {
    if (this.#draws++)
      return;
    do {
      this.#draws = 1;
      const bytes = this.#bytes, isWhole = this.#isWhole;
      const error = await (bytes && this.#drawBytes(bytes, !isWhole).catch(it => it));
      if (isWhole == 1 && bytes == this.#bytes) {
        this.#isWhole = 2;
        this.#end(error);
      }
    } while (--this.#draws);
  }
  async #drawBytes(bytes, partial) {
    const canvas = this.#canvas, bare = this.hasAttribute('bare'), size = await info(bytes, {bare});
    refuse(bytes != this.#bytes); /* another file has come meanwhile */
    this.#fit(size);
    const box = this.getBoundingClientRect(), pixels = side => Math.min(Math.round(side * ratio), MAX_DIMENSION);
    let image, ratio = devicePixelRatio;
    for (; !image && pixels(box.width) * pixels(box.height); ratio /= 2) /* fewer pixels where a limit refuses so many */
      image = await decode(bytes, {width: pixels(box.width), height: pixels(box.height), bare, partial}).catch(error => {
        if (error.code != 'limit')
          throw error;
      });
    if (image && bytes == this.#bytes) {
      canvas.width = image.width;
      canvas.height = image.height;
      canvas.getContext('2d').putImageData(image, 0, 0);
    }
  }
  #end(error) {
    error && this.#clear();
    this.dispatchEvent(error ? new ErrorEvent('error', {error, message: error.message}) : new Event('load'));
  }
  #clear() {
    this.#bytes = this.#canvas.width = this.#canvas.height = 0;
    this.#fit({});
  }
  /* The encoded size is the width of the content, which counts only where neither the attributes nor the page give a size. */
  #fit({width, height}) {
    this.#style.textContent = `:host{display:inline-block;line-height:0;aspect-ratio:${width}/${height}}canvas{width:${width}px;min-width:100%;max-width:100%;height:100%}`;
  }
}
globalThis.customElements?.define('gscl-image', GsclImage);
