// States that are hard to bring about, from a stand-in for the service: each is readable, fits, and says what is wrong.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { found, sticksOut } from "./axe.js";
import { openBrowser } from "./browser.js";
import { startService } from "./mock/service.js";

/** What each state must say, and where. @type {Record<string, [string, RegExp]>} */
const SAYS = {
  "no-camera": ["#states", /none heard/],
  stale: ["#picture-state", /^(The newest picture is 14\.2 s old; the camera has stopped\.|Not live: this picture is .+ old\.)$/],
  "no-landmark": ["#landmark-none", /No landmark is in force/],
  "one-lost": ["#landmarks", /missed: no part of the picture has its colours; the nearest is 2\.4 tolerances off/],
  "recording-failed": ["#recorder-state", /failed: no space left on the disk/],
  thirty: ["#landmark-facts", /24 of 30 measured/],
  "read-only": ["#notice", /Read-only/],
  "leader-gone": ["#states", /absent, last heard/],
  leader: ["#landmark-facts", /2 published/],
};

const VIEWS = /** @type {const} */ ([
  { viewport: { width: 360, height: 740 }, colorScheme: "light" },
  { viewport: { width: 1280, height: 800 }, colorScheme: "dark" },
]);

/** @type {import("playwright-core").Browser} */
let browser;

before(async () => {
  browser = await openBrowser();
});
after(async () => {
  await browser?.close();
});

for (const [state, [place, words]] of Object.entries(SAYS)) {
  test(`${state}: said in words, on a phone and on a desk`, async () => {
    const service = await startService(state, 0, "");
    for (const view of VIEWS) {
      const page = await browser.newPage(view);
      await page.goto(`http://127.0.0.1:${service.port}/`);
      await page.locator(place).filter({ hasText: words }).waitFor();
      assert.equal(await sticksOut(page), 0, `${view.viewport.width} px`);
      assert.deepEqual(await found(page), [], view.colorScheme);
      await page.close();
    }
    service.close();
  });
}
