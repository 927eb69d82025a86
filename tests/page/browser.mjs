// SPDX-License-Identifier: Apache-2.0
// Debian's Chromium, pages in it that fail a test when they complain, and screenshots compared.
//
//   FATHOM_PAGE_CLIENT    a folder in which `npm ci` was run with this folder's package.json
//   FATHOM_NEW_SCREENSHOTS=1   takes screenshots anew instead of comparing them; look at them then
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";

export const kSource = join(import.meta.dirname, "../..");
const kShots = join(import.meta.dirname, "screenshots");
const kBrowsers = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
/** Chromium asks for nothing of the world outside. */
const kQuiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];
/** Kept and compared at half size: people see enough, and letters of another font matter less. */
const kKeptScale = 0.5;
/** From this difference on, of 255, a pixel counts as another. */
const kOther = 40;

export const kSizes = { desktop: { width: 1440, height: 900 }, tablet: { width: 1024, height: 768 }, telephone: { width: 390, height: 844 } };

export async function launch() {
  const { chromium } = createRequire(join(process.env.FATHOM_PAGE_CLIENT, "index.js"))("playwright-core");
  return chromium.launch({ executablePath: kBrowsers.find(existsSync), args: kQuiet });
}

/** A page of its own, as of another person. What it complains of is in `page.complaints`. */
export async function open(browser, url, { size = "desktop", scheme = "light" } = {}) {
  const context = await browser.newContext({
    viewport: kSizes[size], colorScheme: scheme, reducedMotion: "reduce",
    hasTouch: size === "telephone", locale: "en-GB", timezoneId: "UTC",
  });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(error.message));
  page.on("console", (message) => { if (message.type() === "error") page.complaints.push(message.text()); });
  await page.goto(url, { waitUntil: "domcontentloaded" });
  await page.locator("#link", { hasText: "connected" }).waitFor();
  return page;
}

/** Waits until a function of this side says yes. */
export async function until(isSo, what) {
  for (let tries = 0; tries < 2400; ++tries) {
    if (await isSo()) return;
    await new Promise((done) => setTimeout(done, 25));
  }
  assert.fail(`never happened: ${what}`);
}

/** Compares with the committed picture: the part of pixels that differ is below `most`. */
export async function compareShot(browser, page, name, most) {
  const shot = await onCanvas(browser, [(await page.screenshot({ animations: "disabled" })).toString("base64")], kKeptScale);
  const file = join(kShots, `${name}.png`);
  if (process.env.FATHOM_NEW_SCREENSHOTS) {
    await mkdir(kShots, { recursive: true });
    await writeFile(file, Buffer.from(shot.png, "base64"));
    return;
  }
  const { other } = await onCanvas(browser, [(await readFile(file)).toString("base64"), shot.png], 1);
  const left = join(process.env.FATHOM_PAGE_CLIENT, `${name}.png`);
  if (other >= most) await writeFile(left, Buffer.from(shot.png, "base64"));
  assert.ok(other < most, `${(100 * other).toFixed(2)} % of the pixels of ${name} differ from ${file}; seen: ${left}`);
}

/** The first picture scaled, and how much of it is another in the second. */
async function onCanvas(browser, pictures, scale) {
  const page = await browser.newPage();
  const result = await page.evaluate(async ({ pictures, scale, kOther }) => {
    const canvases = await Promise.all(pictures.map(async (base64) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const canvas = new OffscreenCanvas(Math.round(image.width * scale), Math.round(image.height * scale));
      const context = canvas.getContext("2d");
      context.imageSmoothingQuality = "high";
      context.drawImage(image, 0, 0, canvas.width, canvas.height);
      return { canvas, data: context.getImageData(0, 0, canvas.width, canvas.height).data };
    }));
    const bytes = new Uint8Array(await (await canvases[0].canvas.convertToBlob()).arrayBuffer());
    let text = "";
    for (const byte of bytes) text += String.fromCharCode(byte);
    const [a, b] = canvases.map((c) => c.data);
    if (b && a.length !== b.length) return { png: btoa(text), other: 1 };
    let other = 0;
    for (let at = 0; b && at < a.length; at += 4) {
      other += Math.max(...[0, 1, 2].map((c) => Math.abs(a[at + c] - b[at + c]))) > kOther;
    }
    return { png: btoa(text), other: other / (a.length / 4) };
  }, { pictures, scale, kOther });
  await page.close();
  return result;
}
