/* decode and info of bare files in plain JavaScript; tiny.d.ts describes them.
 *
 * ../../format/FORMAT.md defines what this file does, mostly by the same names.  All numbers that decide how bits are read are
 * whole and below 2^53, so that those of JavaScript are exact, or real ones that are not close to what they are rounded at.  The
 * script is to be small: it refuses what bare files of 20 to 400 bytes hardly have.  Files that are not bare are among what it
 * refuses, because their magic reads as another blend. */

const {min, max, floor, round, ceil, abs, exp, cos, sin, PI} = Math;
const clamp = (value, low, high) => min(max(value, low), high);
const list = (count, of) => Array.from({length: count}, (_, i) => of(i));
const sum = numbers => numbers.reduce((total, it) => total + it);
const codesOf = text => [...text].map(character => character.charCodeAt());

const refuse = (isRefused, code, message = `the file is ${code}`) => {
  if (isRefused)
    throw Object.assign(Error(message), {name: 'GsclError', code});
};

/* ---- Range coder ---- */

let bytes, at, code, range;

const takeByte = () => code = (code << 8 | bytes[at++]) >>> 0; /* 0 beyond the end */

/* A symbol by the frequencies of the alphabet, or of as many equally frequent ones as a number says. */
const symbolOf = frequencies => {
  const total = frequencies.length ? sum(frequencies) : frequencies, unit = floor(range / total), target = min(floor(code / unit), total - 1);
  let symbol = 0, before = 0, frequency;
  for (; before + (frequency = frequencies[symbol] ?? 1) <= target; symbol++)
    before += frequency;
  code -= before * unit;
  range = before + frequency < total ? frequency * unit : range - before * unit;
  for (; range < 2 ** 24; range *= 256)
    takeByte();
  return symbol;
};
const flag = n => symbolOf([16 - n, n]);
/* Numbers of more than 17 bits are not exact: numbers of splats, which are refused. */
const number = (...frequencies) => {
  const bits = symbolOf(frequencies) - 1;
  return bits < 1 ? bits + 1 : 2 ** bits + symbolOf(2 ** bits);
};

/* ---- Models ---- */

/* A function that chooses a symbol by row r, and adapts the rows near it.  `gains`: by distance of symbols, in quarters where
 * there is one row. */
const modelOf = (rows, gains, limit = 4000) => (r = 0, choose = symbolOf) => {
  const chosen = choose(rows[r]);
  rows.forEach((row, q) => {
    const weight = 4 - abs(q - r);
    if (weight > 0)
      row.forEach((_, i) => row[i] += weight * (gains[abs(i - chosen)] || 0));
    while (sum(row) > min(limit, 32000))
      row.forEach((it, i) => row[i] = it + 1 >> 1);
  });
  return chosen;
};
/* A table of the page; a character stands for the difference to the number above it. */
const conditional = (text, columns, ...gains) => {
  const numbers = [];
  for (const it of codesOf(text))
    numbers.push(4 * (it - 50) + (numbers[numbers.length - columns] || 0));
  return modelOf(list(numbers.length / columns, () => numbers.splice(0, columns)), gains);
};
const trainedModels = () => [
  /* aspect */
  conditional('\x94lVSOD>:6433333333333333 .2456655332222222222222#-1246665432222222222222%,0134456644222222222222,-0123444453422222222222\
-..0123445453322222222224/0///12434444322222222292/..0112333333322222222<10/../12333333322222222.12101222234434332222222\
,11122111233343333222222)/2222222333434333322222*.0112122223444443332222*.0011212333344444444222+./001222323333344454322\
,/0122212322223444453222.00112122223322223354322//0000121243331334455422100/.//212153444423563223100./002013445424234222\
22100/..2//329645741412242210//.1.222654241432223332210//00117320043952242222221,02537652+//2522', 24, 4, 2, 1),
  /* direction, of which the first and the last symbol are neighbours */
  conditional('_@F@O=A;P<@?O?EA-612032404320315\'925-117-721-4192234-243.232.543\
8240141111130021922032/223034131<3/2111/40013301@3210011410132/0', 16, 7, 1, ...Array(13), 1),
  /* textured, amplitude, wave */
  conditional('\x8d;4022222204133131314040', 2, 10), conditional('ZPD<875433333333', 16, 5, 2, 1), conditional(';@DDA>;976653333', 16, 5, 2),
];
const adaptive = (count, first, gains, meanLimit = 256) => modelOf([list(count, i => first(i) | 0)], gains, count * meanLimit);

/* A function that decodes a level of Co or Cg near a predicted one, by a mixture of two models. */
const channelOf = L => {
  const hill = centre => i => 1 + 150 / (1 + (i - centre) ** 2), size = 2 * L + 1;
  const plain = adaptive(size, hill(L), [37.5, 1.5], 600), residual = adaptive(2 * size - 1, hill(2 * L), [37.5, 3.5, .5], 400);
  let W = 40000;
  return mean => { /* in sixteenths */
    const s = L - clamp(mean + 8 >> 4, -L, L);
    return residual(0, row => s + plain(0, p => {
      const r = row.slice(s, s + size), P = sum(p), R = sum(r), share = (f, total) => floor(f * 16384 / total);
      const i = symbolOf(p.map((it, i) => 1 + (it * share(W, P) + r[i] * share(65536 - W, R) >> 15)));
      const a = W * (share(p[i], P) + 1), b = (65536 - W) * (share(r[i], R) + 1);
      W = clamp(floor(a * 65536 / (a + b)), 2048, 63488);
      return i;
    })) - s - L;
  };
};

/* A function that decodes the levels of Co and Cg of a splat in a bucket of the finest level. */
const chromaOf = L => {
  const coChannel = channelOf(L), cgChannel = channelOf(L), means = [];
  let XX = 2048, XY = 0;
  return (bx, by) => {
    const keys = list(6, shift => shift << 10 | by >> shift << 5 | bx >> shift); /* of its buckets, finest first */
    const [mCo, mCg] = means[keys.find(key => means[key])] || [0, 0];
    const Co = coChannel(mCo), change = 16 * Co - mCo;
    const Cg = cgChannel(mCg + (XY * change / XX | 0)), levels = [Co, Cg];
    XY += change * (16 * Cg - mCg);
    XX += change ** 2;
    for (const key of keys) {
      const mean = means[key];
      means[key] = levels.map((level, i) => mean ? mean[i] + ((16 * level - mean[i]) / 3 | 0) : 16 * level);
    }
    return levels;
  };
};

const CLASS_WEIGHTS = [250, 227, 291, 326, 262, 331, 265, 367, 247, 399, 220, 454, 227, 580, 196, 574, 183, 681, 159, 717, 118, 605, 210, 1534, 167, 1612, 116, 1481, 103, 1790, 73, 1848,
  50, 2130, 34, 2067, 26, 2213, 23, 3332, 16, 2858, 12, 4083, 11, 7182, 10, 13117, 6, 17167, 3, 7821, 4, 15959, 2, 13932, 2, 51780, 1, 49684, 1, 60000, 2, 40000];

/* How many of n points are in the left half. */
const split = (n, A, B) => {
  const weights = [], excess = n * (A - 64) - B + 64, slope = A + B - 128;
  const mode = slope > 0 ? clamp(ceil(excess / slope), 0, n) : excess > 0 && n;
  const numerator = k => (n - k) * (A + 64 * k), denominator = k => (k + 1) * (B + 64 * (n - 1 - k));
  const scaled = (weight, a, b) => floor(weight / b) * a + floor(weight % b * a / b); /* weight * a has up to 57 bits */
  weights[mode] = 2 ** 32;
  for (let k = mode; k < n; k++)
    weights[k + 1] = scaled(weights[k], numerator(k), denominator(k));
  for (let k = mode; k--;)
    weights[k] = scaled(weights[k + 1], denominator(k), numerator(k));
  const total = sum(weights);
  return symbolOf(weights.map(weight => 1 + floor(weight * (65535 - n) / total)));
};

/* The cells of n points in a rectangle of cells: its first column and row, and their numbers. */
const cellsOf = (rectangle, n, priors, pitch) => {
  const k = +(rectangle[2] < rectangle[3]), length = rectangle[k + 2], half = length >> 1;
  const isWide = length > 128, weight = isWide ? 192 : 1024, A = floor(weight * half / length);
  if (!n || !half)
    return list(n, () => rectangle);
  const sides = list(2, side => priors.filter(prior => isWide && side == prior[k] >= 2 * (rectangle[k] + half) * pitch));
  const left = split(n, A + 16 * sides[0].length, weight - A + 16 * sides[1].length);
  return sides.flatMap((near, side) => {
    const part = [...rectangle];
    part[k] += side * half;
    part[k + 2] = side ? length - half : half;
    return cellsOf(part, side ? n - left : left, near, pitch);
  });
};

/* ---- Files ---- */

/* Begins to read bytes or text. */
const open = source => {
  try {
    source = source.trim ? Uint8Array.from(codesOf(atob(source.replace(/[-_]/g, it => it > '-' ? '/' : '+')))) : source;
  } catch {
    source = 0;
  }
  refuse(!(source.byteLength >= 0), 'invalid-argument', 'give bytes or base64');
  bytes = new Uint8Array(source.buffer || source, source.byteOffset, source.byteLength);
  at = code = 0;
  range = 2 ** 32 - 1;
  list(4, takeByte);
};

export const decode = (source, {width, height, isInfo} = {}) => {
  open(source);
  let hasChroma = 1, hasAlpha = 0, hasAnisotropy = 1, hasRotation = 1;
  if (flag(4)) {
    const blend = symbolOf([10, 4, 2]), coding = flag(3), layout = symbolOf([5, 2, 4, 5]), isHigh = flag(4);
    hasChroma = layout > 1 && flag(12);
    hasAlpha = layout % 2 && flag(14);
    refuse(blend + coding + isHigh + flag(6), 'unsupported', `only 'gscl' draws it`);
    hasAnisotropy = flag(14);
    hasRotation = hasAnisotropy && flag(14);
  }
  const hasTexture = flag(12);
  const longer = flag(8) ? 64 * (1 + number(1, 1, 3, 7, 9, 6, 3, 1, 1)) : 1 + number(1, 1, 1, 1, 2, 2, 3, 4, 6, 10, 14, 10, 6, 2, 1);
  const ratio = [0, 1, 2 / 3, 3 / 4, 9 / 16, 5 / 8, 4 / 5, 1 / 2][symbolOf([10, 3, 8, 6, 2, 1, 1, 1])];
  const shorter = ratio ? max(1, round(longer * ratio)) : 1 + symbolOf(longer);
  const own = shorter < longer && flag(6) ? [shorter, longer] : [longer, shorter];
  if (isInfo)
    return {width: own[0], height: own[1]};
  const [w, h] = width || height ? [width, height] : own.map(side => max(1, round(side * min(1, 64 / longer)))); /* 64 pixels */
  refuse([w, h].some(side => !(side > 0) || side % 1), 'invalid-argument', 'give whole pixels');
  refuse(w * h > 2 ** 16, 'limit', `only 'gscl' draws it`);

  const count = number(2, 1, 1, 2, 4, 6, 8, 7, 7, 6, 5, 4, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1);
  /* A split of more points would have a part with equal frequencies; 255 splats of 2^16 pixels take a second at most. */
  refuse(count > 255 || count && flag(1), 'unsupported', `only 'gscl' draws it`);
  const hasSteps = count && flag(2);
  const [scale, position, turn, ...colourSteps] = [6, 8, hasRotation && 4, 5, hasChroma && 3, hasAlpha && 4]
    .map(usual => usual && hasSteps ? symbolOf(16) : usual);
  const [L, chromaL, alphaL] = colourSteps.map(step => [4, 6, 8, 11, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 192, 255][step]);
  const octavesOf = code => code * (scale + 4); /* in 1/32 */
  const sigmaOf = (code, e = octavesOf(code)) => min(2 ** 31, floor(round(2 ** (e % 32 / 32 + 24)) / 512 * 2 ** (e >> 5))); /* 1/65536 pixel */
  let typical = 0;
  while (typical < 63 && floor(sigmaOf(typical) / 256) ** 2 * count < own[0] * own[1] * 65536)
    typical++;
  const d = count && number(8, 4, 4, 2, 1, 1, 1, 1), pivot = clamp(typical + (d % 2 ? ~d : d) / 2, 0, 63);
  const isOwn = !count || flag(2), backgrounds = list(isOwn, () => list(1 + 2 * hasChroma + hasAlpha, () => symbolOf(256) / 255));
  hasChroma || backgrounds.map(it => it.unshift(it[0], it[0]));

  const beyond = L >> 3; /* levels below 0, and above 1 */
  const lumaModel = adaptive(L + 2 * beyond + 1, i => i < beyond || i > L + beyond ? 1 : 5 + 9 * (L + beyond - i) / L, [8, 5, 2.5], 192);
  const alphaModel = adaptive(alphaL + 2 * (alphaL >> 3) + 1, () => 4, [8, 2, .5]), chroma = chromaOf(chromaL);
  const [aspectModel, directionModel, texturedModel, amplitudeModel, waveModel] = trainedModels(), waveDirectionModel = adaptive(16, () => 64, [4, 1.5]);

  const priors = [], sums = new Float64Array(5 * w * h), stepX = own[0] / w, stepY = own[1] / h;
  const boxX = max(0, stepX ** 2 - 1) / 12, boxY = max(0, stepY ** 2 - 1) / 12; /* the variances that reducing adds */
  const addSplat = (cell, major, step) => {
    const sizeRow = clamp(major - typical + 10, 0, 23);
    let aspect = hasAnisotropy && aspectModel(sizeRow, row => symbolOf(row.slice(0, major + 1)));
    if (aspect == 23)
      aspect += symbolOf(major - 22);
    const slimness = 2 ** (octavesOf(aspect) / 32), parts = min(65536, round(slimness));
    const angles = clamp(ceil((slimness - 1 / slimness) * 16 * PI / (turn + 2)), 1, 512);
    let angle = 0;
    if (hasRotation && angles > 1)
      directionModel(min(aspect >> 1, 7), row => {
        const start = bin => ceil(angles * (2 * bin - 1) / 32), codes = bin => start(bin + 1) - start(bin);
        const bin = symbolOf(row.map((it, i) => codes(i) && 1 + (it * codes(i) * floor(65536 / ceil(angles / 16)) >> 16)));
        angle = (start(bin) + symbolOf(codes(bin)) + angles) % angles;
        return bin;
      });
    const isSteep = abs(2 * angle - angles) < angles / 2, part = symbolOf(parts);
    const centre = cell.map((it, k) => isSteep == !k ? floor((2 * (it * parts + part) + 1) * step / parts) : (2 * it + 1) * step); /* 1/512 pixel */

    /* rises where a count of the numbers of the page does */
    const F = clamp(round(3.738 * 2 ** (octavesOf(2 * (major - pivot) - aspect) / 160)), 1, 8), fine = level => level * F + symbolOf(F);
    const Y = fine(lumaModel() - beyond) / L / F;
    const [Co, Cg] = hasChroma ? chroma(...centre.map((it, k) => min(31, it / 16 / own[k] | 0))).map(level => fine(level) / chromaL / F) : [0, 0];
    const B = Y - (Cg + Co) / 2, colour = [B + Co, Y + Cg / 2, B, hasAlpha ? (alphaModel() - (alphaL >> 3)) / alphaL : 1, 1];
    let amplitude = 0, waveX = 0, waveY = 0, phase, directions;
    const v1 = (sigmaOf(major) / 65536) ** 2, v2 = max((sigmaOf(major - aspect) / 65536) ** 2, v1 / 65536);
    if (hasTexture && texturedModel(sizeRow >> 1)) {
      amplitude = min((1 + amplitudeModel()) / L / 1.5, 1) * (v1 <= 2 ** 24);
      const frequency = PI / 1.25 / 2 ** (7 * waveModel() / 16), direction = waveDirectionModel(0, row => symbolOf(directions = row));
      direction % 15 || (directions[15 - direction] += 6); /* they are neighbours */
      phase = symbolOf(8) * PI / 4;
      waveX = cos(direction * PI / 16) * frequency;
      waveY = sin(direction * PI / 16) * frequency;
    }
    isOwn || backgrounds.push(colour);

    const c = cos(angle * PI / angles), s = sin(angle * PI / angles);
    const xx = c * c * v1 + s * s * v2 + boxX, yy = s * s * v1 + c * c * v2 + boxY, xy = c * s * (v1 - v2);
    const determinant = xx * yy - xy ** 2, weight = (v1 * v2 / determinant) ** .5; /* what reducing widens weighs as much as before */
    amplitude *= exp(-(waveX ** 2 * boxX + waveY ** 2 * boxY) / 2);
    for (let j = 0, at = 0; j < h; j++)
      for (let i = 0; i < w; i++, at += 5) {
        const x = stepX * (i + .5) - centre[0] / 512, y = stepY * (j + .5) - centre[1] / 512;
        const q = (yy * x ** 2 / 2 - xy * x * y + xx * y ** 2 / 2) / determinant;
        if (q < 7) {
          const g = weight * (exp(-q) - exp(-7)), wave = amplitude && amplitude * cos(waveX * x + waveY * y - phase);
          for (let k = 0; k < 5; k++)
            sums[at + k] += g * (colour[k] + (k < 3 ? wave : 0));
        }
      }
  };

  let left = count;
  const counts = list(64, i => {
    const n = left && i < 63 ? split(left, ...CLASS_WEIGHTS.slice(2 * clamp(75 - i - typical, 0, 31))) : left;
    left -= n;
    return n;
  });
  counts.forEach((n, i) => {
    const step = max(8, floor(sigmaOf(63 - i) * (position + 2) / 8192));
    for (const cell of cellsOf([0, 0, ...own.map(side => ceil(side * 256 / step))], n, priors, step)) {
      addSplat(cell, 63 - i, step);
      priors.push(cell.map(it => (2 * it + 1) * step));
    }
  });
  refuse(at != bytes.length + 3, at < bytes.length + 3 ? 'corrupt' : 'truncated');

  const background = list(5, k => sum(backgrounds.map(it => it[k] ?? 1)) / backgrounds.length);
  const data = new Uint8ClampedArray(4 * w * h).map((_, i) => {
    const at = 5 * (i >> 2), value = k => sums[at + k] + background[k] / 1024, alpha = clamp(value(3) / value(4), 0, 1);
    return 255 * (i % 4 > 2 ? alpha : alpha && value(i % 4) / value(4) / alpha);
  });
  return globalThis.ImageData ? new ImageData(data, w) : {width: w, height: h, data};
};
export const info = source => decode(source, {isInfo: 1});
