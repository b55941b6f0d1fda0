/* Draws splats by WebGL 2: one rectangle for each splat adds its weight and its weighted colour to targets of floats, and a
 * second pass makes pixels of the sums. */
import {REACH, SPLAT} from './picture.js';

const TARGET = 2048; /* the largest side of the targets, pixels: larger views are drawn in parts */
const FAR = 2 ** 14; /* pixels: splats that reach farther are drawn in an upright rectangle, cut off around the target, for want of precision */
const MOST_HALVES = 200; /* splats over each other, of which sums of 11 bits are good to 1/255: 300 of a conformance file miss it by 24 */
const EPSILON = 1 / 1024; /* weight of the background in blend `normalized` */
const FLOAT = 4; /* bytes */
const NORMALIZED = 0, ALPHA = 1; /* blends, as in the format; the third one is `sum` */
const ATTRIBUTES = ['place', 'form', 'colour', 'wave'];

/* Covariances stay in pixels of the picture, where floats have room for them at any scale.  The axes of the rectangle are the
 * columns of a triangular root of the covariance: of (root.x, root.y) and (0, root.z). */
const SPLAT_VERTEX = `#version 300 es
in vec4 place, form, colour;
in vec3 wave;
uniform vec2 origin, rest; /* the corner of the target in the picture is their sum */
uniform vec2 scale, size; /* of the target */
uniform vec2 box; /* variance of a pixel, where the picture is reduced */
flat out vec2 centre;
flat out vec3 inverse;
flat out vec2 weight; /* opacity and amplitude */
flat out vec4 tint;
flat out vec3 turns;
void main() {
  vec2 variances = place.zw * place.zw, along = vec2(dot(form.xy * form.xy, variances), dot(form.yx * form.yx, variances)), wide = along + box;
  float mixed = form.x * form.y * (variances.x - variances.y);
  float determinant = variances.x * variances.y + along.x * box.y + wide.y * box.x;
  vec3 root = vec3(wide.x, mixed, sqrt(determinant)) / sqrt(wide.x);
  vec2 side = 2. * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1., corner = ${REACH.toFixed(6)} * side;
  centre = ((place.xy - origin) - rest) * scale;
  inverse = vec3(1. / (root.x * scale.x), root.y * scale.y / (root.x * scale.x), 1. / (root.z * scale.y));
  weight = vec2(form.z * sqrt(variances.x * variances.y / determinant), form.w * exp(-19.739209 * dot(wave.xy * wave.xy, box)));
  tint = colour;
  turns = vec3(wave.xy / scale, wave.z);
  vec2 reach = ${REACH.toFixed(6)} * vec2(root.x, length(root.yz)) * scale;
  vec2 at = centre + vec2(root.x * corner.x, root.y * corner.x + root.z * corner.y) * scale;
  if (max(reach.x, reach.y) > ${FAR}.)
    at = clamp(centre + reach * side, vec2(-1), size + 1.);
  gl_Position = vec4(at / size * 2. - 1., 0, 1);
}`;

const SPLAT_FRAGMENT = `#version 300 es
precision highp float;
flat in vec2 centre;
flat in vec3 inverse;
flat in vec2 weight;
flat in vec4 tint;
flat in vec3 turns;
uniform float most;
layout(location = 0) out vec4 sums;
layout(location = 1) out vec4 alphas;
void main() {
  vec2 from = gl_FragCoord.xy - centre, axes = vec2(from.x, from.y - from.x * inverse.y) * inverse.xz;
  float w = min(weight.x * max(exp(-.5 * dot(axes, axes)) - 9.1188197e-4, 0.), most);
  vec3 shade = tint.rgb;
  if (weight.y > 0.)
    shade += weight.y * cos(6.2831853 * fract(dot(from, turns.xy) - turns.z));
  sums = vec4(w * shade, w);
  alphas = vec4(w * tint.a, 0, 0, w);
}`;

const PIXEL_VERTEX = `#version 300 es
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1);
}`;

/* The first row of the target is the top one, that of the canvas the bottom one. */
const PIXEL_FRAGMENT = `#version 300 es
precision highp float;
uniform highp sampler2D sums, alphas;
uniform ivec2 corner;
uniform bool isNormalised, hasAlpha;
out vec4 pixel;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - corner;
  at.y = -at.y;
  vec4 sum = texelFetch(sums, at, 0);
  float factor = isNormalised ? 1. / sum.a : 1., alpha = hasAlpha ? clamp(texelFetch(alphas, at, 0).r * factor, 0., 1.) : 1.;
  pixel = vec4(clamp(sum.rgb * factor, 0., alpha), alpha);
}`;

/* {program, and the places of its uniforms by name} */
const programOf = (gl, ...sources) => {
  const program = gl.createProgram(), places = {program};
  for (const [i, source] of sources.entries()) {
    const shader = gl.createShader(i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    gl.deleteShader(shader);
  }
  ATTRIBUTES.forEach((name, i) => gl.bindAttribLocation(program, i, name));
  gl.linkProgram(program);
  for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i--;) {
    const {name} = gl.getActiveUniform(program, i);
    places[name] = gl.getUniformLocation(program, name);
  }
  return places;
};

const targetOf = (gl, format, width, height) => {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
};

const variance = scale => scale < 1 ? (scale ** -2 - 1) / 12 : 0; /* gscl_resize_splats (host/lib/decode/resize.c) */

/* The first pixel and the end of those of `pixels` along an axis in which a picture lies. */
const extent = (at, scale, side, pixels) => [Math.max(0, Math.round(-at * scale)), Math.min(pixels, Math.round((side - at) * scale))];

/* The parts in which a view of so many pixels is drawn, where the picture is: {left, top, width, height}. */
export const partsOf = (picture, {x, y, scaleX, scaleY}, columns, rows) => {
  const [left, right] = extent(x, scaleX, picture.width, columns), [top, bottom] = extent(y, scaleY, picture.height, rows), parts = [];
  for (let row = top; row < bottom; row += TARGET)
    for (let column = left; column < right; column += TARGET)
      parts.push({left: column, top: row, width: Math.min(TARGET, right - column), height: Math.min(TARGET, bottom - row)});
  return parts;
};

/* What draws to a canvas, or null where the browser has no WebGL 2 that adds floats of 32 or 16 bits.  When its context was lost and is there
 * again, `onRestored` is called. */
export const painterOf = (canvas, onRestored = () => {}) => {
  const gl = canvas.getContext('webgl2', {antialias: false, depth: false, failIfMajorPerformanceCaveat: true});
  let hasFloats, /* of 32 bits; else of 16 */
    splatProgram, pixelProgram, frames, /* of one target and of both */
    targets, width, height, /* of the targets */
    arrays; /* Map of pictures to {buffer, array} on the GPU */

  /* Whether the browser has what is needed; also after the context was lost. */
  const begin = () => {
    arrays = new Map;
    targets = [];
    width = height = 0;
    const has = name => gl?.getExtension(name);
    hasFloats = has('EXT_color_buffer_float') && has('EXT_float_blend');
    if (!hasFloats && !has('EXT_color_buffer_float') && !has('EXT_color_buffer_half_float'))
      return false;
    splatProgram = programOf(gl, SPLAT_VERTEX, SPLAT_FRAGMENT);
    pixelProgram = programOf(gl, PIXEL_VERTEX, PIXEL_FRAGMENT);
    frames = [gl.createFramebuffer(), gl.createFramebuffer()];
    gl.enable(gl.SCISSOR_TEST);
    return true;
  };

  const reserve = part => {
    if (part.width <= width && part.height <= height)
      return;
    width = Math.max(width, part.width);
    height = Math.max(height, part.height);
    targets.forEach(it => gl.deleteTexture(it));
    targets = (hasFloats ? [gl.RGBA32F, gl.R32F] : [gl.RGBA16F, gl.R16F]).map(format => targetOf(gl, format, width, height));
    for (const [i, frame] of frames.entries()) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      for (let k = 0; k <= i; k++)
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + k, gl.TEXTURE_2D, targets[k], 0);
      gl.drawBuffers([gl.COLOR_ATTACHMENT0, i ? gl.COLOR_ATTACHMENT1 : gl.NONE]);
    }
  };

  const arrayOf = picture => {
    if (!arrays.has(picture)) {
      const buffer = gl.createBuffer(), array = gl.createVertexArray();
      arrays.set(picture, {buffer, array});
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, picture.splats, gl.STATIC_DRAW);
      for (const i of ATTRIBUTES.keys()) {
        gl.enableVertexAttribArray(i);
        gl.vertexAttribPointer(i, SPLAT / ATTRIBUTES.length, gl.FLOAT, false, SPLAT * FLOAT, i * SPLAT / ATTRIBUTES.length * FLOAT);
        gl.vertexAttribDivisor(i, 1);
      }
    }
    return arrays.get(picture).array;
  };

  const setArea = (x, y, columns, rows) => {
    gl.viewport(x, y, columns, rows);
    gl.scissor(x, y, columns, rows);
  };

  const addSplats = ({blend, background: [r, g, b, alpha], hasAlpha, count}, {x, y, scaleX, scaleY}, part) => {
    const corner = [x + part.left / scaleX, y + part.top / scaleY], origin = corner.map(Math.fround);
    const [factor, weight] = blend == NORMALIZED ? [EPSILON, EPSILON] : [1, 0]; /* of the background */
    gl.bindFramebuffer(gl.FRAMEBUFFER, frames[+!!hasAlpha]);
    setArea(0, 0, part.width, part.height);
    gl.clearBufferfv(gl.COLOR, 0, [factor * r, factor * g, factor * b, weight]);
    if (hasAlpha)
      gl.clearBufferfv(gl.COLOR, 1, [factor * alpha, 0, 0, 0]);
    gl.useProgram(splatProgram.program);
    gl.uniform2fv(splatProgram.origin, origin);
    gl.uniform2f(splatProgram.rest, corner[0] - origin[0], corner[1] - origin[1]);
    gl.uniform2f(splatProgram.scale, scaleX, scaleY);
    gl.uniform2f(splatProgram.size, part.width, part.height);
    gl.uniform2f(splatProgram.box, variance(scaleX), variance(scaleY));
    gl.uniform1f(splatProgram.most, blend == ALPHA ? .999 : 1);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, blend == ALPHA ? gl.ONE_MINUS_SRC_ALPHA : gl.ONE);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    gl.disable(gl.BLEND);
  };

  const makePixels = ({blend, hasAlpha}, part, column, row) => {
    const bottom = gl.drawingBufferHeight - row - part.height;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    setArea(column, bottom, part.width, part.height);
    gl.useProgram(pixelProgram.program);
    gl.uniform2i(pixelProgram.corner, column, bottom + part.height - 1);
    gl.uniform1i(pixelProgram.alphas, 1);
    gl.uniform1i(pixelProgram.isNormalised, +(blend == NORMALIZED));
    gl.uniform1i(pixelProgram.hasAlpha, hasAlpha);
    targets.forEach((target, i) => {
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, target);
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  };

  const forget = picture => {
    const it = arrays.get(picture);
    gl.deleteBuffer(it?.buffer);
    gl.deleteVertexArray(it?.array);
    arrays.delete(picture);
  };

  const prevent = event => event.preventDefault(); /* else the context does not come back */
  const restore = () => {
    begin();
    onRestored();
  };
  if (!begin())
    return null;
  canvas.addEventListener('webglcontextlost', prevent);
  canvas.addEventListener('webglcontextrestored', restore);
  return {
    canvas,
    /* Whether what it draws is as exact as it should be. */
    takes: ({depth}) => hasFloats || depth <= MOST_HALVES,
    isLost: () => gl.isContextLost(),
    clear: () => {
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      setArea(0, 0, canvas.width, canvas.height);
      gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    },
    /* Draws a part of a view, with its top left corner at a place of the canvas. */
    draw: (picture, view, part, column, row) => {
      reserve(part);
      gl.bindVertexArray(arrayOf(picture));
      addSplats(picture, view, part);
      makePixels(picture, part, column, row);
    },
    forget,
    free: () => {
      canvas.removeEventListener('webglcontextlost', prevent);
      canvas.removeEventListener('webglcontextrestored', restore);
      [...arrays.keys()].forEach(forget);
      targets.forEach(it => gl.deleteTexture(it));
      frames.forEach(it => gl.deleteFramebuffer(it));
      [splatProgram, pixelProgram].forEach(({program}) => gl.deleteProgram(program));
    },
  };
};
