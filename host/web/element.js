/* <gscl-image>: draws a gscl picture in the pixels of the screen, also while its bytes arrive.
 *
 * What the element adds lies in its shadow tree, so that its attributes stay those of the page, which React compares with what
 * a server wrote; and in a sheet of its own, which a content security policy does not refuse as it does <style>. */

/* The bytes of base64, or of base64url as the tool writes it, with or without padding and white space. */
const bytesOf = text => {
  try {
    text = atob(text.replace(/-/g, '+').replace(/_/g, '/'));
  } catch {
    refuse(1, 'data is not base64');
  }
  return Uint8Array.from(text, character => character.charCodeAt());
};

/* Gives an element its picture.  Returns what to call with the name of an attribute that has changed, or when the screen has. */
const pictureOf = element => {
  const canvas = document.createElement('canvas'), sheet = new CSSStyleSheet, root = element.attachShadow({mode: 'open'});
  let state, /* {width, height}: the encoded size of the picture that is drawn; {failed}: whether it failed */
    bytes, /* of the file that have come */
    isWhole, /* 1: all of them have; 2: and the page knows */
    loading, /* AbortController of the file */
    draws = 0; /* calls of draw since the drawing in progress began, with the one that began it */

  /* The encoded size is the width of the content, which counts only where neither the attributes nor the page give a size. */
  const arrange = (it = state) => {
    const {width, height, failed} = state = it, alt = element.alt || '';
    canvas.setAttribute('role', element.alt == '' ? 'none' : 'img');
    canvas.setAttribute('aria-label', alt);
    root.replaceChildren(failed ? alt : canvas);
    sheet.replaceSync(`:host{display:inline-block;width:${element.width}px;height:${element.height}px;aspect-ratio:${width}/${height}}canvas{display:block;width:${width}px;height:100%;max-width:100%;min-width:100%}`);
  };
  const clear = failed => {
    bytes = canvas.width = canvas.height = 0;
    arrange({failed});
  };
  const end = error => {
    error && clear(1);
    element.dispatchEvent(error ? new ErrorEvent('error', {error, message: error.message}) : new Event('load'));
  };

  /* Where the page's policy forbids WebAssembly, bare files are drawn in plain JavaScript. */
  const infoWithoutModule = async (drawn, bare, error) => {
    if (!bare || error.code != 'failed')
      throw error;
    const tiny = await import('./tiny.js');
    GsclImage.draw = async (...given) => tiny.decode(...given);
    return tiny.info(drawn);
  };
  const drawBytes = async (drawn, partial) => {
    const {bare} = element, size = await info(drawn, {bare}).catch(error => infoWithoutModule(drawn, bare, error));
    refuse(drawn != bytes); /* another file has come meanwhile */
    arrange(size);
    const box = element.getBoundingClientRect(), pixels = side => Math.min(Math.round(side * ratio), MAX_DIMENSION);
    let image, ratio = devicePixelRatio;
    for (; !image && pixels(box.width) * pixels(box.height); ratio /= 2) /* fewer pixels where a limit refuses so many */
      image = await GsclImage.draw(drawn, {width: pixels(box.width), height: pixels(box.height), bare, partial}).catch(error => {
        if (error.code != 'limit')
          throw error;
      });
    if (image && drawn == bytes) {
      canvas.width = image.width;
      canvas.height = image.height;
      canvas.getContext('2d')[image.data ? 'putImageData' : 'drawImage'](image, 0, 0);
    }
  };
  /* Draws the bytes that have come, again and again until no more have come meanwhile. */
  const draw = async () => {
    if (draws++)
      return;
    do {
      draws = 1;
      const drawn = bytes, wasWhole = isWhole;
      const error = await (drawn && drawBytes(drawn, !wasWhole).catch(it => it));
      if (wasWhole == 1 && drawn == bytes)
        end(error, isWhole = 2);
    } while (--draws);
  };
  const take = (parts, areAll) => {
    bytes = parts;
    isWhole = areAll;
    draw();
  };

  const fetchParts = async (src, signal) => {
    const reader = (await fetchFile(src, 'not-found', {signal})).body.getReader(), parts = [];
    for (let part = {}; !part.done;) {
      part = await reader.read();
      parts.push(part.value || '');
      const joined = await new Blob(parts).arrayBuffer();
      refuse(signal.aborted); /* another file may have come meanwhile */
      take(joined, part.done);
    }
  };
  const load = async () => {
    loading?.abort();
    const {signal} = loading = new AbortController;
    bytes = isWhole = 0;
    await 0; /* attributes that are set together load one file */
    try {
      refuse(signal.aborted);
      /* base64 in a data: URL may be of the tool, too, which fetch() does not read */
      const {src} = element, data = element.data || src?.split(/^data:.*;base64,(?!.*[%#])/)[1];
      if (data)
        take(bytesOf(data), 1);
      else if (src)
        await fetchParts(src, signal);
      else
        clear();
    } catch (error) {
      signal.aborted || end(error);
    }
  };

  root.adoptedStyleSheets = [sheet];
  clear();
  new ResizeObserver(draw).observe(element);
  return name => /src|data|bare/.test(name) ? load() : draw(arrange());
};

export class GsclImage extends (globalThis.HTMLElement || Object) {
  static observedAttributes = 'src data bare alt width height'.split(' ');
  static draw = decode; /* gpu.js puts another one here, which returns a canvas */
  #change = pictureOf(this);

  connectedCallback() {
    addEventListener('resize', this.#change); /* the zoom of the page changes the pixels of the screen, not the element */
  }
  disconnectedCallback() {
    removeEventListener('resize', this.#change);
  }
  attributeChangedCallback(name) {
    this.#change(name);
  }
}
for (const name of GsclImage.observedAttributes)
  Object.defineProperty(GsclImage.prototype, name, {
    get() {
      return name == 'bare' ? this.hasAttribute(name) : this.getAttribute(name);
    },
    set(value) {
      (value ?? false) === false ? this.removeAttribute(name) : this.setAttribute(name, value);
    },
  });
try {
  customElements.define('gscl-image', GsclImage);
} catch {
  /* A server has no elements; or another entry of this package has defined it. */
}
