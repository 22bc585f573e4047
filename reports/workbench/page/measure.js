// ---- a new campaign: a file is dropped, its curve is shown, and the rest is typed or taken from the records of the site ----
const measure = (() => {
  const most = 31 << 20;
  let file = null, preview = null, records = null, columns = [], problem = "", busy = false, current = null, formOf = null;
  // Tables of campaign.toml and their fields; "!": required for a certificate. The names of the fields are in the words.
  const sections = [
    ["machine", ["maker!", "model!", "serial!", "asset"]],
    ["campaign", ["customer!", "customer_address!", "site!", "operator", "date!"]],
    ["axis", ["from", "to", "expansion_um_per_m_K!", "compensation", "tolerance.A", "tolerance.B", "tolerance.E", "tolerance.R"]],
    ["instrument", ["maker!", "model!", "serial!", "calibrated!", "certificate!", "U_fixed_um!", "U_per_m_um!"]],
    ["environment", ["misalignment_mm!", "temperature_range_K!", "temperature_difference_K!", "expansion_range_um_per_m_K!", "drift_um!"]],
    ["certificate", ["conditions"]]];
  const dates = ["date", "calibrated"], texts = ["maker", "model", "serial", "asset", "customer", "customer_address", "site", "operator", "certificate", "conditions"];
  const known = {linear: ["run", "direction", "target_mm", "deviation_um", "position_mm"], rotary: ["run", "direction", "target_deg", "deviation_arcsec", "position_deg"], both: ["time_s", "material_c", "air_c", "pressure_hpa", "humidity_pct", "ignore"]};
  const all = [...new Set([...known.linear, ...known.rotary, ...known.both])];
  const axes = ["X", "Y", "Z", "U", "V", "W", "A", "B", "C"];
  const idOf = (table, field) => `new-${table}-${field.replace("!", "").replace(".", "-")}`;
  const nameOf = (table, field) => say("field." + `${table}_${field.replace("!", "").replace(".", "_")}`.toLowerCase());

  // ---- the file ----
  const body = (form) => new Blob([JSON.stringify(form) + "\n", file]);
  async function read() {
    busy = true;
    problem = "";
    draw();
    try {
      preview = await net.ask("/api/preview", {body: body({name: file.name, columns, axis: fromName().axis}), type: "application/octet-stream"});
      if (!records) records = await net.ask("/api/records");
      // Columns with the names of an earlier file have the same meaning.
      const header = keysOf(preview.rows ? preview.rows[0].map((c) => c.trim()) : []);
      const earlier = columns.length === 0 && preview.error && records.columns.find((list) => list.every((one) => header.includes(nameIn(one))));
      if (earlier) {
        columns = [...earlier];
        return read();
      }
    } catch (e) {
      preview = null;
      problem = e.message || String(e);
    }
    busy = false;
    draw();
    if (by("new-read")) by("new-read").focus();
  }
  function take(one) {
    if (!one) return;
    file = one;
    preview = null;
    columns = [];
    if (one.size > most) {
      problem = say("new.large", {most: most >> 20});
      file = null;
      return draw();
    }
    if (!location.hash.includes("to=new")) location.hash = "#to=new";
    read();
  }
  function drop() {
    const input = el("input", {type: "file", class: "unseen", id: "new-file", "data-key": "new-file", accept: ".csv,.txt,.dat,.log,.rtl,.rta,.xlsx,.ods", onchange: () => take(input.files[0])});
    const zone = el("div", {class: "drop", id: "new-drop"}, el("label", {}, el("span", {}, say("new.drop") + " "), input, el("span", {class: "choose"}, say(file ? "new.choose_other" : "new.choose_file"))));
    for (const [name, over] of [["dragenter", true], ["dragover", true], ["dragleave", false], ["drop", false]])
      zone.addEventListener(name, (event) => {
        event.preventDefault();
        zone.classList.toggle("over", over);
        if (name === "drop") take(event.dataTransfer.files[0]);
      });
    return zone;
  }

  // ---- the curve ----
  const number = (v, digits) => local(v.toFixed(digits));
  let charts = null, redraw = null;
  /// Deviation over position, one line for each run and direction.
  function plot(p) {
    const unit = shownUnit(p.deviation_unit), [low, high] = nonioExtremes([0, ...p.deviation]), edge = 0.06 * (high - low) || 1, ends = nonioExtremes(p.position);
    const picture = svg("svg", {class: "curve", role: "img", "aria-label": say("new.plot", {n: p.position.length, low: short(low), high: short(high), unit, from: short(ends[0]), to: short(ends[1]), at: p.position_unit})});
    const figure = el("figure", {id: "new-plot"}, picture, el("figcaption", {class: "muted"}, el("span", {class: "key plus"}, "\u25B2 +"), " ", el("span", {class: "key minus"}, "\u25BD \u2212"), " ", say("new.taken", {n: preview.readings, missing: preview.missing})));
    const rows = p.position.map((at, i) => i), passes = new Map();
    for (const i of rows) {
      const key = `${p.run[i]} ${p.direction[i]}`;
      passes.set(key, [...(passes.get(key) || []), i]);
    }
    charts = charts || nonioCharts({tip: by("tip"), words: () => words, number, zoomed: () => redraw()});
    charts.forget();
    charts.keep(() => false);
    redraw = () => {
      const frame = new charts.Frame(picture, "new", p.position, {width: 640, to: 250, range: [low - edge, high + edge], said: {x: `${say("new.position")} / ${p.position_unit}`, y: unit}});
      for (const one of passes.values()) frame.line(one.map((i) => p.position[i]), one.map((i) => p.deviation[i]), "pass " + (p.direction[one[0]] < 0 ? "minus" : "plus"));
      frame.scatter(rows, p.position, p.deviation, {direction: p.direction, painted: true,
        about: (i) => [`${short(p.position[i])} ${p.position_unit}: ${short(p.deviation[i])} ${unit}`, `${say("new.run", {run: p.run[i]})} ${p.direction[i] < 0 ? "\u2212" : "+"}`]});
    };
    redraw();
    return figure;
  }

  // ---- columns that were not recognized ----
  const nameIn = (one) => one.slice(0, one.lastIndexOf("=")).trim();
  /// The key of a column: its name, or its number if the name is empty or not unique.
  const keysOf = (names) => names.map((n, k) => (n !== "" && !/^#\d+$/.test(n) && names.indexOf(n) === names.lastIndexOf(n) ? n : `#${k + 1}`));
  const stated = (key, name) => {
    const one = columns.find((c) => nameIn(c) === key);
    return one ? one.slice(one.lastIndexOf("=") + 1).trim() : all.includes(name) ? name : "";
  };
  function mapping() {
    const [head, ...rest] = preview.rows, names = head.map((n) => n.trim()), keys = keysOf(names);
    const choose = () => {
      const selects = [...document.querySelectorAll("#new-columns select")];
      columns = selects.map((s) => `${s.dataset.column} = ${s.value || "ignore"}`);
      const chosen = selects.map((s) => s.value);
      const whole = ["run", "direction"].every((k) => chosen.includes(k)) && chosen.some((k) => k.startsWith("target_")) && chosen.some((k) => /^(deviation|position)_/.test(k));
      if (whole) read();
    };
    return el("section", {id: "new-columns", "aria-labelledby": "columns-title"}, el("h2", {id: "columns-title"}, say("new.columns")), el("p", {}, say("new.columns_what")),
      el("div", {class: "scroll", role: "group", tabindex: 0, "aria-labelledby": "columns-title"}, el("table", {}, el("thead", {}, el("tr", {}, ...names.map((n) => el("th", {scope: "col"}, entries.visible(n)))),
        el("tr", {}, ...names.map((n, k) => el("td", {}, el("select", {"data-column": keys[k], "data-key": "column-" + k, "aria-label": say("new.column_is", {name: n || k + 1}), onchange: choose}, el("option", {value: ""}, say("new.choose")), ...all.map((a) => el("option", {value: a, selected: a === stated(keys[k], n)}, say("column.of_" + a)))))))),
      el("tbody", {}, ...rest.map((r) => el("tr", {}, ...names.map((n, k) => el("td", {}, entries.visible(r[k] || ""))))))))); 
  }

  // ---- the form ----
  const fieldOf = (table, field) => current.querySelector("#" + idOf(table, field));
  function set(values) {
    for (const [table, fields] of sections) for (const field of fields) {
      const plain = field.replace("!", ""), axis = current.querySelector("#new-axis").value;
      const value = values[table === "axis" ? `machine.axes.${axis}.${plain}` : `${table}.${plain}`], input = fieldOf(table, field);
      if (input && value !== undefined && input.value === "") input.value = value;
    }
    lacking();
  }
  function choose(kind, list) {
    const select = el("select", {id: "new-known-" + kind, "data-key": "new-known-" + kind, onchange: () => {
      const one = list[Number(select.value)];
      for (const [table, fields] of sections) if (table === kind) for (const field of fields) fieldOf(table, field).value = "";
      if (one) set(one.values);
    }}, el("option", {value: ""}, say("new.other")), ...list.map((m, k) => el("option", {value: k}, entries.visible(m.name))));
    return el("label", {class: "wide"}, el("span", {}, say("new.known")), select);
  }
  function input(table, field) {
    const plain = field.replace("!", ""), id = idOf(table, field), needed = field.endsWith("!"), more = {id, "data-key": id, "data-needed": needed || null, oninput: lacking};
    let control = null;
    if (plain === "compensation") control = el("select", more, el("option", {value: ""}, say("new.not_stated")), el("option", {value: "none"}, say("new.none_active")));
    else if (dates.includes(plain)) control = el("input", {...more, type: "date", max: today()});
    else if (texts.includes(plain)) control = el("input", {...more, type: "text", maxlength: 300, autocomplete: "off"});
    else control = el("input", {...more, type: "text", inputmode: "decimal", maxlength: 30, autocomplete: "off"});
    return el("label", {class: plain === "conditions" ? "field long" : "field"}, el("span", {}, nameOf(table, field)), control);
  }
  const today = () => {
    const d = new Date();
    return `${d.getFullYear()}-${String(d.getMonth() + 1).padStart(2, "0")}-${String(d.getDate()).padStart(2, "0")}`;
  };
  /// Date and axis from a file name such as FP12_X_20240302.rtl.
  function fromName() {
    const date = /(?:^|\D)(20\d\d)-?([01]\d)-?([0-3]\d)(?:\D|$)/.exec(file.name), axis = /(?:^|[_ .-])([XYZUVWABCxyzuvwabc])(?=[_ .-])/.exec(file.name);
    return {date: date ? `${date[1]}-${date[2]}-${date[3]}` : "", axis: axis ? axis[1].toUpperCase() : ""};
  }
  /// Values from the operator's text in a laser file: "Machine:Test bed; Serial No:17".
  function fromText() {
    const of = new Map((preview.text || "").split("; ").map((one) => [one.slice(0, one.indexOf(":")).trim().toLowerCase(), one.slice(one.indexOf(":") + 1).trim()]));
    const day = /^20\d\d-[01]\d-[0-3]\d/.exec(of.get("date") || "");
    return {axis: (of.get("axis") || "").toUpperCase(), date: day ? day[0] : "", model: of.get("machine"), serial: of.get("serial no"), operator: of.get("by"), site: of.get("location")};
  }
  function lacking() {
    const needed = [...current.querySelectorAll("[data-needed]")].filter((i) => i.value.trim() === "").map((i) => i.closest("label").querySelector("span").textContent);
    current.querySelector("#new-lacks").textContent = needed.length ? say("new.lacks", {list: needed.join("; ")}) : say("new.lacks_nothing");
  }
  function form() {
    const name = fromName(), typed_ = fromText(), allowed = axes.filter((a) => "ABC".includes(a) === preview.rotary), axis = preview.axis || [typed_.axis, name.axis].find((a) => allowed.includes(a)) || allowed[0];
    const choice = el("select", {id: "new-axis", "data-key": "new-axis"}, ...allowed.map((a) => el("option", {value: a, selected: a === axis}, a)));
    const refuse = el("p", {class: "flag", role: "alert", id: "new-refused"}), go = el("button", {type: "submit", class: "strong", id: "new-create", "data-key": "new-create"}, say(tools.out ? "new.create_run" : "new.create"));
    const lists = {machine: records.machines, instrument: records.instruments};
    const made = el("form", {id: "new-form", autocomplete: "off", onsubmit: async (event) => {
      event.preventDefault();
      go.disabled = true;
      refuse.textContent = "";
      try {
        await create();
      } catch (e) {
        refuse.textContent = e instanceof net.Refused || e instanceof Error ? e.message : String(e);
        go.disabled = false;
        const wrong = e.answer && e.answer.key && by(idOf(...e.answer.key.split(/\.(.*)/)));
        if (wrong) wrong.focus();
      }
    }}, ...sections.map(([table, fields]) => el("fieldset", {}, el("legend", {}, say("new.part_" + table)), lists[table] && lists[table].length ? choose(table, lists[table]) : null,
      el("div", {class: "fields"}, table === "axis" ? el("label", {class: "field"}, el("span", {}, say("new.axis")), choice) : null, ...fields.filter((f) => !(preview.rotary && f.startsWith("expansion"))).map((f) => input(table, f))))),
    el("p", {class: "muted", id: "new-lacks", role: "status"}), refuse, el("div", {class: "buttons"}, go));
    current = made;
    for (const [table, field] of [["machine", "model"], ["machine", "serial"], ["campaign", "operator"], ["campaign", "site"]]) fieldOf(table, field).value = typed_[field] || "";
    fieldOf("campaign", "date").value = typed_.date || name.date || (file.lastModified ? new Date(file.lastModified).toISOString().slice(0, 10) : today());
    if (records.instruments.length === 1) {
      made.querySelector("#new-known-instrument").value = "0";
      set(records.instruments[0].values);
    }
    lacking();
  }
  async function create() {
    const values = {};
    for (const [table, fields] of sections) for (const field of fields) {
      const one = fieldOf(table, field), key = `${table}.${field.replace("!", "")}`;
      if (one && one.value.trim() !== "") values[key] = one.value.trim();
    }
    const answer = await net.ask("/api/campaigns", {body: body({name: file.name, columns, axis: current.querySelector("#new-axis").value, values}), type: "application/octet-stream"});
    if (values[["campaign", "operator"].join(".")]) entries.remember(values[["campaign", "operator"].join(".")]);
    file = preview = records = current = null;
    columns = [];
    await tools.created(answer);
  }

  let tools = {};
  function content() {
    const parts = [el("h1", {tabindex: -1}, say("new.title")), drop()];
    if (problem) parts.push(el("p", {class: "flag", role: "alert", id: "new-problem"}, problem));
    if (busy) parts.push(el("p", {role: "status"}, say("site.reading")));
    if (busy || !preview) return parts;
    parts.push(el("h2", {id: "new-read", tabindex: -1}, entries.visible(file.name)));
    if (preview.text) parts.push(el("p", {class: "muted", id: "new-text"}, say("new.text", {text: entries.visible(preview.text)})));
    if (preview.points) parts.push(plot(preview.points));
    const map = preview.rows && (preview.error || columns.length), first = map && columns.length === 0 && !preview.error?.line;
    if (preview.error) {
      const message = el("span", {lang: "en"}, entries.visible((preview.error.line ? say("new.line", {line: preview.error.line}) + " " : "") + preview.error.message));
      parts.push(first ? el("details", {id: "new-unread"}, el("summary", {}, say("new.unread")), message) : el("p", {class: "flag", id: "new-unread"}, say("new.unread"), " ", message));
    }
    if (map && preview.points) parts.push(el("details", {id: "new-columns-used"}, el("summary", {}, say("new.columns_used")), mapping()));
    else if (map) parts.push(mapping());
    if (preview.points && formOf !== preview) form();
    formOf = preview;
    if (preview.points) parts.push(current);
    return parts;
  }
  function draw() {
    if (by("new-view")) by("new-view").replaceChildren(...content());
  }
  /// The view, made once: it is redrawn only when another file is dropped, so that typed text is kept.
  function view(with_) {
    tools = with_;
    return [el("div", {id: "new-view"}, ...content())];
  }
  return {view, drop};
})();
