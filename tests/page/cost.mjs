// SPDX-License-Identifier: Apache-2.0
// What a page costs and how late its picture is, on the simulated rig. Run by hand on a quiet machine:
//
//   FATHOM_PAGE_CLIENT=FOLDER FATHOM_PROGRAM=build/release/fathom node tests/page/cost.mjs
//
// Chromium draws without a graphics card here, so its share of a processor is an upper bound.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { get } from "node:http";
import { createInterface } from "node:readline";
import { launch, open } from "./browser.mjs";

const kToken = "token-of-a-measurement";
const kWarmUpMs = 2000, kWatchedMs = 8000;

const service = spawn(process.env.FATHOM_PROGRAM, ["serve", "--rig", "sim:target=seedling,distance=1800,start=780",
  "--port", "0", "--token", kToken], { stdio: ["ignore", "pipe", "ignore"] });
const [address] = await once(createInterface(service.stdout), "line");
const browser = await launch();
const page = await open(browser, address);
await page.waitForTimeout(kWarmUpMs);

const [paint] = await page.evaluate(() => performance.getEntriesByType("paint").map((entry) => entry.startTime));
console.log(`first paint          ${paint.toFixed(0)} ms after the address was opened`);

const devtools = await browser.newBrowserCDPSession();
async function processorSeconds() {
  const { processInfo } = await devtools.send("SystemInfo.getProcessInfo");
  return processInfo.reduce((sum, one) => sum + one.cpuTime, 0);
}
const before = await processorSeconds();
await page.waitForTimeout(kWatchedMs);
const part = (await processorSeconds() - before) / (kWatchedMs / 1000);
console.log(`processor            ${(100 * part).toFixed(1)} % of a core, all processes of the browser`);

/** When each picture of a stream came here, which is when it came to the page as well. */
const came = [];
const stream = get(new URL("/api/v1/stream.mjpg?fps=15", address), { headers: { Authorization: `Bearer ${kToken}` } },
  (response) => response.on("data", (bytes) => {
    if (bytes.includes("Content-Type: image")) came.push(Date.now());
  }));
const shown = await page.evaluate(whenShown, kWatchedMs);
stream.destroy();
const delays = shown.map((at) => at - came.findLast((time) => time <= at)).filter(Number.isFinite).sort((a, b) => a - b);
console.log(`from wire to pixel   ${delays[delays.length >> 1]} ms in the middle, ${delays[Math.floor(0.95 * delays.length)]} ms at most for 95 % of ${delays.length} pictures`);

await browser.close();
service.kill();

/** In the page: when the picture on the screen became another. */
async function whenShown(forMs) {
  const image = document.getElementById("stream"), times = [];
  const context = new OffscreenCanvas(8, 8).getContext("2d", { willReadFrequently: true });
  const end = performance.now() + forMs;
  for (let last = ""; performance.now() < end;) {
    await new Promise(requestAnimationFrame);
    context.drawImage(image, 100, 100, 8, 8, 0, 0, 8, 8);
    const now = context.getImageData(0, 0, 8, 8).data.join();
    if (now !== last) times.push(Date.now());
    last = now;
  }
  return times;
}
