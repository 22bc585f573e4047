// ---- the page of a campaign: the server has the state, this page shows it and requests changes ----
(() => {
  view.build();
  let state = null, busy = 0, job = null, again = false, asking = false;
  /// The data that are shown: one part, its fit, and the result of explain.
  const shown = {part: sessionStorage.getItem("nonio-part"), effect: null, drawing: "residual", version: 0, fitted: [], unit: "", column: "residual", etags: {}, of: {},
    /// Effects that were not separable from an effect when it was added: also with the verdict "complete" they may be the cause.
    aliases: JSON.parse(sessionStorage.getItem("nonio-aliases") || "{}")};
  const hidden = {d: new Set(), r: new Set()};
  const pictures = nonioPictures({figure: (k) => by("picture-" + k), tip: by("tip"), hidden,
    inTurn: () => performance.mark("all"), elsewhere: (k) => readings.isBig(shown, k), enlarged: (k, range) => readings.drawAgain(shown, pictures, k, range),
    pick: (i) => readings.openOne(shown, pictures, i, act), brushed: (rows) => region(rows), said: (lines) => view.speak(lines.join(", "))});
  const part = () => state.parts.find((p) => p.name === shown.part);
  /// All inputs of a fit, because results of another trial must not be shown for this one.
  const trial = () => JSON.stringify([state.campaign.read_at, state.model, (state.excluded || []).map((e) => [e.part, e.row]), state.period_mm]);
  const path = (what) => `/api/parts/${encodeURIComponent(shown.part)}/${what}`;

  // ---- requests to the server ----
  async function post(what, body, then) {
    outcome("");
    busy++;
    document.body.classList.add("busy");
    try {
      const answer = await net.ask("/api/" + what, {body});
      view.alarm("");
      if (then) then(answer);
      await refresh();
      return answer;
    } catch (e) {
      complain(e);
    } finally {
      if (--busy === 0) document.body.classList.remove("busy");
    }
  }
  function complain(e) {
    if (e.answer && e.answer.id === "token" && !net.hasToken())
      return by("app").replaceChildren(el("main", {class: "lost"}, el("h1", {}, say("shell.title")), el("p", {role: "alert"}, say("net.no_token"))));
    fresh = true;
    draw();
    fresh = false;
    if (e instanceof net.Refused) view.alarm(e.message, " ", view.button("alarm-close", "dialog.close", {onclick: () => view.alarm("")}));
    else lost(0);
  }
  function lost(status) {
    view.alarm(status === 403 ? say("net.other") : say("net.lost", {at: new Date().toLocaleTimeString(language)}));
    document.body.classList.add("lost");
  }
  /// The result of "suggest" or "finish" until the next action, as text and for screen readers.
  function outcome(text) {
    const place = by("outcome");
    place.hidden = text === "";
    place.textContent = text;
    if (text) view.speak(text);
  }
  function running(n) {
    job = n;
    by("cancel").hidden = n === null;
    for (const id of ["suggest", "finish"]) by(id).disabled = n !== null || Boolean(shown.none);
  }
  /// Requests one result of the server for this part and trial, and gives it to `take`; an answer for another part or
  /// trial is dropped. A request during one of the same result repeats it afterwards, unless it was answered.
  const under_way = new Map();
  async function piece(name, take, query = "") {
    const part_ = shown.part, of = trial(), key = [name, part_, of].join("\n");
    if (under_way.has(key)) return under_way.set(key, true);
    under_way.set(key, false);
    try {
      const known = shown.etags[name], etag = known && known.part === part_ ? known.etag : null;
      const answer = await net.ask(path(name) + query, {none: etag});
      if (shown.part !== part_ || trial() !== of) return;
      if (answer) shown.etags[name] = {part: part_, etag: answer.etag};
      shown.of[name] = of;
      await take(answer, of);
    } catch (e) {
      if (shown.part !== part_ || trial() !== of) return;
      if (e.status !== 409) shown.of[name] = of;
      if (e.status !== 409 && e.status !== 422) throw e;
    } finally {
      const again = under_way.get(key);
      under_way.delete(key);
      if (again && shown.of[name] !== of) piece(name, take, query).catch(complain);
    }
  }
  /// Requests the state and then the results that belong to it. An event during the request repeats it once.
  async function refresh() {
    if (asking) {
      again = true;
      return;
    }
    asking = true;
    try {
      do {
        again = false;
        const next = await net.ask("/api/state");
        if (state && next.engine !== state.engine) location.reload();
        state = next;
        if (state.bench === "opening") view.speak(say("bench.opening"));
        if (!part()) choosePart(state.parts.length ? state.parts[0].name : null);
        if (shown.part) pieces();
        draw();
      } while (again);
      document.body.classList.remove("lost");
    } finally {
      asking = false;
    }
  }
  function pieces() {
    const of = (state.parts_state || {})[shown.part] || {fit: "done", explain: "done"};
    shown.error = of.fit === "failed" || of.explain === "failed" ? (of.error ? net.program(of.error) : say("net.failed")) : null;
    shown.seconds = of.seconds || 0;
    running(state.job ? state.job.job : null);
    const ask = (...one) => piece(...one).catch(complain), due = (name) => shown.of[name] !== trial();
    if (!shown.fit && of.fit !== "done" && due("look")) ask("look", takeLook);
    if (due("picture")) {
      if (of.fit !== "failed" && state.bench === "open") ask("picture", takePicture);
    } else if (shown.fit.partial) ask("fit", takeRest, "?page=0");
    if (of.explain !== "done" && of.explain !== "none") stale();
    else if (due("explain")) ask("explain", takeExplanation);
    else if (due("fingerprints")) ask("fingerprints", takeFingerprints);
  }
  /// Shows the readings as measured until there is a fit.
  function takeLook(measured) {
    if (shown.fit) return;
    shown.looks = true;
    shown.fit = {page: measured.page, compare: null, text: {}};
    show(measured.version);
    draw();
  }
  function takePicture(fit, of) {
    if (fit) {
      shown.looks = false;
      shown.fit = fit;
      shown.fitted = fit.compare.model.effects;
    }
    shown.fitOf = of;
    const drawn = fit ? show(fit.version) : null;
    draw();
    if (drawn) drawn.then(() => painted("fitted"));
    if (shown.fit.partial) piece("fit", takeRest, "?page=0").catch(complain);
    else others();
  }
  /// The rest of the fit, with the positions where it fails; for many readings it arrives after the
  /// figure.
  function takeRest(rest) {
    if (!rest) return;
    shown.fit = {...rest, page: shown.fit.page};
    draw();
    others();
  }
  function others() {
    if (shown.of.without === trial()) return;
    piece("without", (without) => (shown.without = without.without)).catch(() => null).then(draw);
  }
  function takeExplanation(explain, of) {
    shown.explainOf = of;
    shown.explain = explain.explain;
    for (const c of shown.explain.candidates || []) if (c.aliases.length) shown.aliases[c.effect] = c.aliases;
    sessionStorage.setItem("nonio-aliases", JSON.stringify(shown.aliases));
    if (!shown.effect && !learn.on) shown.effect = (shown.explain.verdict || {}).effect || null;
    draw();
    piece("fingerprints", takeFingerprints).catch(() => null).then(draw);
  }
  function takeFingerprints(says) {
    shown.fingerprints = says.fingerprints;
    shown.whatIf = says.what_if;
    if (shown.fit) drawPictures();
    draw();
  }
  /// Sets a performance mark after the frame that shows the page; measurements of speed read it.
  const painted = (name) => requestAnimationFrame(() => setTimeout(() => performance.mark(name)));
  function show(version) {
    const page = shown.fit.page, all = shown.looks ? part().readings : shown.fit.compare.observations;
    shown.version = version;
    shown.drawnTimes = (shown.drawnTimes || 0) + 1;
    shown.unit = page.unit;
    shown.all = all;
    shown.thinned = page.residual.length < all;
    shown.column = shown.looks ? "deviation" : "residual";
    pictures.set(page);
    legends();
    drawPictures();
    const big = readings.drawAllBig(shown, pictures);
    big.then(() => painted("picture"));
    return big;
  }
  function stale() {
    shown.explain = null;
    delete shown.of.explain;
    delete shown.of.fingerprints;
  }
  function choosePart(name) {
    shown.part = name;
    sessionStorage.setItem("nonio-part", name || "");
    Object.assign(shown, {fit: null, explain: null, without: null, fingerprints: null, whatIf: null, effect: null, etags: {}, fitted: [], of: {}, fitOf: null, explainOf: null, looks: false});
    readings.forget();
  }

  // ---- drawing ----
  function legends() {
    const fit = shown.fit.page.fit;
    by("picture-fit-title").textContent = fit.title;
    by("picture-fit-says").textContent = fit.says;
    by("picture-fit").hidden = fit.none !== "";
    shown.fit.page.pictures.forEach((p, k) => {
      const figure = by("picture-" + k);
      by(`picture-${k}-title`).textContent = p.title || "";
      by(`picture-${k}-says`).textContent = p.says || "";
      const old = figure.querySelector(".none");
      if (old) old.remove();
      figure.querySelector("svg").classList.toggle("replaced", p.none !== "");
      if (p.none) figure.querySelector("svg").after(el("p", {class: "none"}, p.none));
    });
    const data = shown.fit.page, thinned = shown.thinned;
    by("legend").textContent = shown.looks ? say("legend.measured", {n: shown.all}) : [say("legend.all"), finite(data.floor) ? say("legend.floor", {s: short(data.floor), unit: data.unit}) : say("bar.no_floor"), data.suspects.length ? say("legend.suspects", {n: data.suspects.length}) : "", thinned ? say("legend.thinned", {n: data.residual.length, all: shown.all}) : ""].filter(Boolean).join(" ");
  }
  /// Residual, deviation, or the deviation predicted after compensation by a table of the control.
  function values() {
    const data = shown.fit.page;
    if (shown.looks) return data.deviation;
    if (shown.drawing === "residual") return data.residual;
    const taken = shown.drawing === "table" ? data.effects.filter((e) => (state.catalogue.find((c) => c.effect === e.name) || {}).compensable) : [];
    return data.deviation.map((d, i) => d - taken.reduce((s, e) => s + (e.says[i] || 0), 0));
  }
  function drawPictures() {
    if (!shown.fit) return;
    const all = shown.learning ? [] : shown.fingerprints || [];
    const over = shown.preview || (state.model.includes(shown.effect) ? null : shown.effect), says = over && (all.find((f) => f.effect === over) || shown.fit.page.effects.find((e) => e.name === over));
    pictures.ghost(says && says.says.length === shown.fit.page.residual.length ? says.says : null);
    const data = shown.fit.page;
    pictures.draw(values(), shown.looks || shown.drawing !== "residual" ? `${data.words.deviation} / ${data.unit}` : "", shown.looks);
    by("legend-ghost").textContent = says ? say("legend.ghost", {effect: over}) : "";
  }
  const figureOf = (where) => {
    const parts_of = where.split(" x ");
    for (const [name, k] of [["direction", 1], ["temperature", 5], ["time", 2], ["run", 3], ["screw-phase", 4], ["phase", 4], ["angle", 4], ["order", 2], ["position", 0], ["line", 0]]) if (parts_of.includes(name)) return k;
    return 0;
  };
  function drawPlaces() {
    const compare = shown.fit && !shown.fit.partial && shown.fit.compare, all = compare ? compare.left && compare.left.length ? compare.left : compare.fails || [] : [];
    for (let k = 0; k < 9; k++) {
      by("fails-" + k).textContent = "";
      by("picture-" + k).classList.remove("failing");
    }
    const items = shown.learning ? [] : all.map((f) => {
      const k = figureOf(f.where), share = Math.round(100 * f.share);
      by("picture-" + k).classList.add("failing");
      by("fails-" + k).textContent = " " + say("places.here", {share});
      return el("li", {}, el("button", {type: "button", class: "place", "data-where": f.where, "data-share": f.share, "data-key": "place-" + f.where, onclick: () => goPlace(f, k)}, typeset(f.says)), el("span", {class: "muted"}, ` ${share} %`));
    });
    fill(by("places-list"), shown.learning ? el("p", {class: "muted"}, say("learn.look")) : items.length ? el("ul", {class: "plain"}, ...items) : el("p", {class: "muted"}, compare ? say("places.nowhere") : say("verdict.fitting")));
  }
  /// Shows the figure of a position where the fit fails, and selects its readings.
  function goPlace(f, k) {
    const data = shown.fit.page, figure = by("picture-" + k);
    let rows = [];
    if (f.line && data.lanes) rows = data.measurement.flatMap((m, i) => (data.lanes[m] === f.line ? [i] : []));
    else if (finite(f.at_run)) rows = data.run.flatMap((r, i) => (r === f.at_run ? [i] : []));
    else if (finite(f.at_mm) || finite(f.at_deg)) {
      const at = finite(f.at_mm) ? f.at_mm : f.at_deg, near = Math.min(...data.target.map((t) => Math.abs(t - at)));
      rows = data.target.flatMap((t, i) => (Math.abs(t - at) <= near + 1e-9 ? [i] : []));
    }
    pictures.select(rows);
    region(rows);
    figure.scrollIntoView({block: "center", behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth"});
    figure.querySelector("svg").focus({preventScroll: true});
  }
  function region(rows) {
    readings.drawRegion(state, shown, rows, act);
    view.speak(rows.length ? say("region.said", {n: rows.length}) : "");
  }
  /// Predicted results after compensation by a table, as `nonio model compare` prints them.
  function tableWouldDo() {
    const compare = shown.fit && !shown.fit.partial && !shown.looks && !shown.fitIsOld && shown.fit.compare, predicted = compare && compare.after_table;
    if (!compare) return null;
    if (!predicted) return el("p", {id: "after-table"}, say("table.none"));
    const cell = (object, name) => el("td", {class: "number", "data-value": field(object, name)}, short(field(object, name)));
    const row = (name, was, is, key) => el("tr", {}, el("th", {scope: "row"}, name), cell(was, key), cell(is, key));
    const rows = predicted.tests.flatMap((t) => ["E", "A", "R"].map((name) => row(predicted.tests.length > 1 ? `${name} (${t.measurement})` : name, t.before, t.after, name)));
    const rms = el("tr", {}, el("th", {scope: "row"}, "RMS"), cell(predicted, "rms_before"), cell(predicted, "rms"));
    const compareIt = /^nonio model compare /.test(state.command) ? state.command : `${state.command} && nonio model compare ${quoted(state.campaign.folder)}`;
    return el("div", {id: "after-table"}, el("table", {}, el("caption", {}, say("table.title", {unit: shown.unit})), el("thead", {}, el("tr", {}, el("td"), el("th", {scope: "col", class: "number"}, say("table.before")), el("th", {scope: "col", class: "number"}, say("table.after")))), el("tbody", {}, ...rows, rms)),
      el("p", {class: "muted"}, say(predicted.tests.length ? "table.what" : "table.what_space", {effects: predicted.takes.join(", ")})), el("details", {class: "muted"}, el("summary", {}, say("site.did")), el("code", {}, compareIt)));
  }
  const quoted = (word) => (/^[\w\-./:=,+@%]+$/.test(word) ? word : "'" + word.replace(/'/g, "'\\''") + "'");
  function drawDrawn() {
    const kinds = ["residual", "deviation", "table"];
    const data = shown.fit && shown.fit.page, v = data ? values() : [], weights = data ? data.weight : [];
    const sum = weights.reduce((a, b) => a + b, 0), rms = Math.sqrt(v.reduce((s, x, i) => s + weights[i] * x * x, 0) / (sum || 1));
    const filters = data ? [["d", [[1, "+"], [-1, "\u2212"]].filter(([d]) => data.direction.includes(d)), "filter.directions"], ["r", [...new Set(data.run)].sort((a, b) => a - b).slice(0, 40).map((r) => [r, String(r)]), "filter.runs"]] : [];
    fill(by("drawn"), el("fieldset", {}, el("legend", {}, say("drawn.title")), ...kinds.map((k) => el("label", {}, el("input", {type: "radio", name: "drawn", value: k, "data-key": "drawn-" + k, checked: shown.drawing === k, onchange: () => {
      shown.drawing = k;
      drawDrawn();
      drawPictures();
    }}), " " + say("drawn." + k)))), data && shown.drawing === "deviation" ? el("p", {}, say("drawn.rms.deviation", {rms: short(rms), unit: shown.unit})) : null,
    shown.drawing === "table" ? tableWouldDo() : null,
    el("details", {open: hidden.d.size + hidden.r.size > 0 || null}, el("summary", {}, say("filter.title")), ...filters.map(([kind, all, word]) => el("fieldset", {}, el("legend", {}, say(word)), ...all.map(([v_, label]) => el("label", {}, el("input", {type: "checkbox", "data-key": kind + v_, checked: !hidden[kind].has(v_), onchange: (e) => {
      if (e.target.checked) hidden[kind].delete(v_);
      else hidden[kind].add(v_);
      drawPictures();
    }}), " " + label))))));
  }
  function drawPeriod() {
    const axis = (shown.part || "").split(" ")[0], now = (state.period_mm || {})[axis];
    const period = now !== undefined ? now : shown.fit && shown.fit.page.period;
    if (!shown.fit || shown.fit.page.position_unit !== "mm" || part().kind === "space") return fill(by("period"));
    const input = el("input", {inputmode: "decimal", size: 7, "data-key": "period", id: "period-value", value: finite(period) && period > 0 ? local(String(period)) : ""});
    fill(by("period"), el("form", {onsubmit: (event) => {
      event.preventDefault();
      const v = typed(input.value);
      if (!(v > 0)) return view.alarm(say("period.bad"));
      post("period", {axis, period_mm: v});
    }}, el("label", {}, say("period.title", {axis}) + " ", input, " mm "), el("button", {type: "submit"}, say("period.do"))));
  }
  function drawHead() {
    const m = state.campaign.machine || {};
    document.title = `${state.campaign.id} \u2013 Nonio`;
    by("campaign").textContent = state.campaign.id;
    const wrong = [...(state.mistakes || []), ...(state.errors || []).map((e) => e.message || String(e))];
    by("wrong").textContent = wrong.length ? net.program(wrong.join(" ")) : "";
    by("wrong").hidden = wrong.length === 0;
    by("machine").textContent = [m.maker, m.model, m.serial, m.asset].filter(Boolean).join(" \u00B7 ");
    fill(by("parts"), ...state.parts.map((p) => el("button", {type: "button", "data-key": "part-" + p.name, "aria-pressed": String(p.name === shown.part), onclick: () => { choosePart(p.name); refresh().catch(complain); }}, say("parts.one", {name: p.name, n: p.readings}))));
    by("undo").disabled = !state.can_undo;
    by("redo").disabled = !state.can_redo;
    const same = state.model.length === state.saved_model.length && state.model.every((e) => state.saved_model.includes(e));
    by("save").disabled = same && !(state.excluded || []).length && !Object.keys(state.period_mm || {}).length;
    by("command").textContent = state.command || say("command.none");
    by("read-at").textContent = say("read.at", {at: new Date(state.campaign.read_at).toLocaleTimeString(language)});
    if (state.bench === "failed") view.alarm(say("bench.failed", {error: net.program(state.bench_error || "")}), " ", view.button("reload", "changed.read", {onclick: reload}));
    else if (state.campaign.changed_on_disk) view.alarm(say("changed.files"), " ", view.button("reload", "changed.read", {onclick: reload}));
  }
  function reload() {
    shown.aliases = {};
    return post("reload", {});
  }
  function draw() {
    if (!state) return;
    shown.none = state.bench !== "open" || state.parts.length ? null : state.kinds.length ? say("parts.none", {kinds: state.kinds.map((k) => (words["kind." + k] ? say("kind." + k) : k)).join(", ")}) : say("parts.nothing");
    document.body.classList.toggle("without", Boolean(shown.none));
    shown.learning = learn.on;
    shown.hideVerdict = learn.on ? say("learn.hidden") : null;
    shown.fitIsOld = shown.fitOf !== trial();
    shown.explainIsOld = shown.fitIsOld || shown.explainOf !== trial();
    drawHead();
    bar.draw(state, shown, steps);
    effects.drawList(state, shown, act);
    effects.drawAbout(state, shown);
    effects.drawNext(state, shown);
    effects.drawWhatIf(state, shown);
    learn.draw(state, shown);
    drawPlaces();
    drawDrawn();
    drawPeriod();
    readings.drawRegion(state, shown, [...pictures.chosen], act);
    readings.drawTable(state, shown, act);
    space.draw(state, shown, () => space.draw(state, shown, () => {}));
    document.body.dataset.version = state.version;
    const settled = (name) => shown.of[name] === trial();
    const explained = shown.explain && !shown.explainIsOld && settled("fingerprints") && settled("without");
    document.body.dataset.ready = shown.none ? "none" : shown.fit && !shown.fitIsOld && !shown.fit.partial ? (explained ? "explained" : "fitted") : "";
  }

  // ---- user actions ----
  const steps = {go: (n) => post("goto", {n}), name: (n, name) => post("name", {n, name})};
  let later = 0;
  const act = {
    toggle: (effect, add) => {
      shown.effect = effect;
      return post("model", add ? {add: effect} : {drop: effect});
    },
    choose(effect) {
      shown.effect = shown.effect === effect ? null : effect;
      effects.drawAbout(state, shown);
      effects.drawList(state, shown, act);
      drawPictures();
    },
    preview(effect) {
      clearTimeout(later);
      later = setTimeout(() => {
        if (shown.preview === effect) return;
        shown.preview = effect;
        drawPictures();
      }, 60);
    },
    open: (i) => readings.openOne(shown, pictures, i, act),
    select(rows) {
      const inside = by("region").contains(document.activeElement);
      if (inside) document.activeElement.blur();
      pictures.select(rows);
      region(rows);
      if (inside) by("region").querySelector("button, summary").focus();
    },
    async exclude(rows, why) {
      if (by("dialog").open) by("dialog").close();
      act.select([]);
      await post("exclude", {part: shown.part, rows, why});
    },
    include: (rows) => post("include", {part: shown.part, rows}),
  };

  async function save() {
    const problem = el("p", {class: "flag", role: "alert"}), why = el("input", {id: "save-why", maxlength: 300, autocomplete: "off"});
    let difference = {};
    try {
      difference = await net.ask("/api/save");
    } catch (e) {
      return complain(e);
    }
    const lines = (difference.diff || "").split("\n").map((line) => el("span", {class: line.startsWith("+") ? "plus" : line.startsWith("-") ? "minus" : ""}, line + "\n"));
    const write = el("button", {type: "submit", class: "strong", id: "save-write", disabled: !state.edit}, say("save.write"));
    view.dialog(say("save.title"), state.edit ? el("p", {}, say("save.what")) : el("p", {class: "flag"}, say("save.readonly")),
      el("pre", {class: "diff", tabindex: 0, role: "region", "aria-label": say("save.diff")}, ...lines),
      el("form", {onsubmit: async (event) => {
        event.preventDefault();
        write.disabled = true;
        try {
          await net.ask("/api/save", {body: {why: why.value.trim()}, match: difference.manifest_sha256 || state.campaign.manifest_sha256});
          by("dialog").close();
          view.speak(say("save.done"));
          await refresh();
        } catch (e) {
          write.disabled = false;
          const a = e.answer || {};
          problem.textContent = e.status === 412 ? `${e.message} ${a.yours ? say("save.both", {yours: a.yours.join(", ") || "\u2013", disk: (a.on_disk || []).join(", ") || "\u2013"}) : ""}` : e.message;
        }
      }}, el("label", {class: "wide"}, say("save.why") + " ", why), problem,
      el("div", {class: "buttons"}, write, el("button", {type: "button", onclick: () => by("dialog").close()}, say("dialog.close")))));
  }
  function help() {
    const keys = ["z", "y", "g", "f", "s", "arrows", "zoom", "enter", "1", "esc", "help"];
    view.dialog(say("tools.keys"), el("dl", {class: "keys"}, ...keys.flatMap((k) => [el("dt", {}, el("kbd", {}, say(`key.${k}`))), el("dd", {}, say(`key.${k}_what`))])), el("div", {class: "buttons"}, el("button", {type: "button", onclick: () => by("dialog").close()}, say("dialog.close"))));
  }
  function enlarge(k) {
    const figure = by("picture-" + k), big = figure.classList.contains("enlarged");
    for (const f of document.querySelectorAll(".enlarged")) f.classList.remove("enlarged");
    figure.classList.toggle("enlarged", !big);
    drawPictures();
    figure.querySelector("svg").focus();
  }
  /// Moves from effect to effect with the arrow keys.
  function walk(event) {
    const ticks = [...document.querySelectorAll("#effects-list input[data-effect]")].filter((e) => e.getClientRects().length > 0), at = ticks.indexOf(document.activeElement);
    if (at < 0) return false;
    const to = event.key === "ArrowDown" ? at + 1 : event.key === "ArrowUp" ? at - 1 : -2;
    if (to === -2) return false;
    if (ticks[to]) ticks[to].focus();
    return true;
  }
  const click = (id) => () => { if (!by(id).disabled && !by(id).hidden) by(id).click(); };
  const keys = {z: click("undo"), y: click("redo"), g: click("suggest"), f: click("finish"), s: click("save"), "?": help};
  document.addEventListener("keydown", (event) => {
    const typing = event.target.closest("input:not([type=checkbox]):not([type=radio]), select, textarea, dialog");
    if (typing || event.altKey || event.defaultPrevented) return;
    if ((event.ctrlKey || event.metaKey) && !["z", "y"].includes(event.key)) return;
    if (walk(event)) event.preventDefault();
    else if (keys[event.key] && state) {
      event.preventDefault();
      keys[event.key]();
    } else if (/^[1-9]$/.test(event.key) && shown.fit) enlarge(Number(event.key) - 1);
    else if (event.key === "Escape") {
      const big = document.querySelector(".enlarged");
      if (big) enlarge(Number(big.id.slice(-1)));
      else if (pictures.chosen.size) act.select([]);
    }
  });
  const on = (id, what) => by(id).addEventListener("click", what);
  on("undo", () => post("undo", {}));
  on("redo", () => post("redo", {}));
  on("suggest", () => post("suggest", {}));
  on("finish", () => post("finish", {}));
  on("cancel", () => post("cancel", {job}).then(() => running(null)));
  on("save", save);
  on("keys", help);
  on("page", () => net.download(`/api/page/${encodeURIComponent(shown.part)}`, `model-${shown.part}.html`).catch(complain));
  on("report", () => net.download("/api/report", `${state.campaign.id}.pdf`).catch(complain));
  on("learn", () => {
    learn.toggle();
    draw();
    drawPictures();
  });
  on("copy", () => navigator.clipboard.writeText(state.command || "").then(() => {
    by("copy").textContent = say("command.copied");
    setTimeout(() => (by("copy").textContent = say("command.copy")), 2000);
  }).catch(() => getSelection().selectAllChildren(by("command"))));

  // ---- events from elsewhere: another tab, a job, a file ----
  let soon = 0;
  function event(e) {
    if (e.type === "failed") {
      running(null);
      if (e.data.job) view.alarm(e.data.id ? say("refused." + e.data.id) : e.data.error ? net.program(e.data.error) : say("net.failed"));
    }
    if (e.type === "progress" && e.data.part) {
      shown.seconds = e.data.seconds || 0;
      if (state && e.data.part === shown.part && !shown.explain) bar.draw(state, shown, steps);
      return;
    }
    if (e.type === "done" && e.data.state === "done")
      outcome(e.data.added && e.data.added.length ? say("job.added", {effects: e.data.added.join(", ")}) : say("job.none"));
    clearTimeout(soon);
    soon = setTimeout(() => refresh().catch(complain), 15);
  }
  refresh().catch(complain).then(() => net.listen({since: () => (state ? state.version : 0), event, lost, found: () => {
    view.alarm("");
    document.body.classList.remove("lost");
    running(null);
    shown.etags = {};
    shown.of = {};
    refresh().catch(complain);
  }}));
})();
