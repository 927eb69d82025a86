// SPDX-License-Identifier: Apache-2.0
// What goes over the wire: commands, questions, and the events of the service.

const kBase = "/api/v1/";
const kRetryMs = 1500;
/** A page that nobody sees leaves its connection to others after this time. */
const kUnseenMs = 20000;
const kEvents = ["state", "frame", "score", "spectrum", "began", "evaluated", "warning", "found",
  "ended", "map", "drive"];

/** The name of this page, which outlives a reload, so that it goes on driving. */
export const client = ownName();

function ownName() {
  const kept = sessionStorage.getItem("fathom-client");
  if (kept) return kept;
  const name = Array.from(crypto.getRandomValues(new Uint32Array(3)), (n) => n.toString(36)).join("-");
  sessionStorage.setItem("fathom-client", name);
  return name;
}

/** What the service refused, in its own words; `code` is for programs. */
export class Refusal extends Error {
  constructor(code, message) {
    super(message);
    this.code = code;
  }
}

const withClient = (path) => `${kBase}${path}${path.includes("?") ? "&" : "?"}client=${client}`;

async function answer(request) {
  let response;
  try {
    response = await request;
  } catch {
    throw new Refusal("unreachable", "The service does not answer. Is fathom serve still running?");
  }
  if (response.status === 401 || response.status === 403) throw await refusalOf(response, kToken);
  if (!response.ok) throw await refusalOf(response, `The service said ${response.status}.`);
  return response.status === 204 ? null : response.json();
}

const kToken = "The token does not hold any more. Open the address that fathom serve printed.";

async function refusalOf(response, otherwise) {
  const body = await response.json().catch(() => null);
  return new Refusal(body?.error?.code ?? `http_${response.status}`, body?.error?.message ?? otherwise);
}

/** Sends a command; throws Refusal. */
export function send(path, body = {}) {
  return answer(fetch(withClient(path), {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  }));
}

/** Asks for something; throws Refusal. */
export const get = (path) => answer(fetch(withClient(path)));

/** Where a file lies, for <img> and <a>. */
export const address = (path) => withClient(path);

/**
 * Hears every event: onEvent(name, data). onLink(true or false, words, why it was refused) tells of
 * the connection.
 * A browser comes back by itself after a break, but not after a refusal: then it is tried again.
 */
export function listen(onEvent, onLink) {
  const source = new EventSource(withClient("events"));
  for (const name of kEvents) {
    source.addEventListener(name, (event) => onEvent(name, JSON.parse(event.data)));
  }
  source.onopen = () => onLink(true, "connected");
  source.onerror = async () => {
    onLink(false, "no connection");
    if (source.readyState !== EventSource.CLOSED) return;
    const why = await get("state").then(() => null, (refusal) => refusal);
    if (why && why.code !== "unreachable") onLink(false, "refused", why.message);
    setTimeout(() => listen(onEvent, onLink), kRetryMs);
  };
  leaveWhenUnseen(source, () => {
    onLink(false, "paused");
    listen(onEvent, onLink);
  });
}

/** Closes what nobody looks at, and calls again() when somebody does. */
function leaveWhenUnseen(source, again) {
  let timer = 0, isLeft = false;
  const look = () => {
    clearTimeout(timer);
    if (isLeft && !document.hidden) again();
    if (source.readyState === EventSource.CLOSED && !document.hidden) {
      document.removeEventListener("visibilitychange", look);
    } else if (document.hidden) {
      timer = setTimeout(leave, kUnseenMs);
    }
  };
  const leave = () => {
    isLeft = source.readyState !== EventSource.CLOSED;
    source.close();
  };
  document.addEventListener("visibilitychange", look);
  addEventListener("pagehide", () => source.close(), { once: true });
}
