nonioLines(document);
if (document.querySelector("svg.chart"))
  document.head.append(Object.assign(document.createElement("script"), {src: document.querySelector("nav a").href.replace(/index\.html$/, "charts.js")}));
