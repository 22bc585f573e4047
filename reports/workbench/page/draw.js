// SPDX-License-Identifier: Apache-2.0
// The readings with their model, and the nine pictures of residuals: the page from disk (model-html) and the live one
// draw with this code. The caller provides the data, what is hidden, and the functions that handle a chosen reading.
"use strict";
/// figure(k): the element of picture k, or of the picture with the model if k is "fit"; tip: the element that shows a reading;
/// hidden: {d: directions, r: runs}, sets. Optional: elsewhere(k) is true if the caller draws picture k itself; pick(row) and
/// brushed(rows) are called when a reading or a region is chosen, said(lines) when a key moves to a reading, drawn(k, frame)
/// after each picture, inTurn() after all; with inTurn visible pictures come first. Circles also have "polar" and "rest" (polar.js).
function nonioPictures({figure, tip, hidden, inTurn, elsewhere, pick, brushed, said, drawn}) {
  let data, words, n, wrong, residual, place, ends_of_lane, lines, ghost = null, named = "";
  let shown = [], range = [0, 1], pictures = [], marked = -1, by_key = false, printing = false, chosen = new Set(), turns = 0, looks = false;

  const text = (template, places) =>
    template.replace(/\{(\w+)\}/g, (all, name) => (name in places ? places[name] : all));
  const number = (v, digits) => {
    const s = v.toFixed(digits).replace("-", "\u2212");
    return data.comma ? s.replace(".", ",") : s;
  };
  const finite = (v) => typeof v === "number" && isFinite(v);
  const counts = (i) => data.weight[i] >= 0.5;

  function common_range(of) {
    let low = 0, high = 0;
    for (const values of [of, data.left_out])
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

  // ---- drawing ----
  const ns = "http://www.w3.org/2000/svg";
  function put(parent, name, attributes, content) {
    const node = document.createElementNS(ns, name);
    for (const key in attributes) node.setAttribute(key, attributes[key]);
    if (content !== undefined) node.textContent = content;
    parent.appendChild(node);
    return node;
  }
  const r1 = (v) => Math.round(v * 10) / 10;

  class Frame {
    /// `options.from`, `to`: range of the height, if a picture has several frames; `bare`: without a title of the x axis.
    constructor(k, xs, options) {
      const holder = figure(options.in || k), {from = 0, to = 230, all = to, bare = false} = options;
      this.svg = holder.querySelector("svg");
      if (from === 0) this.svg.replaceChildren();
      this.g = put(this.svg, "g", {});
      const width = printing ? (options.in ? 740 : 240) : Math.max(220, Math.round(holder.clientWidth) || 320);
      this.svg.setAttribute("viewBox", `0 0 ${width} ${all}`);
      Object.assign(this, {k, x: 46, y: from + 6, w: width - 52, h: to - from - (bare ? 24 : 44), bare, band: options.band, named: options.in ? "" : named, points: []});
      const said = options.said || data.pictures[k];
      let [low, high] = extremes(xs);
      this.empty = !(low <= high);
      if (this.empty) [low, high] = [0, 1];
      // Values that differ only by rounding are one value: no step is small enough for ticks between them.
      if (high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high))) high = low;
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
      const {g: svg, x, y, w, h} = this;
      if (data.floor && !this.own_band())
        put(svg, "rect", {class: "band", x, y: r1(this.py(2 * data.floor)), width: w,
                          height: r1(this.py(-2 * data.floor) - this.py(2 * data.floor))});
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
        put(svg, "line", {class: "rule", x1: r1(rule), x2: r1(rule), y1: y, y2: y + h});
        if (at - half < free || at + half > x + w + 8) continue;
        free = at + half + 4;
        put(svg, "text", {x: r1(at), y: y + h + 13, "text-anchor": "middle"}, t.label);
      }
      put(svg, "rect", {class: "frame", x, y, width: w, height: h});
      if (!this.bare) put(svg, "text", {x: x + w / 2, y: y + h + 31, "text-anchor": "middle"}, said.x);
      put(svg, "text", {transform: `translate(11 ${y + h / 2}) rotate(-90)`, "text-anchor": "middle"}, this.named && said.y === data.pictures[0].y ? this.named : said.y);
      if (this.empty) put(svg, "text", {x: x + w / 2, y: y + h / 2 - 8, "text-anchor": "middle"}, this.k === 1 ? words.one_direction : words.no_readings);
    }
    own_band() { return this.k === 1 || this.band === false; }
    line(xs, ys, look) {
      if (xs.length > 1) this.lines([[xs, ys]], look);
    }
    lines(all, look) {
      const one = ([xs, ys]) => xs.map((v, i) => (i ? "L" : "M") + r1(this.px(v)) + " " + r1(this.py(ys[i]))).join("");
      if (all.length) put(this.g, "path", {class: "line " + look, d: all.map(one).join("")});
    }
    /// Readings by direction; suspects outside the range are drawn at its edge.
    /// For print they are SVG, sharp at any size. On the screen very many are painted on a canvas, in a tenth of the time.
    scatter(rows, xs, ys) {
      const path = {plus: "", minus: "", other: ""}, many = rows.length > 1200, painted = many && !printing;
      const dots = {plus: [], minus: [], other: []};
      const inset = 0.03 * (this.high - this.low), rings = [];
      rows.forEach((i, j) => {
        if (!finite(xs[j]) || !finite(ys[j])) return;
        const v = wrong.has(i) ? Math.min(Math.max(ys[j], this.low + inset), this.high - inset) : ys[j];
        const x = this.px(xs[j]), y = this.py(v), d = data.direction[i], look = d > 0 ? "plus" : d < 0 ? "minus" : "other";
        this.points.push([x, y, i]);
        if (wrong.has(i)) rings.push([x, y]);
        if (painted) return void dots[look].push(x, y);
        const at = "M" + r1(x) + " " + r1(y);
        path[look] += many || d === 0 ? at + "h0" : d > 0 ? at + "m-3 2.2h6l-3-5.2z" : at + "m-3-2.2h6l-3 5.2z";
      });
      if (painted) this.paint(dots);
      for (const look in path)
        if (path[look]) put(this.g, "path", {class: (many || look === "other" ? "dots " : "marks ") + look, d: path[look]});
      for (const [cx, cy] of rings) put(this.g, "circle", {class: "suspect", cx: r1(cx), cy: r1(cy), r: 6});
    }
    paint(dots) {
      const {x, y, w, h} = this, sharp = Math.min(3, window.devicePixelRatio || 1);
      const canvas = () => Object.assign(document.createElement("canvas"), {width: Math.ceil(w * sharp), height: Math.ceil(h * sharp)});
      const shown_ = canvas(), one = canvas(), to = shown_.getContext("2d"), pen = one.getContext("2d");
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
      Object.assign(shown_.style, {width: w + "px", height: h + "px", display: "block"});
      put(this.g, "foreignObject", {class: "dots", x, y, width: w, height: h, "pointer-events": "none"}).append(shown_);
    }
  }

  // ---- places: lines in space are side by side, each in a lane of width 1 ----
  function place_of(m, target) {
    if (!data.lanes) return target;
    const [low, high] = ends_of_lane[m], room = 0.08;
    return m + room + (1 - 2 * room) * (low < high ? (target - low) / (high - low) : 0.5);
  }
  const of_line = (rows, m) => rows.filter((i) => data.measurement[i] === m);

  /// For each value of the key, ascending: [key, readings with weight, their mean].
  function grouped(rows, key, values) {
    const map = new Map();
    for (const i of rows)
      if (counts(i)) {
        const sum = map.get(key[i]);
        if (!sum) map.set(key[i], [key[i], 1, values[i]]);
        else sum[1]++, (sum[2] += values[i]);
      }
    return [...map.values()].map(([k, m, sum]) => [k, m, sum / m]).sort((a, b) => a[0] - b[0]);
  }
  const by_key_of = (groups) => new Map(groups.map((g) => [g[0], g]));
  function mean_by_part(frame, rows, xs) {
    const usable = (j) => finite(xs[j]) && counts(rows[j]), [low, high] = extremes(xs.filter((x, j) => usable(j)));
    let used = 0;
    for (let j = 0; j < rows.length; j++) if (usable(j)) used++;
    if (!(low < high) || used < 12) return;
    const parts = Math.min(12, Math.floor(used / 6));
    const groups = Array.from({length: parts}, () => [0, 0, 0]);
    for (let j = 0; j < rows.length; j++) {
      if (!usable(j)) continue;
      const sum = groups[Math.min(parts - 1, Math.floor(((xs[j] - low) / (high - low)) * parts))];
      sum[0]++;
      sum[1] += xs[j];
      sum[2] += residual[rows[j]];
    }
    const good = groups.filter((g) => g[0] >= 3);
    frame.line(good.map((g) => g[1] / g[0]), good.map((g) => g[2] / g[0]), "mean");
  }
  function extremes(list) {
    let low = Infinity, high = -Infinity;
    for (const v of list)
      if (finite(v)) {
        if (v < low) low = v;
        if (v > high) high = v;
      }
    return [low, high];
  }

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
        frame.line(groups.map((g) => place_of(m, g[0])), groups.map((g) => g[2]), d > 0 ? "plus" : d < 0 ? "minus" : "other");
      }
    return frame;
  }

  // ---- readings of each pass with the model, and the residuals below ----
  function with_model() {
    const xs = shown.map((i) => place[i]), left = (i) => (named ? data.residual[i] : residual[i]), most_lines = 60;
    const model = data.deviation.map((v, i) => v - left(i));
    const [low, high] = extremes([0, ...extremes(shown.map((i) => data.deviation[i])), ...(looks ? [] : extremes(shown.map((i) => model[i])))]);
    const edge = 0.06 * (high - low) || 1;
    // On a low screen the picture is smaller, so that all of it is visible.
    const is_low = !printing && window.innerHeight < 800, all_high = is_low ? 340 : 400, middle = is_low ? 190 : 232;
    const units = [...new Set((data.channels || []).map((c) => c.unit))], each = is_low ? 72 : 96;
    const both = {in: "fit", all: all_high + each * units.length, lanes: true};
    const above = new Frame(0, xs, {...both, to: middle, bare: true, band: false, range: [low - edge, high + edge], said: data.fit});
    const passes = new Map();
    for (const i of shown) {
      const key = [data.measurement[i], data.run[i], data.direction[i]].join(" ");
      if (!passes.has(key)) passes.set(key, []);
      passes.get(key).push(i);
    }
    const of = (rows, values) => [rows.map((i) => place[i]), rows.map((i) => values[i])];
    const all = [...passes.values()];
    for (const rows of all) {
      rows.sort((a, b) => place[a] - place[b]);
      rows.is_path = rows.every((i, j) => j === 0 || place[i] > place[rows[j - 1]]);
    }
    const paths = (d) => all.filter((rows) => rows.is_path && rows.length > 1 && Math.sign(data.direction[rows[0]]) === d);
    const looks_of = [[1, "plus"], [-1, "minus"], [0, "other"]];
    if (all.length <= most_lines) for (const [d, look] of looks_of) above.lines(paths(d).map((rows) => of(rows, data.deviation)), "pass " + look);
    above.scatter(shown, xs, shown.map((i) => data.deviation[i]));
    if (!looks) {
      for (const [d] of looks_of) above.lines(paths(d).map((rows) => of(rows, model)), d < 0 ? "mean dashed" : "mean");
      const single = all.filter((rows) => !rows.is_path).flat();
      if (single.length) put(above.g, "path", {class: "dots model", d: single.map((i) => `M${r1(above.px(place[i]))} ${r1(above.py(model[i]))}h0`).join("")});
    }
    const below = new Frame(0, xs, {...both, from: middle, to: all_high, bare: units.length > 0, range: looks ? [-1, 1] : named ? common_range(data.residual) : range});
    if (!looks) below.scatter(shown, xs, shown.map(left));
    return [above, below, ...units.map((unit, k) => channels_of(unit, xs, {...both, from: all_high + each * k, to: all_high + each * (k + 1) + (k + 1 === units.length ? 0 : -6), bare: k + 1 < units.length}))];
  }

  /// Temperatures, speeds or loads during the readings: those in the model with their names, the others grey.
  function channels_of(unit, xs, options) {
    const of = data.channels.filter((c) => c.unit === unit), used = of.filter((c) => c.used);
    const [low, high] = extremes(of.flatMap((c) => shown.map((i) => c.values[i]))), edge = 0.06 * (high - low) || 1;
    const frame = new Frame(0, xs, {...options, band: false, range: [low - edge, high + edge], said: {...data.fit, y: unit}});
    const rows = [...shown].sort((a, b) => place[a] - place[b]), at = rows.map((i) => place[i]);
    for (const c of of) if (!c.used) frame.line(at, rows.map((i) => c.values[i]), "pass other");
    used.forEach((c, k) => frame.line(at, rows.map((i) => c.values[i]), "mean" + (k % 2 ? " dashed" : "")));
    const names = (used.length ? used : of).map((c) => c.name);
    put(frame.g, "text", {class: "names", x: frame.x + 6, y: frame.y + 12}, (names.length > 8 ? names.slice(0, 8).concat("\u2026") : names).join(", "));
    return frame;
  }

  function by_reversal() {
    const of_lines = lines.map((m) => reversal_of(m));
    const all = (key) => of_lines.flatMap((line) => line[key]);
    const [low, high] = extremes([0, ...all("ys"), ...all("half"), ...all("half").map((v) => -v)]);
    const edge = 0.06 * (high - low) || 1;
    const frame = new Frame(1, all("xs"), {range: [low - edge, high + edge], lanes: true});
    if (lines.length > 1 && data.floor) {
      // One band for all lines: overlapping bands would be darker.
      const widest = Math.max(0, ...all("half"));
      put(frame.g, "rect", {class: "band", x: frame.x, y: r1(frame.py(widest)), width: frame.w,
                              height: r1(frame.py(-widest) - frame.py(widest))});
    }
    for (const line of of_lines) draw_reversal(frame, line);
    return frame;
  }

  /// mean(+) minus mean(-) at each target of one measurement, and twice its standard deviation according to the
  /// noise floor.
  function reversal_of(m) {
    const rows = of_line(shown, m);
    const minus = by_key_of(grouped(rows.filter((i) => data.direction[i] < 0), data.target, residual));
    const both = grouped(rows.filter((i) => data.direction[i] > 0), data.target, residual).filter((g) => minus.has(g[0]));
    return {
      targets: both.map((g) => g[0]),
      xs: both.map((g) => place_of(m, g[0])),
      ys: both.map((g) => g[2] - minus.get(g[0])[2]),
      half: both.map((g) => 2 * (data.floor || 0) * Math.sqrt(1 / g[1] + 1 / minus.get(g[0])[1])),
    };
  }

  function draw_reversal(frame, {targets, xs, ys, half}) {
    if (lines.length === 1 && data.floor && xs.length > 1) {
      const there = xs.map((v, j) => r1(frame.px(v)) + " " + r1(frame.py(half[j])));
      const back = xs.map((v, j) => r1(frame.px(v)) + " " + r1(frame.py(-half[j]))).reverse();
      put(frame.g, "path", {class: "band", d: "M" + there.concat(back).join("L") + "z"});
    }
    frame.line(xs, ys, "other");
    xs.forEach((v, j) => {
      put(frame.g, "circle", {class: "dot", cx: r1(frame.px(v)), cy: r1(frame.py(ys[j])), r: 2.5});
      frame.points.push([frame.px(v), frame.py(ys[j]), -1, [position(targets[j]), words.reversal + " " + number(ys[j], 2) + " " + data.unit]]);
    });
  }

  function by_run() {
    const frame = over(3, data.run, "whole");
    const groups = grouped(shown, data.run, residual);
    frame.line(groups.map((g) => g[0]), groups.map((g) => g[2]), "mean");
    return frame;
  }

  function by_normal() {
    const order = shown.filter((i) => data.weight[i] > 0 || wrong.has(i)).sort((a, b) => residual[a] - residual[b]), m = order.length;
    const outer = 300, step = m > 1600 ? Math.floor((m - 2 * outer) / 1000) : 1;
    const kept = [], zs = [];
    order.forEach((i, j) => {
      if (j >= outer && j + outer < m && j % step !== 0) return;
      kept.push(i);
      zs.push(nonioQuantile((j + 0.5) / m));
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

  // ---- what an effect would explain of the residuals: its means, as a thin line ----
  function ghost_line(frame, xs, group) {
    const sums = new Map();
    shown.forEach((i, j) => {
      if (!finite(xs[j]) || !finite(ghost[i])) return;
      const key = group(i, xs[j]), sum = sums.get(key) || [0, 0, 0];
      sums.set(key, [sum[0] + 1, sum[1] + xs[j], sum[2] + ghost[i]]);
    });
    const points = [...sums.values()].map(([m, x, y]) => [x / m, y / m]).sort((a, b) => a[0] - b[0])
      .filter((p) => p[1] >= frame.low && p[1] <= frame.high);
    frame.line(points.map((p) => p[0]), points.map((p) => p[1]), "ghost");
  }
  function ghost_in(frame, k, columns) {
    if (!ghost || k === 7 || frame.empty) return;
    if (k === 1) return ghost_reversal(frame);
    const all = columns[k];
    if (!all) return;
    const of = (rows) => rows.map((i) => all[i]);
    if (k === 0 || k === 8) {
      const keep = shown;
      for (const m of lines) {
        shown = of_line(keep, m);
        ghost_line(frame, of(shown), (i, x) => x);
      }
      shown = keep;
      return;
    }
    const xs = of(shown), [low, high] = extremes(xs.filter(finite)), parts = 60;
    ghost_line(frame, xs, (i, x) => (k === 3 ? x : Math.floor(((x - low) / (high - low || 1)) * parts)));
  }
  function ghost_reversal(frame) {
    for (const m of lines) {
      const rows = of_line(shown, m);
      const minus = by_key_of(grouped(rows.filter((i) => data.direction[i] < 0), data.target, ghost));
      const both = grouped(rows.filter((i) => data.direction[i] > 0), data.target, ghost).filter((g) => minus.has(g[0]));
      frame.line(both.map((g) => place_of(m, g[0])), both.map((g) => g[2] - minus.get(g[0])[2]), "ghost");
    }
  }

  /// `values`: drawn instead of the residuals of the data; `name`: the title of the axis.
  function draw(values, name, only) {
    if (values) [residual, looks] = [values, only === true];
    named = name || "";
    shown = [];
    for (let i = 0; i < n; i++)
      if (!hidden.d.has(data.direction[i]) && !hidden.r.has(data.run[i])) shown.push(i);
    range = common_range(residual);
    const says = data.deviation.map((v, i) => v - residual[i]);
    const drawers = [by_position, by_reversal, () => over(2, data.time), by_run, () => over(4, phases()),
                     () => over(5, data.temperature), () => over(6, says), by_normal, left_out];
    const columns = [place, null, data.time, data.run, null, data.temperature, says, null, place];
    if (ghost && !data.pictures[4].none) columns[4] = phases();
    pictures = figure("fit") && !data.fit.none ? with_model() : [];
    if (pictures.length) ghost_in(pictures[1], 0, columns);
    const one = (k) => {
      const frame = drawers[k]();
      ghost_in(frame, k, columns);
      pictures.push(frame);
      if (drawn) drawn(k, frame);
    };
    const all = drawers.map((_, k) => k).filter((k) => !data.pictures[k].none && !(elsewhere && elsewhere(k)));
    // With many readings the visible pictures are drawn first.
    const later = inTurn && n > 2000 && !printing ? all.filter((k) => !in_view(k)) : [];
    all.filter((k) => !later.includes(k)).forEach(one);
    const turn = ++turns;
    const next = () => {
      if (turn !== turns) return;
      if (later.length) {
        one(later.shift());
        setTimeout(next);
        return;
      }
      pictures.push(...nonioPolar({figure, data, rows: shown, put, number, text, value: (i) => (looks ? NaN : named ? data.residual[i] : residual[i])}));
      mark(marked);
      select(chosen);
      if (inTurn) inTurn();
    };
    if (later.length) setTimeout(next, 40);
    else next();
  }
  function in_view(k) {
    const box = figure(k).getBoundingClientRect();
    return box.bottom > 0 && box.top < window.innerHeight;
  }

  // ---- one reading, in every picture ----
  const position = (v) => data.axis + " " + number(v, 4).replace(/[.,]?0+$/, "") + " " + data.position_unit;
  function about(i) {
    const signed = (v) => (v > 0 ? "+" : "") + number(v, 2) + " " + data.unit;
    const d = data.direction[i], left = named ? data.residual[i] : residual[i];
    const lines = [
      text(words.reading, {run: data.run[i], direction: d > 0 ? "+" : d < 0 ? "\u2212" : "?"}) + ", " + position(data.target[i]),
      words.deviation + " " + signed(data.deviation[i]),
      words.model + " " + signed(data.deviation[i] - left),
      words.residual + " " + signed(left),
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
      const old = frame.g.querySelector(".chosen");
      if (old) old.remove();
      const point = i >= 0 && frame.points.find((p) => p[2] === i);
      if (point) put(frame.g, "circle", {class: "chosen", cx: r1(point[0]), cy: r1(point[1]), r: 5});
    }
  }
  /// Highlights the same readings in every picture.
  function select(rows) {
    chosen = new Set(rows);
    for (const frame of pictures) {
      const old = frame.g.querySelector(".picked");
      if (old) old.remove();
      frame.g.classList.toggle("choosing", chosen.size > 0);
      if (chosen.size === 0) continue;
      const d = frame.points.filter((p) => chosen.has(p[2])).map((p) => `M${r1(p[0])} ${r1(p[1])}h0`).join("");
      put(frame.g, "path", {class: "picked", d});
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
  function under(event, reach) {
    const svg = event.target.closest && event.target.closest("figure svg");
    const frames = svg ? pictures.filter((f) => f.svg === svg) : [];
    if (frames.length === 0) return [null, null];
    const [x, y] = inside(frames[0], event);
    const frame = frames.find((f) => y < f.y + f.h + 20) || frames[frames.length - 1];
    let best = null, least = reach * reach;
    for (const p of frame.points) {
      const d = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
      if (d < least) [best, least] = [p, d];
    }
    return [frame, best];
  }
  function inside(frame, event) {
    const box = frame.svg.getBoundingClientRect(), scale = frame.svg.viewBox.baseVal.width / box.width;
    return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
  }
  function hover(event) {
    by_key = false;
    const [, best] = under(event, 18);
    if (!best) return hide();
    if (best[2] !== marked || best[2] < 0) mark(best[2]);
    show(best[2] >= 0 ? about(best[2]) : best[3], event.clientX, event.clientY);
  }

  // ---- a region: drawn with the pointer; its readings are chosen in every picture ----
  let drag = null;
  function down(event) {
    hover(event);
    const [frame] = under(event, 18);
    if (!brushed || !frame || event.button !== 0 || event.pointerType === "touch") return;
    drag = {frame, from: inside(frame, event), to: null, box: null};
  }
  function move(event) {
    if (!drag) return hover(event);
    hide();
    event.preventDefault();
    const {frame, from} = drag, clip = (v, low, size) => Math.min(Math.max(v, low), low + size);
    const at = inside(frame, event);
    if (!drag.box && Math.hypot(at[0] - from[0], at[1] - from[1]) < 5) return;
    drag.to = [clip(at[0], frame.x, frame.w), clip(at[1], frame.y, frame.h)];
    drag.box = drag.box || put(frame.svg, "rect", {class: "brush"});
    const corner = (k) => Math.min(from[k], drag.to[k]), size = (k) => Math.abs(from[k] - drag.to[k]);
    for (const [name, v] of [["x", corner(0)], ["y", corner(1)], ["width", size(0)], ["height", size(1)]])
      drag.box.setAttribute(name, r1(v));
  }
  function up(event) {
    const was = drag;
    drag = null;
    if (was && was.box) {
      was.box.remove();
      const within = (v, k) => v >= Math.min(was.from[k], was.to[k]) && v <= Math.max(was.from[k], was.to[k]);
      const rows = was.frame.points.filter((p) => p[2] >= 0 && within(p[0], 0) && within(p[1], 1)).map((p) => p[2]);
      select(rows);
      brushed(rows);
    } else if (pick) {
      const [, best] = under(event, 12);
      if (best && best[2] >= 0) pick(best[2]);
    }
  }

  // ---- the same with keys: a cursor that moves from reading to reading in the picture that has the focus ----
  function key(event) {
    const svg = event.target.closest && event.target.closest("figure svg");
    const frame = svg && pictures.find((f) => f.svg === svg);
    if (!frame || event.ctrlKey || event.altKey || event.metaKey) return;
    const order = frame.points.filter((p) => p[2] >= 0).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    if (order.length === 0) return;
    const at = order.findIndex((p) => p[2] === marked), last = order.length - 1;
    const to = {ArrowRight: at + 1, ArrowLeft: at < 0 ? last : at - 1, Home: 0, End: last, PageDown: at + 10, PageUp: at - 10}[event.key];
    if (to !== undefined) {
      const point = order[Math.min(Math.max(to, 0), last)];
      by_key = true;
      mark(point[2]);
      const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
      show(about(point[2]), box.left + point[0] * scale, box.top + point[1] * scale);
      if (said) said(about(point[2]));
    } else if (event.key === "Enter" && marked >= 0 && pick) pick(marked);
    else if (event.key === "Escape" && tip.hidden) {
      select([]);
      if (brushed) brushed([]);
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
  // A reading marked by a key stays marked when the page scrolls.
  document.addEventListener("scroll", () => (by_key ? (tip.hidden = true) : hide()), {passive: true, capture: true});
  if (pick) document.addEventListener("keydown", key);

  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(() => data && draw(), 100);
  });
  // The canvas does not follow a change of the colour scheme: it is painted again.
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => data && draw());
  for (const [event, now] of [["beforeprint", true], ["afterprint", false]])
    window.addEventListener(event, () => {
      printing = now;
      if (data) draw();
    });

  return {
    /// The data of a part: model-html embeds them, GET /api/parts/X/fit sends them.
    set(page) {
      const other = !data || data.residual.length !== page.residual.length || data.axis !== page.axis;
      data = page;
      words = data.words;
      n = data.residual.length;
      wrong = new Map(data.suspects);
      residual = data.residual;
      ghost = null;
      if (other) [marked, chosen] = [-1, new Set()];
      ends_of_lane = (data.lanes || []).map((name, m) =>
        extremes(data.target.filter((v, i) => data.measurement[i] === m)));
      place = data.target.map((v, i) => place_of(data.measurement[i], v));
      lines = Array.from({length: Math.max(1, data.measurements)}, (_, m) => m);
    },
    /// The value of an effect at each reading, or nothing.
    ghost(column) {
      const means = new Map();
      (column || []).forEach((v, i) => {
        const m = means.get(data.measurement[i]) || [0, 0];
        if (finite(v)) means.set(data.measurement[i], [m[0] + data.weight[i], m[1] + data.weight[i] * v]);
      });
      // Each measurement has a zero of its own, which includes the mean of the effect.
      ghost = column && column.map((v, i) => v - means.get(data.measurement[i])[1] / means.get(data.measurement[i])[0]);
    },
    draw, mark, select, about, hide,
    number, text, finite,
    get shown() { return shown; },
    get chosen() { return chosen; },
    counted: (i) => data.weight[i] > 0 || wrong.has(i),
  };
}
