// Parts of a convoy, each a process of its own, go away one after the other: the page says which, and sees them return.

import assert from "node:assert/strict";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { openBrowser } from "./browser.js";
import { freePort } from "./demo.js";
import { startPart, stopPart, stopParts, untilAnswered } from "./parts.js";
import { openWatched } from "./watched_page.js";

const LONG = { timeout: 60_000 };

/** @type {import("playwright-core").Browser} */
let browser;
/** @type {string} */
let place;

before(async () => {
  [browser, place] = await Promise.all([openBrowser(), mkdtemp(join(tmpdir(), "waymark-parts-"))]);
});
after(async () => {
  await browser?.close();
  await stopParts();
  await rm(place, { recursive: true, force: true });
});

test("the loss of leader and camera is told, and their return", async () => {
  const [http, leaderHttp, tcp] = [await freePort(), await freePort(), await freePort()];
  const reach = { "zenoh.multicast": "false", "zenoh.connect": `["tcp/127.0.0.1:${tcp}"]` };
  const roles = {
    follower: { "zenoh.multicast": "false", "zenoh.listen": `["tcp/127.0.0.1:${tcp}"]`, "http.listen": `127.0.0.1:${http}`, state_dir: join(place, "follower"), "recorder.enabled": "false" },
    leader: { ...reach, "http.listen": `127.0.0.1:${leaderHttp}`, state_dir: join(place, "leader") },
    camera: { ...reach, vehicle: "follower", camera: "front", source: "sim:rink?seed=1&vehicle=2" },
  };
  startPart("follower", roles.follower, place);
  const url = `http://127.0.0.1:${http}`;
  await untilAnswered(`${url}/livez`);
  let [leader, camera] = [startPart("leader", roles.leader, place), startPart("camera", roles.camera, place)];
  const { page, close } = await openWatched(browser, url);
  const states = page.locator("#states");
  await states.getByText(/^present/).waitFor(LONG);
  await states.getByText(/^live, /).waitFor(LONG);

  await stopPart(camera);
  await states.getByText(/^stopped, last frame/).waitFor(LONG);
  await page.locator("#stage.old").waitFor(LONG);
  camera = startPart("camera", roles.camera, place);
  await states.getByText(/^live, /).waitFor(LONG);
  await page.locator("#stage:not(.old)").waitFor(LONG);

  await stopPart(leader);
  await states.getByText(/^absent, last heard/).waitFor(LONG);
  leader = startPart("leader", roles.leader, place);
  await states.getByText(/^present/).waitFor(LONG);
  const told = (await page.locator("#log").textContent()) ?? "";
  assert.match(told, /stopped/);
  assert.match(told, /absent/);
  await close();
});
