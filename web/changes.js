// Changes that a person asks for: made, or answered with words; the token is asked for where one is needed.

import { Problem, change, keepToken } from "./api.js";
import { make, setText } from "./dom.js";

/**
 * Makes a change; what went wrong is told in `place`. Resolves when it is made or given up: the answer, or null.
 * @param {Element} place @param {string} path @param {{method?: string, body?: any}} [how]
 * @returns {Promise<any>}
 */
export async function ask(place, path, how = {}) {
  try {
    const answer = await change(path, how);
    setText(place, "");
    return answer ?? {};
  } catch (error) {
    if (error instanceof Problem && error.status === 401) return askToken(place, path, how);
    setText(place, error instanceof Problem ? error.message : "The service does not answer.");
    return null;
  }
}

/** @param {Element} place @param {string} path @param {{method?: string, body?: any}} how */
function askToken(place, path, how) {
  const field = make("input");
  field.type = "password";
  field.autocomplete = "off";
  const again = make("button", "", "Use this token");
  again.type = "button";
  place.replaceChildren(make("label", "", "Changes need the token: ", field), " ", again);
  field.focus();
  return new Promise((resolve) => {
    again.addEventListener("click", () => {
      keepToken(field.value.trim());
      resolve(ask(place, path, how));
    });
  });
}
