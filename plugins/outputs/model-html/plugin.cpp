// SPDX-License-Identifier: Apache-2.0
// The model of each part of the machine as a self-contained HTML page. Its texts are in
// templates/words/<language>/pictures.toml.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "embedded.h"
#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/reports/page.h"
#include "nonio/reports/residuals.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"
#include "nonio/workbench/data.h"

namespace nonio::model_html {
namespace {

struct Source {
  const OutputInput& in;
  const ModelFit& fit;
  const reports::Wording& words;
  std::array<reports::PictureWords, 9> pictures;
};

using namespace reports;

void add_head(View& view, const Source& source) {
  const Campaign& c = source.in.campaign;
  const std::string title = source.words.get("model.heading", {{"part", source.fit.part}});
  view.set("language", source.words.language()).set("title", title).set("heading", title);
  view.set("program", c.id);
  view.set("script_source", std::string(script_source));
  view.set("style_source", std::string(style_source));
  view.set("script", Html{std::string(page_script)}).set("style", Html{std::string(page_style)});
  std::string line;
  for (const std::string& part :
       {c.id, c.customer, c.machine.maker, c.machine.model, c.machine.serial, c.date})
    if (!part.empty()) line += (line.empty() ? "" : " · ") + part;
  view.set("identity", line);
}

void add_notes(View& view, const Source& source) {
  const auto says = [&](const Finding& f, const char* part) {
    return Html{typeset_html(finding_text(source.in.templates, source.words.language(), f, part))};
  };
  const auto& all = source.fit.diagnosis;
  view.flag("notes", !all.empty()).flag("left", all.size() > 1);
  for (const Finding& f : all) {
    if (&f != &all.front()) {
      view.add("place").set("place", says(f, "says"));
      continue;
    }
    view.flag("attention", f.attention);
    const Html title = says(f, "title");
    if (title.text != f.id || says(f, "says").text.empty()) view.set("note_title", title);
    for (const char* part : {"says", "advice"})
      if (const Html text = says(f, part); !text.text.empty()) view.add("note").set("note", text);
  }
}

void add_parameters(View& view, const Source& source) {
  const Wording& words = source.words;
  view.flag("parameters", !source.fit.parameters.empty());
  if (source.fit.parameters.empty()) return;
  for (const ParameterRow& row :
       parameter_rows(source.fit, source.in.templates, words.language())) {
    View& one = view.add("parameter");
    one.set("effect", row.effect).set("name", row.name).set("meaning", row.meaning);
    one.set("value", row.value).set("U", row.U).set("unit", row.unit);
  }
  for (const std::string& text : {correlated_parameters(source.fit, words),
                                  fit_in_words(source.fit, source.in.results, words)})
    if (!text.empty()) view.add("about_fit").set("about_fit", text);
}

void add_cards(View& view, const Source& source) {
  bool any = false;
  for (const ModelFit::Candidate& c : source.fit.candidates) {
    View* card = nullptr;
    for (const char* what : {"is", "appearance", "remedy"}) {
      const std::string text =
          nonio::words(source.in.templates, source.words.language(),
                       "effect." + c.effect.substr(0, c.effect.find(':')) + "." + what);
      if (text.empty()) continue;
      if (card == nullptr) card = &view.add("card").set("effect", c.effect).flag("first", !any);
      any = true;
      card->add("about").set("about", Html{typeset_html(text)});
    }
  }
  view.flag("cards", any);
}

void add_candidates(View& view, const Source& source) {
  const std::string& language = source.words.language();
  const auto rows = candidate_rows(source.fit, language);
  view.flag("candidates", !rows.empty());
  for (const CandidateRow& row : rows) {
    View& one = view.add("candidate");
    one.set("effect", row.effect).flag("certain", row.certain).set("evidence", row.evidence);
    one.set("rms", row.rms).set("cv_rms", row.cv_rms).set("smallest", row.smallest);
  }
  view.set("no_sign", no_sign(source.fit, source.in.templates, language));
  add_cards(view, source);
  view.flag("plans", !source.fit.next.empty());
  for (const Finding& f : source.fit.next)
    view.add("plan").set(
        "plan", Html{typeset_html(finding_text(source.in.templates, language, f, "says"))});
}

/// The decrease of RMS per effect as bars in percent of the chart width, which need no script.
void add_steps(View& view, const Source& source) {
  const ModelFit& fit = source.fit;
  const Wording& words = source.words;
  const Quantity q = deviation_of(fit.angular);
  const bool has_floor = fit.floor && std::isfinite(*fit.floor);
  const double floor = has_floor ? *fit.floor : 0.0, half = 2 * fit.floor_u.value_or(0.0);
  const double from = std::max(0.0, floor - half);
  double most = has_floor ? floor + half : 0.0;
  bool left_out = false;
  for (const ModelFit::Step& step : fit.steps) {
    most = std::max({most, step.rms, step.cv_rms.value_or(0.0)});
    left_out |= step.cv_rms.has_value();
  }
  const auto percent = [most](double v) { return fixed_text(most > 0 ? 100 * v / most : 0.0, 2); };
  const auto value = [&](std::optional<double> si) {
    if (!si || !std::isfinite(*si)) return std::string("–");
    return localised(short_text(*si * unit_of(q).per_si), words.language()) + " " + unit_text(q);
  };
  view.flag("steps", !fit.steps.empty()).flag("left_out", left_out).set("y", left_out ? "6" : "14");
  if (has_floor) {
    const Printed shown = printed_result(floor, half, q, words.language());
    view.set("floor", words.get("model.floor", {{"s", shown.value},
                                                {"U", shown.U.empty() ? "–" : shown.U},
                                                {"unit", unit_text(q)}}));
    view.set("floor_at", percent(floor)).set("band_from", percent(from));
    view.set("band_width", percent(floor + half - from));
  }
  for (const ModelFit::Step& step : fit.steps) {
    View& one = view.add("step");
    one.set("effect", step.effect.empty() ? words.get("model.start") : "+ " + step.effect);
    one.set("rms", value(step.rms)).set("rms_width", percent(step.rms));
    const bool has = step.cv_rms && std::isfinite(*step.cv_rms);
    one.set("cv_rms", value(step.cv_rms)).set("cv_width", has ? percent(*step.cv_rms) : "");
  }
}

void add_pictures(View& view, const Source& source) {
  view.flag("circles", workbench::has_circles(source.in.campaign, source.fit));
  const PictureWords fit = fit_words(source.fit, source.words);
  view.set("fit_heading", fit.title).set("fit_none", fit.none).set("fit_says", fit.says);
  for (std::size_t i = 0; i < source.pictures.size(); ++i) {
    const PictureWords& p = source.pictures[i];
    View& picture = view.add("picture");
    picture.set("number", std::to_string(i)).set("heading", p.title);
    picture.set("none", p.none).set("says", p.says);
  }
}

/// Returns what the legend states of the fit of the whole model.
std::string legend_numbers(const Source& source) {
  const ModelFit& fit = source.fit;
  const Wording& words = source.words;
  const Quantity q = deviation_of(fit.angular);
  std::string text = fit.floor
                         ? words.get("picture.legend_floor",
                                     {{"s", printed_number(*fit.floor, q, 2, words.language())},
                                      {"unit", unit_text(q)}})
                         : words.get("picture.no_floor");
  if (!fit.suspects.empty())
    text +=
        " " + words.get("picture.legend_suspect", {{"count", std::to_string(fit.suspects.size())}});
  return text;
}

std::string legend(const Source& source, const workbench::Kept& kept) {
  const std::string text = source.words.get("picture.legend");
  if (kept.rows.size() == source.fit.size()) return text;
  return text + " " +
         source.words.get("page.thinned", {{"shown", std::to_string(kept.rows.size())},
                                           {"all", std::to_string(source.fit.size())}});
}

Expected<std::string> page_of(const Source& source) {
  const Wording& words = source.words;
  const workbench::Kept kept = workbench::kept_readings(source.fit.residual);
  const workbench::Drawn drawn{source.in.campaign, source.fit, words, source.pictures};
  View view;
  add_head(view, source);
  add_notes(view, source);
  add_steps(view, source);
  add_candidates(view, source);
  add_parameters(view, source);
  add_pictures(view, source);
  view.set("pictures_heading", words.get("picture.heading", {{"part", source.fit.part}}));
  view.set("toggling", Html{typeset_html(words.get("page.toggling"))});
  view.set("legend", legend(source, kept)).set("legend_numbers", legend_numbers(source));
  view.set("data", Html{workbench::data_of(drawn, kept, false)});
  return page_text("model", view, words);
}

bool applies(const Campaign& campaign) { return !campaign.model.empty(); }

std::string file_name(const std::string& part) {
  std::string name = "model-" + part + ".html";
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_';
    if (!plain) c = '_';
  }
  return name;
}

Expected<OutputResult> write(const OutputInput& in) {
  const reports::Wording words(in.templates, in.options.text("language", "en"), {"pictures"});
  OutputResult result;
  for (const ModelFit& fit : in.results.models) {
    NONIO_TRY(auto bytes, page_of({in, fit, words, reports::picture_words(fit, words)}));
    result.artifacts.push_back({file_name(fit.part), std::move(bytes)});
  }
  if (const auto complete = words.complete(); !complete) return fail(complete.error());
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.role = Output::Role::model_page;
  output.info = {
      "model-html",
      "1.0.0",
      "The error model as an interactive page for a browser, in one file.",
      {one_of({"de", "en", "it"}, {"language", std::string("en"), "", "Language of the page."})}};
  output.applies = applies;
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::model_html
