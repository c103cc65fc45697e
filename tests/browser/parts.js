// Parts of a convoy as processes of their own.

import { spawn } from "node:child_process";
import { once } from "node:events";
import { binary } from "./demo.js";

/** @type {Set<import("node:child_process").ChildProcess>} */
const running = new Set();

/** Starts a part with these settings in directory `place`. @param {string} role @param {Record<string, string>} settings @param {string} place */
export function startPart(role, settings, place) {
  const options = Object.entries(settings).flatMap(([name, value]) => ["--set", `${name}=${value}`]);
  const part = spawn(binary(), [role, ...options], { stdio: "ignore", cwd: place });
  running.add(part);
  return part;
}

/** Asks a part to end, and waits until it has. @param {import("node:child_process").ChildProcess} part */
export async function stopPart(part) {
  running.delete(part);
  if (part.exitCode !== null || part.signalCode !== null) return;
  part.kill("SIGTERM");
  const kill = setTimeout(() => part.kill("SIGKILL"), 10_000);
  await once(part, "exit");
  clearTimeout(kill);
}

/** Ends every part that still runs. */
export async function stopParts() {
  await Promise.all([...running].map(stopPart));
}

/** Waits until somebody answers at `url`. @param {string} url */
export async function untilAnswered(url) {
  const deadline = Date.now() + 60_000;
  while (!(await fetch(url).catch(() => null))?.ok) {
    if (Date.now() > deadline) throw new Error(`nobody answers at ${url}`);
    await new Promise((next) => setTimeout(next, 100));
  }
}
