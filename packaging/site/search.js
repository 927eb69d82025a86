// SPDX-License-Identifier: Apache-2.0
// Looks for words in searchIndex, which search-index.js brings: [address, page, heading, text] a section.
"use strict";

const kMost = 40;
const kRound = 90;  // letters shown to either side of the first word

/** How well a section answers: 0 where a word is missing; headings count more than text. */
function rank([, page, heading, text], words) {
  let sum = 0;
  const head = heading.toLowerCase(), whole = `${page} ${text}`.toLowerCase();
  for (const word of words) {
    const at = head.indexOf(word);
    if (at < 0 && !whole.includes(word)) return 0;
    sum += (at < 0 ? 0 : at === 0 ? 12 : 8) + Math.min(whole.split(word).length - 1, 6);
  }
  return sum;
}

function find(query) {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  if (!words.length) return { words, hits: [] };
  const hits = searchIndex.map((entry) => ({ entry, rank: rank(entry, words) })).filter((hit) => hit.rank > 0);
  return { words, hits: hits.sort((a, b) => b.rank - a.rank).map((hit) => hit.entry) };
}

/** Text with its words marked, as nodes: nothing that was typed is ever read as HTML. */
function marked(text, words) {
  const pattern = new RegExp(`(${words.map((word) => word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|")})`, "i");
  return text.split(pattern).map((part, i) => {
    if (i % 2 === 0) return part;
    const mark = document.createElement("mark");
    mark.textContent = part;
    return mark;
  });
}

function excerpt(text, words) {
  const at = Math.max(0, ...words.map((word) => text.toLowerCase().indexOf(word)));
  const from = Math.max(0, at - kRound), to = Math.min(text.length, at + kRound);
  return (from ? "... " : "") + text.slice(from, to) + (to < text.length ? " ..." : "");
}

function show(query, into) {
  const { words, hits } = find(query);
  const said = document.createElement("p");
  said.textContent = !words.length ? "Type words to look for." : `${hits.length} places have all of: ${words.join(" ")}`;
  into.replaceChildren(said, ...hits.slice(0, kMost).map(([address, page, heading, text]) => {
    const article = document.createElement("article"), title = document.createElement("h2");
    const link = document.createElement("a"), part = document.createElement("p");
    link.href = address;
    link.append(...marked(heading === page ? page : `${page}: ${heading}`, words));
    title.append(link);
    part.append(...marked(excerpt(text, words), words));
    article.append(title, part);
    return article;
  }));
}

const field = document.querySelector("input[type=search]");
const found = document.querySelector("#found");
if (found) {
  field.value = new URLSearchParams(location.search).get("q") ?? "";
  show(field.value, found);
  field.addEventListener("input", () => show(field.value, found));
  field.focus();
}
document.addEventListener("keydown", (event) => {
  if (event.key === "/" && document.activeElement !== field) {
    event.preventDefault();
    field.focus();
  }
});

// One list of pages for all sizes: folded on a telephone, open beside the text elsewhere.
const wide = matchMedia("(min-width: 60.01rem)");
const pages = document.querySelector("nav details");
const unfold = () => { pages.open = wide.matches; };
wide.addEventListener("change", unfold);
unfold();
