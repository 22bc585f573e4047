// SPDX-License-Identifier: Apache-2.0
// A chart as a file: PNG, SVG, or its numbers as CSV. Every page with charts has this.
"use strict";
const nonioSave = (() => {
  const kept = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "opacity", "font-family", "font-size", "font-weight"];
  /// The drawing as a standalone SVG with its computed style; painted canvases become images.
  function alone(svg) {
    const copy = svg.cloneNode(true), {width, height} = svg.viewBox.baseVal;
    const copies = copy.querySelectorAll("*"), make = (name) => document.createElementNS(svg.namespaceURI, name);
    svg.querySelectorAll("*").forEach((node, i) => {
      if (!(node instanceof SVGElement)) return;
      const style = getComputedStyle(node);
      for (const name of kept) copies[i].setAttribute(name, style.getPropertyValue(name));
    });
    const painted = svg.querySelectorAll("foreignObject");
    copy.querySelectorAll("foreignObject").forEach((node, i) => {
      const image = make("image");
      for (const name of ["x", "y", "width", "height"]) image.setAttribute(name, node.getAttribute(name));
      image.setAttribute("href", painted[i].querySelector("canvas").toDataURL());
      node.replaceWith(image);
    });
    const back = make("rect");
    for (const [name, value] of [["width", width], ["height", height], ["fill", getComputedStyle(document.body).backgroundColor]]) back.setAttribute(name, value);
    copy.prepend(back);
    for (const [name, value] of [["width", width], ["height", height]]) copy.setAttribute(name, value);
    return new XMLSerializer().serializeToString(copy);
  }
  async function png(svg) {
    const image = new Image(), {width, height} = svg.viewBox.baseVal, sharp = 2;
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(alone(svg));
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), {width: sharp * width, height: sharp * height});
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  }
  // A number that is text, as the cells of a table are, is no formula.
  const isNumber = (text) => /^[+\-\u2212]?\d+([.,]\d+)?(e[+-]?\d+)?$/i.test(text);
  /// A field of a CSV file. An apostrophe precedes a text that a spreadsheet would take for a formula, as in csv_text of the program.
  function cell(v) {
    if (typeof v === "number") return isFinite(v) ? String(Number(v.toPrecision(9))) : "";
    const text = /^[=+\-@\t\r]/.test(v) && !isNumber(v) ? "'" + v : v;
    return /[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  }
  function hand(blob, name) {
    const link = Object.assign(document.createElement("a"), {href: URL.createObjectURL(blob), download: name});
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }
  function nameOf(svg) {
    const by = document.getElementById(svg.getAttribute("aria-labelledby"));
    return (by ? by.textContent : svg.getAttribute("aria-label") || "").trim() || document.title;
  }
  /// Buttons that export the chart; rows(): table with header for CSV, optional.
  function buttons(svg, rows) {
    const files = {PNG: () => png(svg), SVG: () => new Blob([alone(svg)], {type: "image/svg+xml"}),
      CSV: () => new Blob([rows().map((row) => row.map(cell).join(",") + "\n").join("")], {type: "text/csv"})};
    return Object.keys(files).filter((kind) => kind !== "CSV" || rows).map((kind) => {
      const button = Object.assign(document.createElement("button"), {type: "button", className: "small", textContent: kind});
      button.setAttribute("aria-label", `${kind}: ${nameOf(svg)}`);
      button.addEventListener("click", async () => hand(await files[kind](), nameOf(svg).replace(/[^\p{L}\p{N}]+/gu, "-").slice(0, 80) + "." + kind.toLowerCase()));
      return button;
    });
  }
  return {buttons};
})();
