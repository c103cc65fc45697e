// What the page costs and how live it is, on this machine: node measure.js [WIDTH HEIGHT FPS SECONDS]
// Figures depend on the machine, so nothing here is a test.

import { readFile, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { openBrowser } from "./browser.js";
import { freePort } from "./demo.js";
import { startPart, stopParts, untilAnswered } from "./parts.js";

const [width = 1280, height = 720, fps = 30, seconds = 15] = process.argv.slice(2).map(Number);
/** Clock ticks of /proc per second: the same on every Linux that is about. */
const TICKS_PER_S = 100;

const place = await mkdtemp(join(tmpdir(), "waymark-measure-"));
const [http, tcp] = [await freePort(), await freePort()];
const url = `http://127.0.0.1:${http}`;
const browser = await openBrowser();
try {
  const quiet = { "zenoh.multicast": "false" };
  const follower = startPart("follower", { ...quiet, "zenoh.listen": `["tcp/127.0.0.1:${tcp}"]`, "http.listen": `127.0.0.1:${http}`, state_dir: join(place, "follower"), "recorder.enabled": "false" }, place);
  await untilAnswered(`${url}/livez`);
  const source = `sim:rink?seed=1&vehicle=2&width=${width}&height=${height}&fps=${fps}`;
  startPart("camera", { ...quiet, "zenoh.connect": `["tcp/127.0.0.1:${tcp}"]`, vehicle: "follower", camera: "front", source }, place);
  await untilAnswered(`${url}/api/v1/cameras/front/frame.jpg`);
  const encodesBefore = await encodes();
  const alone = await cost(follower.pid ?? 0, seconds);
  const encodesAlone = (await encodes()) - encodesBefore;
  const encodesUnwatched = await encodes();
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  let bytes = 0;
  let isFirst = true;
  page.on("response", (response) => {
    if (isFirst && !new URL(response.url()).pathname.startsWith("/api/")) bytes += Number(response.headers()["content-length"] ?? 0);
  });
  await page.addInitScript(watch);
  await page.goto(url);
  await page.waitForSelector("#picture[data-sequence]");
  isFirst = false;
  const firstMs = await page.evaluate(() => globalThis.shown[0].atMs);
  await page.evaluate(() => (globalThis.shown.length = 0));
  const watched = await cost(follower.pid ?? 0, seconds);
  const shown = await page.evaluate(() => globalThis.shown);
  const delays = shown.map((one) => one.delayMs).filter(Number.isFinite).sort((a, b) => a - b);
  const at = (part) => delays[Math.floor((delays.length - 1) * part)]?.toFixed(0);
  console.log(`${width} × ${height} px, ${fps} fps from the camera, ${(await registeredHz()).toFixed(1)} registered`);
  console.log(`shown ${(shown.length / seconds).toFixed(1)} fps; capture to canvas median ${at(0.5)} ms, 95 % ${at(0.95)} ms`);
  const pageMs = watched.frameMs - alone.frameMs;
  console.log(`follower ${(100 * alone.cores).toFixed(1)} % of a core without the page, ${(100 * watched.cores).toFixed(1)} % with it; ${encodesAlone} encodes without it, ${(await encodes()) - encodesUnwatched} with it`);
  console.log(`processor time a frame ${alone.frameMs.toFixed(2)} ms without it, ${watched.frameMs.toFixed(2)} ms with it: at ${fps} fps the page takes ${((pageMs * fps) / 10).toFixed(1)} % of a core`);
  console.log(`${(bytes / 1000).toFixed(0)} kB and ${firstMs.toFixed(0)} ms before the first picture`);
} finally {
  await browser.close();
  await stopParts();
  await rm(place, { recursive: true, force: true });
}

/** Notes each picture that is put on the canvas, and how old it is then. */
function watch() {
  const capturedAtMs = new Map();
  const ask = globalThis.fetch;
  globalThis.fetch = async (...asked) => {
    const answer = await ask(...asked);
    const sequence = answer.headers.get("x-waymark-sequence");
    if (sequence) capturedAtMs.set(sequence, Number(answer.headers.get("x-waymark-captured-at")) / 1e6);
    return answer;
  };
  globalThis.shown = [];
  document.addEventListener("DOMContentLoaded", () => {
    const canvas = document.querySelector("#picture");
    const note = () => {
      const { sequence } = canvas.dataset;
      globalThis.shown.push({ atMs: performance.now(), delayMs: Date.now() - capturedAtMs.get(sequence) });
    };
    new MutationObserver(note).observe(canvas, { attributeFilter: ["data-sequence"] });
  });
}

/** Cores that a process uses, and its processor time for each frame, ms: a busy machine registers fewer. @param {number} pid @param {number} seconds */
async function cost(pid, seconds) {
  const ticks = async () => {
    const fields = (await readFile(`/proc/${pid}/stat`, "utf8")).split(") ")[1].split(" ");
    return Number(fields[11]) + Number(fields[12]);
  };
  const [before, framesBefore] = [await ticks(), await counted("waymark_frames_registered_total")];
  await new Promise((next) => setTimeout(next, seconds * 1000));
  const used = ((await ticks()) - before) / TICKS_PER_S;
  return { cores: used / seconds, frameMs: (1000 * used) / ((await counted("waymark_frames_registered_total")) - framesBefore) };
}

/** Views encoded for whoever looks. */
function encodes() {
  return counted("waymark_http_encodes_total");
}

/** @param {string} name of a count of the camera */
async function counted(name) {
  const text = await (await fetch(`${url}/metrics`)).text();
  return Number(new RegExp(`${name}\\{camera="front"\\} (\\d+)`).exec(text)?.[1] ?? 0);
}

async function registeredHz() {
  return (await (await fetch(`${url}/api/v1/status`)).json()).cameras[0].fps;
}
