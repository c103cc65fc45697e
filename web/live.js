// The live picture: asked for frame by frame, so that what is drawn and what is said belong to the same frame.

import { Problem, getPicture, nextPicture, recordedPicture } from "./api.js";
import { byId, make, reconcile, setAttribute, setText } from "./dom.js";
import { nextFrame, playback } from "./playback.js";
import { STALE_AFTER_MS, known, shownEntry } from "./state.js";
import { lesson, lessonPath } from "./lesson.js";
import { duration, figure } from "./words.js";

const LAYER_NAMES = {
  outline: "Outline",
  segments: "Hough segments",
  vector: "Vector from origin",
  prediction: "Prediction",
  gate: "Gate",
  mask: "Mask",
  labels: "Labels",
};

/** Layers that hide what they cover are off until asked for. */
const OFF_AT_FIRST = new Set(["mask"]);

const keptLayers = new Map();
const keptCameras = new Map();

/** What the picture on the screen is. @type {{sequence: number, ageMs: number, at: number, width: number, height: number} | null} */
let shown = null;
/** Times of the last pictures, for the rate. @type {number[]} */
let times = [];
/** Width of the frames themselves: that of the first picture, which is asked for without a width. */
let frameWidthPx = 0;
let held = false;
let loop = new AbortController();

/** Starts, or starts anew with other layers or another camera; a held picture gives way to one later frame. */
export function restartLive() {
  loop.abort();
  times = [];
  loop = new AbortController();
  if (known.camera && known.layers && !document.hidden) void run(known.camera, loop.signal);
}

/** Whether the picture stands still. */
export function isHeld() {
  return held;
}

/** Whether it is no live picture, and not meant to be one. */
function isStill() {
  return held || playback() !== null || lesson() !== null;
}

/** Holds the next frame, every pixel of it, or lets the picture run again. @param {boolean} wanted */
export function hold(wanted) {
  held = wanted;
  restartLive();
}

/** @param {string} camera @param {AbortSignal} stop */
async function run(camera, stop) {
  let after = playback() ? null : (shown?.sequence ?? null);
  while (!stop.aborted) {
    try {
      if (lesson()) return await showLesson(stop);
      after = playback() ? await showRecorded(after, stop) : await showNext(camera, after, stop);
      if (held && !playback()) return;
    } catch (error) {
      if (stop.aborted) return;
      if (error instanceof Problem) explain(error.message);
      else explain("The service does not answer");
      await pause(500, stop);
    }
  }
}

/** @param {string} camera @param {number | null} after @param {AbortSignal} stop */
async function showNext(camera, after, stop) {
  const picture = await nextPicture(camera, after, wanted(held), stop);
  if (!stop.aborted) draw(picture);
  return picture.sequence;
}

/** @param {number | null} after @param {AbortSignal} stop */
async function showRecorded(after, stop) {
  const frame = await nextFrame(after, stop);
  const recording = playback();
  if (frame === null || !recording) return after;
  const { picture, entry } = await recordedPicture(recording, frame, wanted(!recording.running), stop);
  if (stop.aborted) return frame;
  known.playbackEntry = { id: recording.camera, landmarks: entry.registration?.landmarks ?? [], registered: entry.registration !== null };
  draw(picture);
  byId("picture").dataset.frame = String(frame);
  return frame;
}

/** The picture that somebody learns from stands until another one is wanted. @param {AbortSignal} stop */
async function showLesson(stop) {
  const picture = await getPicture(lessonPath(), stop);
  if (!stop.aborted) draw(picture);
}

/** A picture that stands still is shown with every pixel. @param {boolean} isStill @returns {import("./api.js").Wanted} */
function wanted(isStill) {
  return { layers: [...known.layersOn], format: isStill ? "png" : "jpg", widthPx: isStill ? 0 : wantedWidth() };
}

/** No more pixels than the screen shows: the service sends less and the browser scales less. 0 is the frame's own. */
function wantedWidth() {
  if (byId("stage").classList.contains("zoomed")) return 0;
  const shownPx = Math.round(byId("stage").clientWidth * devicePixelRatio);
  const width = [320, 480, 640, 960, 1280, 1920].find((width) => width >= shownPx) ?? 0;
  return width < frameWidthPx ? width : 0;
}

/** @param {number} ms @param {AbortSignal} stop */
function pause(ms, stop) {
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, ms);
    stop.addEventListener("abort", () => {
      clearTimeout(timer);
      resolve(undefined);
    });
  });
}

/** @param {import("./api.js").Picture} picture */
function draw(picture) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("picture"));
  const { bitmap } = picture;
  frameWidthPx ||= bitmap.width;
  if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
    canvas.dispatchEvent(new Event("framesize"));
  }
  canvas.getContext("2d", { willReadFrequently: true })?.drawImage(bitmap, 0, 0);
  shown = { sequence: picture.sequence, ageMs: picture.ageMs, at: performance.now(), width: bitmap.width, height: bitmap.height };
  bitmap.close();
  canvas.dataset.sequence = String(picture.sequence);
  times.push(shown.at);
  byId("stage").classList.remove("old");
  byId("stage").classList.toggle("held", held && !playback());
  byId("picture-state").hidden = true;
}

/** Veils the picture: it is not live, and says why. @param {string} why */
function explain(why) {
  byId("stage").classList.add("old");
  const state = byId("picture-state");
  state.hidden = false;
  setText(state, why);
}

/** Shows what belongs to the picture and is not drawn into it. */
export function showLive() {
  const now = performance.now();
  times = times.filter((time) => now - time < 2000);
  if (shown) {
    const ageMs = shown.ageMs + now - shown.at;
    if (ageMs > STALE_AFTER_MS && !isStill()) explain(`Not live: this picture is ${duration(ageMs / 1000)} old`);
    const rate = times.length > 1 ? ((times.length - 1) * 1000) / (times[times.length - 1] - times[0]) : null;
    const pace = playback() ? "recorded" : lesson() ? "taken to learn from" : held ? "held" : figure(rate, 0, "fps shown");
    const unseen = known.playbackEntry?.registered === false ? " · was not registered" : "";
    setText(byId("frame-facts"), `frame ${shown.sequence} · ${pace} · ${shown.width} × ${shown.height} px${unseen}`);
  }
  setAttribute(byId("picture"), "aria-label", describe());
  showCameraChoice();
}

function describe() {
  const camera = shownEntry();
  if (!camera || !shown) return "No picture yet";
  const seen = (camera.landmarks ?? []).filter((/** @type {any} */ entry) => entry.result === "measured");
  const names = [...new Set(seen.map((/** @type {any} */ entry) => entry.id))].join(", ");
  return `${playback() ? "Recorded" : held ? "Held" : "Live"} picture of camera ${camera.id}; ${names ? `measured: ${names}` : "no landmark measured"}`;
}

/** Offers the layers that the service can draw. */
export function showLayers() {
  const layers = known.layers ?? [];
  byId("layers").hidden = layers.length === 0;
  for (const layer of layers) if (!OFF_AT_FIRST.has(layer)) known.layersOn.add(layer);
  reconcile(byId("layers"), keptLayers, ["legend", ...layers], (layer) => {
    if (layer === "legend") return /** @type {HTMLElement} */ (byId("layers").firstElementChild);
    const box = make("input");
    box.type = "checkbox";
    box.name = layer;
    box.checked = known.layersOn.has(layer);
    box.addEventListener("change", () => {
      if (box.checked) known.layersOn.add(layer);
      else known.layersOn.delete(layer);
      restartLive();
    });
    const name = LAYER_NAMES[/** @type {keyof typeof LAYER_NAMES} */ (layer)] ?? layer;
    return make("label", "", box, ` ${name}`);
  });
}

function showCameraChoice() {
  const ids = [...known.cameras.keys()];
  const choice = byId("cameras");
  choice.hidden = ids.length < 2 || playback() !== null;
  reconcile(choice, keptCameras, ids, (id) => {
    const button = make("input");
    button.type = "radio";
    button.name = "camera";
    button.checked = id === known.camera;
    button.addEventListener("change", () => {
      known.camera = id;
      shown = null;
      frameWidthPx = 0;
      restartLive();
    });
    return make("label", "", button, ` ${id}`);
  });
}

document.addEventListener("visibilitychange", restartLive);
