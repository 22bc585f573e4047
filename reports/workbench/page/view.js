// ---- the sections of the page, made once; the other modules draw their content ----
const view = (() => {
  const button = box.button;
  function section(id, word, ...more) {
    return el("section", {id, "aria-labelledby": id + "-title"}, el("h2", {id: id + "-title"}, say(word)), ...more);
  }
  function pictureFigure(k) {
    return el("figure", {id: "picture-" + k, "aria-labelledby": `picture-${k}-title`},
      el("figcaption", {}, el("b", {id: `picture-${k}-title`}), el("span", {class: "fails", id: `fails-${k}`})),
      svg("svg", {role: "application", "aria-labelledby": `picture-${k}-title`, "aria-describedby": "picture-help", tabindex: 0}),
      el("figcaption", {}, el("p", {id: `picture-${k}-says`})));
  }
  /// A figure for circles, hidden if there are none.
  function polarFigure(name) {
    return el("figure", {id: "picture-" + name, hidden: true}, el("figcaption", {}, el("b")), svg("svg", {role: "application", "aria-describedby": "picture-help", tabindex: 0}), el("figcaption", {}, el("p")));
  }
  function header() {
    return el("header", {},
      el("div", {class: "who"}, net.base ? el("a", {href: "/", id: "back"}, "\u2190 " + say("site.back")) : null, el("h1", {id: "campaign"}), el("p", {id: "machine", class: "muted"})),
      el("div", {id: "parts", role: "group", "aria-label": say("parts.label")}),
      el("div", {class: "tools", role: "group", "aria-label": say("tools.label")},
        button("undo", "tools.undo", {title: say("tools.undo_help"), "aria-keyshortcuts": "z"}),
        button("redo", "tools.redo", {title: say("tools.redo_help"), "aria-keyshortcuts": "y"}),
        button("suggest", "tools.suggest", {title: say("tools.suggest_help"), "aria-keyshortcuts": "g"}),
        button("finish", "tools.finish", {title: say("tools.finish_help"), "aria-keyshortcuts": "f"}),
        button("cancel", "tools.cancel", {hidden: true}),
        button("save", "tools.save", {class: "strong", title: say("tools.save_help"), "aria-keyshortcuts": "s"}),
        button("page", "tools.page"), button("report", "tools.report"),
        button("learn", "tools.learn", {"aria-pressed": "false"}), button("keys", "tools.keys", {"aria-keyshortcuts": "?"})));
  }
  function bar() {
    return el("section", {id: "bar", "aria-labelledby": "bar-title"},
      el("h2", {id: "bar-title", class: "quiet"}, say("bar.title")),
      el("div", {id: "verdict", role: "status"}), el("p", {id: "outcome", class: "note", hidden: true}), el("div", {class: "errors"}, el("div", {id: "now"}), el("div", {id: "trail"})),
      el("p", {id: "limits", class: "muted"}));
  }
  function middle() {
    return el("div", {class: "middle"},
      el("div", {id: "teach", hidden: true}),
      pictureFigure("fit"),
      section("places", "places.title", el("div", {id: "places-list"})),
      section("pictures-section", "pictures.title",
        el("div", {id: "drawn"}), el("p", {id: "legend", class: "muted"}), el("p", {id: "legend-ghost", class: "muted"}),
        el("p", {id: "picture-help", class: "muted"}, say("pictures.help")),
        el("div", {id: "region"}),
        el("div", {class: "pictures"}, polarFigure("polar"), polarFigure("rest"), ...Array.from({length: 9}, (_, k) => pictureFigure(k)))),
      el("section", {id: "space", hidden: true, "aria-labelledby": "space-title"}, el("h2", {id: "space-title"}, say("space.title")), el("div", {id: "space-view"})),
      section("readings", "readings.title", el("div", {id: "readings-list"})));
  }
  function build() {
    by("app").replaceChildren(
      el("div", {id: "alarm", role: "alert", hidden: true}),
      header(),
      el("main", {},
        el("p", {id: "wrong", class: "flag", role: "alert", hidden: true}), bar(),
        el("div", {class: "columns"},
          section("effects", "effects.title", el("div", {id: "effects-list"}), el("div", {id: "period"})),
          middle(),
          el("div", {class: "right", role: "group", tabindex: 0, "aria-labelledby": "about-title next-title"}, section("about", "about.title", el("div", {id: "about-what"})),
            section("next", "next.title", el("div", {id: "next-what"}), el("div", {id: "what-if"}))))),
      el("footer", {}, el("details", {}, el("summary", {id: "command-label"}, say("site.did")), el("code", {id: "command", tabindex: 0, "aria-labelledby": "command-label"}),
        button("copy", "command.copy")), el("span", {id: "read-at", class: "muted"})),
      el("div", {id: "tip", hidden: true}), ...box.places());
    document.body.className = "workbench";
  }
  return {build, ...box};
})();
