// The header: is it alive, is it seeing, is it being recorded.

import { byId, make, makeState, reconcile, setText, showState } from "./dom.js";
import { ago, bytes, duration, figure } from "./words.js";
import { LOST_AFTER_S, STALE_AFTER_MS, frameAgeMs, known, silenceS } from "./state.js";

/** @typedef {{name: string, level: import("./dom.js").Level, words: string}} Item */

const kept = new Map();

/** What the header says, as data; the event log watches the same words. @returns {Item[]} */
export function items() {
  const { status } = known;
  if (!status) return [{ name: "Service", level: "unknown", words: "no answer yet" }];
  const silence = silenceS() ?? 0;
  if (silence > LOST_AFTER_S) {
    return [{ name: "Service", level: "bad", words: `no answer for ${duration(silence)}; trying again` }];
  }
  return [
    ...(status.leader ? [leader(status.leader)] : []),
    ...(status.leader?.clock ? [clock(status.leader.clock)] : []),
    ...(status.role === "follower" || known.cameras.size > 0 ? cameras() : []),
    ...(status.router ? [router(status.router)] : []),
    ...(status.recorder ? [recorder(status.recorder)] : []),
    service(status),
  ];
}

/** @param {any} status @returns {Item} */
function service(status) {
  const name = "Service";
  if (status.role === "follower" && !known.following) {
    return { name, level: "warn", words: "answers, but its events do not arrive" };
  }
  return { name, level: "good", words: `up ${duration(status.uptime_s)}, version ${status.version}` };
}

/** @param {any} leader @returns {Item} */
function leader(leader) {
  const name = leader.vehicle && leader.vehicle !== "leader" ? `Leader ${leader.vehicle}` : "Leader";
  const age = typeof leader.age_s === "number" ? leader.age_s + (silenceS() ?? 0) : null;
  if (leader.present) {
    return { name, level: "good", words: age === null ? "present" : `present, heard ${ago(age)}` };
  }
  if (age === null) return { name, level: "warn", words: "never heard" };
  return { name, level: "warn", words: `absent, last heard ${ago(age)}` };
}

/** Words that change only when a person should know. @param {any} clock @returns {Item} */
function clock(clock) {
  const name = "Leader's clock";
  if (clock.in_step) return { name, level: "good", words: "in step with this vehicle's" };
  const direction = clock.offset_ms > 0 ? "ahead of" : "behind";
  return { name, level: "warn", words: `${duration(Math.abs(clock.offset_ms) / 1000)} ${direction} this vehicle's` };
}

/** @returns {Item[]} */
function cameras() {
  if (known.cameras.size === 0) return [{ name: "Camera", level: "warn", words: "none heard" }];
  return [...known.cameras.values()].map(camera);
}

/** @param {any} camera @returns {Item} */
function camera(camera) {
  const name = `Camera ${camera.id}`;
  const age = frameAgeMs(camera);
  if (camera.state === "waiting" || age === null) return { name, level: "warn", words: "waiting for its first frame" };
  if (camera.state === "live" && age <= STALE_AFTER_MS) {
    // A leader only looks: it counts no frames.
    const rate = typeof camera.fps === "number" ? `${figure(camera.fps, 1, "fps")}, ` : "";
    return { name, level: "good", words: `live, ${rate}frame ${roundedAge(age)} old` };
  }
  return { name, level: "bad", words: `stopped, last frame ${duration(age / 1000)} old` };
}

/** An age that does not flicker: to the next 50 ms. @param {number} ms */
function roundedAge(ms) {
  return ms < 1000 ? `≤ ${Math.max(50, Math.ceil(ms / 50) * 50)} ms` : duration(ms / 1000);
}

/** @param {any} router @returns {Item} */
function router(router) {
  return router.connected
    ? { name: "Router", level: "good", words: "connected" }
    : { name: "Router", level: "bad", words: "not connected" };
}

/** @param {any} recorder @returns {Item} */
function recorder(recorder) {
  const lost = recorder.lost > 0 ? `, ${recorder.lost} messages lost` : "";
  switch (recorder.state) {
    case "recording":
      return { name: "Recorder", level: lost ? "warn" : "good", words: `recording, ${bytes(recorder.bytes)}${lost}` };
    case "failed":
      return { name: "Recorder", level: "bad", words: `failed: ${recorder.reason ?? "reason unknown"}` };
    default:
      return { name: "Recorder", level: "unknown", words: `${recorder.state}${lost}` };
  }
}

/** Shows what is known now. */
export function showHeader() {
  const { status } = known;
  document.body.dataset.role = status?.role ?? "";
  setText(byId("vehicle"), status?.vehicle ?? "Waymark");
  setText(byId("role"), status && status.role !== status.vehicle ? status.role : "");
  const all = items();
  reconcile(byId("states"), kept, all.map((item) => item.name), (name) =>
    make("div", "", make("dt", "", name), make("dd", "", makeState())));
  for (const item of all) {
    const state = /** @type {HTMLElement} */ (kept.get(item.name).lastElementChild.firstElementChild);
    showState(state, item.level, item.words);
  }
  showTitle(all);
  showNotice();
}

/** @param {Item[]} all */
function showTitle(all) {
  const worst = all.find((item) => item.level === "bad") ?? all.find((item) => item.level === "warn");
  const name = known.status?.vehicle ?? "Waymark";
  const title = worst ? `${name}: ${worst.name} ${worst.words.split(",")[0]}` : `${name} · Waymark`;
  if (document.title !== title) document.title = title;
}

function showNotice() {
  const notice = byId("notice");
  const readOnly = known.access === "read_only";
  notice.hidden = !readOnly;
  if (readOnly) {
    setText(notice, "Read-only: other machines can connect and no token is set. Start with --token-file to allow changes.");
  }
}
