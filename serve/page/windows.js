// SPDX-License-Identifier: Apache-2.0
// The windows on the picture and in the list: chosen, dragged, resized, added, removed.
import { another, centred, moved, resized, stretched } from "./geometry.js";
import { byId, lastOnly, make, notice, say, speak } from "./page.js";
import { isBusy, mayChange } from "./model.js";
import { model, on, tell } from "./store.js";

/** So long after a change the service's word on the windows is awaited, and no older one is shown. */
const kSettleMs = 400;
const kStepFast = 10;

const picture = byId("picture"), layer = byId("windows");
const push = lastOnly("windows", () => adopt());
let boxes = [];
let windows = [];
let changedAt = -Infinity;

/** The window that keys, loupe and taps mean. */
export const chosen = () => windows[model.chosen] ?? windows[0] ?? null;

const camera = () => model.state.camera;

function change(next, spoken) {
  windows = next;
  changedAt = performance.now();
  setTimeout(settle, kSettleMs + 1);
  draw();
  push({ windows });
  if (spoken) speak(spoken);
}

/** The service's word on the windows. */
function adopt() {
  windows = model.state.windows;
  if ((model.chosen ?? 0) >= windows.length) model.chosen = 0;
  draw();
}

/** The hand's word goes first while it moves a window; a moment later the service's does. */
function settle() {
  if (performance.now() - changedAt > kSettleMs || isBusy(model.state)) adopt();
  else draw();
}

const replace = (index, window, spoken) =>
  change(windows.map((old, i) => (i === index ? window : old)), spoken);

function choose(index) {
  model.chosen = index;
  draw();
}

function refuse() {
  if (isBusy(model.state)) notice("The windows stay where they are until the measurement has ended, or Stop.");
  else if (model.state?.read_only) notice("This rig is shown only: nothing can be changed.");
  else if (model.state?.isLinked === false) notice("No connection to the service.");
  else notice("Somebody else drives this rig. Ask to take over first.");
}

/** Pixels of the picture that a pointer is at. */
function placeOf(event) {
  const box = picture.getBoundingClientRect();
  return {
    x: (event.clientX - box.left) * camera().width / box.width,
    y: (event.clientY - box.top) * camera().height / box.height,
  };
}

function drag(element, index, moveTo) {
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    choose(index);
    boxes[index].focus({ preventScroll: true });
    if (!mayChange(model.state)) return refuse();
    element.setPointerCapture(event.pointerId);
    const begin = placeOf(event), from = windows[index];
    const move = (next) => {
      const to = moveTo(from, begin, placeOf(next));
      if (!isSame(to, windows[index])) replace(index, to);
    };
    element.addEventListener("pointermove", move);
    const end = () => element.removeEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, end, { once: true });
  });
}

const isSame = (a, b) => a.x === b.x && a.y === b.y && a.n === b.n;

function keyed(event, index) {
  const fast = event.shiftKey ? kStepFast : 1;
  const window = windows[index];
  const actions = {
    ArrowLeft: () => moved(window, -fast, 0, camera()), ArrowRight: () => moved(window, fast, 0, camera()),
    ArrowUp: () => moved(window, 0, -fast, camera()), ArrowDown: () => moved(window, 0, fast, camera()),
    "+": () => resized(window, window.n * 2, camera()), "=": () => resized(window, window.n * 2, camera()),
    "-": () => resized(window, window.n / 2, camera()),
  };
  const removes = event.key === "Delete" || event.key === "Backspace";
  if (!removes && !Object.hasOwn(actions, event.key)) return;
  event.preventDefault();
  if (!mayChange(model.state)) return refuse();
  if (removes) return remove(index);
  const next = actions[event.key]();
  replace(index, next, words(next, index));
}

const words = ({ x, y, n }, index) => `Window ${index + 1}: x ${x}, y ${y}, side ${n} pixels`;

function remove(index) {
  if (windows.length < 2) return notice("One window must stay.");
  model.chosen = 0;
  change(windows.filter((_, i) => i !== index), `Window ${index + 1} removed`);
  boxes[0]?.focus({ preventScroll: true });
}

function add() {
  if (!mayChange(model.state)) return refuse();
  model.chosen = windows.length;
  change([...windows, another(windows, camera())], `Window ${windows.length + 1} added`);
}

function boxFor(index) {
  const corner = make("i", { title: "Drag to resize" });
  const box = make("div", { className: "window", tabIndex: 0 }, make("b"), corner);
  box.setAttribute("role", "group");
  box.setAttribute("aria-roledescription", "window of the picture");
  box.addEventListener("keydown", (event) => keyed(event, index));
  box.addEventListener("focus", () => { if (model.chosen !== index) choose(index); });
  box.addEventListener("click", (event) => event.stopPropagation());
  drag(box, index, (from, begin, now) => moved(from, now.x - begin.x, now.y - begin.y, camera()));
  drag(corner, index, (from, begin, now) => stretched(from, now.x, now.y, camera()));
  return box;
}

function draw() {
  if (boxes.length !== windows.length) {
    boxes = windows.map((_, i) => boxes[i] ?? boxFor(i));
    layer.replaceChildren(...boxes);
  }
  const part = (value, whole) => `${(100 * value / whole).toFixed(4)}%`;
  windows.forEach(({ x, y, n }, i) => {
    const { style, classList } = boxes[i];
    style.left = part(x, camera().width);
    style.top = part(y, camera().height);
    style.width = part(n, camera().width);
    style.height = part(n, camera().height);
    classList.toggle("chosen", windows.length > 1 && i === (model.chosen ?? 0));
    classList.toggle("fixed", !mayChange(model.state));
    classList.toggle("low", y < camera().height * 0.06);
    boxes[i].setAttribute("aria-label", words(windows[i], i));
    say(boxes[i].firstChild, windows.length > 1 ? `${i + 1} \u00b7 ${n}` : `${n} px`);
  });
  drawList();
  tell("windows");
}

/** Kept from one drawing to the next, so that a button that has the focus keeps it. */
let rows = [];

function drawList() {
  if (rows.length !== windows.length) {
    rows = windows.map((_, i) => rows[i] ?? rowFor(i));
    byId("window-list").replaceChildren(...rows.map((row) => row.whole));
  }
  windows.forEach(({ x, y, n }, i) => {
    const { pick, away } = rows[i];
    say(pick, `${i + 1}: ${n} px at ${x}, ${y}${i === 0 ? " (measured)" : ""}`);
    pick.setAttribute("aria-pressed", String(i === (model.chosen ?? 0)));
    away.disabled = windows.length < 2 || !mayChange(model.state);
  });
  byId("add-window").disabled = !mayChange(model.state);
}

function rowFor(index) {
  const pick = make("button", { type: "button", className: "pick" });
  const away = make("button", { type: "button", ariaLabel: `Remove window ${index + 1}` }, "Remove");
  pick.addEventListener("click", () => choose(index));
  away.addEventListener("click", () => remove(index));
  return { pick, away, whole: make("div", { className: "one-window" }, pick, away) };
}

export function showWindows() {
  on("state drive link", () => {
    if (model.state) settle();
  });
  byId("add-window").addEventListener("click", add);
  picture.addEventListener("click", (event) => {
    if (!model.state || !chosen()) return;
    if (!mayChange(model.state)) return refuse();
    const { x, y } = placeOf(event);
    const index = model.chosen ?? 0, next = centred(windows[index], x, y, camera());
    replace(index, next, words(next, index));
  });
}
