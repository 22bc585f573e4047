// SPDX-License-Identifier: Apache-2.0
// The figure of readings with their model, and the nine figures of residuals, for stored pages
// (model-html) and the live page. The caller supplies the data, the hidden readings, and actions
// for a reading.
"use strict";
/// figure(k): element of figure k, "fit" for the model; tip: element of the tooltip; hidden: {d:
/// directions, r: runs}, sets. Optional: elsewhere(k): true if the caller draws figure k;
/// pick(row), brushed(rows): a reading or region was selected; said(lines): a key moved to a
/// reading; enlarged(k, range): zoom of a figure drawn by the caller; drawn(k, frame): called after
/// each figure; inTurn(): called after all figures, and enables drawing visible ones first. Circles
/// have two more figures, "polar" and "rest" (polar.js).
function nonioPictures({figure, tip, hidden, inTurn, elsewhere, pick, brushed, said, drawn, enlarged}) {
  let data, words, n, wrong, residual, place, ends_of_lane, lines, ghost = null, named = "";
  let shown = [], range = [0, 1], printing = false, turns = 0, looks = false;

  const text = (template, places) =>
    template.replace(/\{(\w+)\}/g, (all, name) => (name in places ? places[name] : all));
  const number = (v, digits) => {
    const s = v.toFixed(digits).replace("-", "\u2212");
    return data.comma ? s.replace(".", ",") : s;
  };
  const finite = Number.isFinite;
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
  const charts = nonioCharts({tip, words: () => words, number, about, pick, brushed, said,
    zoomed: (k, of_axis) => (enlarged && elsewhere(k) ? enlarged(k, of_axis) : draw())});
  const {put, r1} = charts;
  /// options.in: name of the figure if it is not number k; own_band: the caller draws the noise
  /// floor; lanes: lines are side by side.
  function frame_of(k, xs, options) {
    const holder = figure(options.in || k), said_ = options.said || data.pictures[k], own_axis = named && !options.in && said_.y === data.pictures[0].y;
    const width = printing ? (options.in ? 740 : 240) : Math.max(220, Math.round(holder.clientWidth) || 320);
    return new charts.Frame(holder.querySelector("svg"), options.in || k, xs, {range, ...options, width,
      said: own_axis ? {...said_, y: named} : said_, floor: k === 1 || options.own_band || !data.floor ? 0 : 2 * data.floor,
      lanes: (options.lanes && data.lanes) || null, where: options.lanes && data.lanes ? of_place : undefined, empty: k === 1 ? words.one_direction : words.no_readings});
  }
  const dots = (frame, rows, xs, ys) => frame.scatter(rows, xs, ys, {direction: data.direction, wrong, painted: !printing});

  // ---- positions: lines in space are side by side, each in a lane of width 1 ----
  function place_of(m, target) {
    if (!data.lanes) return target;
    const [low, high] = ends_of_lane[m], room = 0.08;
    return m + room + (1 - 2 * room) * (low < high ? (target - low) / (high - low) : 0.5);
  }
  /// Line and position on it for a horizontal position in lanes.
  function of_place(x) {
    const m = Math.min(Math.floor(x), data.lanes.length - 1), [low, high] = ends_of_lane[m], room = 0.08;
    return [data.lanes[m], low + ((x - m - room) / (1 - 2 * room)) * (high - low)];
  }
  const of_line = (rows, m) => rows.filter((i) => data.measurement[i] === m);

  /// For each value of the key in ascending order: [key, number of counted readings, their mean].
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
    const usable = (j) => finite(xs[j]) && counts(rows[j]), [low, high] = nonioExtremes(xs.filter((x, j) => usable(j)));
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
  function over(k, column, kind) {
    const xs = shown.map((i) => column[i]);
    const frame = frame_of(k, xs, {kind});
    dots(frame, shown, xs, shown.map((i) => residual[i]));
    if (kind !== "whole") mean_by_part(frame, shown, xs);
    return frame;
  }

  function by_position() {
    const xs = shown.map((i) => place[i]);
    const frame = frame_of(0, xs, {lanes: true});
    dots(frame, shown, xs, shown.map((i) => residual[i]));
    for (const m of lines)
      for (const d of [1, -1, 0]) {
        const groups = grouped(of_line(shown, m).filter((i) => data.direction[i] === d), data.target, residual);
        frame.line(groups.map((g) => place_of(m, g[0])), groups.map((g) => g[2]), d > 0 ? "plus" : d < 0 ? "minus" : "other");
      }
    return frame;
  }

  // ---- readings of each pass with the model, and residuals below ----
  function with_model() {
    const xs = shown.map((i) => place[i]), left = (i) => (named ? data.residual[i] : residual[i]), most_lines = 60;
    const model = data.deviation.map((v, i) => v - left(i));
    const [low, high] = nonioExtremes([0, ...nonioExtremes(shown.map((i) => data.deviation[i])), ...(looks ? [] : nonioExtremes(shown.map((i) => model[i])))]);
    const edge = 0.06 * (high - low) || 1;
    // Reduced heights fit a low screen.
    const is_low = !printing && window.innerHeight < 800, all_high = is_low ? 340 : 400, middle = is_low ? 190 : 232;
    const units = [...new Set((data.channels || []).map((c) => c.unit))], each = is_low ? 72 : 96;
    const both = {in: "fit", all: all_high + each * units.length, lanes: true};
    const above = frame_of(0, xs, {...both, to: middle, bare: true, own_band: true, range: [low - edge, high + edge], said: data.fit});
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
    dots(above, shown, xs, shown.map((i) => data.deviation[i]));
    if (!looks) {
      for (const [d] of looks_of) above.lines(paths(d).map((rows) => of(rows, model)), d < 0 ? "mean dashed" : "mean");
      const single = all.filter((rows) => !rows.is_path).flat();
      if (single.length) put(above.drawn, "path", {class: "dots model", d: single.map((i) => `M${r1(above.px(place[i]))} ${r1(above.py(model[i]))}h0`).join("")});
    }
    const below = frame_of(0, xs, {...both, from: middle, to: all_high, bare: units.length > 0, range: looks ? [-1, 1] : named ? common_range(data.residual) : range});
    if (!looks) dots(below, shown, xs, shown.map(left));
    return [above, below, ...units.map((unit, k) => channels_of(unit, xs, {...both, from: all_high + each * k, to: all_high + each * (k + 1) + (k + 1 === units.length ? 0 : -6), bare: k + 1 < units.length}))];
  }

  /// Temperatures, speeds or loads during the readings: those of the model are named, the others
  /// gray.
  function channels_of(unit, xs, options) {
    const of = data.channels.filter((c) => c.unit === unit), used = of.filter((c) => c.used);
    const [low, high] = nonioExtremes(of.flatMap((c) => shown.map((i) => c.values[i]))), edge = 0.06 * (high - low) || 1;
    const frame = frame_of(0, xs, {...options, own_band: true, range: [low - edge, high + edge], said: {...data.fit, y: unit}});
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
    const [low, high] = nonioExtremes([0, ...all("ys"), ...all("half"), ...all("half").map((v) => -v)]);
    const edge = 0.06 * (high - low) || 1;
    const frame = frame_of(1, all("xs"), {range: [low - edge, high + edge], lanes: true});
    if (lines.length > 1 && data.floor) {
      // One belt for all lines, because overlapping bands would become darker.
      const widest = Math.max(0, ...all("half"));
      put(frame.drawn, "rect", {class: "band", x: frame.x, y: r1(frame.py(widest)), width: frame.w,
                              height: r1(frame.py(-widest) - frame.py(widest))});
    }
    for (const line of of_lines) draw_reversal(frame, line);
    return frame;
  }

  /// Difference of the means in + and - direction at each target of one measurement, and twice its
  /// standard deviation from the noise floor.
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
    if (lines.length === 1 && data.floor && xs.length > 1) frame.area(xs, half.map((v) => -v), half);
    frame.line(xs, ys, "other");
    xs.forEach((v, j) => {
      put(frame.drawn, "circle", {class: "dot", cx: r1(frame.px(v)), cy: r1(frame.py(ys[j])), r: 2.5});
      frame.point(v, ys[j], [position(targets[j]), words.reversal + " " + number(ys[j], 2) + " " + data.unit]);
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
    const frame = frame_of(7, zs, {});
    dots(frame, kept, zs, kept.map((i) => residual[i]));
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
    const frame = frame_of(8, xs, {lanes: true});
    dots(frame, shown, xs, shown.map((i) => (data.left_out ? data.left_out[i] : NaN)));
    return frame;
  }

  // ---- means of what an effect would explain, as a thin line over the residuals ----
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
    const xs = of(shown), [low, high] = nonioExtremes(xs.filter(finite)), parts = 60;
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

  /// `values`: data to be drawn instead of the residuals; `name`: title of their axis; `only`:
  /// readings without a model.
  function draw(values, name, only) {
    if (values) [residual, looks, named] = [values, only === true, name || ""];
    shown = [];
    for (let i = 0; i < n; i++)
      if (!hidden.d.has(data.direction[i]) && !hidden.r.has(data.run[i])) shown.push(i);
    range = common_range(residual);
    const says = data.deviation.map((v, i) => v - residual[i]);
    const drawers = [by_position, by_reversal, () => over(2, data.time), by_run, () => over(4, phases()),
                     () => over(5, data.temperature), () => over(6, says), by_normal, left_out];
    const columns = [place, null, data.time, data.run, null, data.temperature, says, null, place];
    if (ghost && !data.pictures[4].none) columns[4] = phases();
    charts.keep((frame) => frame.svg.isConnected && elsewhere && elsewhere(frame.k));
    const model = figure("fit") && !data.fit.none ? with_model() : [];
    if (model.length) ghost_in(model[1], 0, columns);
    const one = (k) => {
      const frame = drawers[k]();
      ghost_in(frame, k, columns);
      if (drawn) drawn(k, frame);
    };
    const all = drawers.map((_, k) => k).filter((k) => !data.pictures[k].none && !(elsewhere && elsewhere(k)));
    // With many readings, visible figures are drawn first.
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
      nonioPolar({figure, data, rows: shown, charts, number, text, value: (i) => (looks ? NaN : named ? data.residual[i] : residual[i])});
      charts.again();
      if (inTurn) inTurn();
    };
    if (later.length) setTimeout(next, 40);
    else next();
  }
  function in_view(k) {
    const box = figure(k).getBoundingClientRect();
    return box.bottom > 0 && box.top < window.innerHeight;
  }

  // ---- tooltip of one reading, equal in all figures ----
  const position = (v) => data.axis + " " + number(v, 4).replace(/[.,]?0+$/, "") + " " + data.position_unit;
  function about(i) {
    const signed = (v) => (v > 0 ? "+" : "") + number(v, 2) + " " + data.unit;
    const d = data.direction[i], left = named ? data.residual[i] : residual[i], in_run = data.run[i] > 0 || d !== 0;
    const lines = [
      (in_run ? text(words.reading, {run: data.run[i], direction: d > 0 ? "+" : d < 0 ? "\u2212" : "?"}) + ", " : "") + position(data.target[i]),
      words.deviation + " " + signed(data.deviation[i]),
      words.model + " " + signed(data.deviation[i] - left),
      words.residual + " " + signed(left),
    ];
    if (in_run && data.time && finite(data.time[i])) lines.push(words.time + " " + number(data.time[i] , 1) + " " + data.time_unit);
    if (data.temperature && finite(data.temperature[i])) lines.push(words.temperature + " " + number(data.temperature[i], 2) + " \u00B0C");
    const file = data.files[data.measurement[i]];
    lines.push(text(words.line, {file: file || "", line: data.line[i]}));
    if (wrong.has(i)) lines.push(text(words.suspect, {size: number(wrong.get(i), 2), unit: data.unit}));
    return lines;
  }
  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(() => data && draw(), 100);
  });
  // Canvas colors do not follow a theme change.
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => data && draw());
  for (const [event, now] of [["beforeprint", true], ["afterprint", false]])
    window.addEventListener(event, () => {
      printing = now;
      if (data) draw();
    });

  return {
    /// Sets the data of a part: embedded by model-html, or from GET /api/parts/X/fit.
    set(page) {
      const other = !data || data.residual.length !== page.residual.length || data.axis !== page.axis;
      data = page;
      words = data.words;
      n = data.residual.length;
      wrong = new Map(data.suspects);
      residual = data.residual;
      ghost = null;
      if (other) charts.forget();
      ends_of_lane = (data.lanes || []).map((name, m) =>
        nonioExtremes(data.target.filter((v, i) => data.measurement[i] === m)));
      place = data.target.map((v, i) => place_of(data.measurement[i], v));
      lines = Array.from({length: Math.max(1, data.measurements)}, (_, m) => m);
    },
    /// Sets the values of an effect to be drawn as a thin line; none: removes it.
    ghost(column) {
      const means = new Map();
      (column || []).forEach((v, i) => {
        const m = means.get(data.measurement[i]) || [0, 0];
        if (finite(v)) means.set(data.measurement[i], [m[0] + data.weight[i], m[1] + data.weight[i] * v]);
      });
      // The mean of each measurement is absorbed by its zero.
      ghost = column && column.map((v, i) => v - means.get(data.measurement[i])[1] / means.get(data.measurement[i])[0]);
    },
    /// Draws minimum and maximum per position if there are more readings than on the page, for the
    /// whole axis or a part.
    between(k, {xs, low, high, x, y, whole, about: lines_of}) {
      const [least, most] = nonioExtremes([...low, ...high]), edge = 0.06 * (most - least) || 1, svg = figure(k).querySelector("svg");
      const frame = new charts.Frame(svg, k, xs, {width: Math.max(240, Math.round(figure(k).clientWidth)), range: [least - edge, most + edge], said: {x, y}, own: {whole, only_axis: true}});
      frame.area(xs, low, high);
      for (const ys of [low, high]) frame.lines([[xs, ys]], "between");
      xs.forEach((v, j) => finite(low[j]) && frame.point(v, (low[j] + high[j]) / 2, lines_of(j)));
      return frame;
    },
    draw, about, select: charts.select,
    number, text, finite,
    get shown() { return shown; },
    get chosen() { return charts.chosen; },
    counted: (i) => data.weight[i] > 0 || wrong.has(i),
  };
}
