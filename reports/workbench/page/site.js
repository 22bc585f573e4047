// ---- the page of a site: the worklist of the last run, and user actions ----
(() => {
  let state = null, lines = [], known = [], gone = null, filters = "", drawn = "", asking = false, again = false, stale = true, dismissed = "", shown = "", released = null, drawnCharts = null;
  const own = ["campaigns", "machines", "instruments", "certificates", "entries", "settings"];
  const isOwn = (name) => own.includes(name) || (name === "new" && (!state || state.edit)) || name.startsWith("campaign/");
  const isPage = (name) => /^(index|due|compare|instruments)\.html$|^machines\/[^/]+\.html$/.test(name);
  let pages = new Map(); // text by name
  let links = []; // to the static pages of the last run, with their titles

  // ---- the current view: stored in the URL, like the filters of the lines ----
  function view() {
    const to = new URLSearchParams(location.hash.slice(1)).get("to");
    return to && (isOwn(to) || isPage(to)) ? to : state && (!state.out || !state.night.last) ? "campaigns" : "index.html";
  }
  const hrefOf = (name) => (name === "index.html" ? "#" + filters : "#to=" + encodeURIComponent(name));
  /// A link of a page as a path of the site: "../index.html" of "machines/S-1.html" is "index.html".
  function resolved(from, to) {
    const steps = from.split("/").slice(0, -1);
    for (const step of to.split("/")) if (step === "..") steps.pop(); else if (step !== ".") steps.push(step);
    return steps.join("/");
  }

  // ---- requests to the server ----
  let denied = false; // the server refused the role of this user, although the URL is valid
  /// Replaces the whole page.
  function only(name, ...content) {
    by("app").replaceChildren(el("main", {class: "lost"}, ...content));
    document.body.dataset.ready = name;
  }
  function signIn() {
    if (by("sign-in")) return;
    const account = el("input", {name: "account", required: true, maxlength: 100, autocomplete: "username", id: "sign-in-account"});
    const password = el("input", {type: "password", name: "password", required: true, maxlength: 200, autocomplete: "current-password", id: "sign-in-password"});
    const problem = el("p", {class: "flag", role: "alert"}), go = el("button", {type: "submit", class: "strong", id: "sign-in-go"}, say("user.sign_in"));
    only("sign-in", el("h1", {}, say("user.sign_in")), el("form", {id: "sign-in", onsubmit: async (event) => {
      event.preventDefault();
      go.disabled = true;
      problem.textContent = "";
      try {
        await net.ask("/api/sign-in", {body: {account: account.value, password: password.value}});
        location.reload();
      } catch (e) {
        problem.textContent = e.message || String(e);
        password.value = "";
        go.disabled = false;
      }
    }}, el("label", {class: "wide"}, el("span", {}, say("user.account")), account), el("label", {class: "wide"}, el("span", {}, say("user.password")), password), problem, el("div", {class: "buttons"}, go)));
    account.focus();
  }
  function complain(e) {
    const id = e.answer && e.answer.id;
    if (id === "signed_out") return signIn();
    if (id === "token" && !net.hasToken()) return only("no-token", el("h1", {}, say("shell.title")), el("p", {role: "alert"}, say("net.no_token")));
    denied = denied || e.status === 403;
    if (e instanceof net.Refused) box.alarm(e.message, " ", box.button("alarm-close", "dialog.close", {onclick: () => box.alarm("")}));
    else lost(0);
  }
  function lost(status) {
    if (!by("main") || (denied && status === 403)) return;
    // The session may have ended, or the user was removed: the next request shows it.
    if (status === 403 && (!state || state.user)) return void refresh().catch(complain);
    box.alarm(status === 403 ? say("net.other") : say("site.lost", {at: new Date().toLocaleTimeString(language)}));
    document.body.classList.add("lost");
  }
  function told(answer) {
    if (answer && answer.command) by("command").textContent = answer.command;
    by("footer").hidden = by("command").textContent === "";
  }
  async function act(what, body, done) {
    const answer = await net.ask("/api/" + what, {body});
    told(answer);
    if (done) box.speak(done);
    await refresh();
    return answer;
  }
  /// Downloads a file of the results.
  const fetchFile = (path) => net.download("/site/results/" + path.split("/").slice(-2).map(encodeURIComponent).join("/"), path.split("/").slice(-2).join("-")).catch(complain);
  async function text(name) {
    const of = pages; // an answer requested before a change must not get into the new map
    if (!of.has(name)) of.set(name, await (await net.ask("/site/" + name.split("/").map(encodeURIComponent).join("/"), {raw: true})).text());
    return of.get(name);
  }
  /// Runs one request at a time: a call in the meantime repeats it once.
  async function refresh(fresh = true) {
    stale = stale || fresh;
    again = true;
    if (asking) return;
    asking = true;
    try {
      while (again) {
        again = false;
        await ask();
      }
    } finally {
      asking = false;
    }
  }
  async function ask() {
    const next = await net.ask("/api/site/state");
    if (state && next.engine !== state.engine) return location.reload();
    state = next;
    if (state.user) entries.as(state.user.name, state.user.confirms);
    if (stale) {
      stale = false;
      pages = new Map();
      const has = state.out && state.night.last;
      try {
        const [worklist, all, index] = await Promise.all([has ? net.ask("/api/site") : {lines: []}, net.ask("/api/ack"), has ? text("index.html") : ""]);
        lines = worklist.lines;
        known = all.acknowledged;
        // The static pages have the titles of the pages, and the number and date of the run.
        const page = markup.page(index);
        links = page.links;
        by("beside").textContent = page.beside;
      } catch (e) {
        stale = true;
        throw e;
      }
    }
    drawHead();
    await draw();
    document.body.classList.remove("lost");
    document.body.dataset.version = state.version;
  }

  // ---- the actions of a line of the worklist ----
  const campaignOf = (line) => line.campaign || (line.link ? line.link.split("/").slice(-2)[0] : "");
  /// Only judgments of a machine's history can be acknowledged; a lost or failed campaign is a
  /// fact.
  const canBeKnown = (line) => line.machine && line.state === "new" && ["out", "changed", "soon", "overdue", "withheld", "undecided", "information"].includes(line.kind);
  async function openCampaign(campaign) {
    try {
      location.href = (await net.ask("/api/open", {body: {campaign}})).path;
    } catch (e) {
      complain(e);
    }
  }
  const runAgain = (campaign) => act("run", campaign ? {campaign} : {}, say("run.begun")).catch(complain);
  function campaignButtons(campaign, key) {
    return [el("button", {type: "button", class: "link", "data-key": `open-${key}`, "data-campaign": campaign, onclick: () => openCampaign(campaign)}, say("site.open")),
      state.edit && state.out && state.night.last ? el("button", {type: "button", class: "link", "data-key": `run-${key}`, disabled: state.running, title: state.running ? say("run.busy") : null, onclick: () => runAgain(campaign)}, say("run.again")) : null];
  }
  function actions(line, told_) {
    const campaign = campaignOf(line), entry = line.state === "known" ? entries.entryOf(line, known) : null;
    const all = [...(campaign ? campaignButtons(campaign, line.id) : []),
      state.edit && canBeKnown(line) ? el("button", {type: "button", class: "link", "data-key": "ack-" + line.id, onclick: () => entries.acknowledge(line, told_, act)}, say("ack.short")) : null,
      state.edit && entry ? el("button", {type: "button", class: "link", "data-key": "withdraw-" + line.id, onclick: () => entries.withdraw(entry, act)}, say("withdraw.short")) : null,
      state.edit && line.machine ? el("button", {type: "button", class: "link", "data-key": "event-" + line.id, onclick: () => entries.event(line.machine, line.axis, machines(), act)}, say("event.line")) : null].filter(Boolean);
    return all.length ? el("div", {class: "acts"}, ...all) : null;
  }
  const machines = () => [...new Set([...lines.map((l) => l.machine), ...[...document.querySelectorAll("a[data-to*='machines/']")].map((a) => a.textContent)].filter(Boolean))].sort();

  // ---- the static pages of the last run ----
  /// The content of a static page, with links that open in this page.
  function adopted(root, name) {
    for (const a of root.querySelectorAll("a[data-to]")) {
      const to = resolved(name, a.dataset.to);
      a.dataset.to = to;
      a.setAttribute("href", isPage(to) ? hrefOf(to) : "#get=" + encodeURIComponent(to));
      if (isPage(to)) continue;
      a.addEventListener("click", (event) => {
        event.preventDefault();
        if (to === "due.ics") net.download("/site/due.ics", "due.ics").catch(complain);
        else fetchFile(to);
      });
    }
    root.querySelector("h1").setAttribute("tabindex", "-1");
    return root;
  }
  async function pageOfRun(name) {
    const page = markup.page(await text(name)), root = adopted(page.main, name);
    if (name === "index.html") {
      const of = new Map(lines.map((line) => [line.id, line]));
      for (const row of root.querySelectorAll("tr[data-line]")) {
        const line = of.get(row.dataset.line), place = row.querySelector("td.do");
        row.dataset.key = "row-" + row.dataset.line;
        const buttons = line && actions(line, row.cells[3].textContent);
        if (buttons && place) place.append(buttons);
      }
      for (const select of root.querySelectorAll("select")) select.dataset.key = "filter-" + select.name;
    } else if (name.startsWith("machines/")) machineActions(root);
    return [...root.childNodes];
  }
  function machineActions(root) {
    const machine = root.querySelector("h1").textContent, seen = new Map();
    for (const row of root.querySelectorAll("table tbody tr")) {
      const a = row.querySelector("td:last-child a");
      if (a && row.cells.length === 4 && !seen.has(a.textContent)) seen.set(a.textContent, row.cells[0].textContent);
    }
    if (state.edit) root.querySelector("h1").after(el("p", {}, el("button", {type: "button", "data-key": "event-machine", onclick: () => entries.event(machine, "", machines(), act)}, say("event.short"))));
    if (seen.size === 0) return;
    root.append(el("section", {"aria-labelledby": "campaigns-of"}, el("h2", {id: "campaigns-of"}, say("site.campaigns_of")),
      el("ul", {class: "plain campaigns"}, ...[...seen].sort((a, b) => (a[1] < b[1] ? 1 : -1)).map(([id, date]) => el("li", {}, el("span", {class: "day"}, date), " ", el("b", {}, id), " ", ...campaignButtons(id, id))))));
  }

  // ---- pages that this script draws ----
  const tools = () => ({edit: state.edit, approve: state.approve, out: state.out, running: state.running, buttons: campaignButtons, fetchFile, send: state.approve ? (id, file) => entries.send(id, file, act).catch(complain) : null, runAll: () => runAgain(""), complain, drop: measure.drop, release, released, releasedNote});
  /// Shows a new campaign, and evaluates it at once if the server has an output folder.
  async function created(answer) {
    told(answer);
    if (state.out) await act("run", {campaign: answer.campaign}, say("run.begun"));
    location.hash = "#to=" + encodeURIComponent("campaign/" + answer.campaign);
  }
  const releasedNote = () => el("p", {class: "note", id: "released", tabindex: -1, role: "status"}, released.approved ? say("release.approved") : say("release.issued", {number: released.number}), " ",
    ...(released.files || []).flatMap((f) => [el("button", {type: "button", class: "link", "data-key": "issued-" + f, onclick: () => fetchFile(f)}, f.split("/").pop()), " "]),
    released.verdict ? el("span", {id: "released-verdict", class: "block"}, say("release.verified", {verdict: released.verdict})) : null);
  async function release(body) {
    const answer = await net.ask("/api/release", {body});
    told(answer);
    if (!["issued", "approved"].includes(answer.state)) throw Object.assign(new Error(net.program(answer.why || answer.state)), {answer});
    released = answer.state === "issued" ? {folder: body.campaign, number: answer.number, files: answer.files.map((f) => f.split("/").slice(-2).join("/"))} : {folder: body.campaign, approved: true};
    const pdf = (released.files || []).find((f) => f.endsWith(".pdf"));
    // The issued certificate is verified in the same way as by its recipient.
    if (pdf) released.verdict = await certificates.verdictOf("/site/results/" + pdf.split("/").map(encodeURIComponent).join("/")).catch((e) => e.message);
    await refresh();
    if (by("released")) by("released").focus();
  }
  async function certificatesView() {
    const {drafts} = state.out ? await net.ask("/api/drafts").catch((e) => ({drafts: [], error: complain(e)})) : {drafts: []};
    const drawResults = () => by("verified") && by("verified").replaceWith(certificates.results());
    return [el("h1", {tabindex: -1}, say("site.certificates")),
      el("section", {"aria-labelledby": "verify-title"}, el("h2", {id: "verify-title"}, say("verify.title")), el("p", {class: "muted"}, say("verify.what")), certificates.drop(drawResults), certificates.results()),
      el("section", {"aria-labelledby": "drafts-title"}, el("h2", {id: "drafts-title"}, say("release.title", {n: drafts.length})),
        released ? releasedNote() : null,
        drafts.length === 0 ? el("p", {}, say("release.none")) : el("p", {class: "muted"}, state.approve ? say("release.how") : say("site.read_only_release")),
        el("ul", {class: "plain"}, ...drafts.map((d) => certificates.draft(d, state.approve, fetchFile, release))))];
  }
  async function entriesView() {
    const {events} = await net.ask("/api/event");
    return entries.show(known, events, state.edit, {withdrawOne: (entry) => entries.withdraw(entry, act), addEvent: () => entries.event("", "", machines(), act), audit: state.user && state.user.role === "administer" ? () => net.download("/api/audit", "audit.jsonl").catch(complain) : null});
  }

  // ---- drawing ----
  function drawHead() {
    const n = state.night, r = state.run;
    const named = own.map((name) => [name, say("site." + name)]);
    // The static page about instruments has no entry: the page "instruments" links to it.
    fill(by("nav"), ...[...named.slice(0, 3), ...(state.out && n.last ? links.filter(([to]) => to !== "instruments.html") : []), ...named.slice(3)].map(([to, label]) =>
      el("a", {href: hrefOf(to), "data-key": "nav-" + to, "aria-current": view() === to || (to === "campaigns" && /^(new$|campaign\/)/.test(view())) ? "page" : null}, label)));
    const night_ = n.state === "running" ? say(n.last ? "night.running" : "night.first", {n: n.night, last: n.last, date: n.last_date}) : n.state === "cut-short" ? say("night.cut", {n: n.night}) : n.state === "planned" ? say("night.planned", {n: n.night}) : "";
    fill(by("night"), night_ ? el("p", {class: "note", id: "night-says"}, night_) : null);
    fill(by("rights"), state.user ? el("p", {class: "muted", id: "user"}, say("user.is", {name: entries.visible(state.user.name), role: say("user.may_" + state.user.role)}), " ", state.user.signs_out ? el("button", {type: "button", class: "link", id: "sign-out", "data-key": "sign-out", onclick: () => net.ask("/api/sign-out", {body: {}}).then(() => location.reload()).catch(complain)}, say("user.sign_out")) : null) : null, state.edit || state.user ? null : el("p", {class: "muted", id: "read-only"}, say("site.read_only")));
    drawRun(r);
  }
  const stages = ["begin", "survey", "campaigns", "history", "pages"];
  /// Progress of a run, 0 to 1: one tenth for the stages before the campaigns, two tenths for those after them.
  function shareOf(r) {
    const at = Math.max(0, stages.indexOf(r.stage));
    return at < 2 ? 0.05 * at : at > 2 ? 0.5 + 0.1 * at : 0.1 + 0.7 * (r.to_do ? r.done / r.to_do : 0);
  }
  function drawRun(r) {
    if (!r || dismissed === r.command + r.state) return fill(by("run"));
    const what = r.campaign || say("run.everything");
    if (r.state === "running") {
      const share = Math.round(100 * shareOf(r));
      return fill(by("run"), el("div", {class: "note"}, el("p", {}, el("label", {for: "run-share"}, say("run.at", {what, stage: say("run.stage_" + r.stage), share}))),
        el("progress", {id: "run-share", max: 100, value: share}), r.to_do > 1 ? el("p", {class: "muted"}, say("run.count", {done: r.done, all: r.to_do})) : null,
        state.edit ? el("button", {type: "button", id: "run-cancel", "data-key": "run-cancel", onclick: () => net.ask("/api/run/cancel", {body: {}}).catch(complain)}, say("run.cancel")) : null));
    }
    const says = [];
    if (r.state === "cancelled") says.push(say("run.cancelled", {what}));
    else if (r.state === "refused") says.push(say("run.refused", {what, why: net.program(r.message || "")}));
    else if (r.campaign) {
      says.push(say("run.done", {what, status: say("run.status_" + (r.status || "none"))}));
      if (r.status === "failed" && r.message) says.push(net.program(r.message));
      says.push(r.same_results ? say("run.same") : r.was ? say("run.other") : say("run.new"));
      if (r.new_findings && r.new_findings.length) says.push(say("run.found", {what: r.new_findings.join("; ")}));
      if (r.gone_findings && r.gone_findings.length) says.push(say("run.gone", {what: r.gone_findings.join("; ")}));
    } else if (r.counts) says.push(say("run.all_done", {done: r.counts.done, unchanged: r.counts.unchanged, failed: r.counts.failed}));
    fill(by("run"), el("div", {class: "note", id: "run-end"}, ...says.map((text_) => el("p", {}, text_)), el("button", {type: "button", class: "small", "data-key": "run-close", onclick: () => {
      dismissed = r.command + r.state;
      drawHead();
    }}, say("dialog.close"))));
  }
  /// Draws the main part of the page; the focus is kept.
  async function draw(moved = false) {
    const name = view();
    if (name === "index.html" && state.night.last === 0) return put([el("h1", {tabindex: -1}, say("site.worklist")), el("p", {}, say("night.none"))], name, moved);
    if (name === "new" && shown === "new" && !moved) return;
    const content = name === "campaigns" ? await campaigns.list(tools()) : name === "machines" ? await campaigns.machines(complain, lines) : name === "instruments" ? await campaigns.instruments(links.some(([to]) => to === "instruments.html")) : name === "settings" ? await campaigns.settings() : name === "new" ? measure.view({out: state.out, created}) :
      name.startsWith("campaign/") ? await campaigns.one(name.slice("campaign/".length), tools()) : name === "certificates" ? await certificatesView() : name === "entries" ? await entriesView() : await pageOfRun(name);
    if (name !== view()) return;
    put(content, name, moved);
  }
  function put(content, name, moved) {
    if (pressed) return void setTimeout(() => put(content, name, moved), 60);
    moved = moved || (shown !== "" && shown !== name);
    document.body.dataset.ready = shown = name;
    const main = by("main"), next = el("div", {}, ...content), same = name + next.innerHTML;
    const focus = document.activeElement;
    if (!moved && drawn === same) return;
    if (!moved && main.contains(focus) && ["INPUT", "SELECT"].includes(focus.tagName) && focus.type !== "file" && name !== "index.html") return;
    const before = main.contains(focus) ? box.focused() : {};
    // Typed text is kept.
    const id = (e) => e.id || `${e.name} ${e.dataset.finding || ""}`, typed_ = new Map();
    for (const e of main.querySelectorAll("input:not([type=file])")) if (!moved && e.value !== e.defaultValue) typed_.set(id(e), e.value);
    for (const e of next.querySelectorAll("input:not([type=file])")) if (typed_.has(id(e))) e.value = typed_.get(id(e));
    if (gone) gone.abort();
    gone = new AbortController();
    drawn = same;
    main.replaceChildren(...next.childNodes);
    nonioLines(main, {signal: gone.signal});
    drawnCharts.adopt(main);
    fitted.draw().catch(() => null);
    drawHead();
    document.title = `${main.querySelector("h1").textContent} \u2013 ${state.site} \u2013 Nonio`;
    if (moved) main.querySelector("h1").focus();
    else box.focusAgain(before);
  }
  let at = "";
  function moved() {
    const hash = location.hash.slice(1);
    if (view() === "index.html") filters = hash.includes("to=") ? filters : hash;
    if (at === view()) return drawHead();
    at = view();
    draw(true).catch(complain);
  }
  addEventListener("hashchange", moved);
  // A filter changes the address by replaceState, which sends no event hashchange.
  document.addEventListener("change", (event) => {
    if (view() !== "index.html" || !event.target.closest(".filters")) return;
    filters = location.hash.slice(1);
    drawHead();
  });

  by("app").replaceChildren(el("div", {id: "alarm", role: "alert", hidden: true}),
    el("header", {}, el("nav", {id: "nav", "aria-label": say("site.pages")}), el("p", {class: "muted", id: "beside"})),
    el("div", {id: "night", role: "status"}), el("div", {id: "run", role: "status"}), el("div", {id: "rights"}),
    el("main", {id: "main"}, el("h1", {}, say("site.reading"))),
    el("footer", {id: "footer", hidden: true}, el("details", {}, el("summary", {id: "command-label"}, say("site.did")), el("code", {id: "command", tabindex: 0, "aria-labelledby": "command-label"}))), el("div", {id: "tip", hidden: true}), ...box.places());
  document.body.className = "site";
  drawnCharts = nonioDrawn({tip: by("tip"), words});

  let soon = 0, all = false;
  function event(e) {
    all = all || !["run", "campaigns"].includes(e.type);
    clearTimeout(soon);
    soon = setTimeout(() => {
      const fresh = all;
      all = false;
      refresh(fresh).catch(complain);
    }, 30);
  }
  refresh().then(() => (at = view())).catch(complain).then(() => net.listen({path: "/api/site/events", since: () => (state ? state.version : 0), event, lost, found: () => {
    box.alarm("");
    refresh().catch(complain);
  }}));
})();
