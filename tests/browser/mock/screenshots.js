// Pictures of every state of the page, to be looked at: node mock/screenshots.js OUTPUT FRAMES [state…]

import { mkdir } from "node:fs/promises";
import { join } from "node:path";
import { openBrowser } from "../browser.js";
import { startService } from "./service.js";
import { STATES } from "./world.js";

const VIEWS = [
  { name: "phone-light", width: 360, height: 740, colorScheme: "light" },
  { name: "desktop-light", width: 1280, height: 800, colorScheme: "light" },
  { name: "desktop-dark", width: 1280, height: 800, colorScheme: "dark" },
  { name: "4k-dark", width: 3840, height: 2160, colorScheme: "dark" },
];

const [, , output, frames, ...asked] = process.argv;
await mkdir(output, { recursive: true });
const browser = await openBrowser();
for (const state of asked.length > 0 ? asked : STATES) {
  const service = await startService(state, 0, frames);
  for (const { name, width, height, colorScheme } of VIEWS) {
    if (state !== "well" && name !== "phone-light" && name !== "desktop-dark") continue;
    const page = await browser.newPage({ viewport: { width, height }, colorScheme });
    page.on("console", (message) => process.stdout.write(`${state} ${message.text()}\n`));
    page.on("pageerror", (error) => process.stdout.write(`${state} ${error}\n`));
    await page.goto(`http://127.0.0.1:${service.port}/`);
    await page.waitForTimeout(4000);
    await page.screenshot({ path: join(output, `${state}-${name}.png`), fullPage: true });
    await page.close();
  }
  service.close();
}
await browser.close();
