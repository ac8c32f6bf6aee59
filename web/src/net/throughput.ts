// SPDX-License-Identifier: Apache-2.0
// Network throughput of the latest transfers, from the page's resource timing.

const RECENT_MS = 10_000;
const RAMP_MS = 50; // added to the times: short bursts overstate the throughput

/** Throughput, bits per second; 0 if unknown: only transfers from caches, or from servers that do not allow timing. */
export function throughput(): number {
  const since = performance.now() - RECENT_MS;
  const resources = (performance.getEntriesByType('resource') as PerformanceResourceTiming[])
    .filter(({ transferSize, responseStart, responseEnd }) => transferSize > 0 && responseStart > since && responseEnd > responseStart)
    .sort((a, b) => a.responseStart - b.responseStart);
  let bytes = 0, busyMs = 0, end = 0;
  for (const { transferSize, responseStart, responseEnd } of resources) {
    bytes += transferSize;
    busyMs += Math.max(0, responseEnd - Math.max(end, responseStart));
    end = Math.max(end, responseEnd);
  }
  return bytes && (8000 * bytes) / (busyMs + RAMP_MS);
}
