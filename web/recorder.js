// The recorder: is it recording, where to, how much room is left.

import { ask } from "./changes.js";
import { byId, make, makeState, setText, showState } from "./dom.js";
import { known } from "./state.js";
import { MISSING, bytes, duration } from "./words.js";

const COMMANDS = [
  { command: "start", name: "Start", when: (/** @type {string} */ state) => state !== "recording" },
  { command: "stop", name: "Stop", when: (/** @type {string} */ state) => state === "recording" },
  { command: "split", name: "Split into a new file", when: (/** @type {string} */ state) => state === "recording" },
];

/** Bytes and time of the last half minute, for the rate. @type {{at: number, bytes: number, file: string}[]} */
let samples = [];

/** Shows what is known now. */
export function showRecorder() {
  const recorder = known.status?.recorder;
  if (!recorder) return;
  sample(recorder);
  const words = { recording: "recording", failed: `failed: ${recorder.reason ?? "reason unknown"}` };
  const level = recorder.state === "recording" ? "good" : recorder.state === "failed" ? "bad" : "unknown";
  const place = byId("recorder-state");
  if (!place.querySelector(".state")) place.replaceChildren(makeState());
  showState(/** @type {HTMLElement} */ (place.firstElementChild), level,
    words[/** @type {keyof typeof words} */ (recorder.state)] ?? recorder.state);
  fill(recorder);
  showControls(recorder.state);
}

/** @param {any} recorder */
function sample(recorder) {
  const now = performance.now();
  const file = recorder.file ?? "";
  samples = samples.filter((one) => now - one.at < 30000 && one.file === file);
  const last = samples[samples.length - 1];
  if (!last || known.statusAt > last.at) samples.push({ at: known.statusAt, bytes: recorder.bytes, file });
}

function bytesPerS() {
  const first = samples[0];
  const last = samples[samples.length - 1];
  if (!first || last.at - first.at < 2000) return null;
  return ((last.bytes - first.bytes) * 1000) / (last.at - first.at);
}

/** @param {any} recorder */
function fill(recorder) {
  const rate = recorder.state === "recording" ? bytesPerS() : null;
  const left = rate && recorder.free_bytes ? duration(recorder.free_bytes / rate) : MISSING;
  const facts = [
    ["File", recorder.file?.split("/").pop() ?? MISSING],
    ["Written", bytes(recorder.bytes)],
    ["Rate", rate === null ? MISSING : `${bytes(rate)}/s`],
    ["Lost", recorder.lost === undefined ? MISSING : `${recorder.lost} messages`],
    ["Free", bytes(recorder.free_bytes)],
    ["Room for", left],
  ];
  const list = byId("recorder");
  while (list.children.length < facts.length) list.append(make("div", "", make("dt"), make("dd")));
  facts.forEach(([name, value], index) => {
    setText(list.children[index].children[0], name);
    setText(list.children[index].children[1], value);
  });
}

/** @param {string} state */
function showControls(state) {
  const place = byId("recorder-controls");
  if (place.children.length === 0) {
    place.append(...COMMANDS.map(({ command, name }) => {
      const button = make("button", "", name);
      button.type = "button";
      button.addEventListener("click", () => void ask(/** @type {Element} */ (place.lastElementChild), `/api/v1/recorder/${command}`));
      return button;
    }), make("p", "answer quiet"));
    place.lastElementChild?.setAttribute("role", "status");
  }
  const allowed = known.access !== "read_only";
  COMMANDS.forEach(({ when }, index) => {
    const button = /** @type {HTMLButtonElement} */ (place.children[index]);
    button.disabled = !allowed || !when(state);
  });
}
