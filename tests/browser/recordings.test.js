// What was recorded is listed, looked at with the same eyes as the live picture, downloaded and deleted.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { openBrowser } from "./browser.js";
import { startDemo } from "./demo.js";
import { openWatched } from "./watched_page.js";

/** @type {Awaited<ReturnType<typeof startDemo>>} */
let demo;
/** @type {import("playwright-core").Browser} */
let browser;

before(async () => {
  [demo, browser] = await Promise.all([startDemo(), openBrowser()]);
});
after(async () => {
  await browser?.close();
  await demo?.stop();
});

/** Ends the file being written and waits until the page lists a finished one. @param {import("playwright-core").Page} page */
async function finishOne(page) {
  await page.getByRole("button", { name: "Split into a new file" }).click();
  const line = page.locator("#recordings li", { has: page.locator(".words", { hasText: "finished" }) }).first();
  await line.waitFor();
  await line.getByText(/\d+ frames of front/).waitFor();
  return line;
}

test("a recording takes the place of the live picture, is scrubbed, and gives the place back", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const line = await finishOne(page);
  await line.getByRole("button", { name: "Look at it" }).click();
  await page.locator("#live-title").getByText(/^Recording follower-/).waitFor();
  await page.locator("#frame-facts").getByText(/recorded/).waitFor();
  await page.locator("#playback-toggle").click();
  await page.locator("#playback-toggle").getByText("Play").waitFor();
  const slider = page.locator("#playback-frame");
  const last = Number(await slider.getAttribute("max"));
  assert.ok(last > 1, `${last + 1} frames`);
  // Frames that were registered live show what was seen in them: the one in the middle of the file is.
  const middle = Math.floor(last / 2);
  const shows = (/** @type {number} */ frame) => page.locator(`#picture[data-frame="${frame}"]`).waitFor();
  await slider.fill(String(middle));
  await shows(middle);
  await page.locator("#landmarks .result .words", { hasText: /measured|missed/ }).first().waitFor();
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await shows(middle + 1);
  await page.getByRole("button", { name: "Frame back" }).click();
  await shows(middle);
  await page.getByRole("button", { name: "Back to live" }).click();
  await page.locator("#frame-facts").getByText(/fps shown/).waitFor();
  assert.equal(await page.locator("#live-title").textContent(), "Live");
  assert.deepEqual(complaints, []);
  await close();
});

test("playback runs by itself and stops at the end", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const line = await finishOne(page);
  await line.getByRole("button", { name: "Look at it" }).click();
  await page.getByLabel("Speed").selectOption("4");
  await page.locator("#playback-toggle").getByText("Play").waitFor();
  const slider = page.locator("#playback-frame");
  assert.equal(await slider.inputValue(), await slider.getAttribute("max"));
  assert.deepEqual(complaints, []);
  await close();
});

test("a recorded frame is told with the landmarks that it was registered with, bearing included", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const line = await finishOne(page);
  // What is in force by now is another set.
  const retired = await fetch(`${demo.leaderUrl}/api/v1/landmarks/blue`, { method: "DELETE" });
  assert.equal(retired.status, 200);
  await page.locator("#landmarks .name", { hasText: /^blue/ }).first().waitFor({ state: "detached" });
  await line.getByRole("button", { name: "Look at it" }).click();
  await page.locator("#frame-facts").getByText(/recorded/).waitFor();
  await page.locator("#playback-toggle").click();
  const slider = page.locator("#playback-frame");
  const last = Number(await slider.getAttribute("max"));
  const blue = page.locator("#landmarks tbody tr", { has: page.locator(".name", { hasText: /^blue/ }) }).first();
  const bearings = async () => (await page.locator("#landmarks .facts-list div", { hasText: "Bearing" }).locator("dd").allTextContents()).filter((text) => text !== "—");
  for (let frame = last; frame >= 0 && (await bearings()).length === 0; frame -= 1) {
    await slider.fill(String(frame));
    await page.locator(`#picture[data-frame="${frame}"]`).waitFor();
    // The table follows the picture at its own pace.
    await page.waitForFunction(() => {
      const [picture, table] = ["#picture", "#landmarks"].map((id) => /** @type {HTMLElement} */ (document.querySelector(id)).dataset);
      return picture.sequence === table.sequence;
    });
  }
  assert.match((await bearings())[0] ?? "no frame has a bearing", /^\d+\.\d° (left|right|ahead)$/);
  assert.match((await blue.locator(".expected").first().textContent()) ?? "", /^\d+ ± \d+$/);
  assert.match((await page.locator("#landmark-facts").textContent()) ?? "", /set \d+\.\d+$/);
  assert.deepEqual(complaints, []);
  await close();
});

test("layers are drawn into recorded pictures as into live ones", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const line = await finishOne(page);
  await line.getByRole("button", { name: "Look at it" }).click();
  await page.locator("#frame-facts").getByText(/recorded/).waitFor();
  const asked = page.waitForRequest((request) => /frames\/\d+\.(jpg|png)/.test(request.url()) && request.url().includes("mask"));
  await page.waitForFunction(() => {
    const [picture, drawing] = ["#picture", "#drawing"].map((id) => /** @type {HTMLElement} */ (document.querySelector(id)).dataset);
    return picture.sequence === drawing.sequence;
  });
  await page.getByLabel("Mask").check();
  await asked;
  assert.deepEqual(complaints, []);
  await close();
});

test("a recording is downloaded whole, and deleted only when that was meant", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url, { acceptDownloads: true });
  const line = await finishOne(page);
  const name = (await line.locator(".name").textContent()) ?? "";
  const download = page.waitForEvent("download");
  await line.getByRole("link", { name: "Download" }).click();
  assert.equal((await download).suggestedFilename(), `${name}.mcap`);
  const one = page.locator("#recordings li", { has: page.getByText(name, { exact: true }) });
  await one.getByRole("button", { name: "Delete" }).click();
  await one.getByRole("button", { name: "Really delete it" }).click();
  await one.waitFor({ state: "detached" });
  const left = await fetch(`${demo.url}/api/v1/recordings/${name}.mcap`);
  assert.equal(left.status, 404);
  assert.deepEqual(complaints, []);
  await close();
});
