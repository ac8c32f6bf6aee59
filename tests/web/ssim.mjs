// SPDX-License-Identifier: Apache-2.0
// Comparison of pictures { width, height, data: straight-alpha RGBA }.
// SSIM: Wang et al. 2004 on BT.601 luma (as native/lab/measure), 11×11 Gaussian window (sigma 1.5), K1 = 0.01, K2 = 0.03, range 255.
const kWindow = Float64Array.from({ length: 11 }, (_, i) => Math.exp(-((i - 5) ** 2) / (2 * 1.5 ** 2)));
const kSum = kWindow.reduce((a, b) => a + b);
const kGrey = 128;

/** Luma 0..255 of the picture over mid-grey. */
export function lumaOverGrey({ data }) {
  const out = new Float64Array(data.length / 4);
  for (let i = 0; i < out.length; ++i) {
    const a = data[4 * i + 3] / 255;
    const y = 0.299 * data[4 * i] + 0.587 * data[4 * i + 1] + 0.114 * data[4 * i + 2];
    out[i] = a * y + (1 - a) * kGrey;
  }
  return out;
}

// Gaussian mean; borders repeat the edge pixel.
function blur(field, width, height) {
  const pass = (from, step, count, lineStep, lines) => {
    const to = new Float64Array(from.length);
    for (let line = 0; line < lines; ++line) {
      for (let i = 0; i < count; ++i) {
        let sum = 0;
        for (let k = 0; k < 11; ++k) {
          sum += kWindow[k] * from[line * lineStep + Math.min(count - 1, Math.max(0, i + k - 5)) * step];
        }
        to[line * lineStep + i * step] = sum / kSum;
      }
    }
    return to;
  };
  return pass(pass(field, 1, width, width, height), width, height, 1, width);
}

/** Mean SSIM over the whole picture, and over the pixels that either picture covers (alpha > 0.5). */
export function ssim(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error(`sizes differ: ${a.width}×${a.height}, ${b.width}×${b.height}`);
  const { width, height } = a;
  const x = lumaOverGrey(a), y = lumaOverGrey(b);
  const mean = (f) => blur(Float64Array.from(x, (_, i) => f(x[i], y[i])), width, height);
  const mx = mean((p) => p), my = mean((_, q) => q);
  const xx = mean((p) => p * p), yy = mean((_, q) => q * q), xy = mean((p, q) => p * q);
  const c1 = (0.01 * 255) ** 2, c2 = (0.03 * 255) ** 2;
  let all = 0, inside = 0, count = 0;
  for (let i = 0; i < x.length; ++i) {
    const vx = xx[i] - mx[i] ** 2, vy = yy[i] - my[i] ** 2, cov = xy[i] - mx[i] * my[i];
    const s = ((2 * mx[i] * my[i] + c1) * (2 * cov + c2)) / ((mx[i] ** 2 + my[i] ** 2 + c1) * (vx + vy + c2));
    all += s;
    if (a.data[4 * i + 3] > 127 || b.data[4 * i + 3] > 127) {
      inside += s;
      ++count;
    }
  }
  return { all: all / x.length, foreground: count ? inside / count : 0 };
}

/** Fraction of pixels with alpha > 0.5. */
export function coverage({ data }) {
  let covered = 0;
  for (let i = 3; i < data.length; i += 4) covered += data[i] > 127;
  return covered / (data.length / 4);
}

/** Standard deviation of luma inside the silhouette, 0..255: near 0 for a figure of one colour. */
export function textureContrast(picture) {
  const luma = lumaOverGrey(picture).filter((_, i) => picture.data[4 * i + 3] > 127);
  const mean = luma.reduce((a, b) => a + b, 0) / luma.length;
  return Math.sqrt(luma.reduce((a, b) => a + (b - mean) ** 2, 0) / luma.length);
}
