// SPDX-License-Identifier: Apache-2.0
// Script of the stored page, which contains its data. It updates the figures (draw.js) and the numbers
// of the fit when effects, directions or runs are switched off or on. All that is shown is of one fit:
// what is known of the whole model only is hidden meanwhile. The fragment of the URL stores what is off.
"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const words = data.words, n = data.residual.length;
  const out = {e: new Set(), d: new Set(), r: new Set()};
  const runs = [...new Set(data.run)].sort((a, b) => a - b);
  const figure = (k) => document.getElementById("picture-" + k);
  const pictures = nonioPictures({figure, tip: document.getElementById("tip"), hidden: out});
  const {number, text, finite} = pictures;

  /// The fit that is shown: for one effect less, the fit of the others; for several effects less,
  /// their fitted parts are added to the residuals, and the zero of each measurement is updated.
  function fit_shown() {
    if (out.e.size === 0) return data;
    const refitted = out.e.size === 1 && data.effects[[...out.e][0]].without;
    if (refitted) return {...data, ...refitted, refitted: true};
    const residual = data.residual.slice(), sum = new Map(), weight = new Map();
    for (const e of out.e) data.effects[e].says.forEach((v, i) => (residual[i] += v));
    const add = (map, key, v) => map.set(key, (map.get(key) || 0) + v);
    for (let i = 0; i < n; i++) {
      add(sum, data.measurement[i], data.weight[i] * (residual[i] - data.residual[i]));
      add(weight, data.measurement[i], data.weight[i]);
    }
    for (let i = 0; i < n; i++) {
      const all = weight.get(data.measurement[i]);
      if (all > 0) residual[i] -= sum.get(data.measurement[i]) / all;
    }
    return {...data, residual, left_out: null, rms: null, cv_rms: null, largest: null};
  }

  /// RMS, number and largest residual of the readings shown. If these are all, the fit states them,
  /// because a page of very many readings contains a sample.
  function numbers(fit) {
    if (out.d.size === 0 && out.r.size === 0 && finite(fit.rms)) return {rms: fit.rms, count: fit.readings, largest: fit.largest, cv_rms: fit.cv_rms};
    let squares = 0, weight = 0, largest = 0;
    for (const i of pictures.shown) {
      const v = fit.residual[i];
      squares += fit.weight[i] * v * v;
      weight += fit.weight[i];
      if (fit.weight[i] > 0 && Math.abs(v) > Math.abs(largest)) largest = v;
    }
    return {rms: weight > 0 ? Math.sqrt(squares / weight) : NaN, count: pictures.shown.filter(pictures.counted).length, largest};
  }

  function draw() {
    const fit = fit_shown(), whole = out.e.size === 0;
    pictures.set(fit);
    pictures.draw(fit.residual);
    const {rms, count, largest, cv_rms} = numbers(fit), unit = data.unit;
    const names = [...out.e].sort((a, b) => a - b).map((e) => data.effects[e].name).join(", ");
    const sentences = [finite(rms) ? text(words.rms_now, {rms: number(rms, 2), unit, count}) + " " + text(words.largest, {value: number(largest, 2), unit}) : words.no_readings];
    if (finite(cv_rms)) sentences.push(text(words.without_cv, {rms: number(cv_rms, 2), unit}));
    if (!whole) sentences.push(text(fit.refitted ? words.without : words.not_refitted, {effects: names}), words.of_whole);
    document.getElementById("rms").textContent = sentences.join(" ");
    for (const part of document.querySelectorAll(".whole")) part.hidden = !whole;
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
  recall();
  draw();
})();
