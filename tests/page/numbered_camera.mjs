// SPDX-License-Identifier: Apache-2.0
// A camera of 640 x 480 px and 30 pictures a second, each with its number in it, as the rig of a service
// elsewhere (docs/http.md): so that one sees on the page which picture is shown, and how late.
import { createServer } from "node:http";
import { greys, kHeight, kWidth } from "./made_up.mjs";

const kPerSecond = 30, kExposureMs = 10;
/** A number is a row of squares, dark and bright. They outlive JPEG and a narrower picture. */
const kBits = 16, kSquarePx = 32, kDark = 40, kBright = 210, kLimit = 125;
const kToken = "token-of-a-camera";

const kFacts = {
  camera: { description: "numbered pictures", width: kWidth, height: kHeight, bits: 8, exposure_ms: kExposureMs,
    live: true, streams: true, recorded_here: 1, patience_ms: 1000 },
  lens: { description: "a lens that stands still", unit: "steps", min: 0, max: 10, step: 1, coarse: 1, stops: [],
    stop_names: [], optics: null, blur_px_per_unit: null },
  stage: false,
};

const nowNs = () => process.hrtime.bigint();

export class NumberedCamera {
  #ended = [];         // when the exposure of each picture ended, ms of Unix time
  #waiting = null;     // who is given the next picture
  #isTaken = true;     // the last one was given away,
  #end_ns = 0n;        // and when its exposure ended, on the clock of stamps
  #pixels = Buffer.concat([Buffer.from(`P5\n${kWidth} ${kHeight}\n255\n`), greys()]);

  /** Exposures begin with run() or expose(). */
  async start() {
    this.server = createServer((request, response) => this.#answer(request, response));
    await new Promise((ready) => this.server.listen(0, "127.0.0.1", ready));
    this.rig = `http://127.0.0.1:${this.server.address().port}?token=${kToken}`;
    return this;
  }

  run() {
    this.timer = setInterval(() => this.expose(), 1000 / kPerSecond);
  }

  stop() {
    clearInterval(this.timer);
    this.server.closeAllConnections();
    return new Promise((done) => this.server.close(done));
  }

  /** Takes a picture and returns its number. One that nobody has asked for waits, until the next comes. */
  expose() {
    this.#end_ns = nowNs();
    this.#isTaken = false;
    const number = this.#ended.push(performance.timeOrigin + performance.now()) - 1;
    this.#write(number);
    this.#give();
    return number;
  }

  #give() {
    if (this.#isTaken || !this.#waiting) return;
    this.#send(this.#waiting, 200, Buffer.from(this.#pixels), { "X-Fathom-Stamp-Ns": this.#end_ns - BigInt(kExposureMs * 1e6),
      "X-Fathom-End-Ns": this.#end_ns, "X-Fathom-Position": 5, "X-Fathom-Dropped": 0, "X-Fathom-Corrupt": 0 });
    this.#isTaken = true;
    this.#waiting = null;
  }

  #write(number) {
    const first = this.#pixels.length - kWidth * kHeight;
    for (let bit = 0; bit < kBits; ++bit) {
      const grey = (number >> bit) & 1 ? kBright : kDark, from = first + bit * kSquarePx;
      for (let y = 0; y < kSquarePx; ++y) this.#pixels.fill(grey, from + y * kWidth, from + y * kWidth + kSquarePx);
    }
  }

  #answer(request, response) {
    const { pathname, searchParams } = new URL(request.url, "http://localhost");
    const path = pathname.replace("/api/v1/", "");
    if (path === "rig/frame") return this.#wait(response, Number(searchParams.get("timeout_ms")));
    const said = { rig: kFacts, "rig/position": { position: 5 } }[path] ?? {};
    this.#send(response, 200, JSON.stringify(said), {});
  }

  #wait(response, forMs) {
    this.#waiting = response;
    setTimeout(() => {
      if (this.#waiting !== response) return;
      this.#waiting = null;
      response.writeHead(204, { "X-Fathom-Now-Ns": nowNs() }).end();
    }, forMs);
    this.#give();
  }

  #send(response, status, body, headers) {
    response.writeHead(status, { "Content-Length": body.length, "X-Fathom-Now-Ns": nowNs(), ...headers });
    response.end(body);
  }

  /** How late each picture was that a page showed, ms from the end of its exposure, from least to most. */
  async delays(page, forMs) {
    const shown = await numbersShown(page, forMs);
    // The first one may have been there for a while.
    return shown.slice(1).map(({ number, at }) => at - this.#ended[number])
      .filter(Number.isFinite).sort((a, b) => a - b);
  }
}

/** Delays in words. */
export function delayWords(delays) {
  if (!delays.length) return "no picture came";
  const late = (part) => `${delays[Math.floor(part * delays.length)].toFixed(0)} ms`;
  return `${late(0.5)} in the middle, ${late(0.95)} at most for 95 % of ${delays.length} pictures`;
}

/** The number of each new picture on the screen, the one that is there first, and since when, ms of Unix time. */
export const numbersShown = (page, forMs) =>
  page.evaluate(watch, { forMs, kBits, kSquarePx, kLimit, kWidth });

/** In the page. */
async function watch({ forMs, kBits, kSquarePx, kLimit, kWidth }) {
  const image = document.getElementById("stream"), shown = [];
  const context = new OffscreenCanvas(kBits, 1).getContext("2d", { willReadFrequently: true });
  const end = performance.now() + forMs;
  do {
    await new Promise(requestAnimationFrame);
    if (image.naturalWidth === 0) continue;
    const square = kSquarePx * image.naturalWidth / kWidth;
    for (let bit = 0; bit < kBits; ++bit) {
      context.drawImage(image, (bit + 0.25) * square, square / 4, square / 2, square / 2, bit, 0, 1, 1);
    }
    const { data } = context.getImageData(0, 0, kBits, 1);
    let number = 0;
    for (let bit = 0; bit < kBits; ++bit) number |= (data[4 * bit] > kLimit) << bit;
    if (number !== shown.at(-1)?.number) shown.push({ number, at: performance.timeOrigin + performance.now() });
  } while (performance.now() < end);
  return shown;
}
