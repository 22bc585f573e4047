// SPDX-License-Identifier: Apache-2.0
// Charts that the program has drawn, as on the pages of a laboratory, with the tools of chart.js. The drawing stays as it
// is for those who read the page without scripts; a zoom moves its parts along the axis.
"use strict";
function nonioDrawn({tip, words}) {
  const comma = /^(de|it)/.test(document.documentElement.lang), all = new Map();
  let clips = 0;
  const number = (v, digits) => v.toFixed(digits).replace("-", "\u2212").replace(".", comma ? "," : ".");
  const charts = nonioCharts({tip, words: () => words, number, zoomed: (k, range) => all.get(k)(range)});
  /// Each point of a path; after a marker's first point come its radius or its width.
  const POINT = /([ML])(-?[\d.]+) (-?[\d.]+)(?:a([\d.]+) |h([\d.]+)v)?/g;
  const points = (d) => [...d.matchAll(POINT)].map(([, , x, y, r, w]) => [Number(x) + Number(r || w / 2 || 0), Number(y) + Number(w / 2 || 0)]);
  const digits = (step) => Math.max(0, Math.floor(-Math.log10(step)));

  function adopt(svg) {
    const [x, y, w, h, first, last, low, high] = svg.dataset.frame.split(" ").map(Number), kind = svg.dataset.across;
    const inner = svg.querySelector(".drawn"), across = [...svg.querySelectorAll(".across")], originals = across.map((g) => [...g.childNodes]);
    // A line from one side to the other, such as a limit, stays.
    const is_whole = (node) => node.tagName === "path" && ((all_) => all_[0][0] < x + 0.1 && all_[all_.length - 1][0] > x + w - 0.1)(points(node.getAttribute("d")));
    const groups = kind === "names" ? [inner, ...across] : [inner];
    const moved = groups.flatMap((g) => [...g.querySelectorAll("path, text")]).filter((node) => !is_whole(node));
    const parts = moved.map((node) => {
      const box = node.tagName === "text" ? node.getBBox() : null;
      return [node, node.getAttribute("d"), Number(node.getAttribute("x")), box && kind === "names" ? box.width / 2 : 0];
    });
    const hits = [], table = svg.parentNode.querySelector("table");
    const frame = {svg, g: svg, k: svg, x, y, w, h, left: first, right: last, whole: [first, last], said: {x: svg.dataset.x, y: svg.dataset.y}, points: [], series: [], zoomable: true,
      table: table && (() => [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent)))};
    for (const title of inner.querySelectorAll("title")) {
      const item = title.parentNode, at = [...item.querySelectorAll("path")].flatMap((path) => points(path.getAttribute("d"))), is_event = item.querySelector("text");
      const value = ([px, py]) => [first + ((px - x) / w) * (last - first), high - ((py - y) / h) * (high - low)];
      const about = title.textContent, read = (v) => [about, `${frame.said.x}: ${number(v[0], digits((0.01 * (last - first)) / w))}`, `${frame.said.y}: ${number(v[1], digits((0.01 * (high - low)) / h))}`];
      if (is_event) hits.push([at[0][0], y + 8, [about]]);
      else if (at.length === 1) hits.push([...at[0], [about]]);
      else {
        const values = at.map(value);
        at.forEach((p, i) => hits.push([...p, read(values[i])]));
        frame.series.push([about, values.map((v) => v[0]), values.map((v) => v[1])]);
      }
      if (item.tagName === "a") item.setAttribute("aria-label", about);
      title.remove();
    }
    const inside = "drawn-" + ++clips;
    charts.put(charts.put(svg, "clipPath", {id: inside}), "rect", {x: x - 7, y: y - 7, width: w + 14, height: h + (kind === "names" ? 40 : 14)});
    for (const g of groups) g.setAttribute("clip-path", `url(#${inside})`);
    const place = () => {
      const scale = (last - first) / (frame.right - frame.left), px = (v) => charts.r1(x + scale * (v - x) - (scale * w * (frame.left - first)) / (last - first));
      for (const [node, d, at, half] of parts)
        if (d) node.setAttribute("d", d.replace(POINT, (text, pen, v, rest, r, wide) => {
          const middle = Number(r || wide / 2 || 0);
          return pen + charts.r1(px(Number(v) + middle) - middle) + text.slice(1 + v.length);
        }));
        else node.setAttribute("x", charts.r1(px(at + half) - half));
      frame.points = hits.map(([v, py, lines]) => [px(v), py, -1, lines]).filter(([v]) => v >= x - 1 && v <= x + w + 1);
      return px;
    };
    /// The rules and the numbers of a part of the axis.
    function rule() {
      const whole = frame.left === first && frame.right === last, [rules, labels] = originals;
      across.forEach((g, k) => g.replaceChildren(...(whole || kind === "names" ? originals[k] : [])));
      if (whole || kind === "names" || !rules.length || !labels.length) return;
      let free = -Infinity;
      for (const t of nonioTicks(number, frame.left, frame.right, 6, kind)) {
        const at = charts.r1(x + (w * (t.at - frame.left)) / (frame.right - frame.left)), line = rules[0].cloneNode(), text = labels[0].cloneNode(), half = 4.5 * t.label.length;
        if (at < x || at > x + w) continue;
        line.setAttribute("d", `M${at} ${y}L${at} ${y + h}`);
        across[0].append(line);
        if (at - half < free || at + half > x + w + 20) continue;
        free = at + half + 6;
        text.setAttribute("x", at);
        text.setAttribute("text-anchor", "middle");
        text.textContent = t.label;
        across[1].append(text);
      }
    }
    all.set(svg, (range) => {
      [frame.left, frame.right] = range || frame.whole;
      place();
      rule();
    });
    place();
    charts.add(frame);
  }
  return {
    /// Adds the tools to the charts below `root`, which replace those no longer on the page.
    adopt(root) {
      for (const svg of [...all.keys()]) if (!svg.isConnected) all.delete(svg);
      charts.keep((frame) => frame.svg.isConnected);
      root.querySelectorAll("svg.chart[data-frame]").forEach(adopt);
    },
  };
}
