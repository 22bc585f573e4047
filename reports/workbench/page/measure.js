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

  // ---- its curve ----
  const number = (v, digits) => local(v.toFixed(digits));
  /// Deviation over position, one line for each run and direction.
  function plot(p) {
    const W = 640, H = 250, x = 52, y = 12, w = W - x - 16, h = H - y - 54;
    const low = Math.min(...p.position), high = Math.max(...p.position), least = Math.min(0, ...p.deviation), largest = Math.max(0, ...p.deviation);
    const edge = 0.06 * (largest - least) || 1, X = (v) => x + (w * (v - low)) / (high - low || 1), Y = (v) => y + h - (h * (v - least + edge)) / (largest - least + 2 * edge);
    const unit = shownUnit(p.deviation_unit), picture = svg("svg", {viewBox: `0 0 ${W} ${H}`, class: "chart curve", role: "img", "aria-label": say("new.plot", {n: p.position.length, low: short(least), high: short(largest), unit, from: short(low), to: short(high), at: p.position_unit})});
    const text = (at, label, anchor, px, py) => svg("text", {x: px, y: py, "text-anchor": anchor}, label);
    for (const t of nonioTicks(number, least - edge, largest + edge, 5)) picture.append(svg("line", {class: t.at === 0 ? "zero" : "grid", x1: x, x2: x + w, y1: Y(t.at), y2: Y(t.at)}), text(t, t.label, "end", x - 8, Y(t.at) + 5));
    for (const t of nonioTicks(number, low, high || 1, 6)) picture.append(svg("line", {class: "grid", x1: X(t.at), x2: X(t.at), y1: y + h, y2: y + h + 5}), text(t, t.label, "middle", X(t.at), y + h + 20));
    picture.append(text(0, `${say("new.position")}, ${p.position_unit}`, "middle", x + w / 2, H - 5), text(0, unit, "start", 2, y + 6));
    const lines = new Map();
    p.position.forEach((at, i) => {
      const key = `${p.run[i]} ${p.direction[i]}`;
      if (!lines.has(key)) lines.set(key, []);
      lines.get(key).push([at, p.deviation[i]]);
    });
    for (const [key, points] of lines) {
      const kind = key.endsWith("-1") ? "minus" : "plus";
      picture.append(svg("polyline", {class: "curve-line " + kind, points: points.map(([a, b]) => `${X(a).toFixed(1)},${Y(b).toFixed(1)}`).join(" ")}));
      if (p.position.length <= 2000) for (const [a, b] of points) {
        const mark = kind === "plus" ? svg("circle", {class: "curve-mark plus", cx: X(a).toFixed(1), cy: Y(b).toFixed(1), r: 3}) : svg("rect", {class: "curve-mark minus", x: (X(a) - 2.6).toFixed(1), y: (Y(b) - 2.6).toFixed(1), width: 5.2, height: 5.2});
        mark.append(svg("title", {}, `${short(a)} ${p.position_unit}: ${short(b)} ${unit}, ${say("new.run", {run: key.split(" ")[0]})} ${kind === "plus" ? "+" : "\u2212"}`));
        picture.append(mark);
      }
    }
    return el("figure", {id: "new-plot"}, picture, el("figcaption", {class: "muted"}, el("span", {class: "key plus"}, "\u25CF +"), " ", el("span", {class: "key minus"}, "\u25A0 \u2212"), " ", say("new.taken", {n: preview.readings, missing: preview.missing})));
  }

  // ---- columns that were not recognised ----
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
  /// Values from the operator's text in a laser's file: "Machine:Test bed; Serial No:17".
  function fromText() {
    const of = new Map((preview.text || "").split("; ").map((one) => [one.slice(0, one.indexOf(":")).trim().toLowerCase(), one.slice(one.indexOf(":") + 1).trim()]));
    const day = /^20\d\d-[01]\d-[0-3]\d/.exec(of.get("date") || "");
    return {axis: (of.get("axis") || "").toUpperCase(), date: day ? day[0] : "", model: of.get("machine"), serial: of.get("serial no"), operator: of.get("by"), site: of.get("location")};
  }
  function lacking() {
    const needed = [...current.querySelectorAll("[data-needed]")].filter((i) => i.value.trim() === "").map((i) => i.closest("label").querySelector("span").textContent);
    current.querySelector("#new-lacks").textContent = needed.length ? say("new.lacks", {list: needed.join(", ")}) : say("new.lacks_nothing");
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
