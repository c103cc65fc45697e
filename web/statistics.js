// The six statistics of thesis 4.0.1: expected ± tolerance against observed.

/** @typedef {{mean: number[], variance: number[]}} Statistics */
/** @typedef {{expected: number, tolerance: number, isUpperBound: boolean, observed: number | null, offBy: number | null, within: boolean | null}} Comparison an upper bound is met by anything below */

/** @typedef {{gain?: number | null, haze?: number | null, tolerance_scale?: number | null, noise_variance?: number[] | null}} Adaptation how the registration adapted to a frame; nothing of it in faithful mode */

/**
 * Compares what was observed with the nearest shade, as the registration did: under another light haze adds to the
 * means, which scale with the gain, and the variances with its square, tolerances of the means are wider, and the camera's noise comes on top. There an object
 * that is smoother than it was when it was learned, since it is blurred or far away, is none the less the same.
 * @param {{shades: Statistics[], tolerance: Statistics}} landmark @param {Statistics | null | undefined} observed @param {Adaptation} adaptation
 */
export function compare(landmark, observed, { gain, haze, tolerance_scale, noise_variance }) {
  const isAdapted = typeof gain === "number" && gain > 0;
  const shades = landmark.shades.map((shade) => (isAdapted ? inLight(shade, { gain, haze: haze ?? 0 }, noise_variance ?? [0, 0, 0]) : shade));
  const tolerance = { ...landmark.tolerance, mean: landmark.tolerance.mean.map((mean) => mean * (tolerance_scale ?? 1)) };
  // The gain is that of the shade whose colour is nearest; without one all six statistics decide.
  const index = observed ? nearest(shades, tolerance, observed, isAdapted ? ["mean"] : ["mean", "variance"]) : 0;
  const side = (/** @type {"mean" | "variance"} */ kind) => [0, 1, 2].map((channel) => {
    const [expected, allowed, found] = [shades[index][kind][channel], tolerance[kind][channel], observed?.[kind]?.[channel]];
    return isAdapted && kind === "variance" ? atMost(expected, allowed, found) : around(expected, allowed, found);
  });
  return { shade: index + 1, shades: shades.length, mean: side("mean"), variance: side("variance") };
}

/** @param {Statistics} shade @param {{gain: number, haze: number}} light @param {number[]} noise @returns {Statistics} */
function inLight(shade, { gain, haze }, noise) {
  return {
    mean: shade.mean.map((value) => Math.min(255, Math.min(255, Math.max(0, value + haze)) * gain)),
    variance: shade.variance.map((value, channel) => value * gain * gain + noise[channel]),
  };
}

/** @param {number} expected @param {number} tolerance @param {number | undefined} observed @returns {Comparison} */
function around(expected, tolerance, observed) {
  const bound = { expected, tolerance, isUpperBound: false };
  if (typeof observed !== "number") return { ...bound, observed: null, offBy: null, within: null };
  const difference = observed - expected;
  const within = Math.abs(difference) <= tolerance;
  return { ...bound, observed, offBy: within ? 0 : difference - Math.sign(difference) * tolerance, within };
}

/** @param {number} expected @param {number} tolerance @param {number | undefined} observed @returns {Comparison} */
function atMost(expected, tolerance, observed) {
  const bound = { expected, tolerance, isUpperBound: true };
  if (typeof observed !== "number") return { ...bound, observed: null, offBy: null, within: null };
  const offBy = Math.max(0, observed - expected - tolerance);
  return { ...bound, observed, offBy, within: offBy === 0 };
}

/**
 * The shade whose worst statistic is least far out.
 * @param {Statistics[]} shades @param {Statistics} tolerance @param {Statistics} observed @param {("mean" | "variance")[]} kinds
 */
function nearest(shades, tolerance, observed, kinds) {
  const worst = shades.map((shade) => Math.max(...kinds.flatMap((kind) =>
    shade[kind].map((value, channel) => Math.abs(observed[kind][channel] - value) / Math.max(tolerance[kind][channel], 1e-6)))));
  return worst.indexOf(Math.min(...worst));
}
