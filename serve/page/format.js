// SPDX-License-Identifier: Apache-2.0
// Numbers as people write them: with a proper minus, and no more digits than are known.

const signed = (text) => text.replace("-", "\u2212");

/** With so many decimals; "\u2013" where there is no number. */
export function fixed(value, decimals) {
  return Number.isFinite(value) ? signed(value.toFixed(decimals)) : "\u2013";
}

/** As short as it can be said with so many significant digits. */
export function short(value, digits = 6) {
  return Number.isFinite(value) ? signed(String(Number(value.toPrecision(digits)))) : "\u2013";
}

/** Decimals that show a value of this size with so many significant digits. */
export function decimalsFor(size, digits) {
  if (!(size > 0)) return digits - 1;
  return Math.min(Math.max(digits - 1 - Math.floor(Math.log10(size)), 0), 12);
}

/** "781.19 +- 0.07 steps": sigma with two digits, the value no finer than that. */
export function withSigma(value, sigma, unit) {
  const tail = unit ? "\u00a0" + unit : "";
  if (!(sigma > 0)) return short(value) + tail;
  const decimals = decimalsFor(sigma, 2);
  return `${fixed(value, decimals)}\u00a0\u00b1\u00a0${fixed(sigma, decimals)}${tail}`;
}

const kRaised = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";

/** Thousands to multiply small values of this size by, and how that is said: {factor, words}. */
export function thousandsFor(size) {
  if (!(size > 0) || size >= 1e-4) return { factor: 1, words: "" };
  const power = 3 * Math.ceil(-Math.log10(size) / 3);
  const raised = [...String(power)].map((digit) => kRaised[Number(digit)]).join("");
  return { factor: 10 ** power, words: `\u00d7 10\u207b${raised}` };
}

export const percent = (part, decimals = 2) => fixed(100 * part, decimals) + "\u00a0%";

/** What a person typed as a number, commas for points too; null if it is none. */
export function typed(text) {
  const value = Number(text.trim().replace("\u2212", "-").replace(",", "."));
  return text.trim() !== "" && Number.isFinite(value) ? value : null;
}

/** "12:03:05" of today, else with the day. */
export function when(text) {
  const time = new Date(text);
  if (Number.isNaN(time.getTime())) return text;
  const two = (n) => String(n).padStart(2, "0");
  const day = `${time.getFullYear()}-${two(time.getMonth() + 1)}-${two(time.getDate())}`;
  return `${day} ${two(time.getHours())}:${two(time.getMinutes())}:${two(time.getSeconds())}`;
}
