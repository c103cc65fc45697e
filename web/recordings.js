// What has been recorded: to be looked at here, downloaded, or deleted.

import { getJson } from "./api.js";
import { ask } from "./changes.js";
import { byId, make, makeState, reconcile, setText, showState } from "./dom.js";
import { play, playback } from "./playback.js";
import { known } from "./state.js";
import { MISSING, bytes, clock } from "./words.js";

const ASK_MS = 5000;
const PAGE = 20;

/** @type {any[]} */
let listed = [];
let isMore = false;
let wanted = PAGE;

/** A recording whose deletion has been asked for once. */
let doomed = "";

/** @type {Map<string, HTMLElement>} */
const kept = new Map();

/** Asks again and again, as long as the page is there. */
export async function followRecordings() {
  await askRecordings();
  setTimeout(followRecordings, ASK_MS);
}

async function askRecordings() {
  try {
    const answer = await getJson(`/api/v1/recordings?limit=${wanted}`);
    listed = answer.recordings ?? [];
    isMore = Boolean(answer.next);
  } catch {
    // Silence is what the header shows.
  }
}

/** Shows what is known now. */
export function showRecordings() {
  reconcile(byId("recordings"), kept, listed.map((one) => one.name), makeLine);
  for (const one of listed) fill(/** @type {HTMLElement} */ (kept.get(one.name)), one);
  byId("recordings-none").hidden = listed.length > 0;
  byId("recordings-more").hidden = !isMore;
  const size = listed.reduce((sum, one) => sum + one.bytes, 0);
  setText(byId("recordings-facts"), `${isMore ? "newest " : ""}${listed.length}, ${bytes(size)}`);
}

/** @param {string} name */
function makeLine(name) {
  const view = make("button", "", "Look at it");
  view.type = "button";
  view.addEventListener("click", () => lookAt(name));
  const download = make("a", "button", "Download");
  download.href = `/api/v1/recordings/${encodeURIComponent(name)}`;
  download.setAttribute("download", name);
  const remove = make("button", "", "Delete");
  remove.type = "button";
  remove.addEventListener("click", () => void removeOrAsk(name));
  remove.addEventListener("blur", () => (doomed = doomed === name ? "" : doomed));
  for (const control of [view, download, remove]) control.setAttribute("aria-describedby", `recording-${name}`);
  const title = make("span", "name", name.replace(/\.mcap$/, ""));
  title.id = `recording-${name}`;
  return make("li", "", title, makeState(), make("span", "quiet facts"), make("span", "acts", view, download, remove));
}

/** @param {HTMLElement} line @param {any} one */
function fill(line, one) {
  const [, state, facts, acts] = /** @type {HTMLElement[]} */ ([...line.children]);
  const isShown = playback()?.name === one.name;
  const isWritten = known.status?.recorder?.file?.includes(one.name) ?? false;
  if (isShown) showState(state, "good", "shown above");
  else if (one.state === "finished") showState(state, "unknown", "finished");
  else showState(state, isWritten ? "good" : "warn", isWritten ? "being written" : "not finished");
  const frames = one.cameras.map((/** @type {any} */ camera) => `${camera.frames} frames of ${camera.id}`).join(", ");
  setText(facts, [started(one.started_at), one.duration_s === null ? `length ${MISSING}` : clock(one.duration_s), bytes(one.bytes), frames].filter(Boolean).join(" · "));
  const [view, , remove] = /** @type {HTMLButtonElement[]} */ ([...acts.children]);
  view.disabled = one.cameras.length === 0 || isShown;
  remove.disabled = one.state !== "finished" || known.access === "read_only" || isShown;
  setText(remove, doomed === one.name ? "Really delete it" : "Delete");
}

/** `20261123T005602Z` as people write it. @param {string} utc */
function started(utc) {
  const [, year, month, day, hour, minute, second] = /^(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)Z$/.exec(utc) ?? [];
  return year ? `${year}-${month}-${day} ${hour}:${minute}:${second} UTC` : utc;
}

/** @param {string} name */
function lookAt(name) {
  const one = listed.find((entry) => entry.name === name);
  const camera = one?.cameras.find((/** @type {any} */ camera) => camera.id === known.camera) ?? one?.cameras[0];
  if (!camera) return;
  play(name, camera, one.duration_s ?? 0);
  byId("live").scrollIntoView({ block: "start" });
  byId("playback-toggle").focus();
}

/** The first press asks, the second deletes. @param {string} name */
async function removeOrAsk(name) {
  if (doomed !== name) {
    doomed = name;
    showRecordings();
    return;
  }
  doomed = "";
  const isDone = await ask(byId("recordings-answer"), `/api/v1/recordings/${encodeURIComponent(name)}`, { method: "DELETE" });
  if (isDone) await askRecordings();
}

/** Wires what does not belong to one recording. */
export function startRecordings() {
  byId("recordings-more").addEventListener("click", () => {
    wanted = Math.min(1000, wanted + 100);
    void askRecordings();
  });
}
