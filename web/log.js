// The event log: every change of state, with its time, newest first.

import { byId, make, makeState, showState } from "./dom.js";
import { items } from "./header.js";
import { known } from "./state.js";
import { levelOf, missInWords } from "./words.js";

const MAX_LINES = 200;

/** A landmark's state must last this long to count as a change; a single lost frame is not news. */
const SETTLE_MS = 500;

/** @typedef {{level: import("./dom.js").Level, words: string}} State */
/** @type {Map<string, {said: string, now: string, since: number}>} */
const watched = new Map();

let opened = false;

/** Compares what is known now with what was said last. */
export function watchChanges() {
  if (!opened) write("This page", { level: "unknown", words: "opened" });
  opened = true;
  for (const item of items()) watch(item.name, { level: item.level, words: item.words.split(",")[0] }, `${item.name}|${item.level}`, 0);
  for (const camera of known.cameras.values()) {
    for (const entry of camera.landmarks ?? []) {
      const words = entry.result === "measured" ? "measured" : `lost: ${missInWords(entry.result, entry.miss)}`;
      watch(nameOf(entry, camera), { level: levelOf(entry.result), words }, entry.result, SETTLE_MS);
    }
  }
}

/** As short as it can be without confusion. @param {any} entry @param {any} camera */
function nameOf(entry, camera) {
  const instance = entry.instance > 0 ? ` #${entry.instance}` : "";
  const place = known.cameras.size > 1 ? ` in ${camera.id}` : "";
  return `Landmark ${entry.id}${instance}${place}`;
}

/** @param {string} what @param {State} state @param {string} mark @param {number} settleMs */
function watch(what, state, mark, settleMs) {
  const now = performance.now();
  const former = watched.get(what);
  if (!former || former.now !== mark) {
    watched.set(what, { said: former?.said ?? "", now: mark, since: now });
    if (settleMs > 0) return;
  }
  const current = watched.get(what);
  if (current && current.said !== mark && now - current.since >= settleMs) {
    // What is well from the start is no change.
    const isNews = current.said !== "" || state.level !== "good";
    current.said = mark;
    if (isNews) write(what, state);
  }
}

/** @param {string} what @param {State} state */
function write(what, state) {
  const time = make("time", "quiet", new Date().toLocaleTimeString(undefined, { hour12: false }));
  const mark = makeState();
  showState(mark, state.level, state.words);
  const log = byId("log");
  log.prepend(make("li", "", time, " ", make("b", "", what), " ", mark));
  while (log.children.length > MAX_LINES) log.lastElementChild?.remove();
}
