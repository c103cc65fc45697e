// The few ways in which this page touches the document.

/** @template {HTMLElement} [T=HTMLElement] @param {string} id @returns {T} */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element ${id}`);
  return /** @type {T} */ (element);
}

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag @param {string} [className] @param {(Node | string)[]} children
 */
export function make(tag, className = "", ...children) {
  const element = document.createElement(tag);
  if (className) element.className = className;
  element.append(...children);
  return element;
}

/** Sets text only when it differs, so that selections and screen readers are left alone. @param {Element} element @param {string} text */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** @param {Element} element @param {string} name @param {string} value */
export function setAttribute(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

const SHAPES = { good: "●", warn: "▲", bad: "✕", unknown: "○" };

/** @typedef {"good" | "warn" | "bad" | "unknown"} Level */

/** A state: a shape, and words that say the same. @param {string} [className] */
export function makeState(className = "") {
  const shape = make("span", "shape");
  shape.setAttribute("aria-hidden", "true");
  return make("span", `state ${className}`.trim(), shape, make("span", "words"));
}

/** @param {HTMLElement} state @param {Level} level @param {string} words */
export function showState(state, level, words) {
  setAttribute(state, "data-level", level);
  const [shape, text] = state.children;
  setText(shape, SHAPES[level]);
  setText(text, words);
}

/**
 * Keeps one child of `parent` for each key, in the order of the keys.
 * @template {Element} T
 * @param {Element} parent @param {Map<string, T>} kept @param {string[]} keys @param {(key: string) => T} create
 */
export function reconcile(parent, kept, keys, create) {
  for (const [key, element] of kept) {
    if (!keys.includes(key)) {
      element.remove();
      kept.delete(key);
    }
  }
  keys.forEach((key, index) => {
    let element = kept.get(key);
    if (!element) {
      element = create(key);
      kept.set(key, element);
    }
    if (parent.children[index] !== element) parent.insertBefore(element, parent.children[index] ?? null);
  });
}
