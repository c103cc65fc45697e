// A stand-in for a service, for working on the page and for looking at states that are hard to bring about.
// What the page does with the real service is tested in ../*.test.js.
//
//   node mock/service.js [state] [port] [directory with JPEG frames]

import { readFile, readdir } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { bitmapOf } from "./bitmap.js";
import { makeWorld } from "./world.js";

const WEB = resolve(fileURLToPath(import.meta.url), "../../../../web");
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const FRAME_MS = 33;

/** @param {string} state @param {number} port @param {string} framesDir */
export async function startService(state, port, framesDir) {
  const names = framesDir ? (await readdir(framesDir)).filter((name) => name.endsWith(".jpg")).sort() : [];
  const frames = await Promise.all(names.slice(0, 60).map((name) => readFile(join(framesDir, name))));
  const world = makeWorld(state);
  const readers = new Set();
  const waiting = new Set();
  const timer = setInterval(() => {
    if (!world.tick()) return;
    for (const reader of readers) {
      for (const camera of world.status().cameras ?? []) reader.write(`id: ${world.sequence}\nevent: camera\ndata: ${JSON.stringify(camera)}\n\n`);
    }
    for (const answer of waiting) answer();
    waiting.clear();
  }, FRAME_MS);

  const json = (response, value, code = 200) => {
    const type = code < 400 ? "application/json" : "application/problem+json";
    response.writeHead(code, { "content-type": type, "x-waymark-access": state === "read-only" ? "read_only" : "open" });
    response.end(JSON.stringify(value));
  };
  const picture = (response) => {
    const refusal = world.refusal();
    if (refusal) return json(response, { status: 503, detail: refusal }, 503);
    const seen = world.seen();
    const file = frames.length > 0 ? frames[world.sequence % frames.length] : bitmapOf(seen);
    const part = (name, type) => `--between\r\ncontent-disposition: form-data; name="${name}"\r\ncontent-type: ${type}\r\n\r\n`;
    response.writeHead(200, {
      "content-type": "multipart/form-data; boundary=between",
      "x-waymark-sequence": world.sequence,
      "x-waymark-captured-at": String(Date.now() * 1e6),
      "x-waymark-age-ms": 12,
    });
    if (state !== "leader") response.write(`${part("seen", "application/json")}${JSON.stringify(seen)}\r\n`);
    response.write(part('picture"; filename="frame', frames.length > 0 ? "image/jpeg" : "image/bmp"));
    response.write(file);
    response.end("\r\n--between--\r\n");
  };
  const routes = {
    "/api/v1/status": (response) => json(response, world.status()),
    "/api/v1/fleet": (response) => json(response, world.fleet()),
    "/api/v1/recordings": (response) => json(response, world.recordings()),
    "/uplot.js": (response) => {
      response.writeHead(200, { "content-type": "text/javascript" });
      response.end("export default null;");
    },
    "/api/v1/landmarks": (response) => json(response, world.landmarks()),
    "/api/v1/cameras": (response) => json(response, { cameras: ["front"], layers: state === "leader" ? [] : ["outline", "segments", "vector", "prediction", "gate", "mask", "labels"] }),
    "/api/v1/events": (response) => {
      response.writeHead(200, { "content-type": "text/event-stream" });
      response.write("retry: 2000\n\n");
      readers.add(response);
      response.on("close", () => readers.delete(response));
    },
  };
  const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url ?? "/", "http://localhost");
    if (pathname.endsWith("/seen")) {
      if (world.refusal()) setTimeout(() => picture(response), 500);
      else waiting.add(() => picture(response));
    } else if (routes[pathname]) routes[pathname](response);
    else if (pathname.startsWith("/api/")) json(response, { status: 404, detail: "there is nothing at this address" }, 404);
    else {
      const file = pathname === "/" ? "index.html" : pathname.slice(1);
      const body = await readFile(join(WEB, file)).catch(() => null);
      response.writeHead(body ? 200 : 404, { "content-type": TYPES[extname(file)] ?? "text/plain" });
      response.end(body);
    }
  });
  await new Promise((done) => server.listen(port, "127.0.0.1", done));
  return { port: server.address().port, close: () => (clearInterval(timer), server.closeAllConnections(), server.close()) };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [, , state = "well", port = "8099", frames = ""] = process.argv;
  const service = await startService(state, Number(port), frames);
  process.stdout.write(`http://127.0.0.1:${service.port}/\n`);
}
