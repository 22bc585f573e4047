// SPDX-License-Identifier: Apache-2.0
// The chart of every page: axes, lines, readings; tooltips by pointer or key, range selection,
// zoom, and export (save.js).
"use strict";
/// Smallest and largest finite number of a list.
function nonioExtremes(list) {
  let low = Infinity, high = -Infinity;
  for (const v of list)
    if (Number.isFinite(v)) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
  return [low, high];
}
/// tip: element of the tooltip; words(): texts of the page such as "chart.in"; number(v, digits):
/// formats a number; zoomed(k, range): redraws chart k for a part of its axis (null: all).
/// Optional: about(row): tooltip of a reading; pick(row), brushed(rows): a reading or range was
/// selected; said(lines): a key moved to a reading. Without brushed(), selecting a range zooms in.
function nonioCharts({tip, words, number, zoomed, about, pick, brushed, said}) {
  const finite = Number.isFinite, r1 = (v) => Math.round(v * 10) / 10, zooms = new Map();
  let frames = [], marked = -1, spot = null, by_key = false, chosen = new Set(), clips = 0;

  function put(parent, name, attributes, content) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) node.setAttribute(key, attributes[key]);
    if (content !== undefined) node.textContent = content;
    parent.appendChild(node);
    return node;
  }

  class Frame {
    /// k: name of the chart; xs: values on its axis; said: {x, y, degrees}, axis titles; range:
    /// [low, high] of y; from, to, all: heights if several frames share a figure; bare: no x title;
    /// floor: half width of the band about 0; lanes: names of lanes side by side; where(x): [lane,
    /// x] of a position.
    constructor(svg, k, xs, {width, range, said, kind = said.degrees ? "turn" : "", from = 0, to = 230, all = to, bare = false, floor, lanes, where, empty = "", own = {}}) {
      if (from === 0) {
        svg.replaceChildren();
        frames = frames.filter((f) => f.svg !== svg);
      }
      svg.setAttribute("viewBox", `0 0 ${width} ${all}`);
      Object.assign(this, {svg, k, x: 46, y: from + 6, w: width - 52, h: to - from - (bare ? 24 : 44), bare, said, lanes, where, points: [], series: [], zoomable: true, ...own});
      this.g = put(svg, "g", {});
      let [low, high] = nonioExtremes(xs);
      this.empty = !(low <= high);
      if (this.empty) [low, high] = [0, 1];
      // Values that differ only by rounding are treated as equal, because no tick step would be
      // small enough.
      if (high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high))) high = low;
      const side = 0.025 * (high - low) || 0.5;
      this.whole = this.whole || (lanes ? [0, lanes.length] : [low - side, high + side]);
      const part = zooms.get(k);
      [this.left, this.right] = part && part[0] < this.whole[1] && part[1] > this.whole[0] ? part : this.whole;
      [this.low, this.high] = range;
      this.axes(kind, floor, empty);
      const {x, y, w, h} = this, inside = "chart-" + ++clips;
      put(put(this.g, "clipPath", {id: inside}), "rect", {x: x - 6, y: y - 6, width: w + 12, height: h + 12});
      this.drawn = put(this.g, "g", {"clip-path": `url(#${inside})`});
      add(this);
    }
    px(v) { return this.x + (this.w * (v - this.left)) / (this.right - this.left); }
    py(v) { return this.y + this.h * (1 - (v - this.low) / (this.high - this.low)); }
    axes(kind, floor, empty) {
      const {g: svg, x, y, w, h, said} = this, middle = x + w / 2;
      if (floor) put(svg, "rect", {class: "band", x, y: r1(this.py(floor)), width: w, height: r1(this.py(-floor) - this.py(floor))});
      for (const t of nonioTicks(number, this.low, this.high, 6, "")) {
        put(svg, "line", {class: t.at === 0 ? "zero" : "rule", x1: x, x2: x + w, y1: r1(this.py(t.at)), y2: r1(this.py(t.at))});
        put(svg, "text", {x: x - 4, y: r1(this.py(t.at) + 3.5), "text-anchor": "end"}, t.label);
      }
      let free = -Infinity;
      const across = this.lanes
        ? this.lanes.map((name, m) => ({at: m + 0.5, rule: m + 1, label: name}))
        : nonioTicks(number, this.left, this.right, Math.max(2, Math.min(7, Math.round(w / 50))), kind);
      for (const t of across) {
        const at = this.px(t.at), rule = this.px(t.rule === undefined ? t.at : t.rule), half = 3.2 * t.label.length;
        if (rule >= x && rule <= x + w + 0.1) put(svg, "line", {class: "rule", x1: r1(rule), x2: r1(rule), y1: y, y2: y + h});
        if (at - half < free || at < x || at + half > x + w + 8) continue;
        free = at + half + 4;
        put(svg, "text", {x: r1(at), y: y + h + 13, "text-anchor": "middle"}, t.label);
      }
      put(svg, "rect", {class: "frame", x, y, width: w, height: h});
      if (!this.bare) put(svg, "text", {x: middle, y: y + h + 31, "text-anchor": "middle"}, said.x);
      put(svg, "text", {transform: `translate(11 ${y + h / 2}) rotate(-90)`, "text-anchor": "middle"}, said.y);
      if (this.empty) put(svg, "text", {x: middle, y: y + h / 2 - 8, "text-anchor": "middle"}, empty);
    }
    line(xs, ys, look) {
      if (xs.length > 1) this.lines([[xs, ys]], look);
    }
    lines(all, look) {
      const one = ([xs, ys]) => {
        let pen = "M";
        this.series.push([look, xs, ys]);
        return xs.map((v, i) => {
          if (!finite(v) || !finite(ys[i])) return (pen = "M"), "";
          const at = pen + r1(this.px(v)) + " " + r1(this.py(ys[i]));
          pen = "L";
          return at;
        }).join("");
      };
      if (all.length) put(this.drawn, "path", {class: "line " + look, d: all.map(one).join("")});
    }
    /// The area between two lines.
    area(xs, low, high) {
      const at = (ys) => xs.map((v, j) => [v, ys[j]]).filter((p) => finite(p[0]) && finite(p[1])).map((p) => r1(this.px(p[0])) + " " + r1(this.py(p[1])));
      const there = at(high);
      if (there.length) put(this.drawn, "path", {class: "band", d: "M" + there.concat(at(low).reverse()).join("L") + "z"});
    }
    /// A point with its own tooltip that is not a reading.
    point(x, y, lines) {
      if (x >= this.left && x <= this.right) this.points.push([this.px(x), this.py(y), -1, lines]);
    }
    /// Readings by direction; suspects outside of the range are drawn at the edge. When printing
    /// they are SVG, sharp at any size. On screen very many are painted on a canvas, which is ten
    /// times faster.
    scatter(rows, xs, ys, {direction = [], wrong = new Map(), painted = false, about: own}) {
      const path = {plus: "", minus: "", other: ""}, many = rows.length > 1200, dots = {plus: [], minus: [], other: []};
      const inset = 0.03 * (this.high - this.low), rings = [];
      this.series.push(["readings", xs, ys]);
      rows.forEach((i, j) => {
        if (!finite(xs[j]) || !finite(ys[j]) || xs[j] < this.left || xs[j] > this.right) return;
        const v = wrong.has(i) ? Math.min(Math.max(ys[j], this.low + inset), this.high - inset) : ys[j];
        const x = this.px(xs[j]), y = this.py(v), d = direction[i], look = d > 0 ? "plus" : d < 0 ? "minus" : "other";
        this.points.push(own ? [x, y, -1, own(j)] : [x, y, i]);
        if (wrong.has(i)) rings.push([x, y]);
        if (many && painted) return void dots[look].push(x, y);
        const at = "M" + r1(x) + " " + r1(y);
        path[look] += many || look === "other" ? at + "h0" : d > 0 ? at + "m-3 2.2h6l-3-5.2z" : at + "m-3-2.2h6l-3 5.2z";
      });
      if (many && painted) this.paint(dots);
      for (const look in path)
        if (path[look]) put(this.drawn, "path", {class: (many || look === "other" ? "dots " : "marks ") + look, d: path[look]});
      for (const [cx, cy] of rings) put(this.drawn, "circle", {class: "suspect", cx: r1(cx), cy: r1(cy), r: 6});
    }
    paint(dots) {
      const {x, y, w, h} = this, sharp = Math.min(3, window.devicePixelRatio || 1);
      const canvas = () => Object.assign(document.createElement("canvas"), {width: Math.ceil(w * sharp), height: Math.ceil(h * sharp)});
      const shown = canvas(), one = canvas(), to = shown.getContext("2d"), pen = one.getContext("2d");
      const style = getComputedStyle(document.documentElement), size = 2 * sharp;
      to.globalAlpha = 0.6;
      for (const [look, name] of [["plus", "--plus"], ["minus", "--minus"], ["other", "--accent"]]) {
        const at = dots[look];
        if (at.length === 0) continue;
        pen.clearRect(0, 0, one.width, one.height);
        pen.fillStyle = style.getPropertyValue(name).trim();
        for (let k = 0; k < at.length; k += 2) pen.fillRect((at[k] - x) * sharp - size / 2, (at[k + 1] - y) * sharp - size / 2, size, size);
        to.drawImage(one, 0, 0);
      }
      Object.assign(shown.style, {width: w + "px", height: h + "px", display: "block"});
      put(this.drawn, "foreignObject", {class: "dots", x, y, width: w, height: h, "pointer-events": "none"}).append(shown);
    }
  }
  /// Registers a frame, and adds the tools below its figure.
  function add(frame) {
    frames = frames.filter((f) => f !== frame && (f.svg !== frame.svg || frame.zoomable)).concat(frame);
    const {svg} = frame, word = words(), old = svg.parentNode.querySelector(":scope > .chart-tools");
    svg.setAttribute("tabindex", 0);
    if (svg.getAttribute("role") === "img") svg.setAttribute("role", "application");
    if (old) return;
    const box = Object.assign(document.createElement("details"), {className: "chart-tools"}), summary = document.createElement("summary"), group = document.createElement("div");
    Object.assign(summary, {textContent: "\u22EF", title: word["chart.tools"]});
    summary.setAttribute("aria-label", word["chart.tools"]);
    for (const [label, name, key] of frame.zoomable ? [["+", "in", "+"], ["\u2212", "out", "-"], ["\u2190", "left"], ["\u2192", "right"], ["\u2194", "all", "0"]] : []) {
      const button = Object.assign(document.createElement("button"), {type: "button", className: "small", textContent: label, title: word["chart." + name]});
      button.setAttribute("aria-label", word["chart." + name]);
      if (key) button.setAttribute("aria-keyshortcuts", key);
      button.addEventListener("click", () => move_axis(svg, name));
      group.append(button);
    }
    group.append(...nonioSave.buttons(svg, frame.table || (() => numbers(svg))));
    box.append(summary, group);
    svg.after(box);
  }
  /// The data of a figure as a table.
  function numbers(svg) {
    const rows = [];
    for (const f of frames.filter((one) => one.svg === svg))
      for (const [name, xs, ys] of f.series)
        xs.forEach((x, j) => finite(x) && finite(ys[j]) && rows.push([f.said.y, name, ...(f.where ? f.where(x) : ["", x]), ys[j]]));
    return [["axis", "series", "line", frames.find((f) => f.svg === svg).said.x, "value"], ...rows];
  }

  // ---- zoom of the horizontal axis ----
  function zoom({k, whole}, from, to) {
    const all = !(to > from) || (from <= whole[0] && to >= whole[1]);
    const range = all ? null : [Math.max(from, whole[0]), Math.min(to, whole[1])];
    if (range) zooms.set(k, range);
    else zooms.delete(k);
    hide();
    zoomed(k, range);
  }
  function move_axis(svg, name) {
    const frame = frames.find((f) => f.svg === svg && f.zoomable);
    if (!frame) return;
    const {left, right, whole} = frame, part = (right - left) / 4;
    const by = {left: Math.max(-part, whole[0] - left), right: Math.min(part, whole[1] - right)}[name] || 0;
    if (name === "all") zoom(frame, NaN, NaN);
    else if (name === "in") zoom(frame, left + part, right - part);
    else if (name === "out") zoom(frame, left - 2 * part, right + 2 * part);
    else if (by) zoom(frame, left + by, right + by);
  }

  // ---- marking of one reading in all charts ----
  function mark(i) {
    marked = i;
    for (const frame of frames) {
      const old = frame.g.querySelector(".chosen");
      if (old) old.remove();
      const point = i >= 0 && frame.points.find((p) => p[2] === i);
      if (point) put(frame.g, "circle", {class: "chosen", cx: r1(point[0]), cy: r1(point[1]), r: 5});
    }
  }
  /// Selects the same readings in all charts; the others are dimmed.
  function select(rows) {
    chosen = new Set(rows);
    for (const frame of frames) {
      const old = frame.g.querySelector(".picked");
      if (old) old.remove();
      frame.g.classList.toggle("choosing", chosen.size > 0);
      if (chosen.size === 0) continue;
      const d = frame.points.filter((p) => chosen.has(p[2])).map((p) => `M${r1(p[0])} ${r1(p[1])}h0`).join("");
      put(frame.g, "path", {class: "picked", d});
    }
  }
  const lines_of = (point) => (point[2] >= 0 ? about(point[2]) : point[3]);
  function show(point, x, y) {
    spot = point;
    if (point[2] !== marked || point[2] < 0) mark(point[2]);
    tip.replaceChildren(...lines_of(point).map((line) => Object.assign(document.createElement("p"), {textContent: line})));
    tip.hidden = false;
    const room = document.documentElement.clientWidth - tip.offsetWidth - 6;
    tip.style.left = Math.max(4, Math.min(x + 14, room)) + "px";
    tip.style.top = (y + tip.offsetHeight + 24 > window.innerHeight ? y - tip.offsetHeight - 12 : y + 14) + "px";
  }
  function hide() {
    if (!spot) return;
    spot = null;
    tip.hidden = true;
    if (marked >= 0) mark(-1);
  }
  const svg_of = (event) => event.target.closest && event.target.closest("svg");
  function under(event, reach) {
    const svg = svg_of(event), own = svg ? frames.filter((f) => f.svg === svg) : [];
    if (own.length === 0) return [null, null];
    const [x, y] = inside(own[0], event);
    const frame = own.find((f) => y < f.y + f.h + 20) || own[own.length - 1];
    let best = null, least = reach * reach;
    for (const p of frame.points) {
      const d = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
      if (d < least) [best, least] = [p, d];
    }
    return [frame, best];
  }
  function inside(frame, event) {
    const at = frame.svg.getScreenCTM();
    return [(event.clientX - at.e) / at.a, (event.clientY - at.f) / at.d];
  }
  function hover(event) {
    by_key = false;
    const [, best] = under(event, 18);
    if (best) show(best, event.clientX, event.clientY);
    else hide();
  }

  // ---- range selection with the pointer; it zooms with Shift or if nothing can be selected ----
  let drag = null;
  function down(event) {
    hover(event);
    const [frame] = under(event, 18);
    if (!frame || event.button !== 0 || event.pointerType === "touch") return;
    const enlarges = frame.zoomable && (event.shiftKey || !brushed || frame.only_axis);
    if (enlarges || brushed) drag = {frame, enlarges, from: inside(frame, event), to: null, box: null};
  }
  function move(event) {
    if (!drag) return hover(event);
    hide();
    event.preventDefault();
    const {frame, from, enlarges} = drag, clip = (v, low, size) => Math.min(Math.max(v, low), low + size);
    const at = inside(frame, event);
    if (!drag.box && Math.hypot(at[0] - from[0], at[1] - from[1]) < 5) return;
    drag.to = [clip(at[0], frame.x, frame.w), clip(at[1], frame.y, frame.h)];
    drag.box = drag.box || put(frame.svg, "rect", {class: "brush"});
    const corner = (k) => Math.min(from[k], drag.to[k]), size = (k) => Math.abs(from[k] - drag.to[k]);
    for (const [name, v] of [["x", corner(0)], ["y", enlarges ? frame.y : corner(1)], ["width", size(0)], ["height", enlarges ? frame.h : size(1)]])
      drag.box.setAttribute(name, r1(v));
  }
  function up(event) {
    const was = drag;
    drag = null;
    if (was && was.box) {
      was.box.remove();
      const {frame, from, to} = was, ends = (k) => [Math.min(from[k], to[k]), Math.max(from[k], to[k])], [low, high] = ends(0), [top, bottom] = ends(1);
      const value = (x) => frame.left + ((x - frame.x) / frame.w) * (frame.right - frame.left);
      if (was.enlarges) return high - low > 4 ? zoom(frame, value(low), value(high)) : undefined;
      const rows = frame.points.filter((p) => p[2] >= 0 && p[0] >= low && p[0] <= high && p[1] >= top && p[1] <= bottom).map((p) => p[2]);
      select(rows);
      brushed(rows);
    } else if (pick) {
      const [, best] = under(event, 12);
      if (best && best[2] >= 0) pick(best[2]);
    }
  }

  // ---- keyboard: a cursor moves between the values of the focused chart ----
  function key(event) {
    const svg = svg_of(event), frame = svg && frames.find((f) => f.svg === svg);
    if (!frame || event.ctrlKey || event.altKey || event.metaKey) return;
    const axis = {"+": "in", "-": "out", 0: "all"}[event.key] || (event.shiftKey && {ArrowLeft: "left", ArrowRight: "right"}[event.key]);
    const order = [...frame.points].sort((a, b) => a[0] - b[0] || a[1] - b[1]), last = order.length - 1;
    const at = marked >= 0 ? order.findIndex((p) => p[2] === marked) : order.indexOf(spot);
    const to = {ArrowRight: at + 1, ArrowLeft: at < 0 ? last : at - 1, Home: 0, End: last, PageDown: at + 10, PageUp: at - 10}[event.key];
    if (axis) move_axis(svg, axis);
    else if (to !== undefined && last >= 0) {
      const point = order[Math.min(Math.max(to, 0), last)];
      const screen = svg.getScreenCTM();
      by_key = true;
      show(point, screen.e + point[0] * screen.a, screen.f + point[1] * screen.d);
      if (said) said(lines_of(point));
    } else if (event.key === "Enter" && marked >= 0 && pick) pick(marked);
    else if (event.key === "Escape" && tip.hidden && brushed) {
      select([]);
      brushed([]);
    } else if (event.key === "Escape") hide();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
  document.addEventListener("pointermove", move);
  document.addEventListener("pointerdown", down);
  document.addEventListener("pointerup", up);
  document.addEventListener("pointercancel", () => {
    if (drag && drag.box) drag.box.remove();
    drag = null;
  });
  // A reading marked by a key stays marked while scrolling.
  document.addEventListener("scroll", () => (by_key ? (tip.hidden = true) : hide()), {passive: true, capture: true});
  document.addEventListener("keydown", key);
  if (!said) tip.setAttribute("aria-live", "polite");

  return {Frame, put, add, mark, select, hide, r1,
    /// Keeps only the frames that satisfy `holds`.
    keep(holds) { frames = frames.filter(holds); },
    /// Redraws marks after charts were redrawn.
    again() {
      mark(marked);
      select(chosen);
    },
    /// Resets marks and zoom for other data.
    forget() {
      hide();
      [marked, chosen] = [-1, new Set()];
      zooms.clear();
    },
    get chosen() { return chosen; },
  };
}
