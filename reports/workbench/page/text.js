// ---- texts, numbers, elements. Texts are text nodes only; nothing is parsed as markup. ----
const words = JSON.parse(document.getElementById("words").textContent);
const language = document.documentElement.lang;

/// A text of templates/words/<language>/workbench.toml with its {places} filled in.
function say(key, places = {}) {
  const template = words[key] === undefined ? key : words[key];
  return template.replace(/\{(\w+)\}/g, (all, name) => (name in places ? String(places[name]) : all));
}
const finite = (v) => typeof v === "number" && isFinite(v);
const comma = language === "de" || language === "it";
const local = (text) => (comma ? text.replace(".", ",") : text).replace("-", "\u2212");
/// Three significant digits, as on a terminal.
function short(v) {
  if (!finite(v)) return "\u2013";
  if (v === 0) return "0";
  const digits = Math.max(0, 2 - Math.floor(Math.log10(Math.abs(Number(v.toPrecision(3))))));
  return local(digits > 9 ? v.toExponential(1) : v.toFixed(Math.min(digits, 9)));
}
/// A value and its expanded uncertainty, both rounded to the second digit of U.
function withExpanded(value, U) {
  if (!finite(U) || U <= 0) return [short(value), ""];
  const digits = Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(U))));
  return [local(value.toFixed(digits)), local(U.toFixed(digits))];
}
/// A value and U = 2 u of its standard uncertainty.
const withU = (value, u) => withExpanded(value, 2 * u);
/// A field of an answer by its name without the unit: `rms_um`, or `rms_arcsec` for an angle.
const field = (object, name) => {
  if (!object) return undefined;
  for (const unit of ["_um", "_arcsec"]) if (finite(object[name + unit])) return object[name + unit];
  return undefined;
};
const shownUnit = (unit) => unit.replace(/^um/, "\u00B5m").replace(/\bum\b/g, "\u00B5m").replace(/^urad/, "\u00B5rad").replace(/^degC$/, "\u00B0C");
/// A sentence of the engine with typographic units, signs and quotes.
const typeset = (sentence) => sentence.replace(/ u(m|rad)\b/g, " \u00B5$1").replace(/ degC\b/g, " \u00B0C").replace(/(^|[\s(])-(?=\d)/g, "$1\u2212").replace(/`([^`]*)`/g, "\u201C$1\u201D");
/// The number in a typed text, with a decimal point or comma.
const typed = (text) => (text.trim() === "" ? NaN : Number(text.trim().replace(",", ".").replace("\u2212", "-")));

/// An element with attributes, functions `on...` for events, and children. Strings become text nodes.
function el(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else node.setAttribute(key, value === true ? "" : String(value));
  }
  for (const child of children.flat()) if (child !== null && child !== undefined && child !== false) node.append(child);
  return node;
}
function svg(name, attributes = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, String(value));
  node.append(...children);
  return node;
}
const by = (id) => document.getElementById(id);
/// Replaces the content only if it differs and no button is pressed, so that nothing moves between press and release. A
/// field that has the focus is not replaced.
const filled = new WeakMap(), lost = new WeakMap(), waiting = new Map();
let pressed = false;
document.addEventListener("pointerdown", () => (pressed = true), {capture: true});
for (const end of ["pointerup", "pointercancel"])
  document.addEventListener(end, () => setTimeout(() => {
    pressed = false;
    for (const [node, children] of waiting) fill(node, ...children);
    waiting.clear();
  }), {capture: true});
let fresh = false; // after a refusal everything is redrawn, because a box may show a change that was refused
function fill(node, ...children) {
  if (pressed) return void waiting.set(node, children);
  const wanted = el("div", {}, ...children), text = wanted.innerHTML;
  if (!fresh && filled.get(node) === text) return;
  children = [...wanted.childNodes];
  const focus = document.activeElement, inside = focus && node.contains(focus);
  // The element that had the focus may be missing until an answer arrives: its key is kept.
  const waits = lost.get(node), key = inside ? focus.dataset.key : waits && (!focus || focus === document.body) ? waits : null;
  if (inside && focus.tagName === "INPUT" && focus.type !== "checkbox" && focus.type !== "radio") return;
  filled.set(node, text);
  node.replaceChildren(...children);
  if (key) {
    const again = [...node.querySelectorAll("[data-key]")].find((e) => e.dataset.key === key);
    if (again) again.focus({preventScroll: true});
    lost.set(node, again && document.activeElement === again ? null : key);
  }
}
const effectKind = (effect) => effect.split(":")[0];
