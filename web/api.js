// What the page asks of the service it came from. Every call ends: nothing here waits for ever.

import { asStored } from "./jpeg.js";

const PATIENCE_MS = 4000;

/** An answer that is a problem document (RFC 9457). */
export class Problem extends Error {
  /** @param {number} status @param {Record<string, any>} document */
  constructor(status, document) {
    super(document.detail ?? `the service answered ${status}`);
    this.status = status;
    this.document = document;
  }
}

/** @param {Response} response */
async function problem(response) {
  const document = await response.json().catch(() => ({}));
  return new Problem(response.status, document);
}

/** @param {string} path @param {number} [patienceMs] */
export async function getJson(path, patienceMs = PATIENCE_MS) {
  const response = await fetch(path, { signal: AbortSignal.timeout(patienceMs) });
  if (!response.ok) throw await problem(response);
  return response.json();
}

/** What the service says of itself, and what a client may do: `open`, `token` or `read_only`. */
export async function getStatus() {
  const response = await fetch("/api/v1/status", { signal: AbortSignal.timeout(PATIENCE_MS) });
  if (!response.ok) throw await problem(response);
  return { status: await response.json(), access: response.headers.get("x-waymark-access") ?? "open" };
}

/** A change, with the token that is kept for this tab. @param {string} path @param {{method?: string, body?: any}} [how] */
export async function change(path, { method = "POST", body } = {}) {
  const token = sessionStorage.getItem("token");
  /** @type {Record<string, string>} */
  const headers = {};
  if (token) headers.authorization = `Bearer ${token}`;
  if (body !== undefined) headers["content-type"] = "application/json";
  const sent = body === undefined ? undefined : JSON.stringify(body);
  const response = await fetch(path, { method, headers, body: sent, signal: AbortSignal.timeout(PATIENCE_MS) });
  if (!response.ok) throw await problem(response);
  return response.json().catch(() => null);
}

/** Keeps a bearer token for this tab. @param {string} token */
export function keepToken(token) {
  sessionStorage.setItem("token", token);
}

/**
 * @typedef {object} Picture
 * @property {ImageBitmap} bitmap
 * @property {number} sequence
 * @property {number} ageMs age when it was sent
 * @property {import("./drawing.js").Seen | null} seen what was seen in it, where it was told with it
 */

/** @typedef {{layers: string[], format: "jpg" | "png", widthPx: number}} Wanted what a picture is to look like; `png` keeps every pixel */

/** @param {string} path @param {AbortSignal} stop */
async function ask(path, stop) {
  const response = await fetch(path, { signal: AbortSignal.any([stop, AbortSignal.timeout(PATIENCE_MS + 5000)]) });
  if (!response.ok) throw await problem(response);
  return response;
}

/** @param {Response} response @param {Blob} file @param {any} [seen] @returns {Promise<Picture>} */
async function pictureOf(response, file, seen = null) {
  const undecodable = () => new Problem(response.status, { detail: "this picture is damaged: the browser cannot decode it" });
  const bitmap = await createImageBitmap(await asStored(file), { colorSpaceConversion: "none" }).catch(() => Promise.reject(undecodable()));
  return {
    bitmap,
    sequence: Number(response.headers.get("x-waymark-sequence")),
    ageMs: Number(response.headers.get("x-waymark-age-ms")),
    seen,
  };
}

/** @param {string} path @param {AbortSignal} stop */
export async function getPicture(path, stop) {
  const response = await ask(path, stop);
  return pictureOf(response, await response.blob());
}

/**
 * The next picture that is not `after`, and what was seen in it: one answer, so that neither is of another frame.
 * @param {string} camera @param {number | null} after @param {Wanted} wanted @param {AbortSignal} stop
 */
export async function nextPicture(camera, after, wanted, stop) {
  const query = new URLSearchParams({ format: wanted.format });
  if (wanted.layers.length > 0) query.set("layers", wanted.layers.join(","));
  if (wanted.widthPx > 0) query.set("width", String(wanted.widthPx));
  if (after !== null) query.set("after", String(after));
  const response = await ask(`/api/v1/cameras/${encodeURIComponent(camera)}/seen?${query}`, stop);
  const parts = await response.formData();
  const seen = parts.get("seen");
  return pictureOf(response, /** @type {File} */ (parts.get("picture")), typeof seen === "string" ? JSON.parse(seen) : null);
}

/**
 * A recorded picture, and what was said of it.
 * @param {{name: string, camera: string}} recording @param {number} frame @param {Wanted} wanted @param {AbortSignal} stop
 */
export async function recordedPicture({ name, camera }, frame, wanted, stop) {
  // Every layer would be drawn unless told otherwise.
  const query = new URLSearchParams({ camera, layers: wanted.layers.join(",") });
  if (wanted.widthPx > 0) query.set("width", String(wanted.widthPx));
  const path = `/api/v1/recordings/${encodeURIComponent(name)}/frames/${frame}`;
  const [picture, entry] = await Promise.all([
    getPicture(`${path}.${wanted.format}?${query}`, stop),
    getJson(`${path}.json?${new URLSearchParams({ camera })}`),
  ]);
  return { picture, entry };
}

/** The landmarks that a recording was made with. @param {string} name */
export async function recordedLandmarks(name) {
  return (await getJson(`/api/v1/recordings/${encodeURIComponent(name)}/landmarks`)).landmarks ?? [];
}

/**
 * Follows the events; the browser connects again by itself and says where it stopped.
 * @param {(camera: any) => void} onCamera @param {(connected: boolean) => void} onConnection
 */
export function followEvents(onCamera, onConnection) {
  let source = open();
  function open() {
    const events = new EventSource("/api/v1/events");
    events.addEventListener("open", () => onConnection(true));
    events.addEventListener("camera", (event) => onCamera(JSON.parse(event.data)));
    events.addEventListener("error", () => {
      onConnection(false);
      // A refusal, unlike a lost connection, ends the source for good: try again ourselves.
      if (events.readyState === EventSource.CLOSED) setTimeout(() => (source = open()), 2000);
    });
    return events;
  }
  return { close: () => source.close() };
}
