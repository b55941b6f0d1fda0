/* The demonstration page: one picture on a stage, seen through a view that the mouse moves. */
import {decode, info} from '../gscl.js';
import {splats} from '../splats.js';

const LARGEST = 2 ** 23; /* pixels of the drawn picture, of which the stage shows a part */
const REACH = 1.5; /* standard deviations at which ellipses are drawn */

const at = id => document.getElementById(id);
const stage = at('stage'), picture = at('picture'), outlines = at('outlines');

let file; /* {bytes, width, height, splats}; undefined before the first one */
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

/* The part of the drawn picture that the stage shows, and its place there; null where it shows none. */
const visible = () => {
  const [width, height] = stageSize(), fullWidth = Math.max(1, Math.round(file.width * view.scale)), fullHeight = Math.max(1, Math.round(file.height * view.scale));
  const left = Math.round(-view.x * view.scale), top = Math.round(-view.y * view.scale);
  const x = Math.max(0, -left), y = Math.max(0, -top), w = Math.min(width, left + fullWidth) - Math.max(0, left), h = Math.min(height, top + fullHeight) - Math.max(0, top);
  return w > 0 && h > 0 ? {width: fullWidth, height: fullHeight, crop: {x, y, width: w, height: h}, left: Math.max(0, left), top: Math.max(0, top)} : null;
};

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
  const bytes = shownBytes(), partial = isPartial(), frame = visible(), drawn = file;
  const started = performance.now();
  const image = frame && await decode(bytes, {...frame, partial});
  const time = performance.now() - started;
  if (part.size != bytes.length || part.file != drawn)
    part = {file: drawn, size: bytes.length, list: await splats(bytes, {partial})};
  if (drawn != file)
    return;
  const context = prepare(picture);
  image && context.putImageData(image, frame.left, frame.top);
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
      say(error.code == 'truncated' ? 'Not enough bytes yet for the size of the picture' : error.message, error.code != 'truncated');
    });
  }
  isDrawing = false;
  stage.dataset.drawn = 1 + +(stage.dataset.drawn || 0);
};

/* ---- Files ------------------------------------------------------------------------------------- */

const open = async (bytes, name) => {
  try {
    file = {bytes, ...await info(bytes)};
  } catch (error) {
    return say(`${name}: ${error.message}`, true);
  }
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
  return open(new Uint8Array(await blob.arrayBuffer()), blob.name);
};
const openSample = async name => {
  closePhoto();
  const answer = await fetch(`samples/${name}`);
  return answer.ok ? open(new Uint8Array(await answer.arrayBuffer()), name) : say(`samples/${name}: ${answer.status}`, true);
};

/* ---- Photographs, by photo.js, which brings the encoder --------------------------------------------- */

let stopEncode = () => {};
const bytesWanted = () => Math.round(2 ** at('bytes').value);
const showBytes = () => at('bytesText').textContent = `${whole(bytesWanted())} bytes`;

const closePhoto = () => {
  stopEncode();
  photo = undefined;
  at('photo').hidden = true;
  at('divider').value = 0;
};

const showOther = async () => {
  const type = at('other').value, shown = photo, {encodeBy} = await import('./photo.js');
  const other = type && shown ? await encodeBy(shown.canvas, type, file.bytes.length) : undefined;
  if (photo != shown || at('other').value != type)
    return;
  shown.other = other;
  at('otherText').textContent = !type ? '' : other ? `${whole(other.bytes)} bytes, ${other.size}` : 'not of this browser';
  draw();
};

/* Encodes the photograph anew; an encode that goes on is stopped. */
const encodeAgain = async () => {
  const encoded = photo, controller = new AbortController, {encodePhoto} = await import('./photo.js');
  stopEncode();
  stopEncode = () => controller.abort();
  at('progress').hidden = false;
  try {
    const {bytes} = await encodePhoto(encoded.canvas, {
      bytes: bytesWanted(), effort: +at('effort').value, signal: controller.signal, onProgress: ({fraction}) => at('progress').value = fraction,
    });
    at('progress').hidden = true;
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
    const {readPhoto} = await import('./photo.js');
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

/* samples/samples.json is made by host/web/serve.sh: [{"file": "x.gscl", "title": "..."}] */
const listSamples = async () => {
  const answer = await fetch('samples/samples.json').catch(() => ({}));
  if (!answer.ok)
    return say('Drop a photograph or a .gscl file here');
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
  if (!file)
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
at('encode').onclick = encodeAgain;
at('other').onchange = showOther;
at('showOutlines').onchange = draw;
new ResizeObserver(() => file && (isFitted ? fit() : draw())).observe(stage);

listSamples();
