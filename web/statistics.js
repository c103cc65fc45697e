// The six statistics of thesis 4.0.1: expected ± tolerance against observed.

/** @typedef {{mean: number[], variance: number[]}} Statistics */
/** @typedef {{expected: number, tolerance: number, observed: number | null, offBy: number | null, within: boolean | null}} Comparison */

/**
 * Compares what was observed with the nearest shade. Under another light the means scale with the gain and the
 * variances with its square; in faithful mode there is no gain and the descriptor stands as it is.
 * @param {{shades: Statistics[], tolerance: Statistics}} landmark @param {Statistics | null | undefined} observed @param {number | null | undefined} gain
 */
export function compare(landmark, observed, gain) {
  const factor = typeof gain === "number" && gain > 0 ? gain : 1;
  const shades = landmark.shades.map((shade) => scaled(shade, factor));
  const index = observed ? nearest(shades, landmark.tolerance, observed) : 0;
  const shade = shades[index];
  const side = (/** @type {"mean" | "variance"} */ kind) =>
    [0, 1, 2].map((channel) => one(shade[kind][channel], landmark.tolerance[kind][channel], observed?.[kind]?.[channel]));
  return { shade: index + 1, shades: shades.length, mean: side("mean"), variance: side("variance") };
}

/** @param {Statistics} shade @param {number} gain @returns {Statistics} */
function scaled(shade, gain) {
  return {
    mean: shade.mean.map((value) => Math.min(255, value * gain)),
    variance: shade.variance.map((value) => value * gain * gain),
  };
}

/** @param {number} expected @param {number} tolerance @param {number | undefined} observed @returns {Comparison} */
function one(expected, tolerance, observed) {
  if (typeof observed !== "number") return { expected, tolerance, observed: null, offBy: null, within: null };
  const difference = observed - expected;
  const within = Math.abs(difference) <= tolerance;
  const offBy = within ? 0 : difference - Math.sign(difference) * tolerance;
  return { expected, tolerance, observed, offBy, within };
}

/** The shade whose worst statistic is least far out. @param {Statistics[]} shades @param {Statistics} tolerance @param {Statistics} observed */
function nearest(shades, tolerance, observed) {
  const worst = shades.map((shade) => Math.max(...(/** @type {const} */ (["mean", "variance"])).flatMap((kind) =>
    shade[kind].map((value, channel) => Math.abs(observed[kind][channel] - value) / Math.max(tolerance[kind][channel], 1e-6)))));
  return worst.indexOf(Math.min(...worst));
}
