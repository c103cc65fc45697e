// The last minute of each figure that is plotted.

export const SPAN_S = 60;

/** Lines in one plot; more cannot be told apart. */
export const MAX_LINES = 6;

/** @typedef {{at: number, value: number | null}} Sample */

/**
 * What is plotted: a name, a unit, the top of the scale where it is fixed, and the values that one camera entry gives, by line.
 * @type {{name: string, unit: string, digits: number, top?: number, values: (camera: any) => [string, number | null][]}[]}
 */
export const PLOTS = [
  { name: "Off prediction", unit: "px", digits: 1, values: (camera) => perLandmark(camera, "innovation_px") },
  { name: "Area", unit: "px²", digits: 0, values: (camera) => perLandmark(camera, "area_px2") },
  { name: "Score", unit: "", digits: 2, top: 1, values: (camera) => perLandmark(camera, "score") },
  {
    name: "Delay",
    unit: "ms",
    digits: 1,
    values: (camera) => [["capture to result", camera.latency_ms ?? null], ["of it here", camera.processing_ms ?? null]],
  },
  { name: "Frame rate", unit: "fps", digits: 1, values: (camera) => [["registered", camera.fps ?? null]] },
  {
    name: "Frames lost so far",
    unit: "",
    digits: 0,
    values: (camera) => Object.entries(camera.dropped ?? {}).map(([reason, count]) => [reason, Number(count)]),
  },
];

/** By camera, plot and line. @type {Map<string, Map<string, Sample[]>[]>} */
const histories = new Map();

/** @param {any} camera @param {string} field @returns {[string, number | null][]} */
function perLandmark(camera, field) {
  return (camera.landmarks ?? []).slice(0, MAX_LINES).map((/** @type {any} */ entry) => {
    const name = entry.instance > 0 ? `${entry.id} #${entry.instance}` : entry.id;
    return [name, typeof entry[field] === "number" ? entry[field] : null];
  });
}

/** Adds one entry of a camera, `at` ms of performance.now(). @param {any} camera @param {number} at */
export function remember(camera, at) {
  let lines = histories.get(camera.id);
  if (!lines) {
    lines = PLOTS.map(() => new Map());
    histories.set(camera.id, lines);
  }
  PLOTS.forEach((plot, index) => {
    for (const [name, value] of plot.values(camera)) {
      const samples = lines[index].get(name) ?? [];
      samples.push({ at, value });
      while (samples.length > 0 && samples[0].at < at - SPAN_S * 1000) samples.shift();
      lines[index].set(name, samples);
    }
  });
}

/** The lines of one plot, without those that have ended. @param {string} camera @param {number} plot @param {number} now @returns {[string, Sample[]][]} */
export function linesOf(camera, plot, now) {
  const lines = histories.get(camera)?.[plot];
  if (!lines) return [];
  for (const [name, samples] of lines) {
    if (samples.length === 0 || samples[samples.length - 1].at < now - SPAN_S * 1000) lines.delete(name);
  }
  return [...lines].slice(0, MAX_LINES);
}

/** The sample nearest to a moment, within a second of it. @param {Sample[]} samples @param {number} at */
export function valueAt(samples, at) {
  let low = 0;
  let high = samples.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (samples[middle].at < at) low = middle + 1;
    else high = middle;
  }
  const candidates = [samples[low - 1], samples[low]].filter(Boolean);
  candidates.sort((a, b) => Math.abs(a.at - at) - Math.abs(b.at - at));
  const best = candidates[0];
  return best && Math.abs(best.at - at) < 1000 ? best.value : null;
}
