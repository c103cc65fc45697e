// The live picture: asked for frame by frame, so that what is drawn and what is said belong to the same frame.

import { Problem, getPicture, nextPicture, recordedPicture } from "./api.js";
import { byId, make, reconcile, setAttribute, setText } from "./dom.js";
import { lesson, lessonPath } from "./lesson.js";
import { forgetPicture, showPicture, shownPicture } from "./picture.js";
import { nextFrame, playback } from "./playback.js";
import { STALE_AFTER_MS, known, shownEntry } from "./state.js";
import { duration, figure, sentence } from "./words.js";

const keptCameras = new Map();

/** Times of the last pictures, for the rate. @type {number[]} */
let times = [];
let held = false;
let loop = new AbortController();

/** Starts, or starts anew with other layers or another camera; a held picture gives way to one later frame. */
export function restartLive() {
  loop.abort();
  if (!held && !playback()) known.stillEntry = null;
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
  let after = playback() ? null : (shownPicture()?.sequence ?? null);
  while (!stop.aborted) {
    try {
      if (lesson()) return await showLesson(stop);
      after = playback() ? await showRecorded(after, stop) : await showNext(camera, after, stop);
      if (held && !playback()) return;
    } catch (error) {
      if (stop.aborted) return;
      // Once the picture on the screen is old, its age is said instead, anew every moment.
      if (!isOld()) explain(error instanceof Problem ? sentence(error.message) : "The service does not answer.");
      await pause(500, stop);
    }
  }
}

/** @param {string} camera @param {number | null} after @param {AbortSignal} stop */
async function showNext(camera, after, stop) {
  const picture = await nextPicture(camera, after, wanted(held), stop);
  if (stop.aborted) return after;
  draw(picture);
  if (held && picture.seen) known.stillEntry = { id: camera, registered: true, ...picture.seen };
  return picture.sequence;
}

/** @param {number | null} after @param {AbortSignal} stop */
async function showRecorded(after, stop) {
  const frame = await nextFrame(after, stop);
  const recording = playback();
  if (frame === null || !recording) return after;
  const { picture, entry } = await recordedPicture(recording, frame, wanted(!recording.running), stop);
  if (stop.aborted) return frame;
  known.stillEntry = { id: recording.camera, registered: entry.registration !== null, sequence: entry.sequence, ...entry.registration };
  draw({ ...picture, seen: entry.registration });
  byId("picture").dataset.frame = String(frame);
  return frame;
}

/** The picture that somebody learns from stands until another one is wanted. @param {AbortSignal} stop */
async function showLesson(stop) {
  const picture = await getPicture(lessonPath(), stop);
  if (!stop.aborted) draw(picture);
}

/**
 * A picture that stands still is shown with every pixel that the registration saw; one that runs as the camera sent it,
 * since then the service has nothing to do but to pass it on. Only the mask has to be drawn where the pixels are.
 * @param {boolean} isStill @returns {import("./api.js").Wanted}
 */
function wanted(isStill) {
  const layers = known.layersOn.has("mask") ? ["mask"] : [];
  return { layers, format: isStill ? "png" : "jpg", widthPx: isStill ? 0 : Number(select("size").value) };
}

/** @param {string} id */
const select = (id) => /** @type {HTMLSelectElement} */ (byId(id));

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
  showPicture(picture);
  times.push(performance.now());
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

/** How long ago the frame on the screen arrived at the service. */
function shownAgeMs() {
  const shown = shownPicture();
  return shown ? shown.ageMs + performance.now() - shown.at : 0;
}

/** Whether a picture is on the screen that should be live and is not. */
function isOld() {
  return !isStill() && shownAgeMs() > STALE_AFTER_MS;
}

/** Shows what belongs to the picture and is not drawn into it. */
export function showLive() {
  const now = performance.now();
  times = times.filter((time) => now - time < 2000);
  const shown = shownPicture();
  if (shown) {
    if (isOld()) explain(`Not live: this picture is ${duration(shownAgeMs() / 1000)} old.`);
    const rate = times.length > 1 ? ((times.length - 1) * 1000) / (times[times.length - 1] - times[0]) : null;
    const pace = playback() ? "recorded" : lesson() ? "taken to learn from" : held ? "held" : figure(rate, 0, "fps shown");
    const unseen = known.stillEntry?.registered === false ? " · was not registered" : "";
    setText(byId("frame-facts"), `frame ${shown.sequence} · ${pace} · ${shown.width} × ${shown.height} px${unseen}`);
  }
  setAttribute(byId("picture"), "aria-label", describe());
  showCameraChoice();
}

function describe() {
  const camera = shownEntry();
  if (!camera || !shownPicture()) return "No picture yet";
  const seen = (camera.landmarks ?? []).filter((/** @type {any} */ entry) => entry.result === "measured");
  const names = [...new Set(seen.map((/** @type {any} */ entry) => entry.id))].join(", ");
  return `${playback() ? "Recorded" : held ? "Held" : "Live"} picture of camera ${camera.id}; ${names ? `measured: ${names}` : "no landmark measured"}`;
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
      forgetPicture();
      restartLive();
    });
    return make("label", "", button, ` ${id}`);
  });
}

byId("size").addEventListener("change", restartLive);
document.addEventListener("visibilitychange", restartLive);
