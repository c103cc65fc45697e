// What can be said of a page's looks without eyes.

import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

const AXE = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What axe finds on the page as it is now. @param {import("playwright-core").Page} page */
export async function found(page) {
  await page.evaluate(AXE);
  // @ts-ignore the line above defines axe
  const { violations } = await page.evaluate(() => window.axe.run());
  return violations.map((/** @type {any} */ one) => `${one.id}: ${one.nodes.map((/** @type {any} */ node) => node.html).join(" ")}`);
}

/** By how many pixels the page is wider than its window. @param {import("playwright-core").Page} page */
export function sticksOut(page) {
  return page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
}
