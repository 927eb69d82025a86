// SPDX-License-Identifier: Apache-2.0
// Who drives: one page does, the others watch, and may ask to take over.
import { client, send } from "./api.js";
import { byId, command, say } from "./page.js";
import { model, on } from "./store.js";

/** A driver that has not answered for so long may be taken over from. */
const kPatienceMs = 10500;
let askedAt = null;

const drive = (action) => (action === "ask" ? askOrTake() : command("drive", { action }));

/** A driver that has gone need not be asked. */
async function askOrTake() {
  const isTaken = await send("drive", { action: "take" }).then(() => true, () => false);
  if (!isTaken) await command("drive", { action: "ask" });
}

const isPatient = () => askedAt !== null && performance.now() - askedAt < kPatienceMs;

/** What is said, and what the two buttons do: [words, {text, action}, {text, action}]. */
export function offer({ you, driver, asking }, { readOnly, isAsking, mayTake }) {
  if (readOnly) return ["shown only"];
  if (you && asking.length) {
    return ["Another page asks to drive", { text: "Let it", action: "give" }, { text: "Refuse", action: "refuse" }];
  }
  if (you) return ["You drive", { text: "Give away", action: "give" }];
  if (!driver) return ["Nobody drives yet", null, { text: "Drive", action: "take" }];
  if (isAsking && mayTake) return ["No answer", null, { text: "Take over", action: "take" }];
  if (isAsking) return ["Asked; waiting for an answer"];
  return ["Another page drives", null, { text: "Ask to take over", action: "ask" }];
}

function button(element, what) {
  element.hidden = !what;
  if (!what) return;
  say(element, what.text);
  element.dataset.does = what.action;
}

function draw() {
  const state = model.state;
  if (!state) return;
  const isAsking = state.drive.asking.includes(client);
  if (!isAsking) askedAt = null;
  else askedAt ??= performance.now();
  const [words, first, second] = offer(state.drive, { readOnly: state.read_only, isAsking, mayTake: !isPatient() });
  say(byId("drive-words"), words);
  button(byId("drive-give"), first);
  button(byId("drive-ask"), second);
  if (isAsking && isPatient()) setTimeout(draw, kPatienceMs);
}

export function showDrive() {
  on("state drive", draw);
  for (const id of ["drive-give", "drive-ask"]) {
    byId(id).addEventListener("click", (event) => drive(event.currentTarget.dataset.does));
  }
}
