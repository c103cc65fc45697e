// Figures and states as words. What is missing is "—", never 0.

export const MISSING = "—";

/** @param {number | null | undefined} value @param {number} digits @param {string} [unit] */
export function figure(value, digits, unit = "") {
  if (typeof value !== "number" || !Number.isFinite(value)) return MISSING;
  return unit ? `${value.toFixed(digits)} ${unit}` : value.toFixed(digits);
}

/** A duration at the precision a person needs. @param {number | null | undefined} seconds */
export function duration(seconds) {
  if (typeof seconds !== "number" || !Number.isFinite(seconds)) return MISSING;
  if (seconds < 1) return `${Math.round(seconds * 1000)} ms`;
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 120) return `${Math.round(seconds)} s`;
  if (seconds < 7200) return `${Math.round(seconds / 60)} min`;
  return `${Math.round(seconds / 3600)} h`;
}

/** Words of a program as a sentence. @param {string} words */
export function sentence(words) {
  const whole = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!?…]$/.test(whole) ? whole : `${whole}.`;
}

/** A place in a recording, as players show it. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.max(0, seconds);
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const tail = `${String(minutes).padStart(2, "0")}:${rest.toFixed(1).padStart(4, "0")}`;
  return hours > 0 ? `${hours}:${tail}` : tail;
}

/** How long ago, without figures that change too fast to read. @param {number} seconds */
export function ago(seconds) {
  return seconds < 1 ? "under 1 s ago" : `${duration(Math.floor(seconds))} ago`;
}

/** @param {number | null | undefined} count */
export function bytes(count) {
  if (typeof count !== "number" || !Number.isFinite(count)) return MISSING;
  const units = ["B", "kB", "MB", "GB", "TB"];
  let step = 0;
  let value = count;
  while (value >= 1000 && step < units.length - 1) {
    value /= 1000;
    step += 1;
  }
  return `${value.toFixed(step === 0 || value >= 100 ? 0 : 1)} ${units[step]}`;
}

/** @type {Record<string, (miss: Record<string, any>) => string>} */
const MISSES = {
  outside_frame: () => "expected outside the picture",
  no_colour: (miss) => `no part of the picture has its colours${nearest(miss)}`,
  too_small: () => "too small to measure",
  wrong_shape: (miss) => `colour fits, outline does not${fit(miss)}`,
  outside_gate: (miss) =>
    `something alike ${figure(miss.innovation_px, 0, "px")} from where it should be: too far to be it`,
  occluded: (miss) => `covered: ${percent(miss.visible)} of it still seen`,
  skipped: () => "not looked for: this frame's share of work was used up",
};

/** Misses that say nothing against the landmark: it was not to be seen, or not looked for. */
const NOT_TO_BE_SEEN = new Set(["outside_frame", "skipped"]);

/** How grave a result is. @param {string} result @returns {import("./dom.js").Level} */
export function levelOf(result) {
  if (result === "measured") return "good";
  return NOT_TO_BE_SEEN.has(result) ? "warn" : "bad";
}

/** Why a landmark was not measured. @param {string} result @param {Record<string, any> | null} [miss] */
export function missInWords(result, miss) {
  const words = MISSES[result];
  return words ? words(miss ?? {}) : result.replaceAll("_", " ");
}

/** @param {Record<string, any>} miss */
function nearest(miss) {
  if (typeof miss.excess !== "number") return "";
  return `; the nearest is ${miss.excess.toFixed(1)} tolerances off`;
}

/** @param {Record<string, any>} miss */
function fit(miss) {
  const score = miss.shape_score ?? miss.score;
  return typeof score === "number" ? ` (fit ${score.toFixed(2)})` : "";
}

/** @param {number | null | undefined} part */
export function percent(part) {
  return typeof part === "number" ? `${Math.round(part * 100)} %` : MISSING;
}
