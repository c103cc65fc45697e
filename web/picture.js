// The place of the picture: its pixels on one canvas, what was seen in it on another above, put there together.

import { byId } from "./dom.js";
import { drawSeen } from "./drawing.js";
import { known } from "./state.js";

/** @typedef {{sequence: number, ageMs: number, at: number, width: number, height: number, seen: import("./drawing.js").Seen | null}} Shown */

/** More than this no screen shows and not every browser draws. */
const MOST_CANVAS_PX = 4096;

const canvas = /** @type {HTMLCanvasElement} */ (byId("picture"));
const drawing = /** @type {HTMLCanvasElement} */ (byId("drawing"));

/** @type {Shown | null} */
let shown = null;

/** Where the picture has its place on the page, CSS pixels. */
let place = { width: 0, height: 0 };

new ResizeObserver(([entry]) => {
  place = entry.contentRect;
  redraw();
}).observe(canvas);

/** What is on the screen. */
export function shownPicture() {
  return shown;
}

/** The next picture is the first of its camera. */
export function forgetPicture() {
  shown = null;
}

/** Whether the picture has fewer pixels than the frame that it shows. */
export function isReduced() {
  return shown?.seen ? shown.seen.frame_px[0] > shown.width : false;
}

/** @param {import("./api.js").Picture} picture */
export function showPicture({ bitmap, sequence, ageMs, seen }) {
  if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
    canvas.dispatchEvent(new Event("framesize"));
  }
  canvas.getContext("2d", { willReadFrequently: true })?.drawImage(bitmap, 0, 0);
  shown = { sequence, ageMs, at: performance.now(), width: bitmap.width, height: bitmap.height, seen };
  bitmap.close();
  redraw();
  canvas.dataset.sequence = String(sequence);
}

/** Draws what was seen anew, with the layers that are wanted now. */
export function redraw() {
  const pen = drawing.getContext("2d");
  if (!pen || !shown || place.width === 0) return;
  const { width, height, seen } = shown;
  const cssPerPx = Math.min(place.width / width, place.height / height);
  const perPx = Math.min(cssPerPx * devicePixelRatio, MOST_CANVAS_PX / Math.max(width, height));
  const [wide, high] = [Math.round(width * perPx), Math.round(height * perPx)];
  if (drawing.width !== wide || drawing.height !== high) Object.assign(drawing, { width: wide, height: high });
  else pen.clearRect(0, 0, wide, high);
  drawing.dataset.sequence = seen ? String(seen.sequence) : "";
  if (!seen) return;
  // Readable at arm's length also where the page is larger: what is written grows with the page's own letters.
  const perCssPx = (perPx / cssPerPx) * (parseFloat(getComputedStyle(document.documentElement).fontSize) / 16);
  drawSeen(pen, seen, known.layersOn, { perFramePx: (perPx * width) / seen.frame_px[0], perCssPx });
}
