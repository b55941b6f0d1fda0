/* <gscl-image>: draws a gscl picture in the pixels of the screen, also while its bytes arrive. */
export class GsclImage extends (globalThis.HTMLElement || Object) {
  static observedAttributes = ['src', 'data', 'bare', 'alt', 'width', 'height'];
  #canvas = document.createElement('canvas');
  #bytes; /* of the file that have come */
  #isWhole; /* all of them have */
  #isDrawing;
  #isStale; /* there is more to draw than when the drawing in progress began */
  #loading; /* AbortController of the file */
  #redraw = () => this.#draw();
  #observer = new ResizeObserver(this.#redraw);

  constructor() {
    super();
    this.attachShadow({mode: 'open'}).innerHTML = '<style>:host{display:inline-block;line-height:0}canvas{width:100%;height:100%}</style>';
    this.shadowRoot.append(this.#canvas);
    this.#canvas.width = this.#canvas.height = 0;
  }
  connectedCallback() {
    this.role ||= 'img';
    this.#observer.observe(this);
    addEventListener('resize', this.#redraw); /* the zoom of the page changes the pixels of the screen, not the element */
  }
  disconnectedCallback() {
    this.#observer.disconnect();
    removeEventListener('resize', this.#redraw);
  }
  attributeChangedCallback(name, _, value) {
    if (name == 'alt')
      this.ariaLabel = value;
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
      const data = this.getAttribute('data'), src = this.getAttribute('src');
      if (signal.aborted)
        return;
      if (data)
        this.#bytes = Uint8Array.from(atob(data), character => character.charCodeAt());
      else if (src)
        await this.#fetch(src, signal);
      this.#isWhole = this.#bytes && 1;
      this.#draw();
    } catch (error) {
      signal.aborted || this.#fail(error);
    }
  }
  async #fetch(src, signal) {
    const answer = await fetch(src, {signal}), parts = [];
    refuse(!answer.ok, `${answer.url}: ${answer.status}`, 'not-found');
    for (const reader = answer.body.getReader(); ;) {
      const {value, done} = await reader.read();
      if (done)
        break;
      parts.push(value);
      this.#bytes = new Uint8Array(await new Blob(parts).arrayBuffer());
      this.#draw();
    }
    this.#bytes ||= new Uint8Array;
  }
  #fail(error) {
    this.dispatchEvent(new ErrorEvent('error', {error, message: error.message}));
  }

  /* Draws the bytes that have come, again and again until no more have come meanwhile. */
  async #draw() {
    this.#isStale = 1;
    if (this.#isDrawing)
      return;
    this.#isDrawing = 1;
    while (this.#isStale) {
      this.#isStale = 0;
      const bytes = this.#bytes, isWhole = this.#isWhole;
      const isEnd = () => isWhole == 1 && bytes == this.#bytes && (this.#isWhole = 2);
      try {
        bytes && await this.#drawBytes(bytes, !isWhole);
        isEnd() && this.dispatchEvent(new Event('load'));
      } catch (error) {
        isEnd() && this.#fail(error);
      }
    }
    this.#isDrawing = 0;
  }
  async #drawBytes(bytes, partial) {
    const canvas = this.#canvas, style = this.style, bare = this.hasAttribute('bare'), file = await info(bytes, {bare});
    style.aspectRatio = file.width + '/' + file.height;
    this.offsetWidth && this.offsetHeight || (style.width = file.width + 'px', style.maxWidth ||= '100%');
    const box = this.getBoundingClientRect(), [width, height] = [box.width, box.height].map(side => Math.min(Math.round(side * devicePixelRatio), MAX_DIMENSION));
    if (width * height) {
      const image = await decode(bytes, {width, height, bare, partial});
      if (bytes == this.#bytes) {
        canvas.width = width;
        canvas.height = height;
        canvas.getContext('2d').putImageData(image, 0, 0);
      }
    }
  }
}
globalThis.customElements?.define('gscl-image', GsclImage);
