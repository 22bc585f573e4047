// ---- in space: the volume, its lines and diagonals coloured by residual, deviations exaggerated by a slider ----
const space = (() => {
  let turn = 35, lift = 25, times = 0;
  function colour(v, most) {
    const t = Math.max(-1, Math.min(1, v / (most || 1))), strength = Math.round(30 + 70 * Math.abs(t));
    return `color-mix(in srgb, var(${t >= 0 ? "--minus" : "--plus"}) ${strength}%, var(--band))`;
  }
  function project(size, p) {
    const c = p.map((v, i) => (size[i] > 0 ? v - size[i] / 2 : 0)), a = (turn * Math.PI) / 180, b = (lift * Math.PI) / 180;
    const x = c[0] * Math.cos(a) - c[1] * Math.sin(a), y = c[0] * Math.sin(a) + c[1] * Math.cos(a);
    return [x, -(c[2] * Math.cos(b) + y * Math.sin(b))];
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
    const scale = 400 / Math.max(1, ...corners.map((c) => 2 * Math.abs(c[0])), ...corners.map((c) => 3 * Math.abs(c[1])));
    const place = (p) => { const [x, y] = at(p); return [260 + x * scale, 170 + y * scale]; };
    const picture = svg("svg", {viewBox: "0 0 520 340", role: "img", "aria-label": say("space.alt", {n: lines.length, most: short(most), unit: shown.unit})});
    const edge = (a, b) => picture.append(svg("line", {class: "rule edge", x1: a[0].toFixed(1), y1: a[1].toFixed(1), x2: b[0].toFixed(1), y2: b[1].toFixed(1)}));
    const corner = corners.map(([x, y]) => [260 + x * scale, 170 + y * scale]);
    for (let k = 0; k < 8; k++) for (let i = 0; i < 3; i++) if (!(k & (1 << i)) && size[i] > 0) edge(corner[k], corner[k | (1 << i)]);
    ["X", "Y", "Z"].forEach((name, i) => {
      if (size[i] <= 0) return;
      const end = place(low.map((v, j) => v + (i === j ? 1.06 * size[i] : 0))), node = svg("text", {x: end[0].toFixed(1), y: end[1].toFixed(1), "text-anchor": "middle"});
      node.textContent = name;
      picture.append(node);
    });
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
        return [p[0] + off * side[0], p[1] + off * side[1], r / n];
      });
      points.slice(1).forEach((p, k) => {
        const one = svg("line", {class: "in-space", x1: points[k][0].toFixed(1), y1: points[k][1].toFixed(1), x2: p[0].toFixed(1), y2: p[1].toFixed(1)});
        one.style.stroke = colour((p[2] + points[k][2]) / 2, most);
        const tip = svg("title");
        tip.textContent = `${line.id}: ${short(p[2])} ${shown.unit}`;
        one.append(tip);
        picture.append(one);
      });
      const end = points[points.length - 1], name = svg("text", {x: (end[0] + 4).toFixed(1), y: end[1].toFixed(1)});
      name.textContent = line.id;
      picture.append(name);
    });
    const slider = (id, word, value, min, max, set) => el("label", {}, say(word) + " ", el("input", {type: "range", id, min, max, step: "any", value, "data-key": id, oninput: (e) => { set(Number(e.target.value)); redraw(); }}));
    const worst = lines.map((line) => { const m = data.lanes ? data.lanes.indexOf(line.id) : lines.indexOf(line), rows = data.residual.filter((r, i) => data.measurement[i] === m); return [line.id, rows.length, Math.sqrt(rows.reduce((s, r) => s + r * r, 0) / (rows.length || 1))]; }).sort((a, b) => b[2] - a[2]);
    const box = by("space-view");
    if (!box.querySelector("#space-times")) box.replaceChildren(el("div", {id: "space-picture"}), el("div", {class: "sliders"}, slider("space-times", "space.times", times, 0, 3, (v) => (times = v)), slider("space-turn", "space.turn", turn, -180, 180, (v) => (turn = v)), slider("space-lift", "space.lift", lift, -10, 90, (v) => (lift = v))), el("p", {class: "muted"}, say("space.legend")), el("div", {id: "space-table"}));
    by("space-picture").replaceChildren(picture);
    fill(by("space-table"), el("table", {}, el("thead", {}, el("tr", {}, el("th", {scope: "col"}, say("space.line")), el("th", {scope: "col", class: "number"}, say("next.readings")), el("th", {scope: "col", class: "number"}, `RMS / ${shown.unit}`))), el("tbody", {}, ...worst.map(([id, n, r]) => el("tr", {}, el("th", {scope: "row"}, id), el("td", {class: "number"}, String(n)), el("td", {class: "number"}, short(r)))))));
  }
  return {draw};
})();
