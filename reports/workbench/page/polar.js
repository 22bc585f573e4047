// SPDX-License-Identifier: Apache-2.0
// Circles as with a ball bar: readings and model, magnified on one ring, and residuals on another;
// one plot per plane. Used by stored pages and the live page.
"use strict";
/// figure(name): element of "polar" or "rest", may be null; charts: those of the page (chart.js);
/// value(i): residual of reading i, NaN without a model; rows: visible readings.
function nonioPolar({figure, data, rows, charts, value, number, text}) {
  const finite = Number.isFinite, {put, r1} = charts;
  const radius = data.circles || [], of_circle = rows.filter((i) => radius[data.measurement[i]]);
  for (const name of ["polar", "rest"]) if (figure(name)) figure(name).hidden = of_circle.length === 0;
  if (of_circle.length === 0) return;

  /// Each run in each direction has its own center and zero, from a circle through its readings.
  const paths = new Map();
  for (const i of of_circle) {
    const key = [data.measurement[i], data.run[i], data.direction[i]].join(" ");
    if (!paths.has(key)) paths.set(key, []);
    paths.get(key).push({i, t: data.target[i] / radius[data.measurement[i]]});
  }
  function centred(path, of) {
    const rows_ = [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]];
    for (const p of path) {
      const c = [Math.cos(p.t), Math.sin(p.t), 1];
      if (finite(of(p.i)) && data.weight[p.i] > 0)
        for (let a = 0; a < 3; a++) {
          for (let b = 0; b < 3; b++) rows_[a][b] += c[a] * c[b];
          rows_[a][3] += c[a] * of(p.i);
        }
    }
    for (let k = 0; k < 3; k++)
      for (let a = 0; a < 3; a++)
        if (a !== k && rows_[k][k]) {
          const f = rows_[a][k] / rows_[k][k];
          for (let b = k; b < 4; b++) rows_[a][b] -= f * rows_[k][b];
        }
    return rows_.map((row, k) => (row[k] ? row[3] / row[k] : 0));
  }
  const curves = {read: [], model: [], rest: []};
  let modelled = true;
  for (const path of paths.values()) {
    path.sort((a, b) => a.t - b.t);
    path.plane = data.circle_axes[data.measurement[path[0].i]];
    const look = data.direction[path[0].i] > 0 ? "plus" : "minus", [a, b, c] = centred(path, (i) => data.deviation[i]);
    const off = (p) => data.deviation[p.i] - a * Math.cos(p.t) - b * Math.sin(p.t) - c;
    modelled = modelled && path.every((p) => finite(value(p.i)));
    curves.read.push({look, path, r: path.map(off)});
    curves.model.push({look: "mean", path, r: path.map((p) => off(p) - value(p.i))});
    curves.rest.push({look, path, r: path.map((p) => value(p.i))});
  }
  if (!modelled) curves.model = curves.rest = [];
  const planes = [...new Set([...paths.values()].map((path) => path.plane))];

  /// Size of a ring division, um: three divisions contain the largest value.
  function division(all) {
    let largest = 0;
    for (const c of all) for (const v of c.r) if (finite(v)) largest = Math.max(largest, Math.abs(v));
    const least = Math.max(largest, 0.003) / 3, power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 5, 10].map((k) => k * power).find((v) => v >= least * (1 - 1e-9));
  }
  function draw(name, all, says) {
    const holder = figure(name);
    if (!holder) return;
    holder.hidden = all.length === 0;
    if (holder.hidden) return;
    const svg = holder.querySelector("svg"), size = 320, middle = size / 2, ring = 19.5, each = division(all);
    const places = {division: number(each, Math.max(0, -Math.floor(Math.log10(each)))), unit: data.unit};
    holder.querySelector("figcaption b").textContent = text(data.words[name + "_title"], places);
    [...holder.querySelectorAll("figcaption p")].pop().textContent = text(says, places);
    svg.setAttribute("aria-label", text(data.words[name + "_title"], places));
    svg.setAttribute("viewBox", `0 0 ${size} ${size * planes.length}`);
    svg.replaceChildren();
    const frame = {svg, g: svg, k: name, x: 0, y: 0, w: size, h: size * planes.length, points: [], said: {x: "deg", y: data.unit}, series: []};
    for (const [row, plane] of planes.entries()) {
      const top = row * size, y = top + middle;
      for (let k = 1; k <= 7; k++) put(svg, "circle", {class: k === 4 ? "zero" : "rule ring", cx: middle, cy: y, r: k * ring});
      for (const d of [`M4 ${y}H${size - 4}`, `M${middle} ${top + 4}V${top + size - 4}`]) put(svg, "path", {class: "rule", d});
      put(svg, "text", {x: size - 2, y: y - 4, "text-anchor": "end"}, "+" + plane[0]);
      put(svg, "text", {x: middle + 4, y: top + 11}, "+" + plane[1]);
    }
    const at = (p, r, top) => [middle + (4 + r / each) * ring * Math.cos(p.t), top + middle - (4 + r / each) * ring * Math.sin(p.t)];
    for (const {look, path, r} of all) {
      const top = planes.indexOf(path.plane) * size;
      let d = "", last = NaN;
      frame.series.push([`${look} ${path.plane}`, path.map((p) => (p.t * 180) / Math.PI), r]);
      path.forEach((p, j) => {
        if (!finite(r[j])) return;
        const [x, y] = at(p, r[j], top);
        d += (p.t - last < 0.2 ? "L" : "M") + r1(x) + " " + r1(y);
        last = p.t;
        if (look !== "mean") frame.points.push([x, y, p.i]);
      });
      const whole = path[0].t + 2 * Math.PI - path[path.length - 1].t < 0.2;
      put(svg, "path", {class: "line " + look, d: d + (whole ? "z" : "")});
    }
    charts.add(frame);
  }
  draw("polar", [...curves.read, ...curves.model], data.words.polar_says);
  draw("rest", curves.rest, data.words.rest_says);
}
