# SPDX-License-Identifier: Apache-2.0
"""What a script in the page can see of WCAG 2.2 AA."""

# What hinders people who do not see, do not see well, or have no mouse: the rules of WCAG 2.2 AA that a
# program can judge. Gives the list of what is wrong.
HINDRANCES = r"""(() => {
  const bad = [];
  const shown = (e) => e.getClientRects().length > 0 && getComputedStyle(e).visibility !== "hidden";
  const name = (e) => (e.getAttribute("aria-label") || e.textContent || "").trim();
  const say = (what, e) => bad.push(`${what}: ${e.outerHTML.slice(0, 90)}`);
  if (!document.documentElement.lang) bad.push("no language");
  if (!document.title.trim()) bad.push("no title");
  if (document.querySelectorAll("main").length !== 1) bad.push("not one main");
  if (document.querySelectorAll("h1").length !== 1) bad.push("not one h1");
  let level = 0;
  for (const h of document.querySelectorAll("h1, h2, h3, h4, h5, h6")) {
    if (Number(h.tagName[1]) > level + 1) say(`heading after level ${level}`, h);
    level = Number(h.tagName[1]);
    if (!name(h)) say("empty heading", h);
  }
  const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
  if (new Set(ids).size !== ids.length) bad.push("an id twice");
  for (const e of document.querySelectorAll("a[href], button, summary")) if (!name(e)) say("no name", e);
  for (const e of document.querySelectorAll("select, input"))
    if (!(e.labels && e.labels.length && name(e.labels[0])) && !e.getAttribute("aria-label")) say("no label", e);
  for (const e of document.querySelectorAll("svg"))
    if (shown(e) && e.getAttribute("aria-hidden") !== "true" && !(["img", "application", "group"].includes(e.getAttribute("role")) &&
        (e.getAttribute("aria-label") || e.getAttribute("aria-labelledby") || e.querySelector("title")))) say("no text for a picture", e);
  for (const e of document.querySelectorAll("nav, section[role], [role=region]"))
    if (!e.getAttribute("aria-label") && !e.getAttribute("aria-labelledby")) say("no name", e);
  for (const e of document.querySelectorAll("th")) if (!["row", "col"].includes(e.scope)) say("no scope", e);
  for (const e of document.querySelectorAll("th")) if (!e.textContent.trim()) say("empty head", e);
  for (const e of document.querySelectorAll("[role=img] a[href]")) say("a link within what is one picture", e);
  for (const e of document.querySelectorAll("[tabindex]")) if (e.tabIndex > 0) say("order of tabs", e);
  for (const e of document.querySelectorAll("body *")) {
    const style = getComputedStyle(e);
    if (["auto", "scroll"].includes(style.overflowX) && e.scrollWidth > e.clientWidth && e.tabIndex < 0) say("no key scrolls it", e);
  }
  const channel = (c) => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
  const rgb = (text) => text.match(/[\d.]+/g).map(Number);
  const light = (c) => 0.2126 * channel(c[0]) + 0.7152 * channel(c[1]) + 0.0722 * channel(c[2]);
  const behind = (e) => {
    for (; e; e = e.parentElement) {
      const c = rgb(getComputedStyle(e).backgroundColor);
      if (c.length < 4 || c[3] > 0) return c;
    }
    return [255, 255, 255];
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const seen = new Set();
  while (walker.nextNode()) {
    const e = walker.currentNode.parentElement;
    if (seen.has(e) || !walker.currentNode.textContent.trim() || ["SCRIPT", "STYLE"].includes(e.tagName) || !shown(e)) continue;
    seen.add(e);
    const svg = e.closest("svg");
    const style = getComputedStyle(e);
    const a = light(rgb(svg ? style.fill : style.color)), b = light(behind(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) say(`contrast ${ratio.toFixed(2)}`, e);
    const scale = svg ? svg.getBoundingClientRect().width / svg.viewBox.baseVal.width : 1;
    if (parseFloat(style.fontSize) * scale < 9) say(`letters of ${(parseFloat(style.fontSize) * scale).toFixed(1)} px`, e);
  }
  return bad;
})()"""
