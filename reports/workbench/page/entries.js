// ---- user entries: acknowledgments and events; each has a command for the terminal ----
const entries = (() => {
  const day = (days) => {
    const d = new Date(Date.now() + 864e5 * days);
    return `${d.getFullYear()}-${String(d.getMonth() + 1).padStart(2, "0")}-${String(d.getDate()).padStart(2, "0")}`;
  };
  /// Text of an untrusted file: characters that are invisible or change the direction of writing are shown by their number.
  const visible = (text) => text.replace(/[\u0000-\u001F\u007F-\u009F\u00AD\u061C\u180E\u200B-\u200F\u2028-\u202E\u2060-\u2069\uFEFF\uFFF9-\uFFFB]/g,
    (c) => (c === "\n" ? c : "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0")));
  let account = ""; // name of the signed-in user, who makes all entries
  const me = () => account || localStorage.getItem("nonio-by") || "";
  const remember = (by_) => account || localStorage.setItem("nonio-by", by_);
  let confirming = ""; // how approvals are confirmed: by password or by name
  const as = (name, confirms) => ([account, confirming] = [name, confirms]);
  const confirms = () => confirming;
  const mine = () => ({value: me(), readonly: account !== ""});

  function field(name, word, more = {}, note = null) {
    const input = el(more.options ? "select" : "input", {id: "field-" + name, name, autocomplete: "off", ...more, options: null},
      ...(more.options || []).map(([value, text]) => el("option", {value, selected: value === more.value}, text)));
    return el("label", {class: "wide"}, el("span", {}, say(word)), input, note ? el("span", {class: "muted"}, note) : null);
  }
  /// A form in a dialog; `send` receives its values. If the server refuses, it stays open and shows the reason.
  function form(title, told, fields, done, send) {
    const problem = el("p", {class: "flag", role: "alert"}), write = el("button", {type: "submit", class: "strong", id: "dialog-write"}, done);
    const body = el("form", {onsubmit: async (event) => {
      event.preventDefault();
      write.disabled = true;
      problem.textContent = "";
      try {
        await send(Object.fromEntries(new FormData(body)));
        by("dialog").close();
      } catch (e) {
        problem.textContent = e.message || String(e);
        write.disabled = false;
      }
    }}, ...fields, problem, el("div", {class: "buttons"}, write, el("button", {type: "button", onclick: () => by("dialog").close()}, say("dialog.close"))));
    box.dialog(title, told, body);
    const first = body.querySelector("input, select");
    if (first) first.focus();
  }
  const who = () => field("by", "entry.by", {required: true, maxlength: 100, ...mine()}, account ? null : say("entry.name_not_checked"));

  /// `line`: an element of `nonio status --actions --json`.
  function acknowledge(line, told, act) {
    form(say("ack.title"), el("p", {}, el("b", {}, [line.machine, line.axis].filter(Boolean).join(" ")), " ", told), [
      el("p", {class: "muted"}, say("ack.what")), who(),
      field("until", "ack.until", {type: "date", required: true, min: day(0), value: day(30)}),
      field("why", "ack.why", {required: true, maxlength: 500}, say("ack.why_such"))],
    say("ack.do"), (v) => {
      remember(v.by);
      return act("ack", {finding: line.id, machine: line.machine, ...v, why: v.why.trim()}, say("ack.done"));
    });
  }
  /// `entry`: an element of `nonio machine ack --json`.
  function withdraw(entry, act) {
    form(say("withdraw.title"), el("p", {}, el("b", {}, [entry.machine, entry.axis].filter(Boolean).join(" ")), " ", say("withdraw.known", {by: visible(entry.by), until: entry.until, why: visible(entry.why)})), [
      el("p", {class: "muted"}, say("withdraw.what")), who(), field("why", "withdraw.why", {maxlength: 500})],
    say("withdraw.do"), (v) => {
      remember(v.by);
      const body = {withdraw: true, by: v.by};
      for (const key of ["finding", "machine", "axis", "quantity"]) if (entry[key]) body[key] = entry[key];
      if (v.why.trim()) body.why = v.why.trim();
      return act("ack", body, say("withdraw.done"));
    });
  }
  const kinds = ["crash", "repair", "compensation", "moved", "instrument", "software", "other"];
  function event(machine, axis, machines, act) {
    const list = el("datalist", {id: "known-machines"}, ...machines.map((m) => el("option", {value: m})));
    form(say("event.title"), el("p", {class: "muted"}, say("event.what")), [
      field("machine", "event.machine", {required: true, list: "known-machines", value: machine || ""}), list,
      field("axis", "event.axis", {value: axis || "", maxlength: 20}, say("event.axis_such")),
      field("kind", "event.kind", {required: true, value: "other", options: kinds.map((k) => [k, say("event.kind_" + k)])}),
      field("date", "event.date", {type: "date", required: true, max: day(0), value: day(0)}),
      field("text", "event.text", {required: true, maxlength: 500}, say("event.text_such")), who()],
    say("event.do"), (v) => {
      remember(v.by);
      return act("event", Object.fromEntries(Object.entries(v).map(([k, x]) => [k, x.trim()]).filter(([, x]) => x !== "")), say("event.done"));
    });
  }
  /// The entry that acknowledges a line: the first match in the file, as in a run.
  function entryOf(line, all) {
    return all.find((a) => a.machine === line.machine && (!a.axis || a.axis === line.axis) && a.by === line.by && a.until === line.until && a.why === line.why);
  }
  function table(head, rows) {
    return el("div", {class: "scroll", role: "group", tabindex: 0, "aria-label": head.label},
      el("table", {}, el("thead", {}, el("tr", {}, ...head.columns.map((w) => el("th", {scope: "col"}, say(w))))), el("tbody", {}, ...rows)));
  }
  /// The page of the entries.
  function show(acknowledged, events, edit, {withdrawOne, addEvent, audit}) {
    const cell = (text, name) => el("td", {class: name}, visible(text || ""));
    return [el("h1", {tabindex: -1}, say("site.entries")),
      el("p", {class: "muted"}, say("entry.when")), audit ? el("p", {}, el("button", {type: "button", id: "audit", "data-key": "audit", onclick: audit}, say("user.audit"))) : "",
      el("section", {"aria-labelledby": "known-title"}, el("h2", {id: "known-title"}, say("entry.acknowledged", {n: acknowledged.length})),
        acknowledged.length === 0 ? el("p", {}, say("entry.none")) : table({label: say("entry.acknowledged", {n: acknowledged.length}), columns: ["entry.until", "entry.machine", "entry.finding", "entry.why", "entry.who", "entry.do"].slice(0, edit ? 6 : 5)},
          acknowledged.map((a, k) => el("tr", {}, cell(a.until, "day"), cell([a.machine, a.axis].filter(Boolean).join(" ")), cell(a.finding), cell(a.why), cell(a.by),
            edit ? el("td", {}, el("button", {type: "button", class: "small", "data-key": "withdraw-entry-" + k, onclick: () => withdrawOne(a)}, say("withdraw.short"))) : null)))),
      el("section", {"aria-labelledby": "events-title"}, el("h2", {id: "events-title"}, say("entry.events", {n: events.length})),
        edit ? el("p", {}, el("button", {type: "button", id: "add-event", "data-key": "add-event", onclick: () => addEvent()}, say("event.short"))) : null,
        events.length === 0 ? el("p", {}, say("entry.none")) : table({label: say("entry.events", {n: events.length}), columns: ["entry.date", "entry.machine", "entry.kind", "entry.text", "entry.who"]},
          [...events].reverse().slice(0, 200).map((e) => el("tr", {}, cell(e.date, "day"), cell([e.machine, e.axis].filter(Boolean).join(" ")), cell(say("event.kind_" + e.kind)), cell(e.text), cell(e.by)))))];
  }
  /// A file of the results to an address of the site.
  async function send(campaign, file, act) {
    const {mail} = (await net.ask("/api/settings")).run, told = el("p", {}, el("b", {}, `${visible(campaign)}: ${visible(file)}`));
    if (mail.length === 0) return void box.dialog(say("mail.title"), told, el("p", {}, say("mail.none")));
    form(say("mail.title"), told, [field("to", "mail.to", {options: mail.map((one) => [one, one])})], say("mail.do"), ({to}) => act("mail", {campaign, file, to}, say("mail.done", {to})));
  }
  return {send, acknowledge, withdraw, event, entryOf, show, visible, as, confirms, me, mine, remember, field, table};
})();
