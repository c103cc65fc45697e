// Learning a landmark by hand: take a picture, draw a box, see how well it stands out, publish it.

import { Problem, getJson } from "./api.js";
import { ask } from "./changes.js";
import { byId, make, makeState, setText, showState } from "./dom.js";
import { lesson, setLesson } from "./lesson.js";
import { restartLive } from "./live.js";
import { pixelUnder } from "./probe.js";
import { known } from "./state.js";
import { MISSING, figure } from "./words.js";

/** Below this a box is a click that slipped. */
const LEAST_SIDE_PX = 4;

const canvas = /** @type {HTMLCanvasElement} */ (byId("picture"));
const marks = /** @type {HTMLCanvasElement} */ (byId("marks"));
const form = /** @type {HTMLFormElement} */ (byId("teach-form"));
const fields = /** @type {HTMLFieldSetElement} */ (byId("teach-box"));

/** Where a drag began, frame pixels. @type {[number, number] | null} */
let corner = null;

/** What was learned last. @type {any} */
let learned = null;

/** The picture that is on its way, counted from 1, or 0: a box given before it comes would be lost. */
let awaited = 0;
let taken = 0;

/** Counts questions, so that an answer to an earlier one is not shown. */
let asked = 0;

/** Wires the section. */
export function startTeaching() {
  byId("teach-take").addEventListener("click", () => void take());
  byId("teach-leave").addEventListener("click", leave);
  byId("teach-mask").addEventListener("change", showMask);
  form.addEventListener("change", () => void learn());
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void publish();
  });
  canvas.addEventListener("pointerdown", (event) => void begin(event));
  canvas.addEventListener("pointermove", (event) => {
    if (corner) drag(event);
  });
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("framesize", drawBox);
}

/** @param {string} name */
function field(name) {
  return /** @type {HTMLInputElement | HTMLSelectElement} */ (form.elements.namedItem(name));
}

/** Keeps the newest picture on the service and shows it instead of the live one. */
async function take() {
  taken += 1;
  const mine = taken;
  awaited = mine;
  showTeaching();
  const answer = await ask(byId("teach-answer"), `/api/v1/lessons?camera=${encodeURIComponent(known.camera ?? "")}`);
  if (awaited === mine) awaited = 0;
  if (!answer) {
    showTeaching();
    return false;
  }
  setLesson({ number: answer.lesson, widthPx: answer.width_px, heightPx: answer.height_px, box: null, showsMask: false, query: "" });
  forget();
  showTeaching();
  restartLive();
  return true;
}

function leave() {
  setLesson(null);
  forget();
  showTeaching();
  restartLive();
}

function forget() {
  learned = null;
  corner = null;
  asked += 1;
  for (const name of ["x", "y", "w", "h"]) field(name).value = "";
  /** @type {HTMLInputElement} */ (byId("teach-mask")).checked = false;
  byId("teach-verdict").replaceChildren();
  drawBox();
}

/** A drag on the live picture takes it first; the box goes on where the drag began. @param {PointerEvent} event */
async function begin(event) {
  if (byId("teach").hidden || event.button !== 0) return;
  const at = pixelUnder(event);
  canvas.setPointerCapture(event.pointerId);
  if (lesson() || (await take())) corner = at;
}

/** @param {PointerEvent} event */
function drag(event) {
  const current = lesson();
  if (!current || !corner) return;
  const [x, y] = pixelUnder(event);
  const within = (/** @type {number} */ value, /** @type {number} */ most) => Math.min(Math.max(value, 0), most);
  const [left, right] = [corner[0], x].map((side) => within(side, current.widthPx)).sort((a, b) => a - b);
  const [top, bottom] = [corner[1], y].map((side) => within(side, current.heightPx)).sort((a, b) => a - b);
  current.box = { x: left, y: top, w: right - left, h: bottom - top };
  drawBox();
}

function end() {
  const box = corner && lesson()?.box;
  corner = null;
  if (!box) return;
  for (const name of /** @type {const} */ (["x", "y", "w", "h"])) field(name).value = String(box[name]);
  void learn();
}

function drawBox() {
  if (marks.width !== canvas.width) marks.width = canvas.width;
  if (marks.height !== canvas.height) marks.height = canvas.height;
  const pen = marks.getContext("2d");
  const box = lesson()?.box;
  if (!pen) return;
  pen.clearRect(0, 0, marks.width, marks.height);
  if (!box) return;
  const [x, y, w, h] = [box.x - 0.5, box.y - 0.5, box.w + 1, box.h + 1];
  for (const [colour, width] of /** @type {const} */ ([["#000", 3], ["#fff", 1]])) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.strokeRect(x, y, w, h);
  }
}

/** Asks what the box gives. */
async function learn() {
  const current = lesson();
  if (!current) return;
  const box = { x: 0, y: 0, w: 0, h: 0 };
  for (const name of /** @type {const} */ (["x", "y", "w", "h"])) box[name] = Number(field(name).value);
  current.box = box;
  drawBox();
  if (box.w < LEAST_SIDE_PX || box.h < LEAST_SIDE_PX) return;
  const query = new URLSearchParams(Object.entries(box).map(([name, value]) => [name, String(value)]));
  query.set("shape", field("shape").value);
  if (Number(field("size_m").value) > 0) query.set("size_m", field("size_m").value);
  current.query = query.toString();
  asked += 1;
  const question = asked;
  setText(byId("teach-answer"), "Looking at every window of the picture …");
  try {
    const answer = await getJson(`/api/v1/lessons/${current.number}/landmark?${query}`, 20_000);
    if (question !== asked) return;
    learned = answer;
    setText(byId("teach-answer"), "");
    showVerdict();
    if (current.showsMask) restartLive();
  } catch (error) {
    if (question !== asked) return;
    learned = null;
    byId("teach-verdict").replaceChildren();
    setText(byId("teach-answer"), error instanceof Problem ? error.message : "The service does not answer.");
  }
}

function showMask() {
  const current = lesson();
  if (!current) return;
  current.showsMask = /** @type {HTMLInputElement} */ (byId("teach-mask")).checked;
  restartLive();
}

/** How well it stands out, in words and figures. */
function showVerdict() {
  const state = makeState();
  const { level, words } = verdict(learned);
  showState(state, level, words);
  const seen = learned.seen
    ? `${learned.seen.is_in_box ? "" : "elsewhere: "}${figure(learned.seen.x_px, 1)}, ${figure(learned.seen.y_px, 1, "px")}, score ${figure(learned.seen.score, 2)}`
    : "nothing in this picture";
  const facts = [
    ["Rest of the picture", learned.separation === null ? MISSING : `${figure(learned.separation, 1)} tolerances off at its nearest`],
    ["Nearest place", learned.nearest ? `${figure(learned.nearest.x_px, 0)}, ${figure(learned.nearest.y_px, 0, "px")}` : MISSING],
    ["Registration finds", seen],
    ["Window", `${learned.landmark.window_px.join(" × ")} samples`],
    ...learned.landmark.shades.map((/** @type {any} */ shade, /** @type {number} */ index) => [
      `Shade ${index + 1}`, `mean ${rounded(shade.mean)} levels, variance ${rounded(shade.variance)} levels²`,
    ]),
    ["Tolerances", `${rounded(learned.landmark.tolerance.mean)} levels, ${rounded(learned.landmark.tolerance.variance)} levels²`],
  ];
  const list = make("dl", "facts-list", ...facts.map(([name, value]) => make("div", "", make("dt", "", name), make("dd", "", value))));
  byId("teach-verdict").replaceChildren(make("p", "", state), list);
}

/** @param {number[]} values */
const rounded = (values) => values.map((value) => value.toFixed(0)).join(", ");

/** @param {any} one @returns {{level: import("./dom.js").Level, words: string}} */
export function verdict(one) {
  if (!one.seen) return { level: "bad", words: "not found again in its own picture: draw the box closer, or choose another object" };
  if (!one.seen.is_in_box) return { level: "bad", words: "something else in the picture is taken for it" };
  if (one.separation === null) return { level: "warn", words: "the picture shows nothing else to tell it from" };
  if (one.separation <= 1) return { level: "warn", words: "other places match its colours too: only its outline tells it from them" };
  if (one.separation < 2) return { level: "warn", words: "stands out, but not by much" };
  return { level: "good", words: "stands out well from the rest of the picture" };
}

async function publish() {
  const id = field("id").value.trim();
  const place = byId("teach-answer");
  if (!learned || !form.reportValidity()) return;
  if (!id) {
    setText(place, "Give it a name first.");
    field("id").focus();
    return;
  }
  const { revision, digest, ...landmark } = learned.landmark;
  const made = await ask(place, `/api/v1/landmarks/${encodeURIComponent(id)}`, { method: "PUT", body: { ...landmark, id } });
  if (made) setText(place, `${id} is published; the set is now ${made.epoch}.${made.version}.`);
}

/** Shows what can be done now. */
export function showTeaching() {
  if (byId("teach").hidden) return;
  const current = lesson();
  const allowed = known.access !== "read_only";
  fields.disabled = awaited > 0 || !current;
  /** @type {HTMLButtonElement} */ (byId("teach-take")).disabled = !allowed;
  /** @type {HTMLButtonElement} */ (byId("teach-leave")).disabled = !current;
  /** @type {HTMLInputElement} */ (byId("teach-mask")).disabled = !current || !learned;
  /** @type {HTMLButtonElement} */ (byId("teach-publish")).disabled = !allowed || !learned;
  setText(byId("teach-facts"), current ? `picture ${current.number}, ${current.widthPx} × ${current.heightPx} px` : "");
}
