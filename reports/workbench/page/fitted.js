// ---- the model of a campaign and its readings on the site page (read-only figure) ----
const fitted = (() => {
  let pictures = null, turn = 0;
  const chosen = new Map(); // selected part by campaign
  const places = (folder) => el("section", {id: "fitted", "data-folder": folder, "aria-labelledby": "fitted-title", hidden: true}, el("h2", {id: "fitted-title"}, say("one.fitted")), el("div", {id: "fitted-parts", class: "acts wide"}),
    el("div", {id: "picture-fit"}, el("figure", {}, svg("svg", {role: "img", "aria-labelledby": "fitted-title", "aria-describedby": "fitted-says"}), el("figcaption", {}, el("p", {id: "fitted-says", class: "muted"})))), el("div", {id: "fitted-errors"}));
  /// Repeats the request until the answer is ready; null if the page meanwhile shows something else.
  async function settled(mine, path, isThere) {
    for (;;) {
      let answer = null;
      try {
        answer = await net.ask(path);
      } catch (e) {
        if (e.status !== 409) throw e;
      }
      if (mine !== turn || !by("fitted")) return null;
      if (answer && isThere(answer)) return answer;
      await new Promise((done) => setTimeout(done, 150));
    }
  }
  /// Fills the section made by `places`. A campaign that cannot be fitted has none: findings and values report it.
  async function draw() {
    const place = by("fitted"), mine = ++turn;
    if (!place) return;
    const folder = place.dataset.folder, {path} = await net.ask("/api/open", {body: {campaign: folder}});
    const state = await settled(mine, path + "api/state", (s) => s.bench !== "opening");
    if (!state || state.parts.length === 0) return;
    const part = state.parts.find((p) => p.name === chosen.get(folder)) || state.parts[0];
    const fit = await settled(mine, `${path}api/parts/${encodeURIComponent(part.name)}/picture`, () => true);
    if (!fit || fit.page.fit.none) return;
    place.hidden = false;
    by("fitted-says").textContent = [fit.page.fit.says, fit.page.suspects.length ? say("legend.suspects", {n: fit.page.suspects.length}) : ""].filter(Boolean).join(" ");
    fill(by("fitted-parts"), ...(state.parts.length < 2 ? [] : state.parts.map((p) => el("button", {type: "button", class: "small", "data-key": "fitted-" + p.name, "aria-pressed": String(p === part), onclick: () => {
      chosen.set(folder, p.name);
      draw().catch(() => null);
    }}, say("parts.one", {name: p.name, n: p.readings})))));
    const most = 1.04 * Math.max(0, ...["rms", "cv_rms", "noise_floor"].map((name) => field(fit.compare, name)).filter(finite));
    fill(by("fitted-errors"), ...bar.errors(fit.compare, most, fit.page.unit, part.name.includes("/")));
    pictures = pictures || nonioPictures({figure: (k) => (k === "fit" ? by("picture-fit") : null), tip: by("tip"), hidden: {d: new Set(), r: new Set()}, elsewhere: () => true});
    pictures.set(fit.page);
    pictures.draw(fit.page.residual);
    place.dataset.ready = part.name;
  }
  return {places, draw};
})();
