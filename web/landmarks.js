// The landmark table: what is looked for, what was observed, and why not.

import { Problem, getJson } from "./api.js";
import { ask } from "./changes.js";
import { byId, make, makeState, reconcile, setText, showState } from "./dom.js";
import { STALE_AFTER_MS, frameAgeMs, known, shownEntry } from "./state.js";
import { compare } from "./statistics.js";
import { MISSING, ago, figure, levelOf, missInWords } from "./words.js";

/** @type {Map<string, HTMLTableRowElement>} */
const rows = new Map();

/** @typedef {{key: string, landmark: any, entry: any, several: boolean}} Row the descriptor is null where it is not known */

/** What is expected where the descriptor is not known. */
const UNKNOWN = { shades: [{ mean: [NaN, NaN, NaN], variance: [NaN, NaN, NaN] }], tolerance: { mean: [NaN, NaN, NaN], variance: [NaN, NaN, NaN] } };

/** Every landmark in force, with each instance seen by the camera shown; or those of the still frame in its place. @returns {Row[]} */
function entries() {
  const seen = shownEntry()?.landmarks ?? [];
  const sets = known.recordedLandmarks ?? known.landmarks;
  if (known.stillEntry?.registered) return seen.map((/** @type {any} */ entry) => rowOf(descriptorOf(entry, sets), entry, seen));
  return sets.flatMap((landmark) => {
    const instances = known.stillEntry ? [] : seen.filter((/** @type {any} */ entry) => entry.id === landmark.id);
    const shown = instances.length > 0 ? instances : [{ id: landmark.id, instance: 0, result: null }];
    return shown.map((/** @type {any} */ entry) => rowOf(landmark, entry, shown));
  });
}

/** @param {any} landmark @param {any} entry @param {any[]} all @returns {Row} */
function rowOf(landmark, entry, all) {
  const several = all.some((other) => other.id === entry.id && other.instance !== entry.instance);
  return { key: `${entry.id}#${entry.instance}`, landmark, entry, several };
}

/** The one that was looked for, whatever bears its name now. @param {any} entry @param {any[]} landmarks */
function descriptorOf(entry, landmarks) {
  return landmarks.find((landmark) => landmark.digest === entry.digest) ?? null;
}

/** A follower looks for landmarks, a leader publishes them. */
function isFollower() {
  return known.status?.role === "follower";
}

/** Shows what is known now. */
export function showLandmarks() {
  const all = entries();
  const body = byId("landmarks").querySelector("tbody");
  if (!body) return;
  reconcile(body, rows, all.map((one) => one.key), makeRow);
  const ageMs = known.camera && !known.stillEntry ? frameAgeMs(known.cameras.get(known.camera)) : null;
  for (const one of all) fillRow(/** @type {HTMLTableRowElement} */ (rows.get(one.key)), one, ageMs);
  byId("landmarks").dataset.sequence = String(shownEntry()?.sequence ?? "");
  byId("landmarks").hidden = all.length === 0;
  byId("landmark-none").hidden = all.length > 0;
  setText(byId("landmark-none"), isFollower()
    ? "No landmark is in force: none has been received from the leader."
    : "No landmark is published.");
  const isOld = ageMs !== null && ageMs > STALE_AFTER_MS;
  const measured = isOld ? 0 : all.filter((one) => one.entry.result === "measured").length;
  const set = known.stillEntry ? known.stillEntry.set : known.version;
  const version = set ? ` · set ${set.epoch}.${set.version}` : "";
  const count = isFollower() ? `${measured} of ${all.length} measured` : `${all.length} published`;
  setText(byId("landmark-facts"), count + version);
}

/** @param {string} key */
function makeRow(key) {
  const name = make("th", "", make("span", "name"), make("span", "kind quiet"));
  name.scope = "row";
  const result = make("td", "result", makeState());
  result.append(...(isFollower() ? makeWhyNot(key) : [makeRetire(key)]));
  const [mean, variance] = ["mean", "variance"].map((kind) =>
    make("td", kind, make("div", "channels", ...["R", "G", "B"].map(makeStatistic))));
  mean.dataset.label = "Mean, levels";
  variance.dataset.label = "Variance, levels²";
  const facts = make("td", "", make("dl", "facts-list"));
  facts.dataset.label = "Where and how well";
  const row = make("tr", "", name, result, mean, variance, facts);
  row.dataset.key = key;
  row.setAttribute("role", "row");
  name.setAttribute("role", "rowheader");
  for (const cell of [result, mean, variance, facts]) cell.setAttribute("role", "cell");
  return row;
}

/** Asks the service to look at every window of the newest frame. @param {string} key */
function makeWhyNot(key) {
  const id = key.split("#")[0];
  const words = make("p", "why quiet");
  words.setAttribute("role", "status");
  const button = make("button", "", "Why not?");
  button.type = "button";
  button.setAttribute("aria-label", `Why not? ${id}`);
  button.addEventListener("click", async () => {
    try {
      const camera = encodeURIComponent(known.camera ?? "");
      setText(words, explanation(await getJson(`/api/v1/cameras/${camera}/explanations/${encodeURIComponent(id)}`)));
    } catch (error) {
      setText(words, error instanceof Problem ? error.message : "The service does not answer.");
    }
  });
  return [button, words];
}

/** What decided, as `waymark explain` says it. @param {any} answer */
export function explanation(answer) {
  const where = typeof answer.x_px === "number" ? ` at ${answer.x_px.toFixed(0)}, ${answer.y_px.toFixed(0)} px` : "";
  const verdict = answer.reason ?? "registered";
  const outside = answer.statistics
    .filter((/** @type {any} */ one) => one.excess === null || one.excess > 1)
    .map((/** @type {any} */ one) => `${one.statistic} ${one.observed.toFixed(0)} instead of ${one.expected.toFixed(0)} ± ${one.tolerance.toFixed(0)} ${one.unit}`);
  const figures = outside.length > 0 ? ` Outside${where}: ${outside.join("; ")}.` : ` All six statistics fit${where}.`;
  return `Frame ${answer.sequence}: ${verdict}.${figures}`;
}

/** A leader may take a landmark back; the first press asks, the second does it. @param {string} key */
function makeRetire(key) {
  const id = key.split("#")[0];
  const button = make("button", "", "Retire");
  button.type = "button";
  const say = (/** @type {string} */ words) => {
    setText(button, words);
    button.setAttribute("aria-label", `${words}: ${id}`);
  };
  const calm = () => say("Retire");
  calm();
  button.addEventListener("blur", calm);
  button.addEventListener("click", async () => {
    if (button.textContent === "Retire") {
      say("Really retire it");
      return;
    }
    calm();
    await ask(byId("landmark-answer"), `/api/v1/landmarks/${encodeURIComponent(id)}`, { method: "DELETE" });
  });
  return button;
}

/** @param {string} channel */
function makeStatistic(channel) {
  return make("div", "statistic",
    make("span", "channel quiet", channel), make("span", "expected quiet"), make("span", "observed"), makeState("verdict"));
}

/** @param {HTMLTableRowElement} row @param {Row} one @param {number | null} ageMs */
function fillRow(row, { landmark, entry, several }, ageMs) {
  const [name, result, mean, variance, facts] = row.children;
  setText(name.children[0], several ? `${entry.id} #${entry.instance}` : entry.id);
  const comparison = compare(landmark ?? UNKNOWN, entry.observed ?? entry.miss?.observed, entry);
  const shade = comparison.shades > 1 ? ` · shade ${comparison.shade} of ${comparison.shades}` : "";
  setText(name.children[1], landmark ? `${landmark.shape} · window ${landmark.window_px.join(" × ")}${shade}` : "another descriptor than is known here");
  // What was, is not to be taken for what is.
  row.classList.toggle("old", ageMs !== null && ageMs > STALE_AFTER_MS);
  showButton(result, entry);
  fillResult(/** @type {HTMLElement} */ (result.firstElementChild), entry, ageMs, landmark?.revision);
  comparison.mean.forEach((one, index) => fillStatistic(mean.children[0].children[index], one));
  comparison.variance.forEach((one, index) => fillStatistic(variance.children[0].children[index], one));
  fillFacts(facts.firstElementChild, entry);
}

/** A follower may be asked why not, where a landmark is missed; a leader may retire. @param {Element} result @param {any} entry */
function showButton(result, entry) {
  const [, button, words] = /** @type {HTMLElement[]} */ ([...result.children]);
  if (isFollower()) {
    const isMissed = entry.result !== null && entry.result !== "measured" && !known.stillEntry;
    // Once asked, the words stay until the next question: landmarks come and go within a moment.
    button.hidden = !isMissed && words?.textContent === "";
  } else /** @type {HTMLButtonElement} */ (button).disabled = known.access === "read_only";
}

/** @param {HTMLElement} state @param {any} entry @param {number | null} ageMs @param {number} revision */
function fillResult(state, entry, ageMs, revision) {
  const measured = entry.result === "measured";
  if (entry.result === null) {
    const words = known.stillEntry ? "this frame was not registered" : "not looked for yet";
    showState(state, "unknown", isFollower() ? words : `published, revision ${revision}`);
  } else if (ageMs !== null && ageMs > STALE_AFTER_MS) {
    showState(state, "warn", `not now: last ${measured ? "measured" : "missed"} ${ago(ageMs / 1000)}`);
  } else if (measured) {
    showState(state, "good", "measured");
  } else {
    showState(state, levelOf(entry.result), `missed: ${missInWords(entry.result, entry.miss)}`);
  }
}

/** @param {Element} element @param {import("./statistics.js").Comparison} one */
function fillStatistic(element, one) {
  const [, expected, observed, verdict] = element.children;
  const isKnown = Number.isFinite(one.expected);
  const allowed = one.isUpperBound
    ? `≤ ${(one.expected + one.tolerance).toFixed(0)}`
    : `${one.expected.toFixed(0)} ± ${one.tolerance.toFixed(0)}`;
  setText(expected, isKnown ? allowed : MISSING);
  setText(observed, figure(one.observed, 0));
  const state = /** @type {HTMLElement} */ (verdict);
  state.hidden = one.within === null || !isKnown;
  if (one.offBy === null || !isKnown) return;
  if (one.within) showState(state, "good", "within");
  else showState(state, "bad", `${Math.max(1, Math.abs(one.offBy)).toFixed(0)} ${one.offBy > 0 ? "over" : "under"}`);
}

/** @param {Element | null} list @param {any} entry */
function fillFacts(list, entry) {
  if (!list) return;
  const facts = [
    place(entry),
    ["Area", figure(entry.area_px2, 0, "px²")],
    ["Score", figure(entry.score, 2)],
    ["Shape", figure(entry.shape_score, 2)],
    ["Gain", typeof entry.gain === "number" ? `× ${entry.gain.toFixed(2)}` : MISSING],
    ["Off prediction", figure(entry.innovation_px, 1, "px")],
    ["Bearing", bearing(entry.bearing_rad)],
    ["Range", figure(entry.range_m, 1, "m")],
  ];
  while (list.children.length < facts.length) list.append(make("div", "", make("dt"), make("dd")));
  facts.forEach(([name, value], index) => {
    setText(list.children[index].children[0], name);
    setText(list.children[index].children[1], value);
  });
}

/** @param {number | null | undefined} bearingRad positive to the left */
function bearing(bearingRad) {
  if (typeof bearingRad !== "number") return MISSING;
  const degrees = (Math.abs(bearingRad) * 180) / Math.PI;
  return `${degrees.toFixed(1)}° ${degrees < 0.05 ? "ahead" : bearingRad > 0 ? "left" : "right"}`;
}

/** Where it is, or where it was expected. @param {any} entry @returns {[string, string]} */
function place(entry) {
  const words = (/** @type {number} */ x, /** @type {number} */ y) => `${x.toFixed(1)}, ${y.toFixed(1)} px`;
  if (typeof entry.x_px === "number") return ["Centre", words(entry.x_px, entry.y_px)];
  if (typeof entry.predicted_x_px === "number") return ["Expected at", words(entry.predicted_x_px, entry.predicted_y_px)];
  return ["Centre", MISSING];
}
