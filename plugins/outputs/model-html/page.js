// SPDX-License-Identifier: Apache-2.0
// Script of the stored page, which contains its data. It updates the figures (draw.js) when
// effects, directions or runs are switched off or on. The fragment of the URL stores what is off.
"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const words = data.words, n = data.residual.length;
  const out = {e: new Set(), d: new Set(), r: new Set()};
  const runs = [...new Set(data.run)].sort((a, b) => a - b);
  const figure = (k) => document.getElementById("picture-" + k);
  const pictures = nonioPictures({figure, tip: document.getElementById("tip"), hidden: out});
  const {number, text, finite} = pictures;
  let residual = data.residual;

  // ---- residuals without some effects: for one effect, from a fit of the others; for several
  // effects, their fitted parts are added to the residuals, and the zero of each measurement is
  // updated ----
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
  }

  function rms() {
    let squares = 0, weight = 0;
    for (const i of pictures.shown) {
      squares += data.weight[i] * residual[i] * residual[i];
      weight += data.weight[i];
    }
    return weight > 0 ? Math.sqrt(squares / weight) : NaN;
  }

  function draw() {
    work();
    pictures.draw(residual);
    const whole = out.d.size === 0 && out.r.size === 0 && refitted;
    const now = whole ? refitted.rms : rms(), all = out.e.size === 0;
    const names = [...out.e].sort((a, b) => a - b).map((e) => data.effects[e].name).join(", ");
    document.getElementById("rms").textContent =
      (finite(now) ? text(words.rms_now, {rms: number(now, 2), unit: data.unit, count: pictures.shown.filter(pictures.counted).length}) : words.no_readings) +
      (all ? "" : " " + text(refitted ? words.without : words.not_refitted, {effects: names})) +
      (whole && finite(refitted.cv_rms) ? " " + text(words.without_cv, {rms: number(refitted.cv_rms, 2), unit: data.unit}) : "");
  }

  // ---- selection of effects, directions and runs: checkboxes and URL fragment ----
  function remember() {
    const list = [];
    for (const kind in out) for (const v of [...out[kind]].sort()) list.push(kind + v);
    try {
      history.replaceState(null, "", list.length ? "#" + list.join(",") : location.pathname);
    } catch (e) {
      // browsers may not allow a local page to change its URL; the selection is then not stored
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

  window.addEventListener("hashchange", () => {
    recall();
    draw();
  });
  pictures.set(data);
  recall();
  draw();
})();
