// SPDX-License-Identifier: Apache-2.0
// A service that says what a test tells it to, for what a real rig does not do on demand: an outlier,
// a second lobe, the same picture every time. It keeps to docs/http.md as far as the page needs it.
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join } from "node:path";
import * as made from "./made_up.mjs";

const kTypes = { ".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8", ".svg": "image/svg+xml", ".txt": "text/plain" };
const kBoundary = "fathom";

const kMetrics = [
  { name: "walsh-sequency", line: "Walsh-Hadamard in order of sign changes: fast, sure, the usual one" },
  { name: "fft", line: "Fourier with a Hann taper: for fine texture and much noise" },
  { name: "dct", line: "Cosine transform: no taper, no leaks at the edges" },
];
const kSearches = [
  { name: "auto", line: "By spectra where the blur is known, else coarse and fine" },
  { name: "full", line: "Every position of the travel" },
  { name: "golden", line: "Golden section, as in the thesis" },
];

export function firstState() {
  return {
    version: "1", rig: "sim:seed=1", description: "simulated 135 mm lens at f/4", read_only: false,
    camera: { width: made.kWidth, height: made.kHeight, max_value: 255, streams: true },
    lens: { unit: "steps", min: 0, max: 1200, step: 1, stops: null, position: 640, moving: false },
    metric: "walsh-sequency:64", search: "auto", windows: [{ x: 288, y: 208, n: 64 }],
    activity: "live", measurement: null, calibration: null, calibrations: [], folder: true, map: null,
    clients: 1,
  };
}

export class MockService {
  state = firstState();
  drive = { driver: null, asking: [] };
  received = [];   // {path, body, client}
  runs = [];
  runFiles = {};
  #listeners = new Map();
  #id = 0;

  constructor(pageFolder) {
    this.folder = pageFolder;
    this.server = createServer((request, response) => this.#answer(request, response));
    this.image = made.picture();
  }

  async start() {
    await new Promise((ready) => this.server.listen(0, "127.0.0.1", ready));
    this.url = `http://127.0.0.1:${this.server.address().port}/`;
    return this;
  }

  stop() {
    this.server.closeAllConnections();
    return new Promise((done) => this.server.close(done));
  }

  /** Sends an event to every page. */
  emit(name, data) {
    for (const client of this.#listeners.keys()) this.#tell(client, name, data);
  }

  /** Sends the state to every page, each with its own drive. */
  emitState(changes = {}) {
    Object.assign(this.state, changes);
    for (const client of this.#listeners.keys()) this.#tell(client, "state", this.#stateFor(client));
  }

  #stateFor(client) {
    return { ...this.state, drive: { ...this.drive, you: this.drive.driver === client } };
  }

  #tell(client, name, data) {
    for (const response of this.#listeners.get(client) ?? []) {
      response.write(`id: ${++this.#id}\nevent: ${name}\ndata: ${JSON.stringify(data)}\n\n`);
    }
  }

  /** Pages that listen now. */
  get listeners() {
    return [...this.#listeners.values()].reduce((sum, set) => sum + set.size, 0);
  }

  async #answer(request, response) {
    const { pathname, searchParams } = new URL(request.url, "http://localhost");
    response.setHeader("Content-Security-Policy", "default-src 'self'");
    response.setHeader("Cache-Control", "no-store");
    if (pathname === "/") return this.#file(response, "index.html");
    if (pathname.startsWith("/page/")) return this.#file(response, pathname.slice("/page/".length));
    const path = pathname.replace("/api/v1/", ""), client = searchParams.get("client") ?? "anonymous";
    if (request.method === "POST") return this.#command(request, response, path, client);
    if (path === "events") return this.#listen(response, client);
    if (path === "stream.mjpg") return this.#stream(response);
    if (path === "frame") return response.writeHead(200, { "Content-Type": "image/png" }).end(this.image);
    const found = this.#look(path, client);
    this.#json(response, found ? 200 : 404, found ?? { error: { code: "not_found", message: path } });
  }

  #look(path, client) {
    if (path.startsWith("runs/")) return this.runFiles[path.split("/")[1]];
    return { state: this.#stateFor(client), metrics: kMetrics, searches: kSearches, runs: this.runs }[path];
  }

  #json(response, status, data) {
    response.writeHead(status, { "Content-Type": "application/json" });
    response.end(JSON.stringify(data));
  }

  async #file(response, name) {
    try {
      const bytes = await readFile(join(this.folder, name));
      response.writeHead(200, { "Content-Type": kTypes[extname(name)] });
      response.end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  }

  #listen(response, client) {
    response.writeHead(200, { "Content-Type": "text/event-stream" });
    if (!this.#listeners.has(client)) this.#listeners.set(client, new Set());
    this.#listeners.get(client).add(response);
    response.on("close", () => this.#listeners.get(client).delete(response));
    this.#tell(client, "state", this.#stateFor(client));
    this.live();
  }

  /** What a live rig says all the time, once. */
  live() {
    const stamp = 20e9;
    const position = this.state.lens.position;
    this.emit("frame", { stamp_ns: stamp, fps: 25, position, mean: 0.463, histogram: made.histogram(), under: 0.012, over: 0.018 });
    for (let k = 0; k <= 100; ++k) {
      const swept = position - 200 + 2 * k;
      this.emit("score", { stamp_ns: stamp - 20e9 + k * 0.2e9, position: swept,
        scores: this.state.windows.map((_, i) => made.scoreAt(swept + 20 * i) / (1 + i)) });
    }
    this.emit("spectrum", made.spectrum());
  }

  #stream(response) {
    response.writeHead(200, { "Content-Type": `multipart/x-mixed-replace; boundary=${kBoundary}` });
    response.write(`--${kBoundary}\r\n`);
    const part = () => {
      response.write(`Content-Type: image/png\r\nContent-Length: ${this.image.length}\r\n\r\n`);
      response.write(this.image);
      response.write(`\r\n--${kBoundary}\r\n`);
    };
    part();
    const timer = setInterval(part, 200);
    response.on("close", () => clearInterval(timer));
  }

  async #command(request, response, path, client) {
    let text = "";
    for await (const bytes of request) text += bytes;
    const body = JSON.parse(text);
    this.received.push({ path, body, client, type: request.headers["content-type"] });
    const refusal = this.#refusal(path, body, client);
    if (refusal) return this.#json(response, refusal.status, { error: refusal });
    if (path !== "stop" && path !== "drive") this.drive.driver ??= client;
    this.#json(response, 200, this.#does(path, body, client) ?? {});
    this.emitState();
  }

  #refusal(path, body, client) {
    const isElsewhere = this.drive.driver && this.drive.driver !== client;
    if (path === "drive" && body.action === "take" && isElsewhere && !this.isDriverGone) {
      return { status: 409, code: "unavailable", message: "somebody else drives" };
    }
    if (path === "stop" || path === "drive") return null;
    if (isElsewhere) return { status: 403, code: "not_driver", message: "another page drives" };
    if (this.refusing) return { status: 400, code: "bad_argument", message: this.refusing };
    return null;
  }

  #does(path, body, client) {
    const does = {
      windows: () => { this.state.windows = body.windows; },
      lens: () => { this.state.lens.position = body.position ?? this.state.lens.position + body.by; },
      settings: () => Object.assign(this.state, body),
      stop: () => this.#stopped(),
      drive: () => this.#driven(body.action, client),
      calibrate: () => Object.assign(this.state, { activity: "calibrate", calibration: { model: "auto", unit: "mm", distances: [], points: [], waiting_for_next: true, fit: null } }),
      "calibrate/next": () => { this.state.calibration.waiting_for_next = false; },
      capture: () => ({ folder: "capture-1" }),
    };
    if (Object.hasOwn(does, path)) return does[path]() ?? null;
    if (path.endsWith("/rerun")) return { same: true, text: "same answer" };
    if (["focus", "sweep", "range", "depth"].includes(path)) this.begin(path);
    return null;
  }

  #driven(action, client) {
    const { drive } = this;
    const does = {
      ask: () => drive.asking.push(client), take: () => Object.assign(drive, { driver: client, asking: [] }),
      give: () => Object.assign(drive, { driver: drive.asking[0] ?? null, asking: [] }), refuse: () => { drive.asking = []; },
    };
    does[action]();
  }

  #stopped() {
    const { measurement } = this.state;
    if (measurement?.status === "running") this.end("stopped");
    this.state.activity = "live";
  }

  /** A measurement of made-up points, which a test takes forward one by one. */
  begin(kind, positions = 0) {
    this.state.measurement = { id: `${kind}-1`, kind, status: "running", points: [], positions_expected: positions, scatter: 0.0126, warnings: [], result: null };
    this.state.activity = kind;
    this.emit("began", { id: `${kind}-1`, kind, positions, scatter: 0.0126 });
    this.emitState();
  }

  evaluate(position) {
    const point = { position, score: made.scoreAt(position), frames: 1 };
    this.state.measurement.points.push(point);
    this.state.lens.position = position;
    this.emit("evaluated", point);
  }

  find(result) {
    this.state.measurement.result = result;
    this.emit("found", result);
  }

  end(status, error = null) {
    Object.assign(this.state.measurement, { status, error });
    this.state.activity = "live";
    this.emit("ended", { id: this.state.measurement.id, kind: this.state.measurement.kind, status, error });
    this.emitState();
  }
}
