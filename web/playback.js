// A recording that is looked at in the place of the live picture: which of its frames is wanted now.

import { recordedLandmarks } from "./api.js";
import { byId, make, setText } from "./dom.js";
import { lesson } from "./lesson.js";
import { known } from "./state.js";
import { clock } from "./words.js";

/**
 * @typedef {object} Playback
 * @property {string} name of the recording
 * @property {string} camera
 * @property {number} frames how many there are
 * @property {number} rateHz frames per second as they were recorded, on the average
 * @property {number} frame the one that is wanted
 * @property {boolean} running
 * @property {number} speed
 * @property {number} ranAt performance.now() when it began to run
 * @property {number} ranFrom the frame it began from
 */

const SPEEDS = [0.25, 0.5, 1, 2, 4];

/** @type {Playback | null} */
let current = null;

/** Wakes whoever waits for the next frame. */
let wake = () => {};

/** Called when a recording takes the place of the live picture, and when it gives way to it. */
let onChange = () => {};

/** What is being played back, if anything. */
export function playback() {
  return current;
}

/** @param {() => void} listener */
export function whenPlaybackChanges(listener) {
  onChange = listener;
}

/** @param {string} name @param {{id: string, frames: number}} camera @param {number} durationS */
export function play(name, camera, durationS) {
  const rateHz = durationS > 0 ? Math.max(0.1, (camera.frames - 1) / durationS) : 30;
  current = { name, camera: camera.id, frames: camera.frames, rateHz, frame: 0, running: true, speed: 1, ranAt: performance.now(), ranFrom: 0 };
  void learnLandmarks(name);
  changed();
}

/** The recording's own: others may be in force by now. @param {string} name */
async function learnLandmarks(name) {
  known.recordedLandmarks = [];
  const landmarks = await recordedLandmarks(name).catch(() => []);
  if (current?.name === name) known.recordedLandmarks = landmarks;
}

/** Gives the place back to the live picture. */
export function leave() {
  current = null;
  known.stillEntry = null;
  known.recordedLandmarks = null;
  changed();
}

function changed() {
  wake();
  onChange();
  showPlayback();
}

/** The frame that time has come to. @param {Playback} one */
function due(one) {
  if (!one.running) return one.frame;
  const ran = ((performance.now() - one.ranAt) / 1000) * one.rateHz * one.speed;
  return Math.min(one.frames - 1, one.ranFrom + Math.floor(ran));
}

/**
 * Waits until another frame than `after` is wanted, and says which.
 * @param {number | null} after @param {AbortSignal} stop
 */
export async function nextFrame(after, stop) {
  while (current && !stop.aborted) {
    current.frame = due(current);
    if (current.running && current.frame === current.frames - 1) halt();
    if (current.frame !== after) return current.frame;
    const untilNextMs = current.running ? 1000 / (current.rateHz * current.speed) : 1e9;
    await new Promise((resolve) => {
      const timer = setTimeout(resolve, Math.min(untilNextMs, 1e6));
      wake = () => {
        clearTimeout(timer);
        resolve(undefined);
      };
      stop.addEventListener("abort", () => wake(), { once: true });
    });
  }
  return null;
}

function halt() {
  if (!current) return;
  current.frame = due(current);
  current.running = false;
}

/** @param {number} frame */
function seek(frame) {
  if (!current) return;
  const wasRunning = current.running;
  current.frame = Math.min(Math.max(frame, 0), current.frames - 1);
  current.running = false;
  if (wasRunning && current.frame < current.frames - 1) run();
  wake();
  showPlayback();
}

function run() {
  if (!current) return;
  if (current.frame >= current.frames - 1) current.frame = 0;
  Object.assign(current, { running: true, ranAt: performance.now(), ranFrom: current.frame });
  wake();
}

/** @param {number} frames */
function step(frames) {
  halt();
  seek((current?.frame ?? 0) + frames);
}

/** @param {string} text @param {() => void} act */
function button(text, act) {
  const made = make("button", "", text);
  made.type = "button";
  made.addEventListener("click", act);
  return made;
}

/** Makes the controls. */
export function startPlayback() {
  const toggle = button("Pause", () => {
    if (current?.running) halt();
    else run();
    showPlayback();
  });
  toggle.id = "playback-toggle";
  const slider = make("input");
  Object.assign(slider, { type: "range", id: "playback-frame", min: "0", step: "1" });
  slider.setAttribute("aria-label", "Frame");
  slider.addEventListener("input", () => seek(Number(slider.value)));
  const speed = make("select", "", ...SPEEDS.map((factor) => {
    const option = make("option", "", `${factor} ×`);
    option.value = String(factor);
    option.selected = factor === 1;
    return option;
  }));
  speed.id = "playback-speed";
  speed.addEventListener("change", () => {
    if (!current) return;
    const wasRunning = current.running;
    halt();
    current.speed = Number(speed.value);
    if (wasRunning) run();
  });
  byId("playback").append(
    button("Frame back", () => step(-1)), toggle, button("Frame on", () => step(1)),
    slider, make("span", "facts time"), make("label", "", "Speed ", speed), button("Back to live", leave),
  );
}

/** Shows where playback stands. */
export function showPlayback() {
  const place = byId("playback");
  place.hidden = !current;
  byId("live-controls").hidden = Boolean(current);
  setText(byId("live-title"), current ? `Recording ${current.name}` : lesson() ? "Picture to learn from" : "Live");
  if (!current) return;
  const frame = due(current);
  const slider = /** @type {HTMLInputElement} */ (byId("playback-frame"));
  slider.max = String(current.frames - 1);
  if (document.activeElement !== slider || current.running) slider.value = String(frame);
  const [at, whole] = [frame, current.frames - 1].map((count) => clock(count / (current?.rateHz ?? 1)));
  slider.setAttribute("aria-valuetext", `frame ${frame} of ${current.frames}, ${at}`);
  setText(byId("playback-toggle"), current.running ? "Pause" : "Play");
  setText(/** @type {Element} */ (place.querySelector(".time")), `${at} of ${whole}`);
}
