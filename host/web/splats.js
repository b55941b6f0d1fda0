/* splats: the Gaussians of a file; gscl.d.ts describes it. */
import {open} from './gscl.js';

const OUT_OF_MEMORY = 7; /* gsf_result (format/types.h) */
const PARAMS = 14; /* numbers of a splat (cl/constants.h) */

export const splats = (source, options = {}) => open(source, options, (wasm, header, check) => {
  check(wasm.read(!!options.partial));
  const at = wasm.splats(), [, , length, , , , colours, hasAlpha, hasOpacity] = header();
  check(at ? 0 : OUT_OF_MEMORY);
  const list = new Float32Array(wasm.memory.buffer, at, length * PARAMS);
  return Array.from({length}, (_, i) => {
    const [x, y, logSigma1, logSigma2, theta, logit, ...channels] = list.subarray(i * PARAMS, i * PARAMS + PARAMS);
    const [r, g = r, b = r] = channels.slice(0, colours), [waveX, waveY, phase, amplitude] = channels.slice(4);
    return {
      x, y, sigma1: Math.exp(logSigma1), sigma2: Math.exp(logSigma2), theta,
      opacity: hasOpacity ? 1 / (1 + Math.exp(-logit)) : 1,
      colour: [r, g, b, hasAlpha ? channels[colours] : 1],
      ...amplitude ? {wave: {x: waveX, y: waveY, phase, amplitude}} : {},
    };
  });
});
