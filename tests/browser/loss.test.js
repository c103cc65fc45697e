// The program goes away and comes back: the page says so, shows nothing old as live, and finds it again.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { openBrowser } from "./browser.js";
import { startDemo } from "./demo.js";
import { openWatched } from "./watched_page.js";

/** @type {import("playwright-core").Browser} */
let browser;

before(async () => {
  browser = await openBrowser();
});
after(async () => {
  await browser?.close();
});

test("the page survives a restart of the service", async () => {
  const first = await startDemo();
  const { page, close } = await openWatched(browser, first.url);
  await page.locator("#landmarks .result .words", { hasText: /^measured$/ }).first().waitFor();
  await first.stop();
  await page.locator("#states").getByText(/no answer for/).waitFor();
  await page.locator("#stage.old").waitFor();
  const second = await startDemo({ port: first.port });
  try {
    await page.locator("#states").getByText(/^live, /).waitFor();
    await page.locator("#stage:not(.old)").waitFor();
    await page.locator("#landmarks .result .words", { hasText: /^measured$/ }).first().waitFor();
    assert.match((await page.locator("#log").textContent()) ?? "", /no answer for/);
  } finally {
    await close();
    await second.stop();
  }
});
