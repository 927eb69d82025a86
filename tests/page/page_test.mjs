// SPDX-License-Identifier: Apache-2.0
// The page as a person uses it, in headless Chromium, on a service made up for tests.
import assert from "node:assert/strict";
import { readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { compareShot, kSizes, kSource, launch, open, until } from "./browser.mjs";
import * as made from "./made_up.mjs";
import { MockService } from "./mock_service.mjs";

const kPage = join(kSource, "serve/page");
/** Letters and lines are drawn a little differently on other machines. */
const kMostOther = 0.02;

let browser, service, pages;
before(async () => { browser = await launch(); });
after(() => browser.close());
beforeEach(async () => {
  service = await new MockService(kPage).start();
  pages = [];
});
afterEach(async () => {
  await service.stop();
  const complaints = pages.flatMap((page) => page.complaints);
  for (const page of pages) await page.context().close();
  assert.deepEqual(complaints, [], "the browser complains of nothing, the page's policy included");
});

async function opened(options) {
  pages.push(await open(browser, service.url, options));
  return pages.at(-1);
}

const last = (path) => service.received.findLast((r) => r.path === path);
const sent = (path) => until(() => last(path), `${path} is sent`);
const press = (page, name) => page.getByRole("button", { name, exact: true }).click();
const answerSays = (page, text) => page.locator("#answer", { hasText: text }).waitFor();

/** The middle of an element, in pixels of the page. */
async function middle(locator) {
  const { x, y, width, height } = await locator.boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
}

async function drag(page, locator, dx, dy) {
  const { x, y } = await middle(locator);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx / 2, y + dy / 2);
  await page.mouse.move(x + dx, y + dy);
  await page.mouse.up();
}

/** Pixels of the page for one pixel of the camera. */
const scaleOf = async (page) => (await page.locator("#picture").boundingBox()).width / made.kWidth;

async function focusOn(page) {
  await press(page, "Focus");
  await sent("focus");
  for (const position of made.kSearched) service.evaluate(position);
  service.find(made.focusResult());
  service.end("done");
  await answerSays(page, "781.190");
}

test("the page and all that it loads is small", () => {
  const size = readdirSync(kPage).reduce((sum, name) => sum + statSync(join(kPage, name)).size, 0);
  assert.ok(size <= 200e3, `${size} bytes`);
});

test("all modules are asked for at once, not one after the other", async () => {
  const page = await opened();
  const asked = await page.evaluate(() => [...document.querySelectorAll("script, link[rel=modulepreload]")]
    .map((e) => (e.src || e.href).split("/").at(-1)).sort());
  assert.deepEqual(asked, readdirSync(kPage).filter((name) => name.endsWith(".js")).sort());
});

test("the live picture, its facts, loupe, spectrum and histogram are shown", async () => {
  const page = await opened();
  await until(() => page.locator("#stream").evaluate((image) => image.naturalWidth === 640), "a picture");
  for (const [id, text] of [["fps", "25.0"], ["over", "1.80"], ["under", "1.20"]]) {
    await page.locator(`#${id}`, { hasText: text }).waitFor();
  }
  const colours = (id) => page.locator(id).evaluate((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
  for (const id of ["#loupe", "#spectrum", "#histogram", "#trace"]) {
    await until(async () => (await colours(id)) > 2, `${id} is drawn`);
  }
  // Transparent, the mark of what is too bright, the mark of what is too dark.
  await until(async () => (await colours("#marks")) === 3, "what is too bright and too dark is marked");
  await page.getByLabel("Mark both in the picture").uncheck();
  await until(async () => (await colours("#marks")) === 1, "no marks");
});

test("a window is dragged, and its corner resizes it by powers of two", async () => {
  const page = await opened(), scale = await scaleOf(page), box = page.locator(".window");
  await drag(page, box, 100 * scale, -50 * scale);
  await until(() => last("windows")?.body.windows[0].x === 388, "it is moved");
  assert.deepEqual(last("windows").body.windows, [{ x: 388, y: 158, n: 64 }]);
  await drag(page, box.locator("i"), 50 * scale, 50 * scale);
  await until(() => last("windows").body.windows[0].n === 128, "it is resized");
  assert.deepEqual(last("windows").body.windows, [{ x: 388, y: 158, n: 128 }]);
  assert.equal(last("windows").type, "application/json");
});

test("keys move, resize, add and remove windows, and say so", async () => {
  const page = await opened(), box = page.locator(".window").first();
  await box.focus();
  for (const key of ["ArrowRight", "Shift+ArrowDown", "+"]) await page.keyboard.press(key);
  await until(() => last("windows")?.body.windows[0].n === 128, "it is resized");
  assert.deepEqual(last("windows").body.windows[0], { x: 257, y: 186, n: 128 });
  assert.equal(await page.locator("#spoken").textContent(), "Window 1: x 257, y 186, side 128 pixels");
  await press(page, "Add");
  await until(() => service.state.windows.length === 2, "there are two");
  await page.locator(".window").nth(1).focus();
  await page.keyboard.press("Delete");
  await until(() => service.state.windows.length === 1, "there is one");
});

test("a tap on the picture aims the window", async () => {
  const page = await opened({ size: "telephone" }), scale = await scaleOf(page);
  await page.locator("#picture").tap({ position: { x: 200 * scale, y: 300 * scale } });
  await sent("windows");
  const [{ x, y }] = last("windows").body.windows;
  assert.ok(Math.abs(x - 168) <= 2 && Math.abs(y - 268) <= 2, `${x}, ${y}`);
});

test("a refused window goes back to where it is, with the reason", async () => {
  const page = await opened();
  service.refusing = "the window is locked";
  const before = await middle(page.locator(".window"));
  await drag(page, page.locator(".window"), 90, 0);
  await page.locator("#notice", { hasText: "the window is locked" }).waitFor();
  await until(async () => Math.abs((await middle(page.locator(".window"))).x - before.x) < 1, "it is back");
  page.complaints = page.complaints.filter((text) => !text.includes("400 (Bad Request)"));
});

test("focus: points come one by one, then the answer with sigma, second lobe and words", async () => {
  const page = await opened();
  await press(page, "Focus");
  await sent("focus");
  service.evaluate(0);
  await answerSays(page, "Focusing: 1 position");
  assert.ok(await page.getByRole("button", { name: "Sweep" }).isDisabled());
  for (const position of made.kSearched.slice(1)) service.evaluate(position);
  service.find(made.focusResult());
  service.end("done");
  for (const text of ["781.190", "0.067", "focused, confidence 99", "983 times", "lobe at 430"]) await answerSays(page, text);
  await page.getByText("As a table").click();
  await until(async () => (await page.locator("#curve-table tbody tr").count()) === made.kSearched.length, "every point is in the table");
  assert.equal(await page.locator("#curve canvas").count(), 1);
});

test("a verdict that is none says what to try", async () => {
  const page = await opened();
  service.begin("focus");
  for (const position of [0, 600, 1200]) service.evaluate(position);
  service.find({ verdict: "no-focus", position: 600, sigma: 3, confidence: 0.1, words: "the scores rise no more than noise", advice: ["a larger window"], lobes: [], fit: [] });
  service.end("done");
  for (const text of ["no-focus", "no more than noise", "Advice", "a larger window"]) await answerSays(page, text);
  assert.equal(await page.locator("#answer .big").count(), 0, "no number is told as an answer");
  await page.locator("#curve-facts", { hasText: "focus: 3 positions" }).waitFor();
  assert.ok(await page.getByRole("button", { name: "Near the answer" }).isDisabled());
});

test("stop in the middle, by the button and by Escape, also for who does not drive", async () => {
  const page = await opened();
  service.drive.driver = "somebody-else";
  service.begin("sweep", 30);
  service.evaluate(100);
  await answerSays(page, "1 of 30");
  await press(page, "Stop");
  await answerSays(page, "Stopped");
  await page.locator("#stop.idle").waitFor();
  service.received.length = 0;
  await page.keyboard.press("Escape");
  await sent("stop");
});

test("a page that is opened again in the middle shows where things stand", async () => {
  const page = await opened();
  await press(page, "Focus");
  await sent("focus");
  for (const position of made.kSearched.slice(0, 5)) service.evaluate(position);
  await page.reload({ waitUntil: "domcontentloaded" });
  await answerSays(page, "Focusing: 5 positions");
  service.evaluate(526);
  await answerSays(page, "Focusing: 6 positions");
  assert.equal(await page.locator("#drive-words").textContent(), "You drive");
});

test("one drives; the other watches, asks, and takes over when it is let", async () => {
  const one = await opened(), other = await opened({ scheme: "dark" });
  await press(one, "Drive");
  await other.locator("#drive", { hasText: "Another page drives" }).waitFor();
  assert.ok(await other.getByRole("button", { name: "Focus" }).isDisabled());
  assert.ok(await other.getByRole("slider").isDisabled());
  await drag(other, other.locator(".window"), 50, 0);
  await other.locator("#notice", { hasText: "Ask to take over" }).waitFor();
  assert.equal(last("windows"), undefined);
  await press(other, "Ask to take over");
  await one.locator("#drive", { hasText: "asks to drive" }).waitFor();
  await press(one, "Let it");
  await other.locator("#drive", { hasText: "You drive" }).waitFor();
  assert.ok(await one.getByRole("button", { name: "Focus" }).isDisabled());
  assert.ok(await other.getByRole("button", { name: "Focus" }).isEnabled());
  // The browser tells of the first try, which is for a driver that has gone.
  other.complaints = other.complaints.filter((text) => !text.includes("409"));
});

test("a driver that has gone is not asked", async () => {
  const page = await opened();
  service.drive.driver = "who-has-gone";
  service.isDriverGone = true;
  service.emitState();
  await press(page, "Ask to take over");
  await page.locator("#drive", { hasText: "You drive" }).waitFor();
});

test("what is only shown offers nothing that would be refused", async () => {
  service.state.read_only = true;
  const page = await opened();
  await page.locator("#drive", { hasText: "shown only" }).waitFor();
  const enabled = page.locator("#actions button:enabled, [data-step]:enabled, #lens:enabled, #add-window:enabled, #stop:visible, #drive button:visible");
  assert.equal(await enabled.count(), 0);
});

test("calibrate asks for distances one by one, and shows curve, residuals and outliers", async () => {
  const page = await opened();
  await page.getByText("Travel and calibration").click();
  await page.getByLabel("Keep a calibration as").fill("bench");
  await press(page, "Calibrate");
  await until(() => last("calibrate")?.body.name === "bench", "the name is sent");
  const field = page.getByLabel("Distance of the target now");
  const points = [];
  for (const [distance, position] of [[600, 1010], [900, 860], [1500, 640]]) {
    await field.fill(String(distance));
    await page.keyboard.press("Enter");
    await until(() => last("calibrate/next")?.body.distance === distance, "a distance is sent");
    await field.waitFor({ state: "hidden" });
    points.push({ distance, position, sigma: 0.2 });
    service.emitState({ calibration: { ...service.state.calibration, points, waiting_for_next: true } });
    await field.waitFor();
  }
  await press(page, "Finish");
  await sent("calibrate/done");
  const fit = { model: "thin-lens", equation: "s = a + b / d", position_scatter: 0.4, residuals_mm: [0.1, -0.1, 55.5], left_out: [false, false, true], curve: [[560, 1600], [1010, 600]], name: "bench" };
  service.emitState({ activity: "live", calibration: { ...service.state.calibration, waiting_for_next: false, fit }, calibrations: ["bench"] });
  await page.locator("#calibration-table tr.outlier", { hasText: "55.50" }).waitFor();
  assert.equal(await page.locator("#calibration-plot canvas").count(), 1);
  await press(page, "Range");
  await sent("range");
  assert.deepEqual(last("range").body, { calibration: "bench" });
});

test("a distance is told with its sigma; the map grows; runs are compared", async () => {
  const page = await opened();
  service.begin("range");
  service.find({ ...made.focusResult(), distance: { value: 1502.4, sigma: 3.1, unit: "mm" } });
  const run = { kind: "focus", when: "2026-11-30T11:59:46Z", position: 781.19, sigma: 0.067, verdict: "focused" };
  service.runs = [{ id: "a", ...run }, { id: "b", ...run, when: "2026-11-30T11:00:00Z" }];
  for (const { id } of service.runs) service.runFiles[id] = runFile();
  service.end("done");
  await answerSays(page, "1502.4");
  service.emit("map", { columns: 2, rows: 1, unit: "steps", values: [700, null] });
  await page.locator("#map-facts", { hasText: "50" }).waitFor();
  const boxes = page.locator("#runs input");
  await until(async () => (await boxes.count()) === 2, "runs are listed");
  for (const box of await boxes.all()) await box.check();
  await press(page, "Compare");
  await page.locator("#curve-facts", { hasText: "2 runs" }).waitFor();
  assert.equal(await page.locator("#curve-legend span").count(), 2);
  await page.locator("#runs button", { hasText: "Rerun" }).first().click();
  await page.locator("#runs", { hasText: "same answer" }).waitFor();
  assert.match(await page.locator("#runs a").first().getAttribute("href"), /^\/api\/v1\/runs\/a\/file/);
});

function runFile() {
  return {
    setup: { lens: { unit: "steps" }, metric: "walsh-sequency:64" },
    runs: [{ repeat_scatter: 0.01, evaluations: made.kSearched.map((position) => ({ position, score: made.scoreAt(position) })), focus: { result: "focused", position: 781.19, sigma: 0.067, confidence: 0.99, peaks: [] } }],
  };
}

test("lens, metric and travel are sent as they were set", async () => {
  const page = await opened();
  const slider = page.getByRole("slider");
  await until(async () => (await slider.inputValue()) === "640", "the slider is where the lens stands");
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await until(() => last("lens")?.body.position === 641, "the slider moves the lens");
  await page.getByRole("button", { name: "Lens down by 20 steps" }).click();
  await until(() => last("lens").body.by === -20, "a step moves it");
  await page.locator("#metric summary").click();
  await page.getByRole("radio", { name: "fft" }).check();
  await until(() => last("settings")?.body.metric === "fft", "the metric is chosen");
  await page.getByText("Travel and calibration").click();
  await page.getByLabel("From").fill("700,5");
  await page.getByLabel("To", { exact: true }).fill("much");
  await press(page, "Sweep");
  await page.locator("#notice", { hasText: "To is no number" }).waitFor();
  await page.getByLabel("To", { exact: true }).fill("900");
  await press(page, "Sweep");
  await sent("sweep");
  assert.deepEqual(last("sweep").body, { from: 700.5, to: 900 });
});

test("a lost service is told of, and its return", async () => {
  const page = await opened(), { port } = new URL(service.url);
  await service.stop();
  await page.locator("#link", { hasText: "no connection" }).waitFor();
  await page.getByText("this picture is old").waitFor();
  assert.ok(await page.getByRole("button", { name: "Focus" }).isDisabled());
  service = new MockService(kPage);
  await new Promise((ready) => service.server.listen(Number(port), "127.0.0.1", ready));
  await page.locator("#link", { hasText: /^connected/ }).waitFor();
  page.complaints = page.complaints.filter((text) => !text.includes("ERR_"));
});

test("many pages of one browser leave each other connections, so that Stop is heard", async () => {
  const page = await opened();
  const more = [];
  for (let k = 0; k < 3; ++k) {
    more.push(await page.context().newPage());
    await more[k].goto(service.url, { waitUntil: "domcontentloaded" });
    await more[k].locator("#link", { hasText: "connected" }).waitFor();
  }
  service.begin("sweep", 30);
  await answerSays(more[2], "0 of 30");
  await press(more[2], "Stop");
  await answerSays(more[2], "Stopped");
});

test("everything that can be operated or seen has a name", async () => {
  const page = await opened();
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas, [role=img]")]
    .filter((e) => !e.closest("[hidden], [aria-hidden=true], .uplot") && !e.textContent.trim() && !e.labels?.length &&
      !e.ariaLabel && !e.getAttribute("aria-labelledby"))
    .map((e) => e.outerHTML));
  assert.deepEqual(nameless, []);
});

test("on a telephone nothing sticks out, fingers find the buttons, and Stop is always there", async () => {
  const page = await opened({ size: "telephone" });
  await focusOn(page);
  service.emit("map", { columns: 40, rows: 30, unit: "steps", values: Array.from({ length: 1200 }, (_, i) => 700 + i) });
  await page.locator("#map").waitFor();
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= kSizes.telephone.width, `${wide} px wide`);
  for (const name of ["Focus", "Sweep", "Calibrate"]) {
    const { height } = await page.getByRole("button", { name, exact: true }).boundingBox();
    assert.ok(height >= 44, `${name} is ${height} px high`);
  }
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  const { y } = await page.locator("#stop").boundingBox();
  assert.ok(y >= 0 && y < kSizes.telephone.height, `Stop is at ${y}`);
});

for (const [size, scheme] of [["desktop", "light"], ["tablet", "dark"], ["telephone", "light"]]) {
  test(`it looks as it did: ${size}, ${scheme}`, async () => {
    service.state.windows = [{ x: 288, y: 208, n: 64 }, { x: 96, y: 120, n: 128 }];
    const page = await opened({ size, scheme });
    await focusOn(page);
    // The trace goes by the page's clock: here a score comes every 200 ms.
    await page.evaluate(() => {
      let now = performance.now();
      performance.now = () => (now += 200);
    });
    service.live();
    await page.locator("#score-best", { hasText: "758 steps" }).waitFor();
    await until(() => page.locator("#curve canvas").count(), "the curve");
    await until(() => page.locator("#marks").evaluate((canvas) => canvas.width > 300), "the marks");
    await page.evaluate(() => scrollTo(0, 0));
    await page.waitForTimeout(300);  // For what is drawn ten times a second.
    await compareShot(browser, page, `${size}-${scheme}`, kMostOther);
  });
}
