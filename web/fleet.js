// Every vehicle that is present.

import { byId, make, makeState, reconcile, setText, showState } from "./dom.js";
import { ago } from "./words.js";

const kept = new Map();

/** Shows the answer of /api/v1/fleet. @param {{vehicles?: any[]}} fleet */
export function showFleet(fleet) {
  const vehicles = fleet.vehicles ?? [];
  byId("fleet-section").hidden = vehicles.length === 0;
  setText(byId("fleet-facts"), `${vehicles.length} present`);
  reconcile(byId("fleet"), kept, vehicles.map((one) => `${one.vehicle}/${one.role}`), () =>
    make("li", "", make("b"), " ", make("span", "quiet"), " ", makeState()));
  for (const one of vehicles) {
    const [name, role, state] = kept.get(`${one.vehicle}/${one.role}`).children;
    setText(name, one.vehicle);
    setText(role, one.role);
    const stale = typeof one.age_s === "number" && one.age_s > 3;
    showState(state, stale ? "warn" : "good", typeof one.age_s === "number" ? `heard ${ago(one.age_s)}` : "present");
  }
}
