// ---- single readings: their origin, regions of readings, and exclusion with a reason ----
const readings = (() => {
  let first = 0, columns = null;
  /// The row in the files of the reading at place `i` of the page.
  const rowOf = (shown, i) => (shown.fit.page.row ? shown.fit.page.row[i] : i);
  const excludedIn = (state, shown) => (state.excluded || []).filter((e) => e.part === shown.part);

  /// A form that excludes readings; it requires a reason.
  function form(count, send) {
    const why = el("input", {"data-key": "why", maxlength: 200, autocomplete: "off", required: true, "aria-label": say("exclude.why")});
    const problem = el("p", {class: "flag", role: "alert"});
    return el("form", {class: "exclude", onsubmit: (event) => {
      event.preventDefault();
      if (why.value.trim() === "") problem.textContent = say("exclude.needs");
      else send(why.value.trim());
    }}, el("label", {}, say("exclude.why") + " ", why), el("button", {type: "submit", class: "exclude-do"}, say("exclude.do", {n: count})), problem);
  }
  /// Details of the selected reading: file, line, values.
  function openOne(shown, pictures, i, act) {
    const data = shown.fit.page, lines = pictures.about(i);
    view.dialog(say("reading.title"), el("ul", {class: "plain"}, ...lines.map((t) => el("li", {}, t))), form(1, (why) => act.exclude([rowOf(shown, i)], why)),
      el("div", {class: "buttons"}, el("button", {type: "button", onclick: () => by("dialog").close()}, say("dialog.close"))));
  }

  /// A region by its ends, for people who cannot drag.
  function regionForm(shown, choose) {
    const names = {position: "target", time: "time", run: "run", temperature: "temperature", residual: "residual"};
    const kinds = Object.keys(names).filter((k) => shown.fit.page[names[k]]);
    const kind = el("select", {"aria-label": say("region.by"), "data-key": "region-by"}, ...kinds.map((k) => el("option", {value: k}, say("x." + k))));
    const from = el("input", {inputmode: "decimal", size: 7, "aria-label": say("region.from"), "data-key": "region-from"});
    const to = el("input", {inputmode: "decimal", size: 7, "aria-label": say("region.to"), "data-key": "region-to"});
    return el("form", {class: "region-form", onsubmit: (event) => {
      event.preventDefault();
      const values = shown.fit.page[names[kind.value]], low = typed(from.value), high = typed(to.value);
      const rows = [];
      values.forEach((v, i) => finite(v) && !(v < low) && !(v > high) && rows.push(i));
      choose(rows);
    }}, say("region.choose") + " ", kind, " ", from, " \u2026 ", to, " ", el("button", {type: "submit"}, say("region.do")));
  }
  function drawRegion(state, shown, rows, act) {
    const box = by("region");
    if (!shown.fit || shown.looks) return fill(box);
    if (rows.length === 0) return fill(box, el("details", {}, el("summary", {}, say("region.summary")), regionForm(shown, act.select)));
    const data = shown.fit.page, squares = rows.reduce((s, i) => s + data.residual[i] ** 2, 0), mean = rows.reduce((s, i) => s + data.residual[i], 0) / rows.length;
    fill(box, el("div", {class: "note"}, el("p", {}, el("b", {}, say("region.chosen", {n: rows.length, all: data.residual.length, rms: short(Math.sqrt(squares / rows.length)), mean: short(mean), unit: shown.unit}))),
      form(rows.length, (why) => act.exclude(rows.map((i) => rowOf(shown, i)), why)), el("button", {type: "button", id: "region-clear", onclick: () => act.select([])}, say("region.clear"))));
  }

  /// All readings in a table of 25 per page, and the excluded ones.
  function drawTable(state, shown, act) {
    const box = by("readings-list");
    if (!shown.fit || shown.looks) return fill(box);
    const data = shown.fit.page, n = data.residual.length, size = 25, gone = excludedIn(state, shown);
    first = Math.min(first, Math.max(0, n - 1));
    const sign = (d) => (d > 0 ? "+" : d < 0 ? "\u2212" : "?"), cell = (v) => el("td", {class: "number"}, finite(v) ? local(v.toFixed(3)) : "\u2013");
    const rows = [];
    for (let i = first; i < Math.min(n, first + size); i++)
      rows.push(el("tr", {}, el("th", {scope: "row"}, el("button", {type: "button", class: "link", "data-key": "reading" + i, onclick: () => act.open(i)}, `${data.files[data.measurement[i]] || ""}:${data.line[i]}`)),
        el("td", {class: "number"}, String(data.run[i])), el("td", {}, sign(data.direction[i])), cell(data.target[i]), cell(data.deviation[i]), cell(data.deviation[i] - data.residual[i]), cell(data.residual[i])));
    const head = ["file", "run", "direction", "target", "deviation", "model", "residual"].map((k) => el("th", {scope: "col", class: k === "file" || k === "direction" ? null : "number"}, say("column." + k, {unit: shown.unit, position: data.position_unit})));
    const turn = (to, word, off) => el("button", {type: "button", "data-key": word, disabled: off, onclick: () => {
      first = to;
      drawTable(state, shown, act);
    }}, say(word));
    const open = box.querySelector("details") && box.querySelector("details").open;
    fill(box, el("p", {}, gone.length ? say("readings.gone", {n: gone.length}) : say("readings.all", {n: (state.parts.find((p) => p.name === shown.part) || {}).readings || n})),
      gone.length ? el("ul", {class: "plain"}, ...gone.map((e) => el("li", {}, `${e.file || ""}:${e.line || ""} \u2013 ${e.why} `, el("button", {type: "button", "data-key": "back" + e.row, onclick: () => act.include([e.row])}, say("exclude.back"))))) : null,
      el("details", {open}, el("summary", {}, say("readings.table")), el("div", {class: "scroll", tabindex: 0, role: "region", "aria-label": say("readings.table")}, el("table", {}, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...rows))),
        el("div", {class: "buttons"}, turn(Math.max(0, first - size), "readings.before", first === 0), el("span", {}, `${first + 1}\u2013${Math.min(n, first + size)} / ${n}`), turn(first + size, "readings.after", first + size >= n)),
        el("button", {type: "button", onclick: (event) => copyTable(event.target, shown)}, say("readings.copy"))));
  }
  function copyTable(button, shown) {
    const data = shown.fit.page;
    const lines = data.residual.map((r, i) => [data.files[data.measurement[i]], data.line[i], data.run[i], data.direction[i], data.target[i], data.deviation[i], r].join(","));
    navigator.clipboard.writeText(["file,line,run,direction,target,deviation,residual", ...lines].join("\n")).then(() => (button.textContent = say("command.copied")));
  }

  // ---- more readings than the page receives: the server sends the minimum and maximum for each column of pixels ----
  const big = new Map();
  const axes = {0: "target", 2: "time", 3: "run", 4: "phase", 5: "temperature", 6: "model"};
  const isBig = (shown, k) => shown.thinned && axes[k] !== undefined && !(shown.looks && axes[k] === "model");
  async function drawBig(shown, k, x0, x1) {
    const figure = by("picture-" + k), drawing = figure.querySelector("svg");
    const width = Math.max(240, Math.round(figure.clientWidth));
    const query = new URLSearchParams({x: axes[k], y: shown.column, px: String(width)});
    if (finite(x0) && finite(x1)) for (const [name, v] of [["x0", x0], ["x1", x1]]) query.set(name, String(v));
    const times = shown.drawnTimes, series = await net.ask(`/api/parts/${encodeURIComponent(shown.part)}/series?${query}`);
    if (times !== shown.drawnTimes || series.x.length === 0) return;
    const old = big.get(k);
    if (old) old.plot.destroy();
    for (const node of figure.querySelectorAll(".zoom, .big")) node.remove();
    const holder = el("div", {class: "big", role: "group", tabindex: 0, "aria-label": say("big.label", {n: series.n, low: short(Math.min(...series.min.filter(finite))), high: short(Math.max(...series.max.filter(finite))), unit: shown.unit})});
    const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(name).trim();
    const data = shown.fit.page, axis = {stroke: colour("--text"), grid: {stroke: colour("--rule"), width: 0.5}, font: "11px Liberation Sans, Arial, sans-serif", size: 34, values: (u, splits) => splits.map((v) => (v === null ? "" : local(String(Number(v.toPrecision(9))))))};
    // The server's time is in seconds, also if the picture of the sample has another unit.
    const label = series.x_unit ? `${data.pictures[k].x.split(" / ")[0]} / ${shownUnit(series.x_unit)}` : data.pictures[k].x;
    drawing.classList.add("replaced");
    drawing.after(holder);
    const again = (a, b) => drawBig(shown, k, a, b).then(() => {
      requestAnimationFrame(() => setTimeout(() => performance.mark("zoomed")));
    }).catch((e) => e.status === 409 || view.alarm(e.message));
    const plot = new uPlot({width, height: 230, legend: {show: false}, scales: {x: {time: false}},
      cursor: {drag: {x: true, y: false, setScale: false}, points: {show: false}},
      series: [{}, {stroke: colour("--plus"), width: 1}, {stroke: colour("--plus"), width: 1}], bands: [{series: [2, 1], fill: colour("--band")}],
      axes: [{...axis, label, labelSize: 16, labelFont: axis.font}, {...axis, size: 46, label: shown.looks ? `${data.words.deviation} / ${data.unit}` : data.pictures[k].y, labelSize: 14, labelFont: axis.font}],
      hooks: {setSelect: [(u) => u.select.width > 4 && again(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"))]}},
      [series.x, series.min, series.max], holder);
    big.set(k, {plot, range: [x0, x1]});
    const ends = [series.x[0], series.x[series.x.length - 1]], span = ends[1] - ends[0];
    const zoom = (word, a, b) => el("button", {type: "button", class: "small", onclick: () => again(a, b)}, say(word));
    holder.addEventListener("keydown", (event) => {
      const to = {"+": [ends[0] + span / 4, ends[1] - span / 4], "-": [ends[0] - span / 2, ends[1] + span / 2], 0: [NaN, NaN], ArrowRight: [ends[0] + span / 4, ends[1] + span / 4], ArrowLeft: [ends[0] - span / 4, ends[1] - span / 4]}[event.key];
      if (!to) return;
      event.preventDefault();
      event.stopPropagation();
      again(...to).then(() => figure.querySelector(".big").focus({preventScroll: true}));
    });
    holder.after(el("div", {class: "zoom"}, zoom("big.in", ends[0] + span / 4, ends[1] - span / 4), zoom("big.out", ends[0] - span / 2, ends[1] + span / 2), zoom("big.left", ends[0] - span / 4, ends[1] - span / 4), zoom("big.right", ends[0] + span / 4, ends[1] + span / 4), zoom("big.all", NaN, NaN),
      el("span", {class: "muted"}, say("big.shown", {n: series.n}))));
  }
  /// An enlarged range is kept when the model changes.
  function drawAllBig(shown) {
    const data = shown.fit.page, all = [];
    for (let k = 0; k < 9; k++) {
      const figure = by("picture-" + k);
      if (isBig(shown, k) && !data.pictures[k].none) {
        all.push(drawBig(shown, k, ...((big.get(k) || {}).range || [])).catch((e) => e.status === 409 || view.alarm(e.message)));
      } else if (big.has(k)) {
        big.get(k).plot.destroy();
        big.delete(k);
        for (const node of figure.querySelectorAll(".zoom, .big")) node.remove();
        figure.querySelector("svg").classList.remove("replaced");
      }
    }
    return Promise.all(all);
  }
  /// Another part has other positions and times: enlarged ranges are reset.
  function forget() {
    for (const one of big.values()) one.range = [];
  }
  return {openOne, drawRegion, drawTable, drawAllBig, isBig, forget};
})();
