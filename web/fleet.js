// Everyone who is announced in the fleet: who answers, whose clock is off, who runs another version.

import { getJson } from "./api.js";
import { byId, make, makeState, reconcile, setText, showState } from "./dom.js";
import { known } from "./state.js";
import { MISSING, duration } from "./words.js";

/** The service itself asks the others every ten seconds. */
const ASK_MS = 5000;

/** @type {any[]} */
let members = [];

/** @type {Map<string, HTMLElement>} */
const kept = new Map();

/** Asks again and again, as long as the page is there. */
export async function followFleet() {
  try {
    members = (await getJson("/api/v1/fleet")).members ?? [];
  } catch {
    // Silence is what the header shows.
  }
  setTimeout(followFleet, ASK_MS);
}

/** Shows what is known now. */
export function showFleet() {
  reconcile(byId("fleet"), kept, members.map(keyOf), () =>
    make("li", "", make("span", "name"), makeState(), make("span", "quiet")));
  for (const member of members) {
    const [name, state, facts] = /** @type {HTMLElement} */ (kept.get(keyOf(member))).children;
    setText(name, `${member.vehicle} · ${member.role}${isThis(member) ? " (this one)" : ""}`);
    const { level, words } = judge(member);
    showState(/** @type {HTMLElement} */ (state), level, words);
    setText(facts, [member.host, member.version && `version ${member.version}`, isThis(member) ? "" : clockWords(member.clock)].filter(Boolean).join(" · "));
  }
  byId("fleet-none").hidden = members.length > 0;
  const silent = members.filter((member) => !member.answers).length;
  setText(byId("fleet-facts"), `${members.length} announced${silent ? `, ${silent} silent` : ""}`);
}

/** @param {any} member */
function keyOf(member) {
  return `${member.vehicle}/${member.role}/${member.instance}`;
}

/** @param {any} member */
function isThis(member) {
  return member.vehicle === known.status?.vehicle && member.role === known.status?.role;
}

/** @param {any} member @returns {{level: import("./dom.js").Level, words: string}} */
function judge(member) {
  if (!member.answers) return { level: "bad", words: "announced, does not answer" };
  if (member.clock && !member.clock.in_step) return { level: "warn", words: "answers, its clock is off" };
  const own = known.status?.version;
  if (own && member.version && member.version !== own) return { level: "warn", words: "answers, runs another version" };
  return { level: "good", words: "answers" };
}

/** @param {any} clock */
function clockWords(clock) {
  if (typeof clock?.offset_ms !== "number") return `clock ${MISSING}`;
  const side = clock.offset_ms >= 0 ? "ahead" : "behind";
  return `clock ${span(Math.abs(clock.offset_ms))} ${side}, ± ${span(clock.uncertainty_ms)}`;
}

/** Clocks differ by tenths of a millisecond, or by anything. @param {number} ms */
function span(ms) {
  return ms < 1000 ? `${ms.toFixed(1)} ms` : duration(ms / 1000);
}
