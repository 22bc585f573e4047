// ---- single readings: their source, regions of readings, exclusion with a reason ----
const readings = (() => {
  let first = 0, columns = null;
  /// Row in the files of reading i of the page.
  const rowOf = (shown, i) => (shown.fit.page.row ? shown.fit.page.row[i] : i);
  const excludedIn = (state, shown) => (state.excluded || []).filter((e) => e.part === shown.part);

  /// Form that excludes readings; a reason is required.
  function form(count, send) {
    const why = el("input", {"data-key": "why", maxlength: 200, autocomplete: "off", required: true, "aria-label": say("exclude.why")});
    const problem = el("p", {class: "flag", role: "alert"});
    return el("form", {class: "exclude", onsubmit: (event) => {
      event.preventDefault();
      if (why.value.trim() === "") problem.textContent = say("exclude.needs");
      else send(why.value.trim());
    }}, el("label", {}, say("exclude.why") + " ", why), el("button", {type: "submit", class: "exclude-do"}, say("exclude.do", {n: count})), problem);
  }
  /// Dialog of the selected reading: file, line, values.
  function openOne(shown, pictures, i, act) {
    const data = shown.fit.page, lines = pictures.about(i);
    view.dialog(say("reading.title"), el("ul", {class: "plain"}, ...lines.map((t) => el("li", {}, t))), form(1, (why) => act.exclude([rowOf(shown, i)], why)),
      el("div", {class: "buttons"}, el("button", {type: "button", onclick: () => by("dialog").close()}, say("dialog.close"))));
  }

  /// Form that selects a region by its ends, as alternative to dragging.
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

  /// All readings in a table, 25 per page, and the excluded ones.
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

  // ---- more readings than on a page: minimum and maximum per pixel column from the server ----
  const big = new Map();
  const axes = {0: "target", 2: "time", 3: "run", 4: "phase", 5: "temperature", 6: "model"};
  const isBig = (shown, k) => shown.thinned && axes[k] !== undefined && !(shown.looks && axes[k] === "model");
  async function drawBig(shown, pictures, k, range) {
    const figure = by("picture-" + k), query = new URLSearchParams({x: axes[k], y: shown.column, px: String(Math.max(240, Math.round(figure.clientWidth)))});
    if (range) for (const [j, name] of ["x0", "x1"].entries()) query.set(name, String(range[j]));
    const times = shown.drawnTimes, series = await net.ask(`/api/parts/${encodeURIComponent(shown.part)}/series?${query}`);
    if (times !== shown.drawnTimes || series.x.length === 0) return;
    const data = shown.fit.page, xs = series.x, [low, high] = [series.min, series.max], ends = [Math.min(...low.filter(finite)), Math.max(...high.filter(finite))];
    // The server sends the time in s, in any unit of the figure.
    const {whole} = pictures.between(k, {xs, low, high, whole: range && (big.get(k) || {}).whole, x: series.x_unit ? `${data.pictures[k].x.split(" / ")[0]} / ${shownUnit(series.x_unit)}` : data.pictures[k].x,
      y: shown.looks ? `${data.words.deviation} / ${data.unit}` : data.pictures[k].y, about: (j) => [`${local(String(Number(xs[j].toPrecision(6))))}: ${short(low[j])} \u2026 ${short(high[j])} ${shown.unit}`]});
    big.set(k, {whole, range});
    by(`big-${k}`).textContent = say("big.shown", {n: series.n, low: short(ends[0]), high: short(ends[1]), unit: shown.unit});
    requestAnimationFrame(() => setTimeout(() => performance.mark("zoomed")));
  }
  const drawAgain = (...of) => drawBig(...of).catch((e) => e.status === 409 || view.alarm(e.message));
  /// A zoomed figure stays zoomed if the model changes.
  function drawAllBig(shown, pictures) {
    const all = [];
    for (let k = 0; k < 9; k++)
      if (isBig(shown, k) && !shown.fit.page.pictures[k].none) all.push(drawAgain(shown, pictures, k, (big.get(k) || {}).range));
      else {
        big.delete(k);
        by(`big-${k}`).textContent = "";
      }
    return Promise.all(all);
  }
  return {openOne, drawRegion, drawTable, drawAllBig, drawAgain, isBig, forget: () => big.clear()};
})();
