// SPDX-License-Identifier: Apache-2.0
// Metric and search, chosen from lists with one line on each.
import { get } from "./api.js";
import { byId, command, make, say } from "./page.js";
import { mayChange } from "./model.js";
import { model, on } from "./store.js";

const kKinds = { metric: "metrics", search: "searches" };

/** A metric's full text begins with the name under which it is listed: "fft:64:hann" is "fft". */
export function listedAs(text, offers) {
  const named = offers.filter(({ name }) => text === name || text.startsWith(name + ":"));
  return named.reduce((best, offer) => (offer.name.length > (best?.name.length ?? 0) ? offer : best), null);
}

function choice(kind, { name, line }) {
  const radio = make("input", { type: "radio", name: kind, value: name });
  radio.addEventListener("change", () => choose(kind, name));
  return make("label", {}, radio, make("b", {}, name), make("span", {}, line));
}

async function choose(kind, name) {
  if (!(await command("settings", { [kind]: name }))) draw();
}

function another() {
  const field = make("input", { ariaLabel: "Another metric", placeholder: "fft:64:hann:power", autocomplete: "off" });
  const form = make("form", {}, field, make("button", { type: "submit" }, "Use"));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (field.value.trim()) choose("metric", field.value.trim());
  });
  return form;
}

async function fill(kind) {
  const offers = await get(kKinds[kind]).catch(() => []);
  model.offered[kind] = offers;
  const field = byId(kind).querySelector("fieldset");
  field.replaceChildren(field.querySelector("legend"), ...offers.map((offer) => choice(kind, offer)));
  if (kind === "metric") field.append(another());
  draw();
}

function draw() {
  if (!model.state) return;
  for (const kind of Object.keys(kKinds)) {
    const box = byId(kind), text = model.state[kind] ?? "", offer = listedAs(text, model.offered[kind] ?? []);
    say(box.querySelector("summary b"), text);
    say(box.querySelector("summary span"), offer?.line ?? "");
    box.querySelector("fieldset").disabled = !mayChange(model.state);
    for (const radio of box.querySelectorAll("input[type=radio]")) radio.checked = radio.value === offer?.name;
  }
}

export function showSettings() {
  on("state drive link", draw);
  on("link", () => {
    if (model.isLinked) for (const kind of Object.keys(kKinds)) fill(kind);
  });
}
