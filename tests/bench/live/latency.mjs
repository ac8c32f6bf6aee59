// SPDX-License-Identifier: Apache-2.0
// Capture times from the numbers painted on pictures. Stages play their videos by the wall clock: in the k-th frame
// period since 1970 all cameras show picture k modulo `pictures` (native/live/camera/source.cpp). A number read from a
// picture and its arrival time therefore give the capture time, without a clock in the messages.

/** Capture time, ms since 1970, of the picture `number` that arrived at `arrivedMs`. */
export function capturedMs(number, arrivedMs, { fps, pictures }) {
  const last = Math.floor(arrivedMs * fps / 1000);
  const behind = (((last - number) % pictures) + pictures) % pictures;
  return (last - behind) * 1000 / fps;
}

export function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : NaN;
}
export const median = (values) => quantile(values, 0.5);
export const mean = (values) => (values.length ? values.reduce((sum, v) => sum + v, 0) / values.length : NaN);

/** The most frequent number among a frame's cameras; null: none is readable. */
export function numberOf(frame) {
  const votes = new Map();
  for (const { counter } of frame.cameras) if (counter !== null) votes.set(counter, (votes.get(counter) ?? 0) + 1);
  return [...votes].sort((a, b) => b[1] - a[1])[0]?.[0] ?? null;
}

/** Rows for frames with a readable number, from `fourdvt-lab stream`'s output and the messages' arrival times. */
export function rowsOf(recorded, arrivalsMs, stage) {
  return recorded.frames.flatMap((frame, i) => {
    const number = numberOf(frame), ms = arrivalsMs[i];
    if (number === null) return [];
    const captured = capturedMs(number, ms, stage), read = frame.cameras.filter(({ counter }) => counter !== null);
    return [{ ms, captured, latency: ms - captured, stampError: frame.captured_us / 1000 - captured, triangles: frame.triangles, bytes: frame.bytes, surface: frame.surface_bytes,
      shown: frame.cameras.filter(({ shown }) => shown).length, read: read.length, others: read.filter(({ counter }) => counter !== number).length,
      paired: frame.barcode === frame.number % 4096, cameras: frame.cameras }];
  });
}

/** Slope of y over x by least squares, and its standard error. */
export function slope(xs, ys) {
  const mx = mean(xs), my = mean(ys), sxx = xs.reduce((sum, x) => sum + (x - mx) ** 2, 0);
  const b = xs.reduce((sum, x, i) => sum + (x - mx) * (ys[i] - my), 0) / sxx;
  const rest = xs.reduce((sum, x, i) => sum + (ys[i] - my - b * (x - mx)) ** 2, 0);
  return { slope: b, error: Math.sqrt(rest / Math.max(1, xs.length - 2) / sxx) };
}
