// ---- the campaigns of a site: a list with search and filter, its machines, and one campaign with its verdict and documents ----
const campaigns = (() => {
  const query = {search: "", state: "", page: 0}, ofMachines = {search: "", page: 0}, size = 50;
  const states = ["new", "failed", "attention", "ok", "does not conform", "cannot be decided", "conforms", "draft", "certificate"];
  const wordOf = (state) => say("list.is_" + state.replace(/ /g, "_"));
  const link = (key, text, onclick, more = {}) => el("button", {type: "button", class: "link", "data-key": key, onclick, ...more}, text);
  const hrefOf = (folder) => "#to=" + encodeURIComponent("campaign/" + folder);
  const nameOf = (c) => c.machine || c.model || c.id || c.folder;

  /// State and verdict: in words, and by a mark that is readable without color.
  const marks = {new: "\u25CB", failed: "\u2716", attention: "!", changed: "!", overdue: "!", ok: "\u2714", "does not conform": "\u2716", conforms: "\u2714"};
  function badge(state) {
    return state ? el("span", {class: "badge " + state.replace(/ /g, "-")}, `${marks[state] || "?"} ${wordOf(state)}`) : null;
  }
  /// Files by purpose: the report, the certificate or its draft, and the rest.
  function documents(c, {fetchFile, send}) {
    const id = c.id, get = (file) => () => fetchFile(`${id}/${file}`), first = [], rest = [];
    for (const file of c.files) {
      const word = file === "certificate.pdf" ? "list.certificate" : file === "certificate-draft.pdf" ? "list.draft" : /report.*\.pdf$/.test(file) ? "list.report" : null;
      if (word) first.push(link(`get-${c.folder}-${file}`, say(word), get(file)));
      else if (file !== "run.json") rest.push(el("li", {}, link(`get-${c.folder}-${file}`, file, get(file))));
      if (word && word !== "list.draft" && send) first.push(link(`send-${c.folder}-${file}`, say("mail.short"), () => send(id, file), {"aria-label": `${say("mail.title")}: ${say(word)}`}));
    }
    return [...first, rest.length ? el("details", {}, el("summary", {}, say(first.length ? "list.files" : "list.only_files", {n: rest.length})), el("ul", {class: "plain"}, ...rest)) : null].filter(Boolean);
  }
  function row(c, tools) {
    return el("tr", {"data-folder": c.folder}, el("td", {class: "day"}, c.day || "\u2013"),
      el("td", {}, el("a", {href: hrefOf(c.folder), "data-key": "one-" + c.folder}, entries.visible(nameOf(c))), c.machine && c.model ? el("span", {class: "muted block"}, entries.visible(c.model)) : null),
      el("td", {}, entries.visible(c.customer || ""), el("span", {class: "muted block"}, entries.visible(c.id || c.folder))),
      el("td", {}, badge(c.state), " ", badge(c.verdict), c.changed ? el("span", {class: "muted block"}, say("list.changed")) : null,
        c.certificate ? el("span", {class: "muted block"}, say("list.number", {number: c.certificate})) : null,
        c.message ? el("span", {class: "flag block"}, entries.visible(c.message)) : null),
      el("td", {class: "files"}, ...documents(c, tools)),
      el("td", {}, el("div", {class: "acts"}, ...tools.buttons(c.folder, c.folder))));
  }
  async function load() {
    const p = new URLSearchParams({search: query.search, state: query.state, page: query.page, size});
    return net.ask("/api/campaigns?" + p);
  }
  function table(answer, tools) {
    if (answer.found === 0) return answer.complete ? [el("p", {id: "campaign-none"}, answer.all === 0 ? say("list.none") : say("list.no_such"))] : [];
    return [el("div", {class: "scroll", role: "group", tabindex: 0, "aria-label": say("site.campaigns")}, el("table", {class: "lines campaigns-table"}, el("thead", {}, el("tr", {}, ...["day", "machine", "customer", "state", "documents", "actions"].map((w) => el("th", {scope: "col"}, say("list." + w))))),
      el("tbody", {}, ...answer.campaigns.map((c) => row(c, tools))))),
    pager(answer, query, tools.again)];
  }
  function pager(answer, of, again) {
    const pages = Math.ceil(answer.found / size), from = of.page * size + 1, turn = (by_) => () => {
      of.page += by_;
      again();
    };
    return pages > 1 ? el("p", {class: "pager"}, el("button", {type: "button", id: "page-before", "data-key": "page-before", disabled: of.page === 0, onclick: turn(-1)}, say("list.before")), " ",
      say("list.range", {from, to: Math.min(from + size - 1, answer.found), n: answer.found}), " ",
      el("button", {type: "button", id: "page-after", "data-key": "page-after", disabled: of.page + 1 >= pages, onclick: turn(1)}, say("list.after"))) : null;
  }
  let wait = 0;
  /// Sets a value of a query and loads its first page; after a moment while a person types.
  function setQuery(of, key, value, again) {
    of[key] = value;
    of.page = 0;
    clearTimeout(wait);
    wait = setTimeout(again, key === "search" ? 200 : 0);
  }
  const count = (answer) => (answer.complete ? say("site.number", {n: answer.found, all: answer.all}) : say("list.reading", {n: answer.all}));

  /// tools: {edit, out, running, buttons(folder, key), fetchFile, runAll, complain, drop()}.
  async function list(tools) {
    const answer = await load();
    if (query.page > 0 && answer.campaigns.length === 0) query.page = 0;
    const again = async () => {
      try {
        const next = await load();
        if (!by("campaign-list")) return;
        fill(by("campaign-list"), ...table(next, {...tools, again}));
        by("campaign-count").textContent = next.all === 0 && next.complete ? "" : count(next);
      } catch (e) {
        tools.complain(e);
      }
    };
    const search = el("input", {type: "search", id: "campaign-filter", "data-key": "campaign-filter", value: query.search, oninput: () => setQuery(query, "search", search.value, again)});
    const state = el("select", {id: "campaign-state", "data-key": "campaign-state", onchange: () => setQuery(query, "state", state.value, again)},
      el("option", {value: ""}, say("list.any")), ...states.map((s) => el("option", {value: s, selected: s === query.state}, wordOf(s))));
    return [el("h1", {tabindex: -1}, say("site.campaigns")), tools.out ? null : el("p", {class: "note"}, say("site.no_out")),
      answer.all === 0 && answer.complete && tools.edit ? el("section", {}, el("p", {}, say("list.begin")), tools.drop()) : null,
      answer.all === 0 ? null : el("p", {class: "filters"}, tools.edit ? el("a", {class: "button strong", id: "new", href: "#to=new", "data-key": "new"}, say("new.short")) : null,
        el("label", {}, say("list.search") + " ", search), el("label", {}, say("list.only") + " ", state),
        tools.edit && tools.out ? el("button", {type: "button", id: "run-all", "data-key": "run-all", title: say("run.all_what"), disabled: tools.running, onclick: tools.runAll}, say("run.all")) : null),
      el("p", {class: "muted", role: "status", id: "campaign-count"}, answer.all === 0 && answer.complete ? "" : count(answer)), el("div", {id: "campaign-list"}, ...table(answer, {...tools, again}).filter(Boolean))].filter(Boolean);
  }

  /// lines: the worklist, which states what the newest campaign alone does not.
  async function machines(complain, lines) {
    const load_ = () => net.ask("/api/machines?" + new URLSearchParams({search: ofMachines.search, page: ofMachines.page, size}));
    const first = await load_();
    ofMachines.page = first.page;
    const again = async () => {
      try {
        const next = await load_();
        if (by("machine-list")) fill(by("machine-list"), ...machineTable(next, again, lines));
      } catch (e) {
        complain(e);
      }
    };
    const search = el("input", {type: "search", id: "machine-filter", "data-key": "machine-filter", value: ofMachines.search, oninput: () => setQuery(ofMachines, "search", search.value, again)});
    return [el("h1", {tabindex: -1}, say("site.machines")), first.all === 0 ? el("p", {}, say("list.no_machines")) : el("p", {class: "filters"}, el("label", {}, say("list.search") + " ", search)),
      el("div", {id: "machine-list"}, ...machineTable(first, again, lines))];
  }
  function machineTable(answer, again, lines) {
    const also = (m) => ["changed", "overdue"].filter((kind) => lines.some((l) => l.machine === m && l.kind === kind && l.state === "new")).flatMap((kind) => [" ", badge(kind)]);
    const columns = ["machine", "model", "customer", "last", "state", "number_of", "history"];
    if (answer.found === 0) return answer.all === 0 ? [] : [el("p", {role: "status"}, say("list.no_such_machine"))];
    return [el("div", {class: "scroll", role: "group", tabindex: 0, "aria-label": say("site.machines")}, el("table", {class: "lines machines-table"}, el("thead", {}, el("tr", {}, ...columns.map((w) => el("th", {scope: "col"}, say("list." + w))))),
        el("tbody", {}, ...answer.machines.map((m) => {
          return el("tr", {}, el("td", {}, link("machine-" + m.machine, entries.visible(m.machine), () => {
            Object.assign(query, {search: m.machine, state: "", page: 0});
            location.hash = "#to=campaigns";
          })), el("td", {}, entries.visible(m.model)), el("td", {}, entries.visible(m.customer)), el("td", {class: "day"}, m.day || "\u2013"), el("td", {}, badge(m.state), " ", badge(m.verdict), ...also(m.machine)),
          el("td", {class: "number", "data-label": say("list.number_of")}, m.campaigns), el("td", {}, m.page ? el("a", {href: "#to=" + encodeURIComponent(m.page), "data-key": "history-" + m.machine}, say("list.history")) : "\u2013"));
        })))), pager(answer, ofMachines, again)].filter(Boolean);
  }

  /// Instruments with their last calibration: the earliest end of validity first, so that expired ones are at the top.
  async function instruments(history) {
    const {instruments: all} = await net.ask("/api/instruments"), now = new Date().toISOString().slice(0, 10);
    const sorted = all.sort((a, b) => ((a.until || "9999") < (b.until || "9999") ? -1 : 1));
    return [el("h1", {tabindex: -1}, say("site.instruments")), all.length === 0 ? el("p", {}, say("list.no_instruments")) :
      el("div", {class: "scroll", role: "group", tabindex: 0, "aria-label": say("site.instruments")}, el("table", {class: "lines machines-table", id: "instrument-list"}, el("thead", {}, el("tr", {}, ...["instrument", "calibrated", "its_certificate", "until", "used_by"].map((w) => el("th", {scope: "col"}, say("list." + w))))),
        el("tbody", {}, ...sorted.map((i) => el("tr", {}, el("td", {}, entries.visible(i.name)), el("td", {class: "day", "data-label": say("list.calibrated")}, i.calibrated || "\u2013"), el("td", {"data-label": say("list.its_certificate")}, entries.visible(i.certificate || "\u2013")),
          el("td", {class: "day", "data-label": say("list.until")}, !i.until ? "\u2013" : i.until < now ? el("span", {class: "badge failed"}, `\u2716 ${say("list.expired", {day: i.until})}`) : i.until),
          el("td", {}, el("details", {}, el("summary", {}, say("list.campaigns", {n: i.number})), el("ul", {class: "plain"}, ...i.campaigns.map((c) => el("li", {}, c.day || "\u2013", " ", el("a", {href: hrefOf(c.folder)}, entries.visible(c.machine || c.id || c.folder)))))))))))), el("p", {class: "muted"}, say("list.until_what")), history ? el("p", {}, el("a", {href: "#to=instruments.html"}, say("list.history"))) : null].filter(Boolean);
  }

  /// The settings of the site, read-only.
  async function settings() {
    const all = await net.ask("/api/settings");
    const shownAs = (name, v) => (v === null ? say("set.all") : v === true ? say("set.yes") : v === false ? say("set.no") : name === "languages" && v.length === 0 ? say("set.default", {value: "en"}) : name === "decision_rule" && v === "" ? say("set.default", {value: "ISO 14253-1:2017"}) : Array.isArray(v) ? v.join(", ") || say("set.none") : name === "seconds" ? `${v} s` : name === "numbering" ? String(v).replace("{year}", "2026").replace(/\{number(?::(\d+))?\}/, (all_, digits) => "1".padStart(Number(digits || 1), "0")) : String(v)) || "\u2013";
    return [el("h1", {tabindex: -1}, say("site.settings")), el("p", {class: "muted"}, say("set.what")), ...["laboratory", "certificate", "run"].map((part) => el("section", {"aria-labelledby": "set-" + part}, el("h2", {id: "set-" + part}, say("set.of_" + part)),
      el("dl", {class: "settings"}, ...Object.entries(all[part]).flatMap(([name, v]) => [el("dt", {}, say("set." + `${part}_${name}`)), el("dd", {}, entries.visible(shownAs(name, v)))])))),
    all.users ? el("section", {"aria-labelledby": "set-users"}, el("h2", {id: "set-users"}, say("set.of_users")), entries.table({label: say("set.of_users"), columns: ["user.account", "set.name", "set.role", "set.password"]}, all.users.map((u) => el("tr", {}, el("th", {scope: "row"}, entries.visible(u.account)), el("td", {}, entries.visible(u.name)), el("td", {}, say("user.may_" + u.role)), el("td", {}, shownAs("", u.password)))))) : null].filter(Boolean);
  }

  // ---- one campaign ----
  const json = async (id, file) => JSON.parse(await (await net.ask(`/site/results/${encodeURIComponent(id)}/${file}`, {raw: true})).text());
  /// Results with a decision, each with its U and its limit; and A, B, E, R of a positioning test without a limit. Without
  /// either, the first results of each analysis, as on a terminal.
  function decisions(results) {
    const decided = new Map((results.conformity || []).map((d) => [[d.plugin, d.measurement, d.name].join("\n"), d]));
    const all = (results.analyses || []).map((a) => [a, Object.entries(a.values || {})]), most = 6;
    const decisionOf = (a, name) => decided.get([a.plugin, a.measurement, name].join("\n"));
    let shown = all.flatMap(([a, values]) => values.filter(([name]) => decisionOf(a, name) || (a.values.A && a.values.R && ["A", "B", "E", "R"].includes(name))).map(([name, v]) => [a, name, v]));
    const ofOneDirection = (a, name) => /.[+-]$/.test(name) && name.slice(0, -1) in a.values, ofTest = (name) => name.startsWith("lack_of_fit") || name === "redundancy";
    if (shown.length === 0) shown = all.flatMap(([a, values]) => values.filter(([name]) => !ofOneDirection(a, name) && !ofTest(name)).slice(0, most).map(([name, v]) => [a, name, v]));
    const columns = decided.size ? ["value", "result", "limit", "decision"] : ["value", "result"];
    const rows = shown.map(([a, name, v]) => {
      const d = decisionOf(a, name), unit = shownUnit(v.unit || "");
      const number = !finite(v.value) ? "\u2013" : finite(v.U) && v.U > 0 ? withExpanded(v.value, v.U).join(" \u00B1 ") : !unit && Number.isInteger(v.value) ? String(v.value) : short(v.value);
      const of = a.part || a.measurement, limit = d ? `${local(String(d.tolerance))} ${unit}` : "\u2013";
      return el("tr", {}, el("th", {scope: "row"}, `${of ? entries.visible(of) + ": " : ""}${words["one.value_" + name] || name}`), el("td", {class: "number"}, `${number} ${unit}`), ...(decided.size ? [el("td", {class: "number"}, limit), el("td", {}, d ? badge(d.decision) : "\u2013")] : []));
    });
    return [decided.size === 0 ? el("p", {}, say("one.no_limits")) : null, rows.length === 0 ? null :
      el("div", {class: "scroll", role: "group", tabindex: 0, "aria-label": say("one.verdict")}, el("table", {id: "decisions"}, el("thead", {}, el("tr", {}, ...columns.map((w) => el("th", {scope: "col"}, say("one." + w))))), el("tbody", {}, ...rows)))];
  }
  /// An error with its file, line and column.
  const errorText = (e) => entries.visible([[[e.file, e.line].filter(Boolean).join(":"), e.column ? `(${e.column})` : ""].filter(Boolean).join(" "), e.message].filter(Boolean).join(": "));
  /// Keys that campaign.toml lacks for a certificate, by their names in the form.
  function missing(results) {
    const keys = [];
    for (const f of [...(results.findings || []), ...(results.tables || []).flatMap((t) => t.findings || []), ...(results.analyses || []).flatMap((a) => a.findings || [])])
      if (f.id === "certificate.incomplete" && f.evidence && f.evidence.missing) keys.push(...f.evidence.missing.split(/, (?![^(]*\))/));
    const names = new Set(keys.map((key) => fieldName(key.replace(/ \(.*/, ""))));
    return names.size ? el("div", {class: "note", id: "missing"}, el("p", {}, say("one.missing")), el("ul", {}, ...[...names].map((n) => el("li", {}, n)))) : null;
  }
  /// Findings with sentence and action as on a terminal; those of severity info are closed.
  function findings(all) {
    const head = (f) => entries.visible(f.title + (f.measurements.length ? ` (${f.measurements.join(", ")})` : ""));
    const shownText = (s) => entries.visible(typeset(s)), is_syntax = (s) => /\bnonio |\[\[?[a-z]|\.toml|[a-z]{2}_[a-z]{2}|_(um|mm|deg|K)\b|`/.test(s);
    /// Sentences with keys or commands are in a drawer.
    const texts = (f) => {
      const made = [...f.says.map((s) => [s, el("p", {}, shownText(s))]), ...f.advice.map((s) => [s, el("p", {}, el("b", {}, say("one.advice")), " ", shownText(s))])];
      const drawer = made.filter(([s]) => is_syntax(s)).map(([, p]) => p);
      return [...made.filter(([s]) => !is_syntax(s)).map(([, p]) => p), drawer.length ? el("details", {}, el("summary", {}, say("one.advice_files")), ...drawer) : null];
    };
    const rows = all.map((f) => (f.severity === "attention" ? el("li", {class: "attention"}, el("h3", {}, head(f)), ...texts(f)) : el("li", {}, el("details", {}, el("summary", {}, head(f)), ...texts(f)))));
    return rows.length ? [el("section", {"aria-labelledby": "found-title"}, el("h2", {id: "found-title"}, say("one.found")), el("ul", {id: "found", class: "plain"}, ...rows))] : [];
  }
  function fieldName(key) {
    const plain = key.replace(/^machine\.axes\.\w+\./, "axis.").replace(/[^A-Za-z0-9]/g, "_").toLowerCase();
    return words["field." + plain] || say("one.other_key");
  }
  async function one(folder, tools) {
    const {campaigns: found} = await net.ask("/api/campaigns?" + new URLSearchParams({folder}));
    const c = found.find((x) => x.folder === folder);
    const back = el("a", {href: "#to=campaigns", "data-key": "back-to-list"}, say("one.back"));
    if (!c) return [el("h1", {tabindex: -1}, entries.visible(folder)), el("p", {}, back), el("p", {}, say("one.no_such"))];
    const has = c.files.includes("results.json");
    const [results, drafts, found_] = await Promise.all([has ? json(c.id, "results.json") : {}, c.draft ? net.ask("/api/drafts") : {drafts: []}, has ? net.ask("/api/findings?" + new URLSearchParams({campaign: c.id})) : {findings: []}]);
    const draft = drafts.drafts.find((d) => d.folder === folder);
    const errors = (results.errors || []).map(errorText);
    return [el("h1", {tabindex: -1}, entries.visible(nameOf(c)), c.day ? [", ", el("span", {class: "day"}, c.day)] : null),
      el("p", {id: "one-state"}, badge(c.state), " ", badge(c.verdict), " ", entries.visible([c.customer, c.place].filter(Boolean).join(", "))),
      ...(errors.length ? errors : c.message ? [entries.visible(c.message)] : []).map((text) => el("p", {class: "flag"}, text)), c.changed ? el("p", {class: "note"}, say("list.changed")) : null,
      el("div", {class: "acts wide"}, back, ...tools.buttons(folder, folder)),
      el("div", {class: "answer"}, fitted.places(folder), errors.length ? null : has ? el("section", {id: "verdict-of", "aria-labelledby": "verdict-title"}, el("h2", {id: "verdict-title"}, say("one.verdict")), ...decisions(results)) : el("p", {}, say("one.not_yet"))),
      ...findings(found_.findings),
      missing(results),
      c.files.length ? el("section", {"aria-labelledby": "documents-title"}, el("h2", {id: "documents-title"}, say("list.documents")), el("div", {class: "acts wide"}, ...documents(c, tools))) : null,
      tools.released && tools.released.folder === folder ? tools.releasedNote() : null,
      draft ? el("section", {"aria-labelledby": "approve-title"}, el("h2", {id: "approve-title"}, say("one.approve")), el("ul", {class: "plain"}, certificates.draft(draft, tools.approve, tools.fetchFile, tools.release))) : null].filter(Boolean);
  }
  return {list, machines, instruments, settings, one};
})();
