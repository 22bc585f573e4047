// ---- the volume: lines and diagonals colored by residual, with magnified deviations ----
const space = (() => {
  let turn = 35, lift = 25, times = 0, charts = null;
  function colour(v, most) {
    const t = Math.max(-1, Math.min(1, v / (most || 1))), strength = Math.round(30 + 70 * Math.abs(t));
    return `color-mix(in srgb, var(${t >= 0 ? "--minus" : "--plus"}) ${strength}%, var(--band))`;
  }
  function project(size, p) {
    const c = p.map((v, i) => v - size[i] / 2), a = (turn * Math.PI) / 180, b = (lift * Math.PI) / 180;
    const x = c[0] * Math.cos(a) - c[1] * Math.sin(a), y = c[0] * Math.sin(a) + c[1] * Math.cos(a);
    return [x, -(c[2] * Math.cos(b) + y * Math.sin(b))];
  }
  /// The machine as a chain of axes, bed - X - Y - Z - tool, as in the model: boxes [x0, x1, y0, y1, z0, z1] around the
  /// volume, with the tool at `tool`. Portals are on both sides of the volume, every other structure on one.
  function bodies(structure, size, tool, names) {
    const t = 0.05 * Math.max(...size), [x, y, z] = tool, [sx, sy, sz] = size;
    const ram = [...(names.includes("Z") ? [["Z", [x - 0.7 * t, x + 0.7 * t, y - 0.7 * t, y + 0.7 * t, z + 1.5 * t, sz + 5 * t]]] : []), ["tool", [x - 0.2 * t, x + 0.2 * t, y - 0.2 * t, y + 0.2 * t, z, z + 1.5 * t]]];
    if (structure === "gantry" || structure === "bridge")
      return [["bed", [-t, sx + t, -3 * t, sy + 3 * t, -2 * t, -t]],
        ["X", [x - t, x + t, -3 * t, -2 * t, -t, sz + 2 * t]], ["X", [x - t, x + t, sy + 2 * t, sy + 3 * t, -t, sz + 2 * t]], ["X", [x - t, x + t, -3 * t, sy + 3 * t, sz + 2 * t, sz + 3.5 * t]],
        ["Y", [x - 1.5 * t, x + 1.5 * t, y - 1.5 * t, y + 1.5 * t, sz + 1.7 * t, sz + 3.8 * t]], ...ram];
    return [["bed", [-t, sx + t, -6 * t, sy + t, -2 * t, -t]],
      ["X", [x - 1.5 * t, x + 1.5 * t, -5 * t, -2 * t, -t, sz + 3.5 * t]], ["Y", [x - t, x + t, -5.5 * t, y + 1.3 * t, sz + 2 * t, sz + 3.5 * t]], ...ram];
  }
  const cornersOf = (b) => [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [b[k & 1 ? 1 : 0], b[k & 2 ? 3 : 2], b[k & 4 ? 5 : 4]]);
  const faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
  /// The position with the largest mean residual of a target, where the tool is drawn.
  function worstPlace(lines, data) {
    let worst = null, most = -1;
    lines.forEach((line) => {
      const m = data.lanes ? data.lanes.indexOf(line.id) : lines.indexOf(line), mean = new Map();
      data.target.forEach((t, i) => {
        if (data.measurement[i] !== m) return;
        const s = mean.get(t) || [0, 0];
        mean.set(t, [s[0] + 1, s[1] + data.residual[i]]);
      });
      const ts = [...mean.keys()], first = Math.min(...ts), last = Math.max(...ts);
      for (const [t, [n, r]] of mean) {
        if (Math.abs(r / n) <= most) continue;
        most = Math.abs(r / n);
        const f = last > first ? (t - first) / (last - first) : 0;
        worst = line.from.map((v, i) => v + f * (line.to[i] - v));
      }
    });
    return worst;
  }
  function draw(state, shown, redraw) {
    const part = state.parts.find((p) => p.name === shown.part) || {}, section = by("space"), data = shown.fit && shown.fit.page;
    section.hidden = !(part.space && part.space.lines && data);
    if (section.hidden) return;
    const lines = part.space.lines, low = [0, 1, 2].map((i) => Math.min(0, ...lines.flatMap((l) => [l.from[i], l.to[i]])));
    const size = [0, 1, 2].map((i) => Math.max(...lines.flatMap((l) => [l.from[i], l.to[i]])) - low[i]);
    const most = Math.max(...data.residual.map(Math.abs)), big = Math.max(...size);
    const at = (p) => project(size, p.map((v, i) => v - low[i]));
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => at(size.map((s, i) => low[i] + (k & (1 << i) ? s : 0))));
    const machine = state.campaign.machine || {}, structure = {gantry: "gantry", bridge: "bridge", "single-column": "single_column"}[machine.structure] || "other";
    const tool = (worstPlace(lines, data) || low).map((v, i) => v - low[i]), names = (machine.axes || []).map((a) => a.name), chain = bodies(machine.structure, size, tool, names);
    const around = chain.flatMap(([, b]) => cornersOf(b)).map((p) => project(size, p));
    const [left, right] = [Math.min, Math.max].map((f) => f(...around.map((c) => c[0]))), [top, bottom] = [Math.min, Math.max].map((f) => f(...around.map((c) => c[1])));
    const scale = Math.min(440 / Math.max(1, right - left), 300 / Math.max(1, bottom - top)), middle = [260 - (scale * (left + right)) / 2, 170 - (scale * (top + bottom)) / 2];
    const put = ([x, y]) => [middle[0] + x * scale, middle[1] + y * scale], place = (p) => put(at(p));
    charts = charts || nonioCharts({tip: by("tip"), words: () => words, number: (v) => short(v), zoomed: () => {}});
    const box = by("space-view");
    if (!box.querySelector("#space-times")) {
      const slider = (id, word, value, min, max, set) => el("label", {}, say(word) + " ", el("input", {type: "range", id, min, max, step: "any", value, "data-key": id, oninput: (e) => { set(Number(e.target.value)); redraw(); }}));
      box.replaceChildren(el("div", {id: "space-picture"}, svg("svg", {class: "chart", viewBox: "0 0 520 340", role: "img"})), el("div", {class: "sliders"}, slider("space-times", "space.times", times, 0, 3, (v) => (times = v)), slider("space-turn", "space.turn", turn, -180, 180, (v) => (turn = v)), slider("space-lift", "space.lift", lift, -10, 90, (v) => (lift = v))), el("p", {class: "muted"}, say("space.legend")), el("p", {class: "muted", id: "space-chain"}), el("div", {id: "space-table"}));
    }
    const picture = by("space-picture").querySelector("svg"), values = [];
    picture.setAttribute("aria-label", say("space.alt", {n: lines.length, most: short(most), unit: shown.unit}));
    picture.replaceChildren();
    const frame = {svg: picture, g: picture, k: "space", x: 0, y: 0, w: 520, h: 340, points: [], series: [], said: {x: "mm", y: shown.unit}};
    frame.table = () => [["line", "X / mm", "Y / mm", "Z / mm", `deviation / ${shown.unit}`, `residual / ${shown.unit}`], ...values];
    const edge = (a, b) => picture.append(svg("line", {class: "rule edge", x1: a[0].toFixed(1), y1: a[1].toFixed(1), x2: b[0].toFixed(1), y2: b[1].toFixed(1)}));
    for (const [name, box_] of chain) {
      const own = cornersOf(box_).map((p) => put(project(size, p)));
      const body = svg("path", {class: "body " + (name === "tool" ? "tool" : ""), "data-body": name, d: faces.map((f) => f.map((k, i) => (i ? "L" : "M") + own[k].map((v) => v.toFixed(1)).join(" ")).join("") + "z").join("")});
      const tip = svg("title");
      tip.textContent = name === "tool" || name === "bed" ? say("space." + name) : name;
      body.append(tip);
      picture.append(body);
    }
    const corner = corners.map(put);
    for (let k = 0; k < 8; k++) for (let i = 0; i < 3; i++) if (!(k & (1 << i)) && size[i] > 0) edge(corner[k], corner[k | (1 << i)]);
    const labels = [];
    const label = (name, [x, y]) => {  // names that would overlap share one label
      const near = labels.find((l) => Math.hypot(l.x - x, l.y - y) < 24);
      if (!near) labels.push({x, y, names: [name]});
      else if (!near.names.includes(name)) near.names.push(name);
    };
    lines.forEach((line) => {
      const m = data.lanes ? data.lanes.indexOf(line.id) : lines.indexOf(line), rows = data.target.map((t, i) => i).filter((i) => data.measurement[i] === m);
      if (rows.length === 0) return;
      const targets = rows.map((i) => data.target[i]), first = Math.min(...targets), last = Math.max(...targets), mean = new Map();
      for (const i of rows) {
        const s = mean.get(data.target[i]) || [0, 0, 0];
        mean.set(data.target[i], [s[0] + 1, s[1] + data.residual[i], s[2] + data.deviation[i]]);
      }
      const across = (a, b) => { const d = [b[0] - a[0], b[1] - a[1]], l = Math.hypot(...d) || 1; return [-d[1] / l, d[0] / l]; };
      const from = place(line.from), to = place(line.to), side = across(from, to);
      const points = [...mean.entries()].sort((a, b) => a[0] - b[0]).map(([t, [n, r, d]]) => {
        const f = last > first ? (t - first) / (last - first) : 0, p = [0, 1].map((i) => from[i] + f * (to[i] - from[i]));
        const off = (times * 30 * (d / n)) / (Math.max(...data.deviation.map(Math.abs)) || 1);
        const put_ = [p[0] + off * side[0], p[1] + off * side[1]], where = line.from.map((v, i) => v + f * (line.to[i] - v));
        values.push([line.id, ...where, d / n, r / n]);
        frame.points.push([...put_, -1, [line.id, where.map((v, i) => `${"XYZ"[i]} ${short(v)}`).join(", ") + " mm", `${say("column.residual", {unit: shown.unit})}: ${short(r / n)}`]]);
        return [...put_, r / n];
      });
      points.slice(1).forEach((p, k) => {
        const one = svg("line", {class: "in-space", x1: points[k][0].toFixed(1), y1: points[k][1].toFixed(1), x2: p[0].toFixed(1), y2: p[1].toFixed(1)});
        one.style.stroke = colour((p[2] + points[k][2]) / 2, most);
        picture.append(one);
      });
      label(line.id, points[points.length - 1]);
    });
    ["X", "Y", "Z"].forEach((name, i) => { if (size[i] > 0) label(name, place(low.map((v, j) => v + (i === j ? 1.06 * size[i] : 0)))); });
    for (const {x, y, names: all} of labels) {
      const onRight = x > 440, node = svg("text", {x: (onRight ? x - 4 : x + 4).toFixed(1), y: (y - 4).toFixed(1), "text-anchor": onRight ? "end" : "start"});
      node.textContent = all.join(", ");
      picture.append(node);
    }
    const worst = lines.map((line) => { const m = data.lanes ? data.lanes.indexOf(line.id) : lines.indexOf(line), rows = data.residual.filter((r, i) => data.measurement[i] === m); return [line.id, rows.length, Math.sqrt(rows.reduce((s, r) => s + r * r, 0) / (rows.length || 1))]; }).sort((a, b) => b[2] - a[2]);
    charts.add(frame);
    by("space-chain").textContent = say("space.chain", {chain: [say("space.bed"), ...["X", "Y", "Z"].filter((n) => names.includes(n)), say("space.tool")].join(" \u2013 "), structure: say("space.is_" + structure)});
    fill(by("space-table"), el("table", {}, el("thead", {}, el("tr", {}, el("th", {scope: "col"}, say("space.line")), el("th", {scope: "col", class: "number"}, say("next.readings")), el("th", {scope: "col", class: "number"}, `RMS / ${shown.unit}`))), el("tbody", {}, ...worst.map(([id, n, r]) => el("tr", {}, el("th", {scope: "row"}, id), el("td", {class: "number"}, String(n)), el("td", {class: "number"}, short(r)))))));
  }
  return {draw};
})();
