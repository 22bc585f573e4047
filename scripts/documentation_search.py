# SPDX-License-Identifier: Apache-2.0
"""Hook of mkdocs: search in pages that are opened as files. A browser reads no JSON and starts no worker from file://, so
the index is written as a script too, and a frame takes the place of the worker there."""
import pathlib
import posixpath

SCRIPT = """// The index as a script: pages from file:// cannot read search_index.json.
var __search = {index: Promise.resolve(%s)};
if (location.protocol === "file:")
  window.Worker = class extends EventTarget {
    constructor(address) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.side = frame.contentWindow;
      this.waiting = [];
      this.side.document.open();
      this.side.answer = data => this.dispatchEvent(new MessageEvent("message", {data}));
      this.side.ready = () => {
        this.side.postMessage = this.side.answer;
        for (const data of this.waiting.splice(0)) this.send(data);
        this.waiting = null;
      };
      this.side.document.write(`<body><script src="${new URL(address, location)}" onload="ready()"><${"/"}script>`);
      this.side.document.close();
    }
    send(data) { this.side.dispatchEvent(new this.side.MessageEvent("message", {data})); }
    postMessage(data) { if (this.waiting) this.waiting.push(data); else this.send(data); }
    terminate() {}
  };
"""


def on_post_page(output, page, config):
    index = posixpath.relpath("search/search_index.js", posixpath.dirname(page.url) or ".")
    place = output.rindex('<script src="', 0, output.index("assets/javascripts/bundle."))
    return f'{output[:place]}<script src="{index}"></script>{output[place:]}'


def on_post_build(config):
    for name in ("sitemap.xml", "sitemap.xml.gz"):  # of a server; with the time of the build
        (pathlib.Path(config["site_dir"]) / name).unlink(missing_ok=True)
    folder = pathlib.Path(config["site_dir"]) / "search"
    index = (folder / "search_index.json").read_text(encoding="utf-8")
    (folder / "search_index.js").write_text(SCRIPT.replace("%s", index), encoding="utf-8")
