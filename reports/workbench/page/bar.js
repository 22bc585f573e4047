// ---- the present error and the noise floor, one bar per step, and the verdict in one sentence ----
const bar = (() => {
  const percent = (v, most) => `${most > 0 ? Math.min(100, (100 * v) / most) : 0}%`;

  function line(kind, label, value, most, floor, unit) {
    const track = el("div", {class: "track"});
    const value_bar = el("div", {class: "value " + kind});
    value_bar.style.width = percent(value || 0, most);
    track.append(value_bar);
    if (finite(floor.s)) {
      const band = el("div", {class: "floor-band"}), mark = el("div", {class: "floor-mark"});
      const half = 2 * (floor.u || 0);
      band.style.left = percent(Math.max(0, floor.s - half), most);
      band.style.width = percent(Math.min(floor.s, half) + half, most);
      mark.style.left = percent(floor.s, most);
      track.append(band, mark);
    }
    return el("div", {class: "error-line"}, el("span", {class: "label"}, label), track,
      el("span", {class: "number", "data-value": finite(value) ? value : ""}, `${short(value)} ${unit}`));
  }

  /// A displacement over time: its noise floor comes from successive readings.
  const overTime = (shown) => shown.part.includes("/");
  function verdictOf(shown) {
    const {explain, fit} = shown;
    if (shown.none) return ["nothing-here", shown.none];
    if (shown.error) return ["failed", say("verdict.failed", {error: shown.error})];
    if (!fit || shown.fitIsOld) return ["thinking", say("verdict.fitting")];
    if (!explain || shown.explainIsOld) return ["thinking", shown.seconds > 0 ? say("verdict.progress", {seconds: shown.seconds}) : say("verdict.thinking")];
    const verdict = explain.verdict || {};
    const effect = verdict.effect;
    const found = (explain.candidates || []).find((c) => c.effect === effect);
    if (verdict.kind === "missing" && found)
      return [verdict.kind, say(found.aliases.length ? "verdict.missing_or" : "verdict.missing", {effect, others: found.aliases.join(", "),
        from: short(field(explain.model, "rms")), to: short(field(found, "rms")), unit: shown.unit})];
    return [verdict.kind, words["verdict." + verdict.kind] ? say("verdict." + verdict.kind + (overTime(shown) && words["verdict." + verdict.kind + "_over_time"] ? "_over_time" : ""), {rms: short(field(explain.model, "rms")), floor: short(field(explain, "noise_floor")), unit: shown.unit}) : typeset(verdict.says || "")];
  }

  function limitsOf(shown) {
    const {explain, unit} = shown;
    if (!explain || shown.explainIsOld) return "";
    const out = shown.openAliases.map(([effect, others]) => say("limits.open", {effect, others: others.join(", ")}));
    if (finite(explain.false_alarm_rate)) {
      const trials = explain.false_alarm_trials;
      out.push(explain.false_alarm_rate > 0 ? say("limits.alarms", {n: Math.max(1, Math.round(1 / explain.false_alarm_rate)), trials}) : say("limits.alarms_none", {trials}));
    }
    const sizes = (explain.candidates || []).map((c) => [field(c, "minimum_detectable_rms"), c.effect]).filter((c) => finite(c[0])).sort((a, b) => a[0] - b[0]);
    if (sizes.length) out.push(say("limits.smallest", {size: short(sizes[0][0]), unit, effect: sizes[0][1]}));
    return out.join(" ");
  }

  /// The errors of a part as bars with the noise floor; `most` is the value of a full bar.
  function errors(part, most, unit, over_time) {
    const floor = {s: field(part, "noise_floor"), u: field(part, "noise_floor_u")};
    const cv = field(part, "cv_rms") === undefined ? field(part.model, "cv_rms") : field(part, "cv_rms");
    return [line("rms", say("bar.rms"), field(part, "rms"), most, floor, unit), finite(cv) ? line("left-out", say(over_time ? "bar.left_out_over_time" : "bar.left_out"), cv, most, floor, unit) : null,
      el("p", {class: "muted"}, finite(floor.s) ? say(over_time ? "bar.floor_over_time" : "bar.floor", {s: withU(floor.s, floor.u)[0], U: withU(floor.s, floor.u)[1] || "\u2013", unit}) : say("bar.no_floor"))].filter(Boolean);
  }

  /// One bar per step that was taken on this page; each is a button that returns to its step.
  function trail(state, shown, most, floor, go) {
    const steps = state.steps.map((step) => {
      const of = (step.parts || {})[shown.part], rms = field(of, "rms"), cv = field(of, "cv_rms");
      const before = step.n > 0 ? state.steps.find((s) => s.n === step.n - 1) : null;
      const plus = before ? step.model.filter((e) => !before.model.includes(e)) : [], minus = before ? before.model.filter((e) => !step.model.includes(e)) : [];
      const what = step.name || step.what || [...plus.map((e) => "+ " + e), ...minus.map((e) => "\u2212 " + e)].join(" ") || (before ? say("trail.readings") : say("trail.start"));
      const column = el("span", {class: "column", "aria-hidden": "true"});
      for (const [v, kind] of [[rms, "rms"], [cv, "left-out"]]) {
        const one = el("span", {class: kind});
        one.style.height = percent(v || 0, most);
        column.append(one);
      }
      if (finite(floor.s)) {
        const mark = el("span", {class: "floor-line"});
        mark.style.bottom = percent(floor.s, most);
        column.append(mark);
      }
      const now = step.n === state.at;
      return el("li", {}, el("button", {type: "button", "data-key": "step" + step.n, "aria-current": now ? "step" : null, title: say("trail.go"),
          onclick: () => go(step.n)},
        column, el("span", {class: "what"}, what), el("span", {class: "number"}, short(rms), el("span", {class: "unseen"}, " " + shown.unit))));
    });
    return el("ol", {class: "trail", tabindex: 0, "aria-label": say("trail.title")}, ...steps);
  }

  function draw(state, shown, {go, name}) {
    shown.openAliases = Object.entries(shown.aliases).filter(([effect, others]) => state.model.includes(effect) && !state.saved_model.includes(effect) && !others.some((o) => state.model.includes(o)));
    const part = shown.fit && shown.fit.compare, unit = shown.unit;
    const floor = {s: field(part, "noise_floor"), u: field(part, "noise_floor_u")};
    const all = state.steps.map((s) => (s.parts || {})[shown.part]);
    const most = 1.04 * Math.max(0, ...[...all, part].flatMap((o) => [field(o, "rms"), field(o, "cv_rms")]).filter(finite), finite(floor.s) ? floor.s + 2 * (floor.u || 0) : 0);
    const [kind, sentence] = shown.hideVerdict ? ["thinking", shown.hideVerdict] : verdictOf(shown);
    const verdict = by("verdict");
    verdict.className = "verdict " + (kind || "");
    if (verdict.textContent !== sentence) verdict.textContent = sentence;
    for (const id of ["now", "effects-list"]) by(id).classList.toggle("old", Boolean(shown.fitIsOld));
    if (part) fill(by("now"), ...errors(part, most, unit, overTime(shown)));
    const step = state.steps.find((s) => s.n === state.at) || {name: ""};
    const field_ = el("input", {id: "step-name", "data-key": "step-name", value: step.name || "", maxlength: 60, autocomplete: "off", onchange: (e) => name(state.at, e.target.value)});
    fill(by("trail"), trail(state, shown, most, floor, go), el("label", {class: "naming"}, say("trail.name") + " ", field_));
    by("limits").textContent = shown.hideVerdict ? "" : limitsOf(shown);
  }
  return {draw, errors, verdictOf};
})();
