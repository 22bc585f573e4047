// ---- the server: every request has the token (not in its URL, nor in a cookie) or, on a server
// with users, the session of a user ----
const net = (() => {
  const at = /(?:^|[#&])t=([0-9a-f]{32})(?:&|$)/.exec(location.hash);
  if (at) {
    sessionStorage.setItem("nonio-token", at[1]);
    // The rest of the address is kept: it has the filters of the worklist.
    const rest = location.hash.slice(1).split("&").filter((one) => !one.startsWith("t=")).join("&");
    history.replaceState(null, "", location.pathname + (rest ? "#" + rest : ""));
  }
  // The server of a site has an address for each campaign, to which the requests of its workbench go.
  const base = location.pathname.slice(0, location.pathname.lastIndexOf("/"));
  const token = () => sessionStorage.getItem("nonio-token") || "";

  /// Messages of the program about a fit that the page translates.
  const known = [[/^not separable with these readings: (?<which>.+)$/, "apart"], [/^the readings cannot show (?<which>.+)$/, "not_shown"],
    [/^(?<n>\d+) readings cannot determine (?<unknowns>\d+) unknowns$/, "few"], [/^no reading of part (?<part>.+) is left$/, "none_left"],
    [/^no answer within (?<seconds>\d+) s/, "slow"], [/^a plugin brought the process down in which it ran/, "crashed"],
    [/^the process that calculates has ended/, "restarted"], [/^campaign\.toml has this model already/, "saved_already"]];
  /// All other messages are English, as on a terminal; the page introduces them in its own language.
  function program(text) {
    for (const [form, name] of known) {
      const found = form.exec(text);
      if (found) return say("program." + name, found.groups || {});
    }
    return language === "en" ? text : `${say("net.program")} ${text}`;
  }
  class Refused extends Error {
    constructor(status, answer) {
      super(answer && answer.error ? (answer.lang ? program(answer.error) : answer.error) : say("net.status", {status}));
      this.status = status;
      this.answer = answer || {};
    }
  }
  async function ask(path, {body, type, match, none, raw} = {}) {
    const headers = {"X-Nonio-Token": token()};
    if (match) headers["If-Match"] = `"${match}"`;
    if (none) headers["If-None-Match"] = none;
    const options = {headers, cache: "no-store"};
    if (body !== undefined) {
      options.method = "POST";
      headers["Content-Type"] = type || "application/json";
      options.body = type ? body : JSON.stringify(body);
    }
    const response = await fetch(base + path, options);
    if (response.status === 304) return null;
    if (raw && response.ok) return response.blob();
    const text = await response.text();
    let answer = null;
    try {
      answer = JSON.parse(text);
    } catch (e) {
      answer = {error: text.slice(0, 500)};
    }
    if (!response.ok) {
      // On the page of a campaign the session has ended: the page of the site has the form to sign in.
      if (answer.id === "signed_out" && base !== "") location.href = "/";
      throw new Refused(response.status, answer);
    }
    Object.defineProperty(answer, "etag", {value: response.headers.get("ETag")});
    return answer;
  }

  /// Reads the stream of events forever: a lost connection is reported and resumed after the last event. A hidden tab
  /// has no stream, because a browser has only six connections to a server for all tabs.
  async function listen({since, event, lost, found, path = "/api/events"}) {
    let wait = 500, stop = null, gone = false;
    document.addEventListener("visibilitychange", () => document.hidden && stop && stop.abort());
    for (;;) {
      if (document.hidden) {
        await new Promise((done) => document.addEventListener("visibilitychange", done, {once: true}));
        continue;
      }
      try {
        stop = new AbortController();
        const response = await fetch(`${base}${path}?since=${since()}`, {headers: {"X-Nonio-Token": token()}, cache: "no-store", signal: stop.signal});
        if (response.status === 403) return lost(403);
        if (response.ok) {
          if (gone) found();
          gone = false;
          wait = 500;
          await read(response.body.getReader(), event);
        }
      } catch (e) {
        if (!document.hidden) {
          gone = true;
          lost(0);
        }
      }
      if (!document.hidden) await new Promise((done) => setTimeout(done, wait));
      wait = Math.min(wait * 1.5, 3000);
    }
  }
  async function read(reader, event) {
    const decoder = new TextDecoder();
    let rest = "";
    for (;;) {
      const {value, done} = await reader.read();
      if (done) return;
      rest += decoder.decode(value, {stream: true});
      for (let end; (end = rest.indexOf("\n\n")) >= 0; rest = rest.slice(end + 2)) {
        const lines = rest.slice(0, end).split("\n").filter((line) => !line.startsWith(":"));
        const of = (name) => lines.filter((line) => line.startsWith(name + ":")).map((line) => line.slice(name.length + 1).trim()).join("\n");
        if (lines.length === 0) continue;
        let data = {};
        try {
          data = JSON.parse(of("data") || "{}");
        } catch (e) {
          // an event with damaged data still reports a change
        }
        event({type: of("event") || "state", id: Number(of("id")) || 0, data});
      }
    }
  }
  /// Stores a file of the server as a download of the browser.
  async function download(path, name) {
    const url = URL.createObjectURL(await ask(path, {raw: true}));
    const link = el("a", {href: url, download: name});
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
  }
  return {ask, listen, download, program, base, hasToken: () => token() !== "", Refused};
})();
