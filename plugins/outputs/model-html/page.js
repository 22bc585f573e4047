// SPDX-License-Identifier: Apache-2.0
// Draws the nine pictures from the page's data and keeps them right while effects, directions and
// runs are taken out and put back. What is out stands in the address after "#".
"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const words = data.words, n = data.residual.length;
  const wrong = new Map(data.suspects);
  const out = {e: new Set(), d: new Set(), r: new Set()};
  const runs = [...new Set(data.run)].sort((a, b) => a - b);
  let residual = data.residual, shown = [], range = [0, 1], pictures = [], marked = -1, printing = false;

  const text = (template, places) =>
    template.replace(/\{(\w+)\}/g, (all, name) => (name in places ? places[name] : all));
  const number = (v, digits) => {
    const s = v.toFixed(digits).replace("-", "\u2212");
    return data.language === "it" ? s.replace(".", ",") : s;
  };
  const finite = (v) => typeof v === "number" && isFinite(v);
  const counts = (i) => data.weight[i] >= 0.5;

  // ---- the residual without some effects: without one it comes from a fit of the others; without
  // several their parts come back, and each measurement keeps a zero of its own ----
  let refitted = null;
  function work() {
    const one = out.e.size === 1 ? data.effects[[...out.e][0]].without : null;
    refitted = one;
    residual = (one ? one.residual : data.residual).slice();
    if (!one) for (const e of out.e) data.effects[e].says.forEach((v, i) => (residual[i] += v));
    if (out.e.size > 0 && !one) {
      const sum = new Map(), weight = new Map();
      const add = (map, key, v) => map.set(key, (map.get(key) || 0) + v);
      for (let i = 0; i < n; i++) {
        add(sum, data.measurement[i], data.weight[i] * (residual[i] - data.residual[i]));
        add(weight, data.measurement[i], data.weight[i]);
      }
      for (let i = 0; i < n; i++) {
        const all = weight.get(data.measurement[i]);
        if (all > 0) residual[i] -= sum.get(data.measurement[i]) / all;
      }
    }
    shown = [];
    for (let i = 0; i < n; i++)
      if (!out.d.has(data.direction[i]) && !out.r.has(data.run[i])) shown.push(i);
  }

  function rms() {
    let squares = 0, weight = 0;
    for (const i of shown) {
      squares += data.weight[i] * residual[i] * residual[i];
      weight += data.weight[i];
    }
    return weight > 0 ? Math.sqrt(squares / weight) : NaN;
  }

  function common_range() {
    let low = 0, high = 0;
    for (const values of [residual, data.left_out])
      if (values)
        for (const i of shown)
          if (!wrong.has(i) && finite(values[i])) {
            low = Math.min(low, values[i]);
            high = Math.max(high, values[i]);
          }
    if (data.floor) {
      low = Math.min(low, -2.2 * data.floor);
      high = Math.max(high, 2.2 * data.floor);
    }
    const edge = 0.06 * (high - low) || 1;
    return [low - edge, high + edge];
  }

  // ---- scales ----
  function ticks(low, high, count, kind) {
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

  // ---- drawing ----
  const ns = "http://www.w3.org/2000/svg";
  function put(parent, name, attributes, content) {
    const node = document.createElementNS(ns, name);
    for (const key in attributes) node.setAttribute(key, attributes[key]);
    if (content !== undefined) node.textContent = content;
    parent.appendChild(node);
    return node;
  }
  const r1 = (v) => v.toFixed(1);

  class Frame {
    constructor(k, xs, options) {
      const figure = document.getElementById("picture-" + k);
      this.svg = figure.querySelector("svg");
      this.svg.replaceChildren();
      const width = printing ? 240 : Math.max(220, Math.round(figure.clientWidth) || 320), height = 230;
      this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      Object.assign(this, {k, x: 46, y: 6, w: width - 52, h: height - 44, points: []});
      const said = data.pictures[k];
      const ends = (list) => list.reduce(([a, b], v) => (finite(v) ? [Math.min(a, v), Math.max(b, v)] : [a, b]), [Infinity, -Infinity]);
      let [low, high] = ends(xs);
      this.empty = !(low <= high);
      if (this.empty) [low, high] = [0, 1];
      const side = 0.025 * (high - low) || 0.5;
      this.lanes = options.lanes ? data.lanes : null;
      this.left = this.lanes ? 0 : low - side;
      this.right = this.lanes ? this.lanes.length : high + side;
      [this.low, this.high] = options.range || range;
      this.axes(said, options.kind || (said.degrees ? "turn" : ""));
    }
    px(v) { return this.x + (this.w * (v - this.left)) / (this.right - this.left); }
    py(v) { return this.y + this.h * (1 - (v - this.low) / (this.high - this.low)); }
    axes(said, kind) {
      const {svg, x, y, w, h} = this;
      if (data.floor && !this.own_band())
        put(svg, "rect", {class: "band", x, y: r1(this.py(2 * data.floor)), width: w,
                          height: r1(this.py(-2 * data.floor) - this.py(2 * data.floor))});
      for (const t of ticks(this.low, this.high, 6, "")) {
        put(svg, "line", {class: t.at === 0 ? "zero" : "rule", x1: x, x2: x + w, y1: r1(this.py(t.at)), y2: r1(this.py(t.at))});
        put(svg, "text", {x: x - 4, y: r1(this.py(t.at) + 3.5), "text-anchor": "end"}, t.label);
      }
      let free = -Infinity;
      const across = this.lanes
        ? this.lanes.map((name, m) => ({at: m + 0.5, rule: m + 1, label: name}))
        : ticks(this.left, this.right, Math.max(2, Math.min(7, Math.round(w / 50))), kind);
      for (const t of across) {
        const at = this.px(t.at), rule = this.px(t.rule === undefined ? t.at : t.rule), half = 3.2 * t.label.length;
        put(svg, "line", {class: "rule", x1: r1(rule), x2: r1(rule), y1: y, y2: y + h});
        if (at - half < free || at + half > x + w + 8) continue;
        free = at + half + 4;
        put(svg, "text", {x: r1(at), y: y + h + 13, "text-anchor": "middle"}, t.label);
      }
      put(svg, "rect", {class: "frame", x, y, width: w, height: h});
      put(svg, "text", {x: x + w / 2, y: y + h + 31, "text-anchor": "middle"}, said.x);
      put(svg, "text", {transform: `translate(11 ${y + h / 2}) rotate(-90)`, "text-anchor": "middle"}, said.y);
      if (this.empty) put(svg, "text", {x: x + w / 2, y: y + h / 2 - 8, "text-anchor": "middle"}, this.k === 1 ? words.one_direction : words.no_readings);
    }
    own_band() { return this.k === 1; }
    line(xs, ys, look) {
      if (xs.length < 2) return;
      const d = xs.map((v, i) => (i ? "L" : "M") + r1(this.px(v)) + " " + r1(this.py(ys[i]))).join("");
      put(this.svg, "path", {class: "line " + look, d});
    }
    /// Readings by direction; suspects that lie outside stand at the edge.
    scatter(rows, xs, ys) {
      const path = {plus: "", minus: "", other: ""}, many = rows.length > 1200;
      const inset = 0.03 * (this.high - this.low), rings = [];
      rows.forEach((i, j) => {
        if (!finite(xs[j]) || !finite(ys[j])) return;
        const v = wrong.has(i) ? Math.min(Math.max(ys[j], this.low + inset), this.high - inset) : ys[j];
        const x = this.px(xs[j]), y = this.py(v), at = "M" + r1(x) + " " + r1(y);
        const d = data.direction[i];
        path[d > 0 ? "plus" : d < 0 ? "minus" : "other"] +=
          many || d === 0 ? at + "h0" : d > 0 ? at + "m-3 2.2h6l-3-5.2z" : at + "m-3-2.2h6l-3 5.2z";
        this.points.push([x, y, i]);
        if (wrong.has(i)) rings.push([x, y]);
      });
      for (const look in path)
        if (path[look]) put(this.svg, "path", {class: (many || look === "other" ? "dots " : "marks ") + look, d: path[look]});
      for (const [cx, cy] of rings) put(this.svg, "circle", {class: "suspect", cx: r1(cx), cy: r1(cy), r: 6});
    }
  }

  // ---- places: lines in space stand side by side, each in a lane of width 1 ----
  const ends_of_lane = (data.lanes || []).map((name, m) =>
    data.target.reduce(([a, b], v, i) => (data.measurement[i] === m ? [Math.min(a, v), Math.max(b, v)] : [a, b]), [Infinity, -Infinity]));
  function place_of(m, target) {
    if (!data.lanes) return target;
    const [low, high] = ends_of_lane[m], room = 0.08;
    return m + room + (1 - 2 * room) * (low < high ? (target - low) / (high - low) : 0.5);
  }
  const place = data.target.map((v, i) => place_of(data.measurement[i], v));
  const lines = Array.from({length: Math.max(1, data.measurements)}, (_, m) => m);
  const of_line = (rows, m) => rows.filter((i) => data.measurement[i] === m);

  const mean = (list) => list.reduce((a, b) => a + b, 0) / list.length;
  function grouped(rows, key, values) {
    const map = new Map();
    for (const i of rows)
      if (counts(i)) {
        if (!map.has(key[i])) map.set(key[i], []);
        map.get(key[i]).push(values[i]);
      }
    return [...map.entries()].sort((a, b) => a[0] - b[0]);
  }
  function mean_by_part(frame, rows, xs) {
    const used = rows.map((i, j) => [xs[j], residual[i], i]).filter((p) => finite(p[0]) && counts(p[2]));
    const low = Math.min(...extremes(used.map((p) => p[0]))), high = Math.max(...extremes(used.map((p) => p[0])));
    if (!(low < high) || used.length < 12) return;
    const parts = Math.min(12, Math.floor(used.length / 6));
    const groups = Array.from({length: parts}, () => []);
    for (const p of used) groups[Math.min(parts - 1, Math.floor(((p[0] - low) / (high - low)) * parts))].push(p);
    const good = groups.filter((g) => g.length >= 3);
    frame.line(good.map((g) => mean(g.map((p) => p[0]))), good.map((g) => mean(g.map((p) => p[1]))), "mean");
  }
  const extremes = (list) => list.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);

  function over(k, column, kind) {
    const xs = shown.map((i) => column[i]);
    const frame = new Frame(k, xs, {kind});
    frame.scatter(shown, xs, shown.map((i) => residual[i]));
    if (kind !== "whole") mean_by_part(frame, shown, xs);
    return frame;
  }

  function by_position() {
    const xs = shown.map((i) => place[i]);
    const frame = new Frame(0, xs, {lanes: true});
    frame.scatter(shown, xs, shown.map((i) => residual[i]));
    for (const m of lines)
      for (const d of [1, -1, 0]) {
        const groups = grouped(of_line(shown, m).filter((i) => data.direction[i] === d), data.target, residual);
        frame.line(groups.map((g) => place_of(m, g[0])), groups.map((g) => mean(g[1])), d > 0 ? "plus" : d < 0 ? "minus" : "other");
      }
    return frame;
  }

  function by_reversal() {
    const of_lines = lines.map((m) => reversal_of(m));
    const all = (key) => of_lines.flatMap((line) => line[key]);
    const [low, high] = extremes([0, ...all("ys"), ...all("half"), ...all("half").map((v) => -v)]);
    const edge = 0.06 * (high - low) || 1;
    const frame = new Frame(1, all("xs"), {range: [low - edge, high + edge], lanes: true});
    if (lines.length > 1 && data.floor) {
      // One belt for all lines: bands would darken each other.
      const widest = Math.max(0, ...all("half"));
      put(frame.svg, "rect", {class: "band", x: frame.x, y: r1(frame.py(widest)), width: frame.w,
                              height: r1(frame.py(-widest) - frame.py(widest))});
    }
    for (const line of of_lines) draw_reversal(frame, line);
    return frame;
  }

  /// mean(+) less mean(-) at each target of one measurement, and twice its standard deviation by the
  /// floor.
  function reversal_of(m) {
    const rows = of_line(shown, m);
    const minus = new Map(grouped(rows.filter((i) => data.direction[i] < 0), data.target, residual));
    const both = grouped(rows.filter((i) => data.direction[i] > 0), data.target, residual).filter((g) => minus.has(g[0]));
    return {
      targets: both.map((g) => g[0]),
      xs: both.map((g) => place_of(m, g[0])),
      ys: both.map((g) => mean(g[1]) - mean(minus.get(g[0]))),
      half: both.map((g) => 2 * (data.floor || 0) * Math.sqrt(1 / g[1].length + 1 / minus.get(g[0]).length)),
    };
  }

  function draw_reversal(frame, {targets, xs, ys, half}) {
    if (lines.length === 1 && data.floor && xs.length > 1) {
      const there = xs.map((v, j) => r1(frame.px(v)) + " " + r1(frame.py(half[j])));
      const back = xs.map((v, j) => r1(frame.px(v)) + " " + r1(frame.py(-half[j]))).reverse();
      put(frame.svg, "path", {class: "band", d: "M" + there.concat(back).join("L") + "z"});
    }
    frame.line(xs, ys, "other");
    xs.forEach((v, j) => {
      put(frame.svg, "circle", {class: "dot", cx: r1(frame.px(v)), cy: r1(frame.py(ys[j])), r: 2.5});
      frame.points.push([frame.px(v), frame.py(ys[j]), -1, [position(targets[j]), words.reversal + " " + number(ys[j], 2) + " " + data.unit]]);
    });
  }

  function by_run() {
    const frame = over(3, data.run, "whole");
    const groups = grouped(shown, data.run, residual);
    frame.line(groups.map((g) => g[0]), groups.map((g) => mean(g[1])), "mean");
    return frame;
  }

  /// z with Phi(z) = p, by Newton's method from 0; Phi by its series and, far out, its continued
  /// fraction (Abramowitz and Stegun, Handbook of Mathematical Functions, 26.2.11 and 26.2.14).
  function quantile(p) {
    if (p > 0.5) return -quantile(1 - p);
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
  function by_normal() {
    const order = shown.filter((i) => data.weight[i] > 0 || wrong.has(i)).sort((a, b) => residual[a] - residual[b]), m = order.length;
    const outer = 300, step = m > 1600 ? Math.floor((m - 2 * outer) / 1000) : 1;
    const kept = [], zs = [];
    order.forEach((i, j) => {
      if (j >= outer && j + outer < m && j % step !== 0) return;
      kept.push(i);
      zs.push(quantile((j + 0.5) / m));
    });
    const frame = new Frame(7, zs, {});
    frame.scatter(kept, zs, kept.map((i) => residual[i]));
    if (data.floor && zs.length > 1) {
      const ends = [zs[0], zs[zs.length - 1]];
      frame.line(ends, ends.map((z) => z * data.floor), "mean dashed");
    }
    return frame;
  }

  function phases() {
    return data.target.map((p) => {
      const v = p - data.period * Math.floor(p / data.period);
      return data.period - v < 1e-9 * data.period ? 0 : v;
    });
  }
  function left_out() {
    const xs = shown.map((i) => place[i]);
    const frame = new Frame(8, xs, {lanes: true});
    frame.scatter(shown, xs, shown.map((i) => data.left_out[i]));
    return frame;
  }

  function draw() {
    work();
    range = common_range();
    const says = data.deviation.map((v, i) => v - residual[i]);
    const drawers = [by_position, by_reversal, () => over(2, data.time), by_run, () => over(4, phases()),
                     () => over(5, data.temperature), () => over(6, says), by_normal, left_out];
    pictures = [];
    drawers.forEach((drawer, k) => {
      if (!data.pictures[k].none) pictures.push(drawer());
    });
    const whole = out.d.size === 0 && out.r.size === 0 && refitted;
    const now = whole ? refitted.rms : rms(), all = out.e.size === 0;
    const names = [...out.e].sort((a, b) => a - b).map((e) => data.effects[e].name).join(", ");
    document.getElementById("rms").textContent =
      (finite(now) ? text(words.rms_now, {rms: number(now, 2), unit: data.unit, count: shown.filter((i) => data.weight[i] > 0 || wrong.has(i)).length}) : words.no_readings) +
      (all ? "" : " " + text(refitted ? words.without : words.not_refitted, {effects: names})) +
      (whole && finite(refitted.cv_rms) ? " " + text(words.without_cv, {rms: number(refitted.cv_rms, 2), unit: data.unit}) : "");
    mark(marked);
  }

  // ---- one reading, in every picture ----
  const tip = document.getElementById("tip");
  const position = (v) => data.axis + " " + number(v, 4).replace(/[.,]?0+$/, "") + " " + data.position_unit;
  function about(i) {
    const signed = (v) => (v > 0 ? "+" : "") + number(v, 2) + " " + data.unit;
    const d = data.direction[i];
    const lines = [
      text(words.reading, {run: data.run[i], direction: d > 0 ? "+" : d < 0 ? "\u2212" : "?"}) + ", " + position(data.target[i]),
      words.deviation + " " + signed(data.deviation[i]),
      words.model + " " + signed(data.deviation[i] - residual[i]),
      words.residual + " " + signed(residual[i]),
    ];
    if (data.time && finite(data.time[i])) lines.push(words.time + " " + number(data.time[i] , 1) + " " + data.time_unit);
    if (data.temperature && finite(data.temperature[i])) lines.push(words.temperature + " " + number(data.temperature[i], 2) + " \u00B0C");
    const file = data.files[data.measurement[i]];
    lines.push(text(words.line, {file: file || "", line: data.line[i]}));
    if (wrong.has(i)) lines.push(text(words.suspect, {size: number(wrong.get(i), 2), unit: data.unit}));
    return lines;
  }
  function mark(i) {
    marked = i;
    for (const frame of pictures) {
      const old = frame.svg.querySelector(".chosen");
      if (old) old.remove();
      const point = i >= 0 && frame.points.find((p) => p[2] === i);
      if (point) put(frame.svg, "circle", {class: "chosen", cx: r1(point[0]), cy: r1(point[1]), r: 5});
    }
  }
  function show(lines, x, y) {
    tip.replaceChildren(...lines.map((line) => {
      const p = document.createElement("p");
      p.textContent = line;
      return p;
    }));
    tip.hidden = false;
    const room = document.documentElement.clientWidth - tip.offsetWidth - 6;
    tip.style.left = Math.max(4, Math.min(x + 14, room)) + "px";
    tip.style.top = (y + tip.offsetHeight + 24 > window.innerHeight ? y - tip.offsetHeight - 12 : y + 14) + "px";
  }
  function hide() {
    tip.hidden = true;
    if (marked >= 0) mark(-1);
  }
  function hover(event) {
    const svg = event.target.closest && event.target.closest("figure svg");
    const frame = svg && pictures.find((f) => f.svg === svg);
    if (!frame) return hide();
    const box = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / box.width;
    const x = (event.clientX - box.left) * scale, y = (event.clientY - box.top) * scale;
    let best = null, least = 18 * 18;
    for (const p of frame.points) {
      const d = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
      if (d < least) [best, least] = [p, d];
    }
    if (!best) return hide();
    if (best[2] !== marked || best[2] < 0) mark(best[2]);
    show(best[2] >= 0 ? about(best[2]) : best[3], event.clientX, event.clientY);
  }
  document.addEventListener("pointermove", hover);
  document.addEventListener("pointerdown", hover);
  document.addEventListener("scroll", hide, {passive: true});

  // ---- what is in and what is out ----
  function remember() {
    const list = [];
    for (const kind in out) for (const v of [...out[kind]].sort()) list.push(kind + v);
    try {
      history.replaceState(null, "", list.length ? "#" + list.join(",") : location.pathname);
    } catch (e) {
      // a page from disk that may not change its address works without
    }
  }
  function recall() {
    for (const kind in out) out[kind].clear();
    for (const part of location.hash.slice(1).split(","))
      if (/^[edr]-?\d+$/.test(part)) {
        const v = Number(part.slice(1));
        if (part[0] !== "e" || v < data.effects.length) out[part[0]].add(v);
      }
    for (const box of document.querySelectorAll("#choices input")) box.checked = !out[box.dataset.kind].has(Number(box.value));
  }
  function choice(group, kind, value, label) {
    const holder = document.createElement("label"), box = document.createElement("input");
    box.type = "checkbox";
    box.checked = true;
    box.value = value;
    box.dataset.kind = kind;
    box.addEventListener("change", () => {
      if (box.checked) out[kind].delete(value);
      else out[kind].add(value);
      remember();
      draw();
    });
    holder.append(box, " " + label);
    group.append(holder);
  }
  const group = (id) => document.getElementById(id);
  data.effects.forEach((e, k) => choice(group("effects"), "e", k, e.name));
  for (const [d, label] of [[1, "+"], [-1, "\u2212"], [0, "?"]])
    if (data.direction.includes(d)) choice(group("directions"), "d", d, label);
  runs.forEach((r) => choice(group("runs"), "r", r, r));
  document.getElementById("choices").hidden = false;

  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(draw, 100);
  });
  window.addEventListener("hashchange", () => {
    recall();
    draw();
  });
  for (const [event, now] of [["beforeprint", true], ["afterprint", false]])
    window.addEventListener(event, () => {
      printing = now;
      draw();
    });
  recall();
  draw();
})();
