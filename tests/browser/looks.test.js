// The page fits a phone and a desk, in light and dark, and can be used without eyes or mouse.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { found, sticksOut } from "./axe.js";
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

const PHONE = { width: 360, height: 740 };
const DESK = { width: 1280, height: 800 };

for (const [screen, viewport] of Object.entries({ phone: PHONE, desk: DESK })) {
  for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
    test(`axe finds nothing: ${screen}, ${colorScheme}`, async () => {
      const { page, complaints, close } = await openWatched(browser, demo.url, { viewport, colorScheme, bypassCSP: true });
      await page.locator("#landmarks .result .words").first().waitFor();
      await page.locator("#recordings li").first().waitFor();
      assert.deepEqual(await found(page), []);
      assert.deepEqual(complaints, []);
      await close();
    });

    test(`axe finds nothing while a landmark is learned: ${screen}, ${colorScheme}`, async () => {
      const { page, complaints, close } = await openWatched(browser, demo.leaderUrl, { viewport, colorScheme, bypassCSP: true });
      await page.getByRole("button", { name: "Take this picture" }).click();
      for (const label of ["Left px", "Top px", "Width px", "Height px"]) {
        await page.getByLabel(label, { exact: true }).fill("100");
        await page.keyboard.press("Tab");
      }
      await page.locator("#teach-verdict").getByText(/Registration finds/).waitFor();
      assert.deepEqual(await found(page), []);
      assert.deepEqual(complaints, []);
      await close();
    });
  }
}

test("axe finds nothing while a recording is looked at", async () => {
  const { page, complaints, close } = await openWatched(browser, demo.url, { viewport: PHONE, bypassCSP: true });
  await page.getByRole("button", { name: "Split into a new file" }).click();
  await page.getByRole("button", { name: "Look at it" }).and(page.locator(":enabled")).first().click();
  await page.locator("#frame-facts").getByText(/recorded/).waitFor();
  assert.deepEqual(await found(page), []);
  assert.deepEqual(complaints, []);
  await close();
});

for (const width of [360, 768, 1280, 1920, 3840]) {
  test(`nothing sticks out at ${width} px`, async () => {
    const { page, close } = await openWatched(browser, demo.url, { viewport: { width, height: 900 } });
    await page.locator("#landmarks .result .words").first().waitFor();
    assert.equal(await sticksOut(page), 0);
    await close();
  });
}

test("the first key leads to the live picture", async () => {
  const { page, close } = await openWatched(browser, demo.url);
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement?.id), "live");
  await close();
});
