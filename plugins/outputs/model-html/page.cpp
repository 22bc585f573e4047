// SPDX-License-Identifier: Apache-2.0
#include "page.h"

#include <algorithm>
#include <cmath>

#include "embedded.h"
#include "escape.h"
#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "nonio/workbench/data.h"

namespace nonio::model_html {

using namespace reports;

namespace {

std::string element(std::string_view name, std::string_view inner, std::string_view more = "") {
  std::string out = "<";
  out += name;
  if (!more.empty()) out += " " + std::string(more);
  out += ">" + std::string(inner) + "</" + std::string(name) + ">\n";
  return out;
}

/// A table that may be wider than a phone: it is scrolled by keys too.
std::string wide_table(std::string_view rows, const std::string& heading) {
  return element(
      "div", element("table", rows),
      "class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + html(heading) + "\"");
}

std::string title_of(const Source& source) {
  return source.words.get("model.heading", {{"part", source.fit.part}});
}

std::string head(const Source& source) {
  return "<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src '" +
         std::string(script_source) + "'; style-src '" + std::string(style_source) +
         "'; base-uri 'none'; form-action 'none'\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
         element("title", html(title_of(source) + " · " + source.in.campaign.id)) +
         element("style", page_style) + "</head>\n";
}

std::string identity(const Source& source) {
  const Campaign& c = source.in.campaign;
  std::string line;
  for (const std::string& part :
       {c.id, c.customer, c.machine.maker, c.machine.model, c.machine.serial, c.date})
    if (!part.empty()) line += (line.empty() ? "" : " · ") + html(part);
  return element("h1", html(title_of(source))) + element("p", line, "class=\"muted\"");
}

/// The verdict in a box, and in it where something is left, line by line.
std::string notes(const Source& source) {
  std::string note, list;
  bool attention = false;
  const auto says = [&](const Finding& f, const char* part) {
    return typeset_html(finding_text(source.in.templates, source.words.language(), f, part));
  };
  for (const Finding& f : source.fit.diagnosis) {
    if (&f != &source.fit.diagnosis.front()) {
      list += element("li", says(f, "says"));
      continue;
    }
    attention = f.attention;
    const std::string title = says(f, "title");
    if (title != f.id || says(f, "says").empty())
      note += element("b", title);  // a verdict has none
    for (const char* part : {"says", "advice"})
      if (const std::string text = says(f, part); !text.empty()) note += element("p", text);
  }
  if (!list.empty()) note += element("ul", list);
  if (note.empty()) return note;
  return element("div", note, attention ? "class=\"note attention\"" : "class=\"note\"");
}

std::string parameters(const Source& source) {
  const Wording& words = source.words;
  const ModelFit& fit = source.fit;
  if (fit.parameters.empty()) return element("p", html(words.get("model.empty")));
  std::string rows = "<tr>" + element("th", html(words.get("model.effect"))) +
                     element("th", html(words.get("model.parameter")), "colspan=\"2\"") +
                     element("th", html(words.get("model.value")), "class=\"number\"") +
                     "<th class=\"number\">U</th>" + element("th", html(words.get("model.unit"))) +
                     "</tr>\n";
  for (const ParameterRow& row : parameter_rows(fit, source.in.templates, words.language()))
    rows += "<tr>" + element("td", html(row.effect)) + element("td", html(row.name)) +
            element("td", html(row.meaning)) + element("td", row.value, "class=\"number\"") +
            element("td", row.U, "class=\"number\"") + element("td", html(row.unit)) + "</tr>\n";
  std::string out = wide_table(rows, words.get("model.parameters"));
  for (const std::string& text :
       {correlated_parameters(fit, words), fit_in_words(fit, source.in.results, words)})
    if (!text.empty()) out += element("p", html(text));
  return out;
}

/// What effects are and what cures them, as the catalogue says it.
std::string cards(const Source& source) {
  std::string out;
  for (const ModelFit::Candidate& c : source.fit.candidates) {
    std::string text;
    for (const char* what : {"is", "looks", "cure"})
      if (const std::string words =
              nonio::words(source.in.templates, source.words.language(),
                           "effect." + c.effect.substr(0, c.effect.find(':')) + "." + what);
          !words.empty())
        text += element("p", typeset_html(words));
    if (!text.empty())
      out +=
          element("details", element("summary", html(c.effect)) + text, out.empty() ? "open" : "");
  }
  if (out.empty()) return out;
  return element("h3", html(source.words.get("model.card"))) + out;
}

/// Effects that are not in the model: those with evidence, those without, what to measure next.
std::string candidates(const Source& source) {
  const Wording& words = source.words;
  const std::string& language = words.language();
  std::string rows;
  for (const CandidateRow& row : candidate_rows(source.fit, language)) {
    const std::string certain =
        row.certain ? " <b>" + html(words.get("model.certain")) + "</b>" : "";
    rows += "<tr>" + element("td", html(row.effect) + certain);
    for (const std::string* text : {&row.evidence, &row.rms, &row.cv_rms, &row.smallest})
      rows += element("td", html(*text), "class=\"number\"");
    rows += "</tr>\n";
  }
  std::string out = element("h2", html(words.get("model.candidates")));
  if (rows.empty()) {
    out += element("p", html(words.get("model.none_missing")));
  } else {
    std::string head = element("th", html(words.get("model.effect")));
    for (const char* title : {"evidence", "rms_after", "left_out_after", "smallest"})
      head += element("th", html(words.get(std::string("model.") + title)), "class=\"number\"");
    out += wide_table("<tr>" + head + "</tr>\n" + rows, words.get("model.candidates"));
  }
  if (const std::string text = no_sign(source.fit, source.in.templates, language); !text.empty())
    out += element("p", html(text));
  out += cards(source);
  std::string next;
  for (const Finding& f : source.fit.next)
    next += element("li", typeset_html(finding_text(source.in.templates, language, f, "says")));
  if (!next.empty()) out += element("h3", html(words.get("model.next"))) + element("ul", next);
  return out;
}

/// Bars in percent of the chart's width, so that they fit any screen without a script.
class Falling {
 public:
  explicit Falling(const Source& source)
      : source_(source), q_(deviation_of(source.fit.angular)), floor_(source.fit.floor) {
    if (floor_ && !std::isfinite(*floor_)) floor_.reset();
    most_ = floor_ ? *floor_ + half() : 0.0;
    for (const ModelFit::Step& step : source.fit.steps) {
      most_ = std::max({most_, step.rms, step.cv_rms.value_or(0.0)});
      left_out_ |= step.cv_rms.has_value();
    }
  }

  std::string text() const {
    const Wording& words = source_.words;
    std::string rows;
    for (const ModelFit::Step& step : source_.fit.steps) {
      const std::string label = step.effect.empty() ? words.get("model.start") : "+ " + step.effect;
      rows += element("div", html(label), "class=\"label\"") + element("svg", bars(step)) +
              element("div", value(step.rms) + (left_out_ ? "<br>" + value(step.cv_rms) : ""),
                      "class=\"values\"");
    }
    return element("div", key(), "class=\"key\"") + element("div", rows, "class=\"falls\"");
  }

 private:
  double half() const { return 2 * source_.fit.floor_u.value_or(0.0); }
  std::string percent(double v) const {
    return "\"" + fixed_text(most_ > 0 ? 100 * v / most_ : 0.0, 2) + "%\"";
  }
  std::string value(std::optional<double> si) const {
    if (!si || !std::isfinite(*si)) return "–";
    return localised(short_text(*si * unit_of(q_).per_si), source_.words.language()) + " " +
           unit_text(q_);
  }
  std::string bars(const ModelFit::Step& step) const {
    std::string out;
    if (floor_) {
      const double from = std::max(0.0, *floor_ - half());
      out += "<rect class=\"band\" height=\"44\" x=" + percent(from) +
             " width=" + percent(*floor_ + half() - from) + "/>";
    }
    const char* y = left_out_ ? "\"6\"" : "\"14\"";
    out += "<rect class=\"fill-rms\" height=\"15\" y=" + std::string(y) +
           " width=" + percent(step.rms) + "/>";
    if (step.cv_rms && std::isfinite(*step.cv_rms))
      out += "<rect class=\"fill-left-out\" height=\"15\" y=\"23\" width=" + percent(*step.cv_rms) +
             "/>";
    if (floor_)
      out += "<line class=\"floor\" y1=\"0\" y2=\"44\" x1=" + percent(*floor_) +
             " x2=" + percent(*floor_) + "/>";
    return out;
  }
  static std::string key_entry(const char* sign, const std::string& text) {
    return element("span", "<svg>" + std::string(sign) + "</svg> " + html(text));
  }
  std::string key() const {
    const Wording& words = source_.words;
    std::string out =
        key_entry("<rect class=\"fill-rms\" width=\"16\" height=\"11\"/>", words.get("model.rms"));
    if (left_out_)
      out += key_entry("<rect class=\"fill-left-out\" width=\"16\" height=\"11\"/>",
                       words.get("model.cv_rms"));
    if (!floor_) return out;
    const Printed shown = printed_result(*floor_, half(), q_, words.language());
    return out + key_entry(
                     "<rect class=\"band\" width=\"16\" height=\"12\"/>"
                     "<line class=\"falls floor\" x1=\"8\" x2=\"8\" y1=\"0\" y2=\"12\"/>",
                     words.get("model.floor", {{"s", shown.value},
                                               {"U", shown.U.empty() ? "–" : shown.U},
                                               {"unit", unit_text(q_)}}));
  }

  const Source& source_;
  Quantity q_;
  std::optional<double> floor_;
  double most_ = 0.0;
  bool left_out_ = false;
};

std::string choices(const Source& source) {
  std::string out;
  for (const char* id : {"effects", "directions", "runs"})
    out += "<div id=\"" + std::string(id) + "\"><span>" +
           html(source.words.get("page." + std::string(id))) + "</span></div>\n";
  out += "<p id=\"rms\"></p>\n" +
         element("p", typeset_html(source.words.get("page.toggling")), "class=\"muted hint\"");
  return element("section", out, "id=\"choices\" hidden");
}

std::string nine(const Source& source) {
  std::string out;
  if (workbench::has_circles(source.in.campaign, source.fit))
    for (const char* name : {"polar", "rest"})
      out += "<figure id=\"picture-" + std::string(name) +
             "\" hidden>\n<figcaption><b></b></figcaption>\n<svg role=\"img\"></svg>\n"
             "<figcaption><p></p></figcaption>\n</figure>\n";
  for (std::size_t i = 0; i < source.pictures.size(); ++i) {
    const PictureWords& p = source.pictures[i];
    const std::string title = html(p.title);
    const std::string inside = p.none.empty()
                                   ? "<svg role=\"img\" aria-label=\"" + title + "\"></svg>\n"
                                   : element("p", html(p.none), "class=\"none\"");
    out += "<figure id=\"picture-" + std::to_string(i) + "\">\n<figcaption><b>" + title +
           "</b></figcaption>\n" + inside + "<figcaption>" + element("p", html(p.says)) +
           "</figcaption>\n</figure>\n";
  }
  return element("div", out, "class=\"pictures\"");
}

std::string legend(const Source& source, const workbench::Kept& kept) {
  const ModelFit& fit = source.fit;
  const Wording& words = source.words;
  const Quantity q = deviation_of(fit.angular);
  std::string text = words.get("picture.legend") + " ";
  text += fit.floor ? words.get("picture.legend_floor",
                                {{"s", printed_number(*fit.floor, q, 2, words.language())},
                                 {"unit", unit_text(q)}})
                    : words.get("picture.no_floor");
  if (!fit.suspects.empty())
    text +=
        " " + words.get("picture.legend_suspect", {{"count", std::to_string(fit.suspects.size())}});
  if (kept.rows.size() < fit.size())
    text += " " + words.get("page.thinned", {{"shown", std::to_string(kept.rows.size())},
                                             {"all", std::to_string(fit.size())}});
  return element("p", html(text), "class=\"muted\"");
}

}  // namespace

std::string page_of(const Source& source) {
  const Wording& words = source.words;
  const workbench::Kept kept = workbench::kept_readings(source.fit.residual);
  const workbench::Drawn drawn{source.in.campaign, source.fit, words, source.pictures};
  std::string body = identity(source) + notes(source);
  if (!source.fit.steps.empty())
    body += element("h2", html(words.get("model.falls"))) + Falling(source).text();
  body += candidates(source);
  body += element("h2", html(words.get("model.parameters"))) + parameters(source);
  body += "<section class=\"residuals\">\n" +
          element("h2", html(words.get("picture.heading", {{"part", source.fit.part}}))) +
          choices(source) + element("noscript", html(words.get("page.noscript"))) +
          legend(source, kept) + nine(source) + "</section>\n";
  body = element("main", body);
  body += "<div id=\"tip\" hidden></div>\n";
  body += "<script type=\"application/json\" id=\"data\">" +
          workbench::data_of(drawn, kept, false) + "</script>\n";
  body += element("script", page_script);
  return "<!DOCTYPE html>\n<html lang=\"" + html(words.language()) + "\">\n" + head(source) +
         element("body", body) + "</html>\n";
}

}  // namespace nonio::model_html
