// ---- certificates: files to verify, drafts to approve ----
const certificates = (() => {
  const most = 32 << 20;
  const types = {pdf: "application/pdf", xml: "application/xml", json: "application/json"};
  const verified = []; // {name, state, answer}, the newest first

  /// One file after the other, so that many files take no more memory than one.
  async function verify(files, draw) {
    const mine = [...files].map((file) => ({file, name: file.name, state: "waits"}));
    verified.unshift(...mine);
    draw();
    for (const one of mine) {
      const type = types[one.name.toLowerCase().split(".").pop()];
      one.state = "checking";
      draw();
      try {
        if (!type) throw new Error(say("verify.kind"));
        if (one.file.size > most) throw new Error(say("verify.large", {most: most >> 20}));
        one.answer = await net.ask("/api/verify", {body: one.file, type});
        one.state = one.answer.holds ? "holds" : "fails";
      } catch (e) {
        one.state = "failed";
        one.error = e.message || String(e);
      }
      one.file = null;
      draw();
      box.speak(`${one.name}: ${verdict(one)}`);
    }
  }
  function verdict(one) {
    if (one.state === "failed") return say("verify.failed", {error: one.error});
    if (!one.answer) return say("verify." + one.state);
    const key = "verify.verdict_" + one.answer.verdict.replace(/-/g, "_"), text = say(key);
    return one.answer.not_made && one.answer.verdict === "incomplete" ? `${text}: ${[...new Set(one.answer.not_made.map(nameOf))].join(", ")}` : text;
  }
  /// A check in words; a DCC inside a PDF has the checks of a separate one. A check that this version does not know is shown by its id.
  function nameOf(id) {
    const word = (name) => words["check." + name.replace(/\./g, "_")];
    if (id === "dcc") return say("check.dcc_none");
    const rest = id.startsWith("dcc.") ? id.slice(4) : "";
    const what = rest ? word(id) || word("xml_" + rest) || word("certificate_" + rest) || word("signer_" + rest) || rest : word(id) || id;
    return rest ? say("check.dcc", {what}) : what;
  }
  /// The meaning of a failure of this check; nothing for a check that this version does not know.
  function meaning(id) {
    const rest = id.startsWith("dcc.") ? id.slice(4) : "";
    const names = id === "dcc" ? ["dcc_none"] : rest ? ["dcc_" + rest, "xml_" + rest, "certificate_" + rest, "signer_" + rest] : [id];
    const found = names.map((name) => words["failing." + name.replace(/\./g, "_")]).find(Boolean);
    return found ? el("p", {class: "meaning"}, found) : null;
  }
  const sign = {holds: "\u2714", fails: "\u2716", "not checked": "\u2013"};
  function result(one) {
    const checks = one.answer ? one.answer.checks : [];
    const wrong = checks.filter((c) => c.state === "fails");
    return el("li", {class: "verified " + one.state}, el("h3", {}, entries.visible(one.name)), el("p", {class: "verdict"}, verdict(one)),
      one.answer && one.answer.signer ? el("p", {class: "muted"}, say("verify.signer", {signer: entries.visible(one.answer.signer)})) : null,
      checks.length ? el("details", {open: wrong.length > 0}, el("summary", {}, say("verify.checks", {n: checks.length, wrong: wrong.length})),
        entries.table({label: say("verify.checks", {n: checks.length, wrong: wrong.length}), columns: ["verify.check", "verify.state", "verify.says"]},
          checks.map((c) => el("tr", {class: "check-" + c.state.replace(" ", "-")}, el("th", {scope: "row", title: c.id}, nameOf(c.id)), el("td", {}, `${sign[c.state] || ""} ${say("verify.is_" + c.state.replace(" ", "_"))}`), el("td", {}, c.state === "fails" ? meaning(c.id) : null, el("span", {lang: "en", class: c.state === "fails" ? "muted" : null}, entries.visible(c.says))))))) : null);
  }
  function drop(draw) {
    const input = el("input", {type: "file", id: "verify-files", multiple: true, accept: ".pdf,.xml,.json", "data-key": "verify-files", onchange: () => verify(input.files, draw)});
    const zone = el("div", {class: "drop", id: "drop"}, el("label", {}, el("span", {}, say("verify.drop") + " "), input));
    for (const [name, over] of [["dragenter", true], ["dragover", true], ["dragleave", false], ["drop", false]])
      zone.addEventListener(name, (event) => {
        event.preventDefault();
        zone.classList.toggle("over", over);
        if (name === "drop" && event.dataTransfer.files.length) verify(event.dataTransfer.files, draw);
      });
    return zone;
  }

  const keyOf = (f) => (f.measurement ? f.measurement + ": " : "") + f.id;
  function draftForm(draft, act) {
    const asking = draft.findings.filter((f) => f.severity === "attention");
    const given = new Map(asking.map((f) => [keyOf(f), el("input", {name: "reason", required: !f.reason, maxlength: 500, autocomplete: "off", value: f.reason || null, "data-finding": keyOf(f)})]));
    const by_ = el("input", {name: "by", required: true, maxlength: 100, autocomplete: "off", ...entries.mine(), id: "release-by-" + draft.campaign});
    const password = entries.confirms() === "password" ? el("input", {type: "password", name: "password", required: true, maxlength: 200, autocomplete: "current-password", id: "release-password-" + draft.campaign}) : null;
    const confirmed = entries.confirms() === "name" ? el("input", {name: "confirmed", required: true, maxlength: 100, autocomplete: "off", id: "release-name-" + draft.campaign}) : null;
    const as = el("select", {name: "as", id: "release-as-" + draft.campaign}, ...["", "author", "authoriser"].map((value) => el("option", {value}, say("release.as_" + (value || "site")))));
    const problem = el("p", {class: "flag", role: "alert"}), go = el("button", {type: "submit", class: "strong", disabled: Boolean(draft.stale)}, say("release.do"));
    return el("form", {class: "release", onsubmit: async (event) => {
      event.preventDefault();
      go.disabled = true;
      problem.textContent = "";
      const reasons = {};
      for (const [key, input] of given) if (input.value.trim()) reasons[key] = input.value.trim();
      entries.remember(by_.value.trim());
      const body = {campaign: draft.folder, by: by_.value.trim(), reasons};
      if (as.value) body.as = as.value;
      if (password) body.password = password.value;
      if (confirmed) body.confirmed = confirmed.value;
      try {
        await act(body);
      } catch (e) {
        const a = e.answer || {};
        if (password) password.value = "";
        problem.textContent = a.without_reason ? say("release.lacking", {findings: a.without_reason.join("; ")}) : e.message;
        go.disabled = Boolean(draft.stale);
      }
    }}, asking.length ? el("p", {}, say("release.reasons")) : null,
    ...asking.map((f) => el("label", {class: "wide"}, el("span", {}, el("b", {}, entries.visible(f.said || f.title)), " ", el("span", {class: "muted"}, keyOf(f))), given.get(keyOf(f)))),
    el("label", {class: "wide"}, el("span", {}, say("release.by")), by_), el("label", {class: "wide"}, el("span", {}, say("release.as")), as),
    password ? el("label", {class: "wide"}, el("span", {}, say("release.password")), password) : null, confirmed ? el("label", {class: "wide"}, el("span", {}, say("release.confirm", {name: entries.visible(entries.me())})), confirmed) : null,
    el("p", {class: "muted"}, `${say("release.what")} ${entries.confirms() ? "" : say("release.name_not_checked")}`), problem, el("div", {class: "buttons"}, go));
  }
  /// One draft; with `edit` it can be approved.
  function draft(one, edit, fetchFile, act) {
    const file = one.file.split("/").slice(-2).join("/"), info = one.findings.filter((f) => f.severity !== "attention");
    return el("li", {class: "draft", "data-campaign": one.campaign}, el("h3", {}, one.campaign),
      el("p", {}, el("button", {type: "button", class: "link", "data-key": "draft-" + one.campaign, onclick: () => fetchFile(file)}, say("release.read")),
        one.replaces ? " " + say("release.replaces", {number: one.replaces}) : "", one.author ? " " + say("release.author", {name: entries.visible(one.author.name), at: one.author.at}) : ""),
      one.stale ? el("p", {class: "flag"}, say("release.stale")) : null,
      info.length ? el("details", {}, el("summary", {}, say("release.notes", {n: info.length})), el("ul", {}, ...info.map((f) => el("li", {}, `${keyOf(f)}: ${entries.visible(f.said || f.title)}`)))) : null,
      edit ? draftForm(one, act) : el("ul", {}, ...one.findings.filter((f) => f.severity === "attention").map((f) => el("li", {}, `${keyOf(f)}: ${entries.visible(f.said || f.title)}`))));
  }
  /// The verdict on a file of the server, in words.
  async function verdictOf(path) {
    const file = await net.ask(path, {raw: true}), answer = await net.ask("/api/verify", {body: file, type: types.pdf});
    return verdict({answer, state: "checked"});
  }
  const results = () => el("ul", {class: "plain", id: "verified"}, ...verified.map(result));
  return {drop, draft, results, verdictOf};
})();
