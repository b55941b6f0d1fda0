/* Pictures for the encoder of the package, in Node and in pages. */

/* Discs before a slope, as a canvas has it; `alpha` is that of a bar. */
export const sceneOf = (width, height, channels = 4, alpha = 255) => {
  const data = new Uint8ClampedArray(width * height * channels);
  for (let i = 0; i < width * height; i++) {
    const x = i % width / width, y = Math.floor(i / width) / height, dx = x - 0.4, dy = y - 0.5, inside = dx * dx + dy * dy < 0.0625; /* Math.hypot differs between engines */
    const colour = [inside ? 230 : 60 + 120 * x, inside ? 90 : 80 + 100 * y, inside ? 40 : 200 - 90 * x].slice(0, channels < 3 ? 1 : 3);
    data.set(channels % 2 ? colour : [...colour, x > 0.8 ? alpha : 255], i * channels);
  }
  return {data, width, height};
};
