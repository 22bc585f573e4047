// ---- the effects in four groups: in the model, would help, no sign of, cannot be judged; and details of the chosen one ----
const effects = (() => {
  const cardOf = (state, effect) => (state.catalogue || []).find((c) => c.effect === nameOf(effect)) || {effect, card: {}};
  const ofPart = (state, shown) => (state.catalogue || []).filter((c) => c.part === shown.part && !c.library).map((c) => c.effect);

  /// "squareness:XY = 12.3 arcsec" is an effect of fixed size; "heat:t4/x1+x2" applies to the
  /// displacements x1 and x2 only.
  const nameOf = (entry) => entry.split(" = ")[0].split("/")[0];
  const isOf = (entry, part) => !entry.includes("/") || entry.split("/")[1].split("+").includes(part.split("/")[1]);
  const writtenOf = (state, shown, effect) => ((state.catalogue || []).find((c) => c.part === shown.part && c.effect === effect) || {}).written || effect;

  /// The four groups. Each effect is in exactly one of them.
  function groups(state, shown) {
    const model = state.model.filter((e) => isOf(e, shown.part)), taken = new Set(model.filter((e) => nameOf(e) !== e).map(nameOf));
    const own = ofPart(state, shown).filter((e) => !taken.has(e));
    const inModel = model.filter((e) => own.includes(e) || shown.fitted.includes(e) || (e.includes("/") && shown.fitted.includes(nameOf(e))));
    const explain = shown.explain || {}, candidates = (explain.candidates || []).filter((c) => !inModel.includes(c.effect) && !taken.has(c.effect));
    const help = candidates.filter((c) => c.score > 0), none = candidates.filter((c) => !(c.score > 0));
    const unseen = (explain.unseen || []).filter((u) => !inModel.includes(u.effect));
    const named = new Set([...inModel, ...candidates.map((c) => c.effect), ...unseen.map((u) => u.effect)]);
    const rest = own.filter((e) => !named.has(e));
    return {inModel, help, none, unseen, rest, descriptions: explain.descriptions || []};
  }

  /// A small plot of what an effect would explain of each reading, in their order.
  function spark(says, direction) {
    const width = 84, height = 26, values = says.filter(finite);
    const picture = svg("svg", {class: "spark", viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true"});
    if (values.length < 2) return picture;
    const low = Math.min(...values), high = Math.max(...values), step = Math.max(1, Math.floor(values.length / 200));
    const points = values.map((v, i) => [((width - 2) * i) / (values.length - 1) + 1, height - 2 - ((height - 4) * (v - low)) / (high - low || 1)]).filter((p, i) => i % step === 0);
    picture.append(svg("path", {class: "line ghost", d: points.map((p, i) => (i ? "L" : "M") + p[0].toFixed(1) + " " + p[1].toFixed(1)).join("")}));
    return picture;
  }

  function tick(state, shown, effect, checked, act) {
    return el("input", {type: "checkbox", "data-key": "tick-" + effect, "data-effect": effect, checked, onchange: () => act.toggle(checked ? effect : writtenOf(state, shown, effect), !checked)});
  }
  function row(state, shown, effect, checked, act, ...more) {
    const card = cardOf(state, effect), chosen = shown.effect === effect;
    const label = el("label", {}, tick(state, shown, effect, checked, act), el("span", {class: "name"}, effect), card.card && card.card.title ? el("span", {class: "title"}, card.card.title) : null);
    const about = el("button", {type: "button", class: "about", "data-key": "about-" + effect, "aria-pressed": String(chosen), "aria-label": say("row.about", {effect}), onclick: () => act.choose(effect)}, say("row.about_sign"));
    return el("li", {class: chosen ? "effect chosen" : "effect", "data-row": effect, onpointerenter: () => act.preview(effect), onpointerleave: () => act.preview(null), onfocusin: () => act.preview(effect)}, el("div", {class: "head"}, label, about), ...more);
  }

  function valuesOf(shown, effect) {
    const all = ((shown.fit || {}).compare || {model: {}}).model.parameters || [];
    const own = all.filter((p) => p.effect === nameOf(effect));
    if (own.length > 4) return el("p", {class: "values"}, say("row.curve", {n: own.length}));
    return own.map((p) => {
      const [value, U] = withU(p.value, p.u), unit = shownUnit(p.unit || "");
      return el("p", {class: "values", "data-parameter": `${effect}.${p.name}`, "data-value": p.value}, `${p.name} = ${value}${U ? " \u00B1 " + U : ""} ${unit}`, p.searched && !p.stated ? el("span", {class: "muted"}, " " + say("row.searched")) : null,
        p.below_uncertainty ? el("span", {class: "flag"}, " " + say("row.below")) : null);
    });
  }
  function drawList(state, shown, act) {
    const g = groups(state, shown), unit = shown.unit, rms = field((shown.fit || {}).compare, "rms");
    const list = (word, items, help) => items.length ? [el("h3", {}, say(word)), help ? el("p", {class: "muted"}, say(help)) : null, el("ul", {class: "effects-of", "data-group": word}, ...items)] : [];
    const inModel = g.inModel.map((effect) => {
      const without = shown.fitIsOld || shown.of.without !== shown.fitOf ? null : (shown.without || []).find((w) => w.effect === nameOf(effect));
      return row(state, shown, effect, true, act, valuesOf(shown, effect), without ? el("p", {class: "muted", "data-without": field(without, "rms")}, say("row.without", {rms: short(field(without, "rms")), cv: short(field(without, "cv_rms")), unit})) : null);
    });
    const help = shown.learning ? [] : g.help.map((c) => {
      if (shown.explainIsOld) return row(state, shown, c.effect, false, act);
      const says = (shown.fingerprints || []).find((f) => f.effect === c.effect);
      const sure = ((shown.explain || {}).certain || []).includes(c.effect);
      return row(state, shown, c.effect, false, act, el("div", {class: "helps"}, says ? spark(says.says) : null,
        el("span", {class: "number", "data-rms": field(c, "rms")}, `${short(rms)} \u2192 ${short(field(c, "rms"))} ${unit}`), sure ? el("b", {class: "sure"}, say("row.certain")) : null),
        c.aliases.length ? el("p", {class: "flag"}, say("row.or", {others: c.aliases.join(", ")})) : null);
    });
    const none = shown.learning ? [] : g.none.map((c) => row(state, shown, c.effect, false, act, shown.explainIsOld ? null : el("p", {class: "muted"}, say("row.seen_from", {size: short(field(c, "minimum_detectable_rms")), unit}))));
    const unseen = shown.learning ? [] : g.unseen.map((u) => row(state, shown, u.effect, false, act, el("p", {class: "muted"}, typeset(u.says))));
    const described = shown.learning ? [] : g.descriptions.filter((d) => !state.model.includes(d.effect)).map((d) => row(state, shown, d.effect, false, act, el("p", {class: "muted"}, d.says ? typeset(d.says) : say("row.description"))));
    const rest = (shown.learning ? [...g.help, ...g.none].map((c) => c.effect).concat(g.unseen.map((u) => u.effect), g.rest).sort() : g.rest).map((effect) => row(state, shown, effect, false, act));
    fill(by("effects-list"),
      g.inModel.length ? list("effects.model", inModel) : [el("h3", {}, say("effects.model")), el("p", {class: "muted"}, say("effects.empty"))],
      list("effects.help", help, "effects.help_how"), list("effects.described", described, "effects.described_how"), list("effects.none", none), list("effects.unseen", unseen),
      rest.length ? el("details", {"data-key": "rest", open: shown.learning || null}, el("summary", {}, say(shown.learning ? "effects.all" : "effects.rest", {n: rest.length})), el("ul", {class: "effects-of"}, ...rest)) : null);
  }

  /// The picture of an effect: its value at each reading over the column that orders these values best.
  function fingerprint(shown, all) {
    // A pseudo-random sample is enough for the small plot, and has no fixed phase to periods of the
    // readings.
    const most = 1500, share = most / all.length, keep = (_, i) => share >= 1 || ((i * 2654435761) >>> 0) / 4294967296 < share;
    const thin = (column) => column && column.filter(keep), whole = shown.fit.page, says = thin(all);
    const data = {...whole, target: thin(whole.target), time: thin(whole.time), run: thin(whole.run), temperature: thin(whole.temperature), direction: thin(whole.direction)}, columns = [["position", data.target, data.position_unit], ["time", data.time, data.time_unit], ["run", data.run, ""], ["temperature", data.temperature, "\u00B0C"]].filter((c) => c[1]);
    const score = ([, xs]) => { // share of the variance within 24 parts of x: the smaller, the better ordered
      const parts = new Map(), usable = xs.map((x, i) => [x, says[i], data.direction[i]]).filter((p) => finite(p[0]) && finite(p[1]));
      if (usable.length < 4) return Infinity;
      const low = Math.min(...usable.map((p) => p[0])), high = Math.max(...usable.map((p) => p[0]));
      if (!(high > low)) return Infinity;
      for (const [x, y, d] of usable) {
        const key = Math.floor((23.99 * (x - low)) / (high - low)) + ":" + d, s = parts.get(key) || [0, 0, 0];
        parts.set(key, [s[0] + 1, s[1] + y, s[2] + y * y]);
      }
      let sum = 0;
      for (const [m, y, yy] of parts.values()) sum += yy - (y * y) / m;
      return sum * (1 + 0.001 * columns.findIndex((c) => c[1] === xs));
    };
    const best = columns.slice().sort((a, b) => score(a) - score(b))[0];
    if (!best) return null;
    const [name, xs, unit] = best, points = xs.map((x, i) => [x, says[i], data.direction[i]]).filter((p) => finite(p[0]) && finite(p[1]));
    const ends = (k) => [Math.min(...points.map((p) => p[k])), Math.max(...points.map((p) => p[k]))];
    const [x0, x1] = ends(0), [y0, y1] = ends(1), width = 270, height = 110;
    const level = (y) => short(Math.abs(y) < 1e-6 * Math.max(-y0, y1) ? 0 : y); // rounding is shown as 0
    const px = (x) => 44 + ((width - 52) * (x - x0)) / (x1 - x0 || 1), py = (y) => 8 + (height - 34) * (1 - (y - y0) / (y1 - y0 || 1));
    const path = (d) => points.filter((p) => (d < 0 ? p[2] < 0 : p[2] >= 0)).map((p) => `M${px(p[0]).toFixed(1)} ${py(p[1]).toFixed(1)}h0`).join("");
    const picture = svg("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": say("about.picture_alt", {x: say("x." + name), low: level(y0), high: level(y1), unit: shown.unit})},
      svg("rect", {class: "frame", x: 44, y: 4, width: width - 48, height: height - 26}), svg("path", {class: "dots plus", d: path(1)}), svg("path", {class: "dots minus", d: path(-1)}));
    const label = (x, y, anchor, text) => {
      const node = svg("text", {x, y, "text-anchor": anchor});
      node.textContent = text;
      picture.append(node);
    };
    label(40, 14, "end", level(y1));
    label(40, height - 24, "end", level(y0));
    label(width - 4, height - 6, "end", `${say("x." + name)} ${short(x0)} \u2026 ${short(x1)} ${unit}`);
    label(4, height - 6, "start", shown.unit);
    return el("figure", {class: "fingerprint"}, picture, el("figcaption", {class: "muted"}, say("about.picture")));
  }

  function drawAbout(state, shown) {
    const effect = shown.effect, box = by("about-what");
    if (!effect) return fill(box, el("p", {class: "muted"}, say("about.none")));
    const entry = cardOf(state, effect), card = entry.card || {}, explain = shown.explain || {};
    const candidate = (explain.candidates || []).find((c) => c.effect === effect), unseen = (explain.unseen || []).find((u) => u.effect === effect);
    const said = ((shown.fit && shown.fit.page.effects) || []).find((e) => e.name === effect) || (shown.learning ? null : (shown.fingerprints || []).find((f) => f.effect === effect));
    const items = [];
    const part = (word, text) => text && items.push(el("dt", {}, say(word)), el("dd", {}, typeset(text)));
    part("about.is", card.is);
    part("about.size", card.size);
    part("about.appearance", card.appearance);
    part("about.similar", card.similar);
    part("about.remedy", card.remedy);
    const correlated = ((shown.fit && shown.fit.compare.correlations) || []).filter((c) => [c.one, c.other].filter((p) => p.startsWith(effect + " ")).length === 1);
    const evidence = [];
    if (candidate && shown.fit && !shown.explainIsOld && !shown.learning) {
      const rms = field(shown.fit.compare, "rms");
      evidence.push(candidate.score > 0 ? say("about.evidence", {effect, from: short(rms), to: short(field(candidate, "rms")), cv: short(field(candidate, "cv_rms")), unit: shown.unit, p: candidate.p < 1e-4 ? "< " + local("0.0001") : "= " + short(candidate.p), evidence: short(candidate.score)})
        : !finite(field(candidate, "minimum_detectable_rms")) ? candidate.says
        : say("about.no_evidence", {effect, size: short(field(candidate, "minimum_detectable_rms")), unit: shown.unit}));
      if (candidate.aliases.length) evidence.push(say("about.aliases", {others: candidate.aliases.join(", ")}));
      if (finite(candidate.bias)) evidence.push(say("about.bias", {factor: short(candidate.bias)}));
    }
    if (unseen && !shown.learning) evidence.push(typeset(unseen.says));
    for (const c of correlated) evidence.push(say("about.correlated", {one: c.one, other: c.other, r: short(c.r)}));
    const plans = shown.learning || shown.explainIsOld ? [] : (explain.plans || []).filter((p) => (p.separates || []).includes(effect));
    fill(box, el("h3", {id: "about-name"}, card.title ? `${card.title} (${effect})` : effect), said && shown.fit && said.says.length === shown.fit.page.residual.length ? fingerprint(shown, said.says) : null,
      state.model.includes(effect) ? valuesOf(shown, effect) : null, ...evidence.map((t) => el("p", {}, t)),
      el("p", {class: "muted"}, say(entry.compensable ? "about.table" : "about.no_table")), items.length ? el("dl", {}, ...items) : null,
      plans.length ? [el("h4", {}, say("about.apart")), el("ul", {}, ...plans.map((p) => el("li", {}, typeset(p.says))))] : null);
  }

  /// Proposed measurements, each with its number of readings and its power.
  function drawNext(state, shown) {
    const explain = shown.explain, box = by("next-what");
    if (!explain || shown.explainIsOld || shown.learning) return fill(box, el("p", {class: "muted"}, say("next.none")));
    const plans = (explain.plans || []).map((p) => el("tr", {}, el("td", {}, typeset(p.says)), el("td", {class: "number"}, String(p.readings)), el("td", {class: "number"}, short(p.power))));
    const table = plans.length ? el("div", {class: "scroll", tabindex: 0, role: "region", "aria-label": say("next.table")}, el("table", {}, el("thead", {}, el("tr", {}, el("th", {scope: "col"}, say("next.plan")), el("th", {scope: "col", class: "number"}, say("next.readings")), el("th", {scope: "col", class: "number"}, say("next.power")))), el("tbody", {}, ...plans))) : null;
    const next = explain.next || [];
    fill(box, table, next.length ? el("ul", {}, ...next.map((t) => el("li", {}, typeset(t)))) : null, ...(explain.warnings || []).map((t) => el("p", {}, typeset(t))),
      !plans.length && !next.length ? el("p", {class: "muted"}, say("next.nothing")) : null);
  }
  /// The effect of one more run, in each order of directions, on U of each parameter and on the evidence; also for a terminal.
  function drawWhatIf(state, shown) {
    const explain = shown.explain, box = by("what-if"), all = shown.explainIsOld || shown.learning ? [] : shown.whatIf || [];
    if (!explain || !all.length) return fill(box);
    const parameters = ((explain.model || {}).parameters || []).filter((p) => finite(p.u));
    const cell = (v) => el("td", {class: "number"}, short(v));
    const row = (name, unit, now, then) => el("tr", {}, el("th", {scope: "row"}, name, unit ? [" ", el("span", {class: "muted"}, unit)] : ""), cell(now), ...all.map((one) => cell(then(one))));
    const u = (p) => row(`U ${p.effect} ${p.name}`, shownUnit(p.unit || ""), 2 * p.u, (one) => 2 * p.u * (one.parameters.find((f) => f.effect === p.effect && f.name === p.name) || {factor: NaN}).factor);
    const evidence = (x) => row(say("more.evidence", {effect: x.effect}), "", x.score, (one) => (one.evidence.find((f) => f.effect === x.effect) || {then: NaN}).then);
    fill(box, el("h3", {}, say("more.title")), el("p", {class: "muted"}, say("more.what")),
      el("div", {class: "scroll", tabindex: 0, role: "region", "aria-label": say("more.title")}, el("table", {}, el("thead", {}, el("tr", {}, el("td"), el("th", {scope: "col", class: "number"}, say("more.now")),
        ...all.map((one) => el("th", {scope: "col", class: "number"}, `${say("more.is_" + one.plan.replace(/-/g, "_"))} (+${one.readings})`)))),
      el("tbody", {}, ...parameters.map(u), ...all[0].evidence.map(evidence)))),
      /^nonio model compare /.test(state.command) ? el("details", {class: "muted"}, el("summary", {}, say("site.did")), el("code", {}, state.command.replace("nonio model compare", "nonio model explain") + " --what-if")) : null);
  }
  return {drawList, drawAbout, drawWhatIf, drawNext, groups, fingerprint};
})();
