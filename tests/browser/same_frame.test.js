// Picture and drawing are of the same frame, always: blocks jump from frame to frame, and the outline stays on them.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { openBrowser } from "./browser.js";
import { startService } from "./mock/service.js";
import { openWatched } from "./watched_page.js";

const FRAMES = 40;

/** @type {Awaited<ReturnType<typeof startService>>} */
let service;
/** @type {import("playwright-core").Browser} */
let browser;

before(async () => {
  [service, browser] = await Promise.all([startService("well", 0, ""), openBrowser()]);
});
after(async () => {
  await browser?.close();
  service?.close();
});

test("each time something is drawn, it is drawn on what the picture shows", async () => {
  const { page, complaints, close } = await openWatched(browser, `http://127.0.0.1:${service.port}/`);
  for (const name of ["vector", "prediction", "gate", "labels"]) await page.locator(`#layers input[name=${name}]`).uncheck();
  const frames = await page.evaluate(look, FRAMES);
  assert.equal(frames.length, FRAMES);
  for (const { sequence, drawn, bright, ink } of frames) {
    assert.equal(drawn, sequence);
    assert.ok(bright !== null && ink !== null, "a block and its outline");
    for (const side of [0, 1]) assert.ok(Math.abs(bright[side] - ink[side]) < 4, `frame ${sequence}: block ${bright}, outline ${ink}`);
  }
  assert.ok(new Set(frames.map((frame) => frame.bright?.[0])).size > 5, "the blocks do move");
  assert.deepEqual(complaints, []);
  await close();
});

/**
 * Looks at both canvases at every repaint that shows a new frame, as the eye would. @param {number} count
 * @returns {Promise<{sequence?: string, drawn?: string, bright: number[] | null, ink: number[] | null}[]>}
 */
async function look(count) {
  const [picture, drawing] = ["#picture", "#drawing"].map((id) => /** @type {HTMLCanvasElement} */ (document.querySelector(id)));
  const copy = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true }));
  /** Left and right end of what is on a canvas in the row of the first block, in parts of its width. */
  const span = (/** @type {HTMLCanvasElement} */ canvas, /** @type {(pixel: Uint8ClampedArray) => boolean} */ isOn) => {
    const row = Math.round((200 / 480) * canvas.height);
    copy.canvas.width = canvas.width;
    copy.drawImage(canvas, 0, -row);
    const { data } = copy.getImageData(0, 0, canvas.width, 1);
    const on = [...Array(canvas.width).keys()].filter((x) => isOn(data.subarray(4 * x, 4 * x + 4)));
    return on.length > 0 ? [on[0], on[on.length - 1]].map((x) => (x / canvas.width) * 640) : null;
  };
  const seen = [];
  while (seen.length < count) {
    await new Promise((next) => requestAnimationFrame(next));
    const { sequence } = picture.dataset;
    if (sequence === seen[seen.length - 1]?.sequence) continue;
    seen.push({
      sequence, drawn: drawing.dataset.sequence,
      bright: span(picture, ([red]) => red > 150),
      ink: span(drawing, ([red, , blue, alpha]) => alpha > 200 && red > 150 && blue < 150),
    });
  }
  return seen;
}
