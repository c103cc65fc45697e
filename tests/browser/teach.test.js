// A landmark is learned by drawing a box on the leader's live picture, judged, published and retired.

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

/** Where on the screen a pixel of the picture is. @param {import("playwright-core").Page} page @param {number} x @param {number} y */
async function onScreen(page, x, y) {
  await page.locator("#picture").scrollIntoViewIfNeeded();
  return page.locator("#picture").evaluate((canvas, [x, y]) => {
    const { width, height } = /** @type {HTMLCanvasElement} */ (canvas);
    const box = canvas.getBoundingClientRect();
    const scale = Math.min(box.width / width, box.height / height);
    return [box.left + (box.width - width * scale) / 2 + x * scale, box.top + (box.height - height * scale) / 2 + y * scale];
  }, [x, y]);
}

/** Drags a box over pixels of the picture. @param {import("playwright-core").Page} page @param {number[]} from @param {number[]} to */
async function drag(page, from, to) {
  const [left, top] = await onScreen(page, from[0], from[1]);
  await page.mouse.move(left, top);
  await page.mouse.down();
  await page.locator("#teach-facts").getByText(/picture \d+/).waitFor();
  await page.locator("#frame-facts").getByText(/taken to learn from/).waitFor();
  const [right, bottom] = await onScreen(page, to[0], to[1]);
  await page.mouse.move(right, bottom, { steps: 5 });
  await page.mouse.up();
}

test("a box on the live picture becomes a landmark that followers look for, until it is retired", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.leaderUrl);
  await drag(page, [300, 20], [340, 50]);
  const verdict = page.locator("#teach-verdict");
  await verdict.getByText(/tolerances off at its nearest/).waitFor();
  await verdict.locator(".state .words").waitFor();
  assert.equal(await page.getByLabel("Left px").inputValue(), "300");
  const masked = page.waitForResponse((response) => response.url().includes("/mask.png") && response.ok());
  await page.getByLabel("Show what matches").check();
  await masked;
  await page.getByLabel("Name").fill("by-hand");
  await page.getByRole("button", { name: "Publish" }).click();
  await page.locator("#landmarks .name", { hasText: /^by-hand$/ }).waitFor();
  const known = async () => (await (await fetch(`${demo.url}/api/v1/landmarks`)).json()).landmarks.map((/** @type {any} */ one) => one.id);
  await until(async () => (await known()).includes("by-hand"));
  await page.getByRole("button", { name: "Retire: by-hand" }).click();
  await page.getByRole("button", { name: "Really retire it: by-hand" }).click();
  await page.locator("#landmarks .name", { hasText: /^by-hand$/ }).waitFor({ state: "detached" });
  await until(async () => !(await known()).includes("by-hand"));
  await page.getByRole("button", { name: "Back to live" }).click();
  await page.locator("#frame-facts").getByText(/fps shown/).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test("the box can be given in figures, and what is no box is told", async () => {
  const { page, close } = await openWatched(browser, demo.leaderUrl);
  /** @type {() => void} */
  let release = () => {};
  const held = new Promise((next) => { release = () => next(undefined); });
  await page.route("**/api/v1/lessons?*", async (route) => {
    await held;
    await route.continue();
  });
  await page.getByRole("button", { name: "Take this picture" }).click();
  assert.ok(await page.getByLabel("Left px").isDisabled(), "a box is asked for before there is a picture");
  release();
  await page.locator("#frame-facts").getByText(/taken to learn from/).waitFor();
  for (const [label, value] of [["Left px", "630"], ["Top px", "100"], ["Width px", "30"], ["Height px", "30"]]) {
    await page.getByLabel(label, { exact: true }).fill(value);
    await page.keyboard.press("Tab");
  }
  await page.locator("#teach-answer").getByText(/leaves its picture/).waitFor();
  await page.getByLabel("Left px").fill("200");
  await page.keyboard.press("Tab");
  await page.locator("#teach-verdict").getByText(/Registration finds/).waitFor();
  await close();
});

/** @param {() => Promise<boolean>} condition */
async function until(condition) {
  const deadline = Date.now() + 60_000;
  while (!(await condition())) {
    if (Date.now() > deadline) throw new Error("it did not come true");
    await new Promise((next) => setTimeout(next, 100));
  }
}
