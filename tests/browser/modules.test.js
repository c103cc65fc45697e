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
  const { shade, mean, variance } = await call("/statistics.js", "compare", LANDMARK, observed, {});
  assert.equal(shade, 1);
  assert.deepEqual(mean.map((/** @type {any} */ one) => [one.within, one.offBy]), [[true, 0], [false, -1], [true, 0]]);
  assert.deepEqual(variance.map((/** @type {any} */ one) => [one.within, one.offBy]), [[false, 1], [true, 0], [true, 0]]);
});

test("the nearest shade is compared, in the light of the moment", async () => {
  const dim = { mean: [20, 35, 80], variance: [25, 20, 15] };
  const { shade, mean, variance } = await call("/statistics.js", "compare", LANDMARK, dim, { gain: 0.5 });
  assert.equal(shade, 2);
  assert.deepEqual(mean.map((/** @type {any} */ one) => one.expected), [20, 35, 80]);
  assert.deepEqual(variance.map((/** @type {any} */ one) => one.expected), [25, 20, 15]);
  const adapted = await call("/statistics.js", "compare", LANDMARK, dim, { gain: 0.5, tolerance_scale: 2, noise_variance: [3, 2, 1] });
  assert.deepEqual(adapted.mean.map((/** @type {any} */ one) => one.tolerance), mean.map((/** @type {any} */ one) => 2 * one.tolerance));
  assert.deepEqual(adapted.variance.map((/** @type {any} */ one) => one.expected), [28, 22, 16]);
  assert.deepEqual(adapted.variance.map((/** @type {any} */ one) => one.tolerance), variance.map((/** @type {any} */ one) => one.tolerance));
  const hazy = await call("/statistics.js", "compare", LANDMARK, dim, { gain: 0.5, haze: 10 });
  assert.deepEqual(hazy.mean.map((/** @type {any} */ one) => one.expected), [25, 40, 85]);
  // Smoother than learned is no fault of what was followed; rougher is.
  const blurred = await call("/statistics.js", "compare", LANDMARK, { ...dim, variance: [0, 0, 900] }, { gain: 0.5 });
  assert.deepEqual(blurred.variance.map((/** @type {any} */ one) => one.within), [true, true, false]);
  const nothing = await call("/statistics.js", "compare", LANDMARK, null, {});
  assert.equal(nothing.mean[0].within, null);
});

test("a value is found at a moment, and gaps stay gaps", async () => {
  const samples = [{ at: 0, value: 1 }, { at: 1000, value: null }, { at: 2000, value: 3 }];
  for (const [at, value] of [[100, 1], [900, null], [1900, 3], [2900, 3], [3100, null]]) {
    assert.equal(await call("/history.js", "valueAt", samples, at), value);
  }
  assert.equal(await call("/history.js", "valueAt", [], 5), null);
});

test("labels stay off each other and off what is named, and inside the room", async () => {
  const about = { x: 290, y: 180, w: 20, h: 20 };
  const wanted = [...Array.from({ length: 7 }, () => ({ about, w: 70 })), { about: null, w: 70 }, { about: null, w: 70 }];
  const placed = await call("/labels.js", "placeLabels", wanted, { w: 320, h: 200 }, 18);
  const overlap = (/** @type {any} */ a, /** @type {any} */ b) => a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
  assert.equal(overlap(placed[0], about), false);
  placed.forEach((/** @type {any} */ place, /** @type {number} */ index) => {
    assert.ok(place.x >= 0 && place.y >= 0 && place.x + place.w <= 320 && place.y + place.h <= 200, JSON.stringify(place));
    for (const other of placed.slice(0, index)) assert.equal(overlap(place, other), false, `${JSON.stringify(place)} ${JSON.stringify(other)}`);
  });
});

test("labels that find no room are left out rather than laid over others", async () => {
  const wanted = Array.from({ length: 12 }, () => ({ about: { x: 20, y: 20, w: 10, h: 10 }, w: 90 }));
  const placed = await call("/labels.js", "placeLabels", wanted, { w: 100, h: 60 }, 18);
  const shown = placed.filter(Boolean);
  assert.ok(shown.length >= 1 && shown.length < 12, `${shown.length} of 12`);
  assert.equal(new Set(shown.map((/** @type {any} */ place) => place.y)).size, shown.length);
});

test("labels say what was measured or why not, as the service's own do", async () => {
  const seen = { id: "red", instance: 0, result: "measured", x_px: 458.46, y_px: 325.64, area_px2: 588.6, miss: null };
  assert.equal(await call("/drawing.js", "labelOf", seen, true), "red  x 458.5 y 325.6  589 px²");
  assert.equal(await call("/drawing.js", "labelOf", { ...seen, instance: 2 }, false), "red#2");
  const missed = (/** @type {string} */ result, /** @type {object} */ figures) => ({ id: "blue", instance: 1, result, miss: { reason: result, ...figures } });
  assert.equal(await call("/drawing.js", "labelOf", missed("outside_gate", { innovation_px: 34.4 }), true), "blue#1: outside gate (34 px off)");
  assert.equal(await call("/drawing.js", "labelOf", missed("occluded", { visible: 0.3 }), true), "blue#1: occluded (30 % seen)");
  assert.equal(await call("/drawing.js", "labelOf", missed("no_colour", { excess: 2 }), true), "blue#1: no colour");
});

test("a picture is shown as its pixels are stored, whatever its Exif says", async () => {
  const sizes = await page.evaluate(async () => {
    const canvas = new OffscreenCanvas(40, 20);
    canvas.getContext("2d")?.fillRect(0, 0, 40, 20);
    const jpeg = await canvas.convertToBlob({ type: "image/jpeg" });
    // Exif that says: turn it by 90 degrees.
    const exif = [0xff, 0xe1, 0, 34, 0x45, 0x78, 0x69, 0x66, 0, 0, 0x4d, 0x4d, 0, 0x2a, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0];
    const turned = new Blob([jpeg.slice(0, 2), new Uint8Array(exif), jpeg.slice(2)], { type: "image/jpeg" });
    const { asStored } = await import(/** @type {any} */ ("/jpeg.js"));
    const sizeOf = async (/** @type {Blob} */ file) => {
      const { width, height } = await createImageBitmap(file);
      return [width, height];
    };
    const cut = await asStored(turned.slice(0, 9));
    return [await sizeOf(turned), await sizeOf(await asStored(turned)), (await asStored(jpeg)) === jpeg, cut.size];
  });
  assert.deepEqual(sizes, [[20, 40], [40, 20], true, 2]);
});
