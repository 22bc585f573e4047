// SPDX-License-Identifier: Apache-2.0
// Numbers for the figures of draw.js: ticks of a scale, quantiles of the normal distribution.
"use strict";
/// Ticks of an axis of days since 1970-01-01: beginnings of years or months, or days.
function nonioDays(low, high) {
  const span = high - low, day = 864e5, months = span > 1095 ? 12 : span > 500 ? 6 : span > 200 ? 3 : 1, list = [];
  if (span < 60) return nonioTicks((v) => new Date(v * day).toISOString().slice(0, 10), low, high, 4, "whole");
  const month = new Intl.DateTimeFormat(document.documentElement.lang, {month: "short", year: "numeric", timeZone: "UTC"});
  for (let at = new Date(low * day), n = Math.floor(at.getUTCMonth() / months) * months; ; n += months) {
    const date = new Date(Date.UTC(at.getUTCFullYear(), n)), v = date / day;
    if (v > high) return list;
    if (v >= low) list.push({at: v, label: months === 12 ? String(date.getUTCFullYear()) : month.format(date)});
  }
}
/// About `count` ticks at round numbers from low to high, each with number(value, digits) as the label. kind: "turn" for
/// degrees of a turn, "whole" for integers, "days" for days since 1970-01-01.
function nonioTicks(number, low, high, count, kind) {
  if (kind === "days") return nonioDays(low, high);
  let raw = (high - low) / count, step = 0;
  if (kind === "turn" && raw > 10)
    step = [15, 30, 45, 60, 90, 180, 360].find((s) => raw <= s) || 0;
  if (kind === "whole") raw = Math.max(raw, 1);
  if (!step) {
    const power = Math.pow(10, Math.floor(Math.log10(raw)));
    const whole = kind === "whole" && power <= 1;
    step = (whole ? [1, 2, 5, 10] : [1, 2, 2.5, 5, 10]).find((s) => raw <= s * power * (1 + 1e-9)) * power;
  }
  let digits = 0;
  for (let s = step; digits < 9 && Math.abs(s - Math.round(s)) > 1e-6 * s; s *= 10) digits++;
  const list = [];
  for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++)
    list.push({at: k * step, label: number(k * step, digits)});
  return list;
}

/// z with Phi(z) = p, by Newton's method from 0; Phi by its series and, far out, its continued
/// fraction (Abramowitz and Stegun, Handbook of Mathematical Functions, 26.2.11 and 26.2.14).
function nonioQuantile(p) {
  if (p > 0.5) return -nonioQuantile(1 - p);
  const density = (z) => Math.exp((-z * z) / 2) / Math.sqrt(2 * Math.PI);
  const below = (z) => {
    const x = -z;
    if (x < 2.5) {
      let term = x, sum = x;
      for (let k = 1; k < 60; k++) sum += term *= (x * x) / (2 * k + 1);
      return 0.5 - density(x) * sum;
    }
    let f = 0;
    for (let k = 60; k > 0; k--) f = k / (x + f);
    return density(x) / (x + f);
  };
  let z = 0;
  for (let i = 0; i < 60; i++) {
    const step = (below(z) - p) / density(z);
    z -= step;
    if (Math.abs(step) < 1e-9) break;
  }
  return z;
}
