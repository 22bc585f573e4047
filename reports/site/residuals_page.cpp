// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "chart.h"
#include "embedded.h"
#include "nonio/reports/drawing.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"
#include "pages.h"

namespace nonio::reports {

namespace {

struct Across {
  const char* id;
  std::vector<double> values;
  std::string title, none{}, says{};
};

/// Keeps large residuals, and of the others so many that a browser can show the page.
std::vector<std::size_t> kept_rows(const JointResiduals& part) {
  constexpr std::size_t most = 10000;
  const std::size_t n = part.residual.size(), step = (n + most - 1) / most;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < n; ++i)
    if (std::isfinite(part.residual[i]) &&
        (i % std::max<std::size_t>(step, 1) == 0 || std::fabs(part.residual[i]) > 4.0 * part.noise))
      out.push_back(i);
  return out;
}

std::vector<double> in_order(std::size_t n) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<double>(i + 1);
  return out;
}

std::vector<double> times_scale(std::vector<double> values, double scale) {
  for (double& v : values) v *= scale;
  return values;
}

/// Order of the readings in their files, or of machining. A part that states none is named.
Across order_of(const JointResiduals& part, const Wording& words) {
  if (!part.made_order)
    return {"order", in_order(part.residual.size()), words.get("together.order.x")};
  std::vector<char> stated(part.campaigns.size(), 0);
  for (std::size_t i = 0; i < part.made_order->size(); ++i)
    if (std::isfinite((*part.made_order)[i])) stated[part.campaign[i]] = 1;
  std::string without;
  for (std::size_t k = 0; k < stated.size(); ++k)
    if (stated[k] == 0) without += (without.empty() ? "" : ", ") + part.campaigns[k];
  Across out{"order", *part.made_order, words.get("together.order.made.x")};
  out.says = without.empty() ? "" : words.get("together.order.made.none", {{"parts", without}});
  if (std::find(stated.begin(), stated.end(), 1) == stated.end()) out.none = out.says;
  return out;
}

std::array<Across, 4> axes_of(const JointResiduals& part, const Wording& words) {
  const Quantity q = part.rotary ? Quantity::angle : Quantity::length;
  double longest = 0.0;
  bool timed = false, warm = false;
  for (const double t : part.time)
    if (std::isfinite(t)) longest = std::max(longest, t), timed = true;
  for (const double t : part.temperature) warm = warm || std::isfinite(t);
  const auto [unit, seconds] = longest > 7200.0  ? std::pair{"h", 3600.0}
                               : longest > 300.0 ? std::pair{"min", 60.0}
                                                 : std::pair{"s", 1.0};
  return {Across{"position", times_scale(part.position, unit_of(q).per_si),
                 words.get(part.made_order ? "together.position.made.x" : "picture.position.x",
                           {{"axis", part.axis}, {"unit", unit_text(q)}})},
          Across{"time", times_scale(part.time, 1.0 / seconds),
                 words.get("picture.time.x", {{"unit", unit}}),
                 timed ? "" : words.get("picture.time.none")},
          Across{"temperature", part.temperature, words.get("picture.temperature.x"),
                 warm ? "" : words.get("picture.temperature.none")},
          order_of(part, words)};
}

void put_part(View& view, const site::Page& page, const JointResiduals& part) {
  const Wording& words = page.words;
  const Quantity q = deviation_of(part.angular);
  const std::vector<std::size_t> rows = kept_rows(part);
  View& of = view.add("part");
  of.set("name", part.name);
  of.set("says", words.get(part.made_order ? "together.made" : "together.part",
                           {{"readings", std::to_string(part.residual.size())},
                            {"shown", std::to_string(rows.size())},
                            {"count", std::to_string(part.campaigns.size())},
                            {"s", printed_number(part.noise, q, 2, words.language())},
                            {"unit", unit_text(q)}}));
  for (const Across& a : axes_of(part, words)) {
    View& picture = of.add("picture");
    const std::string heading = words.get("together." + std::string(a.id) + ".title");
    picture.set("heading", heading).set("none", a.none);
    picture.set("says", a.none.empty() ? a.says : "");
    if (a.none.empty())
      picture.set("chart", site::residuals_chart(page, part, rows, a.values, heading, a.title));
  }
}

}  // namespace

Expected<std::string> residuals_page(const std::vector<JointResiduals>& parts,
                                     const Templates& templates, const std::string& language) {
  const Wording words(templates, language, {"pictures"});
  const SiteHistory none{};
  const site::Page page{none, templates, words, "", std::make_shared<const Fonts>()};
  View view;
  view.set("language", language).set("program", "Nonio");
  view.set("title", words.get("together.title"));
  view.set("script_source", std::string(site::alone_source));
  view.set("style_source", std::string(site::style_source));
  view.set("script", Html{std::string(site::alone_script) + std::string(site::charts_script)});
  view.set("style", Html{std::string(site::page_style)});
  JsonWriter json(JsonWriter::Layout::in_script);
  json.begin_object();
  for (const char* key : chart_words) json.member(key, words.get(key));
  json.end_object();
  view.set("chart_words", Html{json.take()});
  for (const JointResiduals& part : parts) put_part(view, page, part);
  NONIO_TRY(auto text, page_text("residuals", view, words));
  if (const auto complete = words.complete(); !complete) return fail(complete.error());
  return text;
}

}  // namespace nonio::reports
