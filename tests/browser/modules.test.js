// The page's pure modules, run where they run: words, statistics and history, against cases worked by hand.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { openBrowser } from "./browser.js";
import { startService } from "./mock/service.js";

/** @type {Awaited<ReturnType<typeof startService>>} */
let service;
/** @type {import("playwright-core").Browser} */
let browser;
/** @type {import("playwright-core").Page} */
let page;

before(async () => {
  [service, browser] = await Promise.all([startService("no-landmark", 0, ""), openBrowser()]);
  page = await browser.newPage();
  await page.goto(`http://127.0.0.1:${service.port}/icon.svg`);
});
after(async () => {
  await browser?.close();
  service?.close();
});

/** Calls a function of a module of the page. @param {string} module @param {string} name @param {any[]} values */
const call = (module, name, ...values) =>
  page.evaluate(async ([module, name, values]) => (await import(module))[name](...values), /** @type {const} */ ([module, name, values]));

test("figures carry units, and what is missing is a dash", async () => {
  for (const [value, digits, unit, words] of [[3.14159, 2, "px", "3.14 px"], [0, 0, "", "0"], [null, 1, "px", "—"], [Number.NaN, 1, "", "—"]]) {
    assert.equal(await call("/words.js", "figure", value, digits, unit), words);
  }
  for (const [seconds, words] of [[0.0421, "42 ms"], [4.26, "4.3 s"], [73, "73 s"], [900, "15 min"], [90_000, "25 h"], [null, "—"]]) {
    assert.equal(await call("/words.js", "duration", seconds), words);
  }
  for (const [count, words] of [[999, "999 B"], [48_211_004, "48.2 MB"], [212_000_000_000, "212 GB"], [undefined, "—"]]) {
    assert.equal(await call("/words.js", "bytes", count), words);
  }
});

test("every reason for a miss has words, with its figures", async () => {
  assert.match(await call("/words.js", "missInWords", "no_colour", { excess: 2.44 }), /2\.4 tolerances off$/);
  assert.match(await call("/words.js", "missInWords", "outside_gate", { innovation_px: 84.2 }), /84 px/);
  assert.match(await call("/words.js", "missInWords", "occluded", { visible: 0.2 }), /20 %/);
  for (const reason of ["outside_frame", "no_colour", "too_small", "wrong_shape", "outside_gate", "occluded", "skipped"]) {
    assert.doesNotMatch(await call("/words.js", "missInWords", reason, null), /_|undefined|null/);
  }
  assert.equal(await call("/words.js", "missInWords", "some_new_reason", {}), "some new reason");
});

const RED = { mean: [180, 50, 40], variance: [100, 80, 60] };
const BLUE = { mean: [40, 70, 160], variance: [100, 80, 60] };
const LANDMARK = { shades: [RED, BLUE], tolerance: { mean: [15, 15, 15], variance: [50, 50, 50] } };

test("tolerances include their bounds, and the distance beyond them is told with its side", async () => {
  const observed = { mean: [195, 34, 40], variance: [151, 80, 10] };
  const { shade, mean, variance } = await call("/statistics.js", "compare", LANDMARK, observed, null);
  assert.equal(shade, 1);
  assert.deepEqual(mean.map((/** @type {any} */ one) => [one.within, one.offBy]), [[true, 0], [false, -1], [true, 0]]);
  assert.deepEqual(variance.map((/** @type {any} */ one) => [one.within, one.offBy]), [[false, 1], [true, 0], [true, 0]]);
});

test("the nearest shade is compared, in the light of the moment", async () => {
  const dim = { mean: [20, 35, 80], variance: [25, 20, 15] };
  const { shade, mean, variance } = await call("/statistics.js", "compare", LANDMARK, dim, 0.5);
  assert.equal(shade, 2);
  assert.deepEqual(mean.map((/** @type {any} */ one) => one.expected), [20, 35, 80]);
  assert.deepEqual(variance.map((/** @type {any} */ one) => one.expected), [25, 20, 15]);
  const nothing = await call("/statistics.js", "compare", LANDMARK, null, null);
  assert.equal(nothing.mean[0].within, null);
});

test("a value is found at a moment, and gaps stay gaps", async () => {
  const samples = [{ at: 0, value: 1 }, { at: 1000, value: null }, { at: 2000, value: 3 }];
  for (const [at, value] of [[100, 1], [900, null], [1900, 3], [2900, 3], [3100, null]]) {
    assert.equal(await call("/history.js", "valueAt", samples, at), value);
  }
  assert.equal(await call("/history.js", "valueAt", [], 5), null);
});
