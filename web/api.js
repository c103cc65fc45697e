// What the page asks of the service it came from. Every call ends: nothing here waits for ever.

import { known } from "./state.js";

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
 * @property {number} capturedAtMs capture time, ms since the Unix epoch
 * @property {number} ageMs age when it was sent
 */

/** @typedef {{layers: string[], format: "jpg" | "png", widthPx: number}} Wanted what a picture is to look like; `png` keeps every pixel */

/** @param {Wanted} wanted */
function queryOf({ layers, widthPx }) {
  // A service that draws nothing does not know the parameter.
  const query = new URLSearchParams(known.layers?.length ? { layers: layers.join(",") } : {});
  if (widthPx > 0) query.set("width", String(widthPx));
  return query;
}

/** @param {string} path @param {AbortSignal} stop @returns {Promise<Picture>} */
export async function getPicture(path, stop) {
  const response = await fetch(path, { signal: AbortSignal.any([stop, AbortSignal.timeout(PATIENCE_MS + 5000)]) });
  if (!response.ok) throw await problem(response);
  const bitmap = await createImageBitmap(await response.blob());
  return {
    bitmap,
    sequence: Number(response.headers.get("x-waymark-sequence")),
    capturedAtMs: Number(response.headers.get("x-waymark-captured-at")) / 1e6,
    ageMs: Number(response.headers.get("x-waymark-age-ms")),
  };
}

/**
 * The next picture that is not `after`; the geometry drawn into it is that of the same frame.
 * @param {string} camera @param {number | null} after @param {Wanted} wanted @param {AbortSignal} stop
 */
export function nextPicture(camera, after, wanted, stop) {
  const query = queryOf(wanted);
  if (after !== null) query.set("after", String(after));
  return getPicture(`/api/v1/cameras/${encodeURIComponent(camera)}/overlay.${wanted.format}?${query}`, stop);
}

/**
 * A recorded picture, and what was said of it.
 * @param {{name: string, camera: string}} recording @param {number} frame @param {Wanted} wanted @param {AbortSignal} stop
 */
export async function recordedPicture({ name, camera }, frame, wanted, stop) {
  const query = queryOf(wanted);
  query.set("camera", camera);
  if (wanted.format === "png") query.set("quality", "100");
  const path = `/api/v1/recordings/${encodeURIComponent(name)}/frames/${frame}`;
  const [picture, entry] = await Promise.all([
    getPicture(`${path}.jpg?${query}`, stop),
    getJson(`${path}.json?${new URLSearchParams({ camera })}`),
  ]);
  return { picture, entry };
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
