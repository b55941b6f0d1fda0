/* The demonstration page: one picture on a stage, seen through a view that the mouse moves. */
import {decode, info, splats} from './decoder.js';
import {drawPicture} from './draw.js';
import {LINK_BYTES, fits, fragmentOf, readFragment} from './link.js';
import {encodeBy, encodePhoto, readPhoto, reduced} from './photo.js';

const LARGEST = 2 ** 40; /* pixels of a side, beyond which numbers no longer place the view */
const LINK_PIXELS = 2 ** 15; /* of a picture that is encoded for a link */
const REACH = 1.5; /* standard deviations at which ellipses are drawn */

const at = id => document.getElementById(id);
const stage = at('stage'), picture = at('picture'), outlines = at('outlines');

let file; /* {bytes, bare, width, height, splats}; undefined before the first one */
let view = {scale: 1, x: 0, y: 0}; /* pixels of the screen per pixel of the picture; the picture's place at the stage's corner */
let part = {size: 0, list: null}; /* splats of the part of the file that the slider shows */
let isFitted = true;
let photo; /* {canvas, name, other}; other: {bitmap, ...} of another codec; undefined where a file was opened */

const whole = number => number.toLocaleString('en');
const byteCount = () => Math.max(1, Math.round(file.bytes.length * at('part').value / 100));
const shownBytes = () => file.bytes.subarray(0, byteCount());
const isPartial = () => byteCount() < file.bytes.length;
const stageSize = () => [stage.clientWidth, stage.clientHeight].map(side => Math.max(1, Math.round(side * devicePixelRatio)));

const say = (text, isError = false) => {
  at('message').textContent = text;
  at('message').hidden = !text;
  at('message').classList.toggle('error', isError);
};

/* ---- The view ---------------------------------------------------------------------------------- */

const fit = () => {
  const [width, height] = stageSize(), scale = Math.min(width / file.width, height / file.height);
  view = {scale, x: (file.width - width / scale) / 2, y: (file.height - height / scale) / 2};
  isFitted = true;
  draw();
};

/* Zooms by a factor; the point (x, y) of the stage, in pixels of the screen, keeps its place. */
const zoomBy = (factor, x, y) => {
  if (!file)
    return;
  const largest = LARGEST / Math.max(file.width, file.height), smallest = 8 / Math.max(file.width, file.height);
  const scale = Math.min(Math.max(view.scale * factor, smallest), largest);
  view = {scale, x: view.x + x / view.scale - x / scale, y: view.y + y / view.scale - y / scale};
  isFitted = false;
  draw();
};
const zoomCentre = factor => zoomBy(factor, ...stageSize().map(side => side / 2));

const moveBy = (dx, dy) => {
  view = {...view, x: view.x - dx / view.scale, y: view.y - dy / view.scale};
  isFitted = false;
  draw();
};

/* ---- Drawing ----------------------------------------------------------------------------------- */

const prepare = canvas => {
  const [width, height] = stageSize();
  if (canvas.width != width || canvas.height != height)
    Object.assign(canvas, {width, height});
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, width, height);
  return context;
};

const drawOutlines = () => {
  const context = prepare(outlines), [width, height] = stageSize();
  if (!at('showOutlines').checked || !part.list)
    return;
  context.fillStyle = '#0c0e11c8';
  context.fillRect(0, 0, width, height);
  context.lineWidth = devicePixelRatio;
  for (const {x, y, sigma1, sigma2, theta, colour} of part.list) {
    const cx = (x - view.x) * view.scale, cy = (y - view.y) * view.scale, a = REACH * sigma1 * view.scale, b = REACH * sigma2 * view.scale, reach = Math.max(a, b);
    if (cx + reach < 0 || cy + reach < 0 || cx - reach > width || cy - reach > height)
      continue;
    const [r, g, u] = colour.map(value => Math.round(70 + 185 * Math.min(Math.max(value, 0), 1)));
    context.strokeStyle = `rgb(${r} ${g} ${u} / 0.8)`;
    context.beginPath();
    context.ellipse(cx, cy, a, b, theta, 0, 2 * Math.PI);
    context.stroke();
  }
};

/* Draws what is compared with the picture, up to the divider. */
const drawOther = context => {
  const source = photo?.other?.bitmap || photo?.canvas, [width, height] = stageSize(), x = width * at('divider').value / 100;
  if (!source || !x)
    return;
  context.save();
  context.beginPath();
  context.rect(0, 0, x, height);
  context.clip();
  context.clearRect(0, 0, x, height);
  context.drawImage(source, -view.x * view.scale, -view.y * view.scale, file.width * view.scale, file.height * view.scale);
  context.restore();
  context.fillStyle = '#fff';
  context.fillRect(x - devicePixelRatio, 0, devicePixelRatio, height);
};

const drawOnce = async () => {
  const bytes = shownBytes(), partial = isPartial(), drawn = file, shown = view, canvas = new OffscreenCanvas(...stageSize());
  const started = performance.now();
  await drawPicture(canvas.getContext('2d'), {...drawn, bytes, partial}, shown);
  const time = performance.now() - started;
  if (part.size != bytes.length || part.file != drawn)
    part = {file: drawn, size: bytes.length, list: await splats(bytes, {partial, bare: drawn.bare})};
  if (drawn != file)
    return;
  const context = prepare(picture);
  context.drawImage(canvas, 0, 0);
  drawOther(context);
  drawOutlines();
  at('scale').textContent = `${(100 * view.scale).toLocaleString('en', {maximumSignificantDigits: 3})} %`;
  at('partText').textContent = `${whole(bytes.length)} of ${whole(file.bytes.length)} bytes`;
  at('splats').textContent = `${whole(part.list.length)} of ${whole(file.splats)}`;
  at('time').textContent = `${time.toFixed(0)} ms`;
  say('');
};

/* Draws the present state; states that come while a picture is drawn are drawn once, after it. */
let isDrawing = false, isStale = false;
const draw = async () => {
  isStale = true;
  if (isDrawing || !file)
    return;
  isDrawing = true;
  while (isStale) {
    isStale = false;
    await new Promise(requestAnimationFrame);
    await drawOnce().catch(error => {
      prepare(picture), prepare(outlines);
      part = {};
      const isEarly = error.code == 'truncated' && isPartial();
      say(isEarly ? 'Not enough bytes yet for the size of the picture' : error.message, !isEarly);
    });
  }
  isDrawing = false;
  stage.dataset.drawn = 1 + +(stage.dataset.drawn || 0);
};

/* ---- Files ------------------------------------------------------------------------------------- */

const open = async (bytes, name, bare = false) => {
  try {
    file = {bytes, bare, ...await info(bytes, {bare})};
  } catch (error) {
    return say(`${name}: ${error.message}`, true);
  }
  at('link').disabled = false;
  at('part').value = 100;
  at('name').textContent = name;
  at('size').textContent = `${whole(bytes.length)} bytes, ${(8 * bytes.length / file.width / file.height).toFixed(3)} bits per pixel`;
  at('pixels').textContent = `${file.width} × ${file.height}`;
  for (const button of at('list').children)
    button.setAttribute('aria-pressed', button.dataset.file == name);
  fit();
};
const openFile = async blob => {
  if (!blob)
    return;
  if (blob.type.startsWith('image/'))
    return openPhoto(blob);
  closePhoto();
  setFragment('');
  return open(new Uint8Array(await blob.arrayBuffer()), blob.name);
};
const openSample = async name => {
  closePhoto();
  setFragment('');
  const answer = await fetch(`samples/${name}`);
  return answer.ok ? open(new Uint8Array(await answer.arrayBuffer()), name) : say(`samples/${name}: ${answer.status}`, true);
};

/* ---- Photographs ----------------------------------------------------------------------------------- */

let stopEncode = () => {};
const bytesWanted = () => Math.round(2 ** at('bytes').value);
const showBytes = () => at('bytesText').textContent = `${whole(bytesWanted())} bytes`;

const showEffort = () => at('effortText').textContent = at('effort').value;

const closePhoto = () => {
  stopEncode();
  photo = undefined;
  at('photo').hidden = true;
  at('divider').value = 0;
};

const showOther = async () => {
  const type = at('other').value, shown = photo;
  at('otherText').textContent = type ? 'Encoding ...' : '';
  const other = type && shown ? await encodeBy(shown.canvas, type, file.bytes.length) : undefined;
  if (photo != shown || at('other').value != type)
    return;
  shown.other = other;
  at('otherText').textContent = !type ? '' : !other ? 'not here' : other.bitmap ? `${whole(other.bytes)} bytes, ${other.size}` : 'none is as small';
  draw();
};

/* Encodes the photograph anew; an encode that goes on is stopped. */
const encodeAgain = async () => {
  if (!photo)
    return;
  const encoded = photo, controller = new AbortController;
  stopEncode();
  stopEncode = () => controller.abort();
  at('progress').hidden = false;
  try {
    const {bytes} = await encodePhoto(encoded.canvas, {
      bytes: bytesWanted(), effort: +at('effort').value, signal: controller.signal, onProgress: ({fraction}) => at('progress').value = fraction,
    });
    at('progress').hidden = true;
    setFragment('');
    await open(bytes, encoded.name);
    await showOther();
  } catch (error) {
    if (error.name == 'AbortError')
      return;
    at('progress').hidden = true;
    say(`${encoded.name}: ${error.message}`, true);
  }
};

const openPhoto = async blob => {
  closePhoto();
  try {
    photo = {canvas: await readPhoto(blob), name: blob.name};
  } catch (error) {
    return say(`${blob.name}: ${error.message}`, true);
  }
  at('photo').hidden = false;
  at('divider').value = 50;
  at('bytes').value = Math.min(15, Math.log2(Math.max(256, photo.canvas.width * photo.canvas.height / 64)));
  showBytes();
  await encodeAgain();
};

/* ---- Links ----------------------------------------------------------------------------------------- */

const setFragment = fragment => history.replaceState(null, '', fragment || location.href.split('#')[0]);

/* The file itself where a link has room for it, else the picture encoded anew. */
const fileOfLink = async () => {
  if (fits(file))
    return file;
  const source = photo?.canvas || await canvasOf(file);
  const {bytes} = await encodePhoto(reduced(source, LINK_PIXELS), {bytes: LINK_BYTES, bare: true, effort: +at('effort').value});
  return {bytes, bare: true};
};
/* The picture of a file in few pixels. */
const canvasOf = async ({bytes, bare, width, height}) => {
  const factor = Math.min(1, Math.sqrt(LINK_PIXELS / (width * height))), size = [width, height].map(side => Math.max(1, Math.round(side * factor)));
  const image = await decode(bytes, {width: size[0], height: size[1], bare}), canvas = new OffscreenCanvas(...size);
  canvas.getContext('2d').putImageData(image, 0, 0);
  return canvas;
};
const share = async () => {
  const shared = file;
  at('link').disabled = true;
  at('linkText').textContent = 'Encoding ...';
  try {
    const {bytes, bare} = await fileOfLink();
    if (file != shared) /* another file has come meanwhile */
      return at('linkText').textContent = '';
    const fragment = fragmentOf(bytes, bare);
    setFragment(fragment);
    await open(bytes, 'the link', bare);
    const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    at('linkText').textContent = `${fragment.length} characters are the picture, ${isCopied ? 'copied' : 'in the address of the page'}`;
    photo && await showOther();
  } catch (error) {
    at('linkText').textContent = error.message;
  } finally {
    at('link').disabled = false;
  }
};
/* Returns whether the page's address has a picture. */
const openFragment = async () => {
  try {
    const linked = readFragment(location.hash);
    if (linked) {
      closePhoto();
      await open(linked.bytes, 'the link', linked.bare);
    }
    return !!linked;
  } catch (error) {
    say(`the link: ${error.message}`, true);
    return true;
  }
};

/* samples/samples.json is made by host/web/serve.sh: [{"file": "x.gscl", "title": "..."}] */
const listSamples = async isEmpty => {
  const answer = location.protocol == 'file:' ? {} : await fetch('samples/samples.json').catch(() => ({}));
  if (!answer.ok)
    return isEmpty && say('Drop a photograph or a .gscl file here');
  const samples = await answer.json();
  for (const {file: name, title} of samples) {
    const button = document.createElement('button'), image = document.createElement('gscl-image'), text = document.createElement('span'), size = document.createElement('small');
    button.dataset.file = name;
    button.onclick = () => openSample(name);
    Object.entries({src: `samples/${name}`, alt: title}).forEach(entry => image.setAttribute(...entry));
    text.textContent = title;
    size.textContent = name;
    text.append(size);
    button.append(image, text);
    at('list').append(button);
  }
  at('samples').hidden = false;
  if (isEmpty && !file && !photo)
    openSample(samples[0].file);
};

/* ---- Events ------------------------------------------------------------------------------------ */

const pointers = new Map;
const placeOf = event => {
  const box = stage.getBoundingClientRect();
  return [(event.clientX - box.left) * devicePixelRatio, (event.clientY - box.top) * devicePixelRatio];
};

stage.addEventListener('wheel', event => {
  event.preventDefault();
  zoomBy(2 ** (-event.deltaY * (event.deltaMode ? 20 : 1) / 240), ...placeOf(event));
}, {passive: false});
stage.addEventListener('pointerdown', event => {
  if (event.target.closest('#zoom'))
    return;
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, placeOf(event));
  stage.classList.add('dragged');
});
stage.addEventListener('pointermove', event => {
  const before = pointers.get(event.pointerId), now = placeOf(event);
  if (!before || !file)
    return;
  const other = [...pointers].find(([id]) => id != event.pointerId)?.[1];
  if (other) { /* a pinch: the other finger keeps its place */
    const distance = place => Math.hypot(place[0] - other[0], place[1] - other[1]);
    zoomBy(distance(now) / Math.max(distance(before), 1), ...other);
  } else {
    moveBy(now[0] - before[0], now[1] - before[1]);
  }
  pointers.set(event.pointerId, now);
});
for (const name of ['pointerup', 'pointercancel'])
  stage.addEventListener(name, event => {
    pointers.delete(event.pointerId);
    stage.classList.toggle('dragged', pointers.size > 0);
  });
stage.addEventListener('keydown', event => {
  const action = {'+': () => zoomCentre(1.5), '=': () => zoomCentre(1.5), '-': () => zoomCentre(1 / 1.5), 0: fit,
    ArrowLeft: () => moveBy(80, 0), ArrowRight: () => moveBy(-80, 0), ArrowUp: () => moveBy(0, 80), ArrowDown: () => moveBy(0, -80)}[event.key];
  if (action && file) {
    event.preventDefault();
    action();
  }
});
document.addEventListener('dragover', event => {
  event.preventDefault();
  stage.classList.add('over');
});
document.addEventListener('dragleave', () => stage.classList.remove('over'));
document.addEventListener('drop', event => {
  event.preventDefault();
  stage.classList.remove('over');
  openFile(event.dataTransfer.files[0]);
});
at('chooser').onchange = event => openFile(event.target.files[0]);
at('in').onclick = () => zoomCentre(2);
at('out').onclick = () => zoomCentre(0.5);
at('fit').onclick = () => file && fit();
at('part').oninput = draw;
at('divider').oninput = draw;
at('bytes').oninput = showBytes;
at('effort').oninput = showEffort;
at('bytes').onchange = at('effort').onchange = encodeAgain; /* when the slider is let go */
at('link').onclick = share;
at('other').onchange = showOther;
at('showOutlines').onchange = draw;
new ResizeObserver(() => file && (isFitted ? fit() : draw())).observe(stage);
addEventListener('hashchange', openFragment);

showEffort();
listSamples(!await openFragment());
