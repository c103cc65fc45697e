// A page whose every complaint is kept: console errors, exceptions, violations of the content policy.

const FIRST_PICTURE = "#picture[data-sequence]";

/**
 * Opens the page and waits until `sign` is there: the first picture, unless told otherwise.
 * @param {import("playwright-core").Browser} browser @param {string} url
 * @param {import("playwright-core").BrowserContextOptions} [options] @param {string} [sign]
 */
export async function openWatched(browser, url, options = {}, sign = FIRST_PICTURE) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  /** @type {string[]} */
  const complaints = [];
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") complaints.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`exception: ${error}`));
  await page.exposeFunction("keepViolation", (/** @type {string} */ text) => complaints.push(`policy: ${text}`));
  await page.addInitScript(() => {
    document.addEventListener("securitypolicyviolation", (event) =>
      // @ts-ignore exposed above
      window.keepViolation(`${event.violatedDirective} ${event.blockedURI}`));
  });
  await page.goto(url);
  await page.waitForFunction((sign) => Boolean(document.querySelector(sign)), sign);
  return { page, complaints, close: () => context.close() };
}
