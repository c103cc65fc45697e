// The real program, as a person would start it, with every file and port of its own.

import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync } from "node:fs";
import { mkdtemp, rm } from "node:fs/promises";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const ROOT = resolve(fileURLToPath(import.meta.url), "../../..");
const PLACES = [process.env.WAYMARK_BIN, join(ROOT, "target/release/waymark"), join(ROOT, "target/debug/waymark")];
const START_MS = 60_000;

export async function freePort() {
  const server = createServer().listen(0, "127.0.0.1");
  await once(server, "listening");
  const { port } = /** @type {import("node:net").AddressInfo} */ (server.address());
  server.close();
  await once(server, "close");
  return port;
}

/** The program that is tested. */
export function binary() {
  const found = PLACES.find((place) => place && existsSync(place));
  if (!found) throw new Error("no binary to test: build it with cargo or set WAYMARK_BIN");
  return found;
}

/** Starts `waymark demo` and waits until its camera is live. */
export async function startDemo({ port = 0 } = {}) {
  const path = binary();
  const recordings = await mkdtemp(join(tmpdir(), "waymark-browser-"));
  const [http, leader] = [port || (await freePort()), await freePort()];
  const program = spawn(path, [
    "demo", "--headless", "--duration", "600s", "--listen", `127.0.0.1:${http}`,
    "--leader-listen", `127.0.0.1:${leader}`, "--recordings", recordings,
  ], { stdio: ["ignore", "pipe", "pipe"] });
  const said = [];
  for (const stream of [program.stdout, program.stderr]) stream.on("data", (chunk) => said.push(chunk.toString()));
  const url = `http://127.0.0.1:${http}`;
  const demo = { url, leaderUrl: `http://127.0.0.1:${leader}`, port: http, recordings, program, stop };
  try {
    await until(() => isLive(url), () => program.exitCode !== null, () => `the demo did not come to life:\n${said.join("")}`);
  } catch (error) {
    await stop();
    throw error;
  }
  return demo;

  async function stop() {
    if (program.exitCode === null && program.signalCode === null) {
      program.kill("SIGINT");
      const kill = setTimeout(() => program.kill("SIGKILL"), 10_000);
      await once(program, "exit");
      clearTimeout(kill);
    }
    await rm(recordings, { recursive: true, force: true });
  }
}

/** @param {string} url */
async function isLive(url) {
  const status = await fetch(`${url}/api/v1/status`).then((answer) => answer.json()).catch(() => null);
  return status?.cameras?.some((/** @type {any} */ camera) => camera.state === "live" && camera.landmarks.length > 0) ?? false;
}

/** @param {() => Promise<boolean>} condition @param {() => boolean} isHopeless @param {() => string} complaint */
async function until(condition, isHopeless, complaint) {
  const deadline = Date.now() + START_MS;
  while (!(await condition())) {
    if (isHopeless() || Date.now() > deadline) throw new Error(complaint());
    await new Promise((next) => setTimeout(next, 100));
  }
}
