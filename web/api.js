// What the page asks of the service it came from. Every call ends: nothing here waits for ever.

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

/** @param {string} path */
export async function getJson(path) {
  const response = await fetch(path, { signal: AbortSignal.timeout(PATIENCE_MS) });
  if (!response.ok) throw await problem(response);
  return response.json();
}

/** What the service says of itself, and what a client may do: `open`, `token` or `read_only`. */
export async function getStatus() {
  const response = await fetch("/api/v1/status", { signal: AbortSignal.timeout(PATIENCE_MS) });
  if (!response.ok) throw await problem(response);
  return { status: await response.json(), access: response.headers.get("x-waymark-access") ?? "open" };
}

/** A change; the token is asked for once and kept for this tab only. @param {string} path @param {string} [method] */
export async function change(path, method = "POST") {
  const token = sessionStorage.getItem("token");
  const headers = token ? { authorization: `Bearer ${token}` } : undefined;
  const response = await fetch(path, { method, headers, signal: AbortSignal.timeout(PATIENCE_MS) });
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

/**
 * The next picture that is not `after`; the geometry drawn into it is that of the same frame.
 * @param {string} camera
 * @param {{layers: string[], after: number | null, format: "jpg" | "png", widthPx: number}} wanted `png` keeps every pixel
 * @param {AbortSignal} stop
 * @returns {Promise<Picture>}
 */
export async function nextPicture(camera, { layers, after, format, widthPx }, stop) {
  const query = new URLSearchParams({ layers: layers.join(",") });
  if (after !== null) query.set("after", String(after));
  if (widthPx > 0) query.set("width", String(widthPx));
  const path = `/api/v1/cameras/${encodeURIComponent(camera)}/overlay.${format}?${query}`;
  const signal = AbortSignal.any([stop, AbortSignal.timeout(PATIENCE_MS + 5000)]);
  const response = await fetch(path, { signal });
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
