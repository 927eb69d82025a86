// SPDX-License-Identifier: Apache-2.0
// The pages of one browser share six connections to a service. Each holds one for events and one for
// its picture, and one must stay free: for Stop, and for the next page.

/** Pages that may hold a connection for pictures, of so many that are open. */
export const streamsFor = (pages) => (pages <= 2 ? pages : Math.max(5 - pages, 0));

/** So long the others are given to say that they are there. */
const kListenMs = 300;

/** Calls onChange(whether this page may stream) whenever that changes; at first it may not. */
export function joinCrowd(onChange) {
  const channel = new BroadcastChannel("fathom-pages");
  const own = { name: crypto.getRandomValues(new Uint32Array(2)).join("-"), since: Date.now() };
  const others = new Map();
  let may = false, isHeard = false;
  const decide = () => {
    const isBefore = ([name, since]) => since < own.since || (since === own.since && name < own.name);
    const next = [...others].filter(isBefore).length < streamsFor(others.size + 1);
    if (isHeard && next !== may) onChange(may = next);
  };
  channel.onmessage = ({ data: { says, name, since } }) => {
    if (says === "bye") others.delete(name);
    else others.set(name, since);
    if (says === "hello") channel.postMessage({ says: "here", ...own });
    decide();
  };
  channel.postMessage({ says: "hello", ...own });
  addEventListener("pagehide", () => channel.postMessage({ says: "bye", ...own }));
  setTimeout(() => {
    isHeard = true;
    decide();
  }, kListenMs);
}
