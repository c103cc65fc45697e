// Reads the picture's pixels: their values, and the six statistics of the window around them, as a landmark's
// search would see them. Holding the picture makes it lossless and keeps it still.

import { byId, setAttribute, setText } from "./dom.js";
import { hold, isHeld, restartLive } from "./live.js";
import { isReduced } from "./picture.js";
import { known } from "./state.js";
import { compare } from "./statistics.js";

/** Side of the window where there is no landmark to take it from, in frame pixels. */
const DEFAULT_WINDOW_PX = 6;

const canvas = /** @type {HTMLCanvasElement} */ (byId("picture"));

/** The pixel under the cursor. @type {{x: number, y: number} | null} */
let at = null;

/** Wires the controls of the picture. */
export function startProbe() {
  byId("hold").addEventListener("click", () => {
    hold(!isHeld());
    byId("hold").setAttribute("aria-pressed", String(isHeld()));
    /** @type {HTMLButtonElement} */ (byId("step")).disabled = !isHeld();
  });
  byId("step").addEventListener("click", restartLive);
  byId("zoom").addEventListener("change", zoom);
  canvas.addEventListener("framesize", zoom);
  canvas.addEventListener("pointermove", (event) => moveTo(...pixelUnder(event)));
  canvas.addEventListener("keydown", onKey);
}

function zoom() {
  const factor = Number(/** @type {HTMLSelectElement} */ (byId("zoom")).value);
  byId("stage").classList.toggle("zoomed", factor > 0);
  for (const one of [canvas, byId("drawing"), byId("marks")]) one.style.width = factor > 0 ? `${canvas.width * factor}px` : "";
}

/** The frame is fitted into the element without distortion, so there may be margins. @param {PointerEvent} event @returns {[number, number]} */
export function pixelUnder(event) {
  const box = canvas.getBoundingClientRect();
  const scale = Math.min(box.width / canvas.width, box.height / canvas.height);
  const left = box.left + (box.width - canvas.width * scale) / 2;
  const top = box.top + (box.height - canvas.height * scale) / 2;
  return [Math.floor((event.clientX - left) / scale), Math.floor((event.clientY - top) / scale)];
}

/** @param {KeyboardEvent} event */
function onKey(event) {
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const step = steps[/** @type {keyof typeof steps} */ (event.key)];
  if (!step) return;
  const far = event.shiftKey ? 10 : 1;
  const from = at ?? { x: canvas.width >> 1, y: canvas.height >> 1 };
  moveTo(from.x + step[0] * far, from.y + step[1] * far);
  event.preventDefault();
}

/** @param {number} x @param {number} y */
function moveTo(x, y) {
  at = { x: Math.min(Math.max(x, 0), canvas.width - 1), y: Math.min(Math.max(y, 0), canvas.height - 1) };
  showProbe();
}

/** Says what is under the cursor. */
export function showProbe() {
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  if (!at || !pen || !canvas.dataset.sequence) return;
  const [r, g, b] = pen.getImageData(at.x, at.y, 1, 1).data;
  const window = windowStatistics(pen, at.x, at.y, windowSide());
  const words = [
    `Pixel ${at.x + 0.5}, ${at.y + 0.5}: R ${r}, G ${g}, B ${b} levels.`,
    window
      ? `Window ${windowSide()} × ${windowSide()} px: mean ${rounded(window.mean)} levels, variance ${rounded(window.variance)} levels². ${verdict(window)}`
      : "The window does not lie wholly inside the picture.",
    known.layersOn.has("mask") ? "The mask is drawn into the pixels: switch it off to read the bare frame." : "",
    isReduced() ? "The picture is smaller than the frame: hold it, or have it as sent, to read the frame's own pixels." : "",
  ];
  // While pictures run, the values change faster than anybody can be told.
  setAttribute(byId("probe"), "aria-live", isHeld() ? "polite" : "off");
  setText(byId("probe"), words.join(" ").trim());
}

/** A landmark's window counts samples of the doubled grid: half as many frame pixels. */
function windowSide() {
  const side = known.landmarks[0]?.window_px[0];
  return side ? Math.max(1, Math.round(side / 2)) : DEFAULT_WINDOW_PX;
}

/** @param {CanvasRenderingContext2D} pen @param {number} x @param {number} y @param {number} side */
function windowStatistics(pen, x, y, side) {
  const [left, top] = [x - (side >> 1), y - (side >> 1)];
  if (left < 0 || top < 0 || left + side > canvas.width || top + side > canvas.height) return null;
  const { data } = pen.getImageData(left, top, side, side);
  const count = side * side;
  const channel = (/** @type {number} */ offset) => {
    let sum = 0;
    let squares = 0;
    for (let index = offset; index < data.length; index += 4) {
      sum += data[index];
      squares += data[index] ** 2;
    }
    const mean = sum / count;
    return { mean, variance: squares / count - mean ** 2 };
  };
  const channels = [0, 1, 2].map(channel);
  return { mean: channels.map((one) => one.mean), variance: channels.map((one) => one.variance) };
}

/** @param {number[]} values */
const rounded = (values) => values.map((value) => value.toFixed(0)).join(", ");

/** Which landmark this window would match, or the one it is nearest to. @param {import("./statistics.js").Statistics} window */
function verdict(window) {
  const outside = known.landmarks.map((landmark) => {
    const { mean, variance } = compare(landmark, window, {});
    return { id: landmark.id, count: [...mean, ...variance].filter((one) => one.within === false).length };
  });
  outside.sort((a, b) => a.count - b.count);
  const [best] = outside;
  if (!best) return "";
  return best.count === 0 ? `It matches ${best.id}.` : `Nearest is ${best.id}, with ${best.count} of 6 outside.`;
}
