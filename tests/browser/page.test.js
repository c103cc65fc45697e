// The page on the running program: what a person sees, and that nothing goes wrong on the way.

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

/** @param {string} state the selector of a state @param {import("playwright-core").Page} page */
const wordsOf = (page, state) => page.locator(`${state} .words`).first();

test("loads without a complaint, from this service alone, and is light", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  /** @type {string[]} */
  const foreign = [];
  let bytes = 0;
  page.on("request", (request) => {
    if (!request.url().startsWith(demo.url) && !request.url().startsWith("blob:")) foreign.push(request.url());
  });
  page.on("response", async (response) => {
    const isPage = !new URL(response.url()).pathname.startsWith("/api/");
    if (isPage) bytes += Number(response.headers()["content-length"] ?? 0);
  });
  await page.goto(demo.url);
  await page.waitForFunction(() => Boolean(document.querySelector("#picture")?.dataset.sequence));
  // The camera's pictures are passed on as they came, however many are looked at.
  const first = Number(await page.locator("#picture").getAttribute("data-sequence"));
  await page.waitForFunction((first) => Number(document.querySelector("#picture")?.dataset.sequence) >= first + 5, first);
  const metrics = await (await fetch(`${demo.url}/metrics`)).text();
  assert.match(metrics, /waymark_http_encodes_total\{camera="front"\} 0\n/);
  await context.close();
  assert.deepEqual(foreign, []);
  assert.ok(bytes > 0 && bytes <= 250_000, `${bytes} bytes before the first picture`);
});

test("the picture is live and the header says so in words", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const sequence = () => page.locator("#picture").getAttribute("data-sequence");
  const first = await sequence();
  await page.waitForFunction((first) => document.querySelector("#picture")?.dataset.sequence !== first, first);
  assert.ok(Number(await sequence()) > Number(first), "pictures come in order");
  const states = page.locator("#states");
  await states.getByText(/^live, /).waitFor();
  await states.getByText(/^present/).waitFor();
  await states.getByText("connected", { exact: true }).waitFor();
  await page.locator("#frame-facts").getByText(/frame \d+ · \d+ fps shown · \d+ × \d+ px/).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test("red and blue are measured, with six statistics each, expected and observed", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  for (const id of ["red", "blue"]) {
    const row = page.locator("#landmarks tbody tr", { has: page.locator(".name", { hasText: new RegExp(`^${id}`) }) }).first();
    await row.locator(".result .words", { hasText: /^measured$/ }).waitFor();
    const statistics = row.locator(".statistic");
    assert.equal(await statistics.count(), 6, id);
    for (const statistic of await statistics.all()) {
      assert.match((await statistic.locator(".expected").textContent()) ?? "", /^(\d+ ±|≤) \d+$/);
      assert.match((await statistic.locator(".observed").textContent()) ?? "", /^\d+$/);
      assert.match((await statistic.locator(".verdict .words").textContent()) ?? "", /^(within|\d+ (over|under))$/);
    }
  }
  assert.deepEqual(complaints, []);
  await close();
});

test("layers are drawn by the page as they are toggled, also from the keyboard", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  // On a picture that stands still, on a page that has found its shape, nothing else changes the drawing.
  await page.locator("#landmarks .result .words").first().waitFor();
  await page.locator("#recordings li").first().waitFor();
  await measuredAndHeld(page);
  const inked = () => page.locator("#drawing").evaluate((canvas) => {
    const drawing = /** @type {HTMLCanvasElement} */ (canvas);
    const copy = new OffscreenCanvas(drawing.width, drawing.height).getContext("2d", { willReadFrequently: true });
    copy?.drawImage(drawing, 0, 0);
    const levels = copy?.getImageData(0, 0, drawing.width, drawing.height).data ?? [];
    // For each pixel: the page may still find its shape, and the drawing its size.
    return levels.reduce((sum, value) => sum + value, 0) / (drawing.width * drawing.height);
  });
  const boxes = page.locator("#layers input:not([name=mask])");
  assert.ok((await boxes.count()) >= 5, "there are layers to choose from");
  const toggle = async (/** @type {import("playwright-core").Locator} */ box) => {
    await box.focus();
    await page.keyboard.press("Space");
  };
  const all = await inked();
  for (const box of await boxes.all()) await toggle(box);
  assert.equal(await inked(), 0, "nothing is drawn without a layer");
  for (const box of await boxes.all()) await toggle(box);
  const again = await inked();
  assert.ok(Math.abs(again - all) < 0.1 * all, `all of it comes back: ${again} of ${all}`);
  for (const name of ["outline", "vector", "labels"]) {
    const before = await inked();
    await toggle(page.locator(`#layers input[name=${name}]`));
    assert.notEqual(await inked(), before, name);
    await toggle(page.locator(`#layers input[name=${name}]`));
  }
  assert.deepEqual(complaints, []);
  await close();
});

/** Holds a frame in which something was measured. @param {import("playwright-core").Page} page */
async function measuredAndHeld(page) {
  await page.getByRole("button", { name: "Hold" }).click();
  for (let tries = 0; tries < 100; tries += 1) {
    await page.locator("#frame-facts").getByText(/held/).waitFor();
    const former = await page.locator("#picture").getAttribute("data-sequence");
    if (await page.locator("#picture").getAttribute("aria-label").then((label) => /measured: /.test(label ?? ""))) return;
    await page.getByRole("button", { name: "Next frame" }).click();
    await page.waitForFunction((former) => document.querySelector("#picture")?.dataset.sequence !== former, former);
  }
  throw new Error("nothing is ever measured");
}

test("the mask is drawn by the service, only while it is wanted", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const asksFor = (/** @type {boolean} */ mask) => page.waitForRequest((request) =>
    request.url().includes("/seen?") && (new URL(request.url()).searchParams.get("layers") === "mask") === mask);
  for (const wanted of [true, false]) {
    const asked = asksFor(wanted);
    await page.getByLabel("Mask").setChecked(wanted);
    await asked;
  }
  assert.deepEqual(complaints, []);
  await close();
});

test("a slow way gets smaller pictures, when that is chosen, with the drawing in its place", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  await page.locator("#size").selectOption("320");
  await page.locator("#frame-facts").getByText(/ 320 × \d+ px/).waitFor();
  await page.waitForFunction(() => document.querySelector("#drawing")?.dataset.sequence === document.querySelector("#picture")?.dataset.sequence);
  assert.deepEqual(complaints, []);
  await close();
});

test("the recorder's state is shown and can be changed", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const state = wordsOf(page, "#recorder-state");
  await page.locator("#recorder-state").getByText("recording", { exact: true }).waitFor();
  assert.match((await page.locator("#recorder").textContent()) ?? "", /File.+\.mcap.*Written.+B.*Free.+B/);
  await page.getByRole("button", { name: "Stop" }).click();
  await page.locator("#recorder-state").getByText("off", { exact: true }).waitFor();
  await page.locator("#log").getByText("Recorder").first().waitFor();
  await page.getByRole("button", { name: "Start" }).click();
  await page.locator("#recorder-state").getByText("recording", { exact: true }).waitFor();
  assert.equal(await state.textContent(), "recording");
  assert.deepEqual(complaints, []);
  await close();
});

test("plots share one cursor, moved by pointer or keys", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const shows = (/** @type {string} */ text) =>
    page.waitForFunction((text) => document.querySelector("#plot-moment")?.textContent === text, text);
  // The page has found its shape once the tables above the plots are filled.
  await page.locator("#landmarks .result .words").first().waitFor();
  await page.locator("#plots .area:visible").first().waitFor();
  await page.locator("#plots").focus();
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowLeft");
  await shows("2 s ago");
  await page.keyboard.press("Escape");
  await shows("now");
  // What moves the plots away from the pointer must not fail this: the pointer follows.
  let seen = "now";
  for (let tries = 0; tries < 50 && seen !== "30 s ago"; tries += 1) {
    await page.locator("#plots .area:visible").first().hover();
    await page.waitForFunction(() => document.querySelector("#plot-moment")?.textContent !== "now");
    seen = (await page.locator("#plot-moment").textContent()) ?? "";
  }
  assert.equal(seen, "30 s ago");
  assert.deepEqual(complaints, []);
  await close();
});

test("a held picture stands still, steps, zooms, and gives its pixels and their six statistics", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const facts = page.locator("#frame-facts");
  const heldFrame = async () => {
    await facts.getByText(/held/).waitFor();
    return page.locator("#picture").getAttribute("data-sequence");
  };
  await page.getByRole("button", { name: "Hold" }).click();
  const first = await heldFrame();
  await page.getByRole("button", { name: "Next frame" }).click();
  await page.waitForFunction((first) => document.querySelector("#picture")?.dataset.sequence !== first, first);
  assert.ok(Number(await heldFrame()) > Number(first));
  await page.getByLabel("Zoom").selectOption("4");
  await page.locator("#picture").focus();
  await page.keyboard.press("ArrowRight");
  await page.locator("#probe").getByText(/Pixel \d+\.5, \d+\.5: R \d+, G \d+, B \d+ levels\. Window \d+ × \d+ px: mean/).waitFor();
  await page.getByRole("button", { name: "Hold" }).click();
  await facts.getByText(/fps shown/).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test("the leader's page shows what is published, and nothing that a leader does not have", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.leaderUrl, {}, "#landmarks tbody tr");
  for (const id of ["red", "blue"]) await page.locator("#landmarks .name", { hasText: new RegExp(`^${id}`) }).waitFor();
  assert.match((await page.locator("#landmarks .result").first().textContent()) ?? "", /published, revision \d+/);
  for (const section of ["#recordings-section", "#recorder-section", "#plots-section"]) assert.equal(await page.locator(section).isHidden(), true);
  assert.deepEqual(complaints, []);
  await close();
});

test("the fleet names everyone who is announced, with the state of each in words", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  await page.waitForFunction(() => document.querySelectorAll("#fleet li").length >= 2);
  const lines = await page.locator("#fleet li").allInnerTexts();
  assert.ok(lines.some((line) => /leader/.test(line)) && lines.some((line) => /follower \(this one\)/.test(line)), lines.join("\n"));
  for (const line of lines) assert.match(line, /answers[^]*version \d/);
  assert.deepEqual(complaints, []);
  await close();
});

test("a landmark that is missed is explained on request, as the command line does", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url);
  const statistics = (/** @type {number} */ level) => ({ mean: [0, level, 0], variance: [level, level, level] });
  const nowhere = { window_px: [12, 12], shape: "any", shades: [statistics(255)], tolerance: statistics(1) };
  const address = `${demo.leaderUrl}/api/v1/landmarks/nowhere`;
  const published = await fetch(address, { method: "PUT", headers: { "content-type": "application/json" }, body: JSON.stringify(nowhere) });
  assert.equal(published.status, 200);
  const ask = page.getByRole("button", { name: "Why not? nowhere" });
  await ask.click({ timeout: 60_000 });
  await page.locator(".why").getByText(/^Frame \d+: no window matched; the nearest one fails by .+ instead of 255 ± /).waitFor();
  assert.equal((await fetch(address, { method: "DELETE" })).status, 200);
  assert.deepEqual(complaints, []);
  await close();
});
