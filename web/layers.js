// What is drawn over the picture, to be chosen.

import { byId, make, reconcile } from "./dom.js";
import { restartLive } from "./live.js";
import { redraw } from "./picture.js";
import { known } from "./state.js";

const NAMES = {
  outline: "Outline",
  segments: "Hough segments",
  vector: "Vector from origin",
  prediction: "Prediction",
  gate: "Gate",
  mask: "Mask",
  labels: "Labels",
};

/** Needs the pixels as the registration sees them, so the service draws it; it hides what it covers, so it is off at first. */
const MASK = "mask";

/** @type {Map<string, HTMLElement>} */
const kept = new Map();

/** Offers the layers that there are. */
export function showLayers() {
  const layers = known.layers ?? [];
  byId("layers").hidden = layers.length === 0;
  for (const layer of layers) if (layer !== MASK) known.layersOn.add(layer);
  reconcile(byId("layers"), kept, ["legend", ...layers], (layer) =>
    layer === "legend" ? /** @type {HTMLElement} */ (byId("layers").firstElementChild) : makeChoice(layer));
}

/** @param {string} layer */
function makeChoice(layer) {
  const box = make("input");
  box.type = "checkbox";
  box.name = layer;
  box.checked = known.layersOn.has(layer);
  box.addEventListener("change", () => {
    if (box.checked) known.layersOn.add(layer);
    else known.layersOn.delete(layer);
    if (layer === MASK) restartLive();
    else redraw();
  });
  return make("label", "", box, ` ${NAMES[/** @type {keyof typeof NAMES} */ (layer)] ?? layer}`);
}
