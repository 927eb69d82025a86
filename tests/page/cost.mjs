// SPDX-License-Identifier: Apache-2.0
// What a page costs and how late its picture is: on the simulated rig, and on a camera of 640 x 480 px
// and 30 pictures a second. Run by hand on a quiet machine:
//
//   FATHOM_PAGE_CLIENT=FOLDER FATHOM_PROGRAM=build/release/fathom node tests/page/cost.mjs
//
// Chromium draws without a graphics card here, so its share of a processor is an upper bound.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { createInterface } from "node:readline";
import { launch, open } from "./browser.mjs";
import { delayWords, NumberedCamera } from "./numbered_camera.mjs";

const kWarmUpMs = 3000, kWatchedMs = 8000;

const browser = await launch();
const devtools = await browser.newBrowserCDPSession();

async function processorSeconds() {
  const { processInfo } = await devtools.send("SystemInfo.getProcessInfo");
  return processInfo.reduce((sum, one) => sum + one.cpuTime, 0);
}

const say = (what, words) => console.log(`${what.padEnd(20)} ${words}`);

async function watch(rig, more) {
  say("rig", rig);
  const service = spawn(process.env.FATHOM_PROGRAM, ["serve", "--rig", rig, "--port", "0"],
    { stdio: ["ignore", "pipe", "ignore"] });
  const [address] = await once(createInterface(service.stdout), "line");
  const page = await open(browser, address);
  await page.waitForTimeout(kWarmUpMs);
  const [paint] = await page.evaluate(() => performance.getEntriesByType("paint").map((entry) => entry.startTime));
  say("first paint", `${paint.toFixed(0)} ms after the address was opened`);
  const before = await processorSeconds();
  await page.waitForTimeout(kWatchedMs);
  const part = (await processorSeconds() - before) / (kWatchedMs / 1000);
  say("processor", `${(100 * part).toFixed(1)} % of a core, all processes of the browser`);
  await more(page);
  await page.context().close();
  service.kill();
  await once(service, "exit");
}

await watch("sim:target=seedling,distance=1800,start=780", () => {});
const camera = await new NumberedCamera().start();
camera.run();
await watch(camera.rig, async (page) => {
  say("exposure to pixel", delayWords(await camera.delays(page, kWatchedMs)));
});
await camera.stop();
await browser.close();
