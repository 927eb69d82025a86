// SPDX-License-Identifier: Apache-2.0
// Short words for what every part of the page does with the document.
import { send } from "./api.js";

export const byId = (id) => document.getElementById(id);

/** Sets text only where it differs, so that nothing is laid out again for nothing. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** make("td", {className: "number"}, "1", other element) */
export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** A table of rows of texts or elements; columns: {name, number: bool}. */
export function table(columns, rows, caption) {
  const kind = (column) => (column.number ? "number" : "");
  const head = columns.map((c) => make("th", { className: kind(c), scope: "col" }, c.name));
  const body = rows.map(({ cells, className = "" }) => make("tr", { className },
    ...cells.map((cell, i) => make("td", { className: kind(columns[i]) }, cell))));
  return make("table", {}, make("caption", { className: "unseen" }, caption),
    make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...body));
}

/** Shows what went wrong until it is closed, or something goes well. */
export function notice(text) {
  byId("notice").hidden = !text;
  say(byId("notice-words"), text ?? "");
}
byId("notice-close").addEventListener("click", () => notice(null));

/** Tells it to those who hear the page, not to those who see it. */
export const speak = (text) => say(byId("spoken"), text);

/** Does something that the service may refuse; says so if it does. Returns the answer or null. */
export async function trying(action) {
  try {
    const result = await action();
    notice(null);
    return result ?? {};
  } catch (refusal) {
    notice(refusal.message);
    return null;
  }
}

export const command = (path, body) => trying(() => send(path, body));

/** Sends at most one at a time, and of those that come meanwhile only the last: for drags. */
export function lastOnly(path, onRefused = () => {}) {
  let isSending = false, waiting = null;
  return async function push(body) {
    if (isSending) {
      waiting = body;
      return;
    }
    isSending = true;
    const answer = await command(path, body);
    isSending = false;
    if (!answer && !waiting) onRefused();
    if (waiting) {
      const next = waiting;
      waiting = null;
      await push(next);
    }
  };
}

/** A canvas as large as it is shown, in the screen's own pixels. Returns its context and size. */
export function fitted(canvas) {
  const scale = devicePixelRatio || 1;
  const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, width, height);
  return { context, width, height, scale };
}

const colours = new Map();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => colours.clear());

/** A colour of the style sheet, such as "accent". */
export function colour(name) {
  if (!colours.has(name)) {
    const value = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    if (value === "") return "#888";  // The style sheet is not there yet.
    colours.set(name, value);
  }
  return colours.get(name);
}
