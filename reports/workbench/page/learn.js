// ---- learning: the page hides its findings, the reader looks for the effect, and the page reports whether it is right ----
const learn = (() => {
  let on = sessionStorage.getItem("nonio-learn") === "1", before = null;
  function toggle() {
    on = !on;
    sessionStorage.setItem("nonio-learn", on ? "1" : "0");
    before = null;
  }
  /// Judges the reader's last step by the result of explain: [kind, sentence].
  function judge(state, shown) {
    const {explain, fit} = shown;
    if (!explain || !fit || shown.explainIsOld) return ["wait", say("learn.wait")];
    const kind = explain.verdict.kind, rms = field(fit.compare, "rms"), floor = field(explain, "noise_floor");
    if (kind === "nothing") return ["right", say("learn.right", {rms: short(rms), floor: short(floor), unit: shown.unit})];
    const step = state.steps.find((s) => s.n === state.at), last = state.steps.find((s) => s.n === state.at - 1);
    const came = step && last ? step.model.filter((e) => !last.model.includes(e)) : [];
    if (came.length === 0) return ["go", say("learn.start", {rms: short(rms), floor: short(floor), unit: shown.unit})];
    const was = field((last.parts || {})[shown.part], "rms"), gain = finite(was) ? 1 - rms / was : 0;
    const useful = gain > 0.1;
    return useful ? ["good", say("learn.good", {effect: came.join(", "), from: short(was), to: short(rms), unit: shown.unit})] : ["bad", say("learn.bad", {effect: came.join(", "), from: short(was), to: short(rms), unit: shown.unit})];
  }
  const hints = ["position", "direction", "time", "run", "phase", "temperature"];
  function draw(state, shown) {
    const box = by("teach");
    box.hidden = !on;
    by("learn").setAttribute("aria-pressed", String(on));
    if (!on) return;
    const [kind, text] = judge(state, shown);
    fill(box, el("h2", {}, say("learn.title")), el("p", {class: "learn " + kind, role: "status", id: "learn-says"}, text), el("details", {}, el("summary", {}, say("learn.how")), el("ol", {}, ...[1, 2, 3, 4].map((k) => el("li", {}, say("learn.step" + k)))), el("ul", {}, ...hints.map((h) => el("li", {}, say("learn.hint." + h))))));
  }
  return {toggle, draw, judge, get on() { return on; }};
})();
