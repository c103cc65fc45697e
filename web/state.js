// What is known now, and when it was learnt. Sections read it; only this file and main.js write it.

/**
 * @typedef {object} Known
 * @property {any} status last answer of /api/v1/status
 * @property {string} access what this page may do: open, token or read_only
 * @property {number} statusAt performance.now() of it
 * @property {Map<string, any>} cameras newest entry of each camera, from status or events
 * @property {Map<string, number>} cameraAt performance.now() of each
 * @property {any[]} landmarks descriptors in force
 * @property {{epoch: number, version: number} | null} version of the landmark set
 * @property {string | null} camera the one shown
 * @property {string[] | null} layers that can be drawn, once they are known
 * @property {Set<string>} layersOn that are drawn
 * @property {boolean} following events arrive
 * @property {any} stillEntry what was said of the frame that is shown, while that is a recorded or a held one
 * @property {any[] | null} recordedLandmarks descriptors of the recording that is shown, while one is shown
 */

/** @type {Known} */
export const known = {
  status: null,
  access: "open",
  statusAt: 0,
  cameras: new Map(),
  cameraAt: new Map(),
  landmarks: [],
  version: null,
  camera: null,
  layers: null,
  layersOn: new Set(),
  following: false,
  stillEntry: null,
  recordedLandmarks: null,
};

/** @param {any} camera */
export function learnCamera(camera) {
  const former = known.cameras.get(camera.id);
  const sinceMs = performance.now() - (known.cameraAt.get(camera.id) ?? -Infinity);
  // An answer that was under way may be older than an event that overtook it. Not so after a pause: then the camera
  // may have started anew and counts from the beginning.
  if (former && sinceMs < 1000 && former.sequence > camera.sequence) return;
  known.cameras.set(camera.id, camera);
  known.cameraAt.set(camera.id, performance.now());
}

/** @param {any} status @param {string} access */
export function learnStatus(status, access) {
  known.status = status;
  known.access = access;
  known.statusAt = performance.now();
  for (const camera of status.cameras ?? []) learnCamera(camera);
  for (const id of known.cameras.keys()) {
    if (!(status.cameras ?? []).some((/** @type {any} */ camera) => camera.id === id)) known.cameras.delete(id);
  }
}

/** What is said of the picture that is shown: of the live one, or of a recorded or held one in its place. */
export function shownEntry() {
  if (known.stillEntry) return known.stillEntry;
  return known.camera ? known.cameras.get(known.camera) : null;
}

/** How old the newest frame of a camera is now, in ms: what the service said, and the time since. @param {any} camera */
export function frameAgeMs(camera) {
  if (typeof camera?.age_ms !== "number") return null;
  return camera.age_ms + performance.now() - (known.cameraAt.get(camera.id) ?? 0);
}

/** Seconds since the service last answered, or null when it never did. */
export function silenceS() {
  return known.statusAt ? (performance.now() - known.statusAt) / 1000 : null;
}

/** The service counts as lost after this long without an answer. */
export const LOST_AFTER_S = 3;

/** A frame older than this is not now. */
export const STALE_AFTER_MS = 2000;
