// ---- static pages of the last run (worklist, machines) as elements of this page. Only the elements and attributes listed here
// are made, and the browser never parses the text as markup, so that a page cannot run a script. ----
const markup = (() => {
  const plain = new Set("a b code dd details div dl dt em h1 h2 h3 h4 label li main nav ol option p section select span strong summary table tbody td th thead tr ul".split(" "));
  const drawn = new Set("circle g line path polygon polyline rect svg text title tspan".split(" "));
  const kept = /^(class|title|scope|colspan|rowspan|tabindex|role|hidden|name|value|open|lang|id|href|data-[a-z]+|aria-[a-z]+)$/;
  const never = /^(on|style$|href$|xlink)/;
  const entities = {amp: "&", lt: "<", gt: ">", quot: "\"", apos: "'", nbsp: "\u00A0"};
  const decoded = (text) => text.replace(/&(#x?[0-9a-fA-F]+|[a-z]+);/g, (all, name) => name[0] !== "#" ? entities[name] || all
    : String.fromCodePoint(name[1] === "x" ? parseInt(name.slice(2), 16) : Number(name.slice(1))));
  /// Only relative links are kept: null for one with a scheme or an absolute path.
  const address = (to) => (/^[A-Za-z][A-Za-z0-9+.-]*:|^\/|^\\/.test(to) ? null : to);

  function element(name, attributes, inside) {
    const is_drawn = inside || name === "svg";
    if (!(is_drawn ? drawn.has(name) || name === "a" : plain.has(name))) return null;
    const node = is_drawn ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
    for (const [all, key, value] of attributes.matchAll(/([A-Za-z][\w:-]*)(?:="([^"]*)")?/g)) {
      const text = decoded(value || "");
      if (key === "href") {
        if (address(text) !== null) node.dataset.to = address(text);
      } else if (is_drawn ? !never.test(key) : kept.test(key)) node.setAttribute(key, text);
    }
    if (node.dataset.to && !is_drawn) node.setAttribute("href", "#to=" + encodeURIComponent(node.dataset.to));
    if (node.dataset.to && is_drawn) node.setAttribute("href", "#to=" + encodeURIComponent(node.dataset.to));
    return node;
  }
  /// The elements of `text`, below a new <div>.
  function read(text) {
    const root = el("div");
    const open = [{name: "", node: root}];
    const token = /<(\/?)([A-Za-z][A-Za-z0-9]*)((?:\s+[A-Za-z][\w:-]*(?:="[^"]*")?)*)\s*(\/?)>|([^<]+)|</g;
    for (const [all, closes, name, attributes, alone, said] of text.matchAll(token)) {
      const top = open[open.length - 1];
      if (said !== undefined || name === undefined) {
        if (top.node) top.node.append(decoded(said || all));
      } else if (closes) {
        const at = open.map((one) => one.name).lastIndexOf(name);
        if (at > 0) open.length = at;
      } else {
        const node = top.node && element(name, attributes, top.node.namespaceURI.endsWith("svg"));
        if (node) top.node.append(node);
        if (!alone && !["br", "hr", "meta", "link"].includes(name)) open.push({name, node});
      }
    }
    return root;
  }
  /// The text between the first pair of tags of that name.
  function between(text, name) {
    const from = text.search(new RegExp(`<${name}[ >]`)), to = text.indexOf(`</${name}>`, from);
    return from < 0 || to < 0 ? "" : text.slice(text.indexOf(">", from) + 1, to);
  }
  /// Parts of a whole page: its main part, its links to other pages, and the text next to them.
  function page(text) {
    const header = read(between(text, "header"));
    const beside = header.querySelector("p");
    return {main: read(between(text, "main")), links: [...header.querySelectorAll("a")].map((a) => [a.dataset.to, a.textContent]), beside: beside ? beside.textContent : ""};
  }
  return {read, page};
})();
