// SPDX-License-Identifier: Apache-2.0
// The page on the service itself, with a simulated rig: FATHOM_PROGRAM is the program.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { kSizes, launch, open, until } from "./browser.mjs";
import { delayWords, NumberedCamera, numbersShown } from "./numbered_camera.mjs";

const kToken = "token-of-a-test";
const kStart = 500;
const kRig = `sim:target=seedling,distance=1800,start=${kStart}`;

let browser, folder, service, pages;
before(async () => { browser = await launch(); });
after(() => browser.close());
beforeEach(async () => {
  folder = await mkdtemp(join(tmpdir(), "fathom-page-"));
  pages = [];
  service = await serve();
});
afterEach(async () => {
  const complaints = pages.flatMap((page) => page.complaints);
  for (const page of pages) await page.context().close();
  await end(service);
  await rm(folder, { recursive: true });
  assert.deepEqual(complaints, []);
});

async function serve(port = 0, rig = kRig) {
  const child = spawn(process.env.FATHOM_PROGRAM, ["serve", "--rig", rig, "--port", String(port),
    "--token", kToken, "--folder", folder], { stdio: ["ignore", "pipe", "inherit"] });
  const [address] = await once(createInterface(child.stdout), "line");
  return { child, address, port: Number(new URL(address).port) };
}

async function end({ child }, signal = "SIGTERM") {
  if (child.exitCode !== null || child.signalCode !== null) return;
  child.kill(signal);
  await once(child, "exit");
}

async function opened(options) {
  pages.push(await open(browser, service.address, options));
  return pages.at(-1);
}

/** What a program sees of the service. */
async function state() {
  const answer = await fetch(new URL("/api/v1/state", service.address), { headers: { Authorization: `Bearer ${kToken}` } });
  return answer.json();
}

const press = (page, name) => page.getByRole("button", { name, exact: true }).click();
const answerSays = (page, text) => page.locator("#answer", { hasText: text }).waitFor({ timeout: 60000 });
const isIdle = () => until(async () => (await state()).activity === "live", "it comes to rest");

async function setTravel(page, from, to, step) {
  await page.getByText("Travel and calibration").click();
  for (const [id, value] of Object.entries({ from, to, step })) await page.locator(`#${id}`).fill(String(value));
}

test("an address with its token opens the page, and the token leaves the address", async () => {
  const page = await opened();
  assert.equal(new URL(page.url()).search, "");
  await until(() => page.locator("#stream").evaluate((image) => image.naturalWidth > 0), "a picture");
  await until(async () => Number(await page.locator("#score").textContent()) > 0, "a score");
  await page.locator("#spectrum-facts", { hasText: "dB" }).waitFor();
});

test("a picture is shown as it comes, and does not wait for the next one", async (t) => {
  const camera = await new NumberedCamera().start();
  await end(service);
  service = await serve(0, camera.rig);
  const page = await opened(), shown = async () => (await numbersShown(page, 0)).at(-1)?.number;
  for (let i = 0; i < 5; ++i) {
    const number = camera.expose();
    await until(async () => await shown() === number, `picture ${number} is shown`);
  }
  camera.run();
  t.diagnostic(`640 x 480 px, 30 a second, from exposure to pixel: ${delayWords(await camera.delays(page, 3000))}`);
  await page.context().close();
  pages = [];
  await end(service);
  await camera.stop();
  assert.deepEqual(page.complaints, []);
});

test("a window is dragged on the rig", async () => {
  const page = await opened(), { x, y, width, height } = await page.locator(".window").boundingBox();
  const scale = (await page.locator("#picture").boundingBox()).width / 256;
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 40 * scale, y + height / 2 - 20 * scale, { steps: 5 });
  await page.mouse.up();
  await until(async () => JSON.stringify((await state()).windows) === '[{"x":136,"y":68,"n":64}]', "it is moved");
});

test("a window is found on the nearest surface", async () => {
  await end(service);
  service = await serve(0, `sim:target=stair,distance=1500,start=${kStart}`);
  const page = await opened();
  await setTravel(page, 900, 1050, "");
  await press(page, "Nearest surface");
  await answerSays(page, "on the nearest surface");
  await isIdle();
  const { windows: [window], lens } = await state();
  assert.ok(window.x > 128, "it is the band at the right");
  assert.equal(lens.position, kStart);
  await page.locator("#window-list", { hasText: `${window.n} px at ${window.x}, ${window.y}` }).waitFor();
});

test("focus is found, survives a reload, and is computed again to the same answer", async () => {
  const page = await opened();
  await press(page, "Focus");
  await answerSays(page, "focused, confidence");
  const position = parseFloat(await page.locator("#answer .big").textContent());
  assert.ok(Math.abs((await state()).lens.position - position) < 5, "the lens is left there");
  await page.reload({ waitUntil: "domcontentloaded" });
  await answerSays(page, "focused, confidence");
  await page.locator("#runs button", { hasText: "Rerun" }).click();
  await until(async () => /same/.test(await page.locator("#runs").textContent()), "the same answer");
  await page.locator("#runs button", { hasText: "Open" }).click();
  await page.getByRole("button", { name: "Back to the measurement" }).waitFor();
});

test("a sweep goes on through a reload; Stop ends it and the lens goes back", async () => {
  const page = await opened();
  await setTravel(page, 0, 1200, 1);
  await press(page, "Sweep");
  await answerSays(page, "of 1201");
  await page.reload({ waitUntil: "domcontentloaded" });
  await answerSays(page, "of 1201");
  await press(page, "Stop");
  await answerSays(page, "Stopped");
  await isIdle();
  assert.equal((await state()).lens.position, kStart);
});

test("calibrate with distances asked for one by one, then range", async () => {
  const page = await opened();
  await press(page, "Calibrate");
  const field = page.locator("#distance");
  for (const distance of [1500, 1800, 2200]) {
    await field.fill(String(distance));
    await page.keyboard.press("Enter");
    await until(async () => (await state()).calibration.points.length > 0 && (await state()).calibration.distances.includes(distance) &&
      (await state()).calibration.waiting_for_next, `${distance} is measured`);
  }
  await press(page, "Finish");
  await isIdle();
  const rows = page.locator("#calibration-table tbody tr");
  await rows.nth(2).waitFor();  // the page draws a few times a second
  assert.equal(await rows.count(), 3);
  await press(page, "Range");
  await answerSays(page, "mm");
  await isIdle();
  await answerSays(page, "focused");
  const distance = parseFloat(await page.locator("#answer .big").textContent());
  assert.ok(Math.abs(distance - 2200) < 22, `${distance} mm`);
});

test("a map of depth is shown", async () => {
  const page = await opened();
  await setTravel(page, 700, 900, 20);
  await press(page, "Depth");
  await page.locator("#map").waitFor();
  await isIdle();
  await until(async () => !/growing/.test(await page.locator("#map-facts").textContent()), "it is ready");
  await page.reload({ waitUntil: "domcontentloaded" });
  await page.locator("#map").waitFor();
});

test("another page watches, asks, and takes over; a telephone does as well", async () => {
  const one = await opened(), other = await opened({ size: "telephone" });
  await press(one, "Drive");
  await press(other, "Ask to take over");
  await press(one, "Let it");
  await other.locator("#drive", { hasText: "You drive" }).waitFor();
  await press(other, "Focus");
  for (const page of pages) await answerSays(page, "focused, confidence");
  assert.ok(await other.evaluate(() => document.documentElement.scrollWidth) <= kSizes.telephone.width);
  other.complaints.length = 0;  // The browser tells of the take that came before the question.
});

for (const signal of ["SIGTERM", "SIGKILL"]) {
  test(`a service that ends by ${signal} is told of; the page comes back with the next one`, async () => {
    const page = await opened(), { port } = service;
    await end(service, signal);
    await page.locator("#no-picture", { hasText: "No connection" }).waitFor();
    service = await serve(port);
    await page.locator("#link", { hasText: /^connected/ }).waitFor();
    page.complaints.length = 0;  // It tells of the broken connection.
  });
}
