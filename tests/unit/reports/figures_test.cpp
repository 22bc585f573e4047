// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "fixtures.h"
#include "pages.h"

namespace nonio::fixtures::figures_test {
namespace {

/// Figures compared with the table of targets and with the printed results.
struct Figures : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);

  void SetUp() override {
    for (const char* name : {"iso230-2", "vdi-dgq-3441"})
      ASSERT_TRUE(plugins.load(NONIO_PLUGINS, name));
  }

  /// Of the first measurement, one kind of figure.
  std::vector<reports::Plot> plots(const Case& c, const std::string& kind) {
    const auto& own = templates.tables.at("report").values;
    const auto list = [&](const char* key) {
      return std::get<std::vector<std::string>>(own.at(key));
    };
    auto look = pages::read_look(templates, "report", list("blocks"), list("measurement"));
    EXPECT_TRUE(look) << look.error().message;
    look->plots = {kind};
    const auto fonts = pages::fonts_of(templates, *look);
    EXPECT_TRUE(fonts);
    const Settings options;
    const OutputInput in{c.campaign, c.observations, c.results, options, templates};
    const reports::Wording words(templates, "en", {"results", "report"});
    const pages::Source source{in, *look, words, **fonts};
    pages::Blocks blocks;
    pages::add_plots(source, pages::measured(in).front(), blocks);
    std::vector<reports::Plot> out;
    for (const reports::Block& block : blocks)
      if (const auto* row = std::get_if<reports::Columns>(&block.what))
        for (const auto& part : row->parts)
          out.push_back(std::get<reports::Plot>(part.front().what));
    return out;
  }

  static const Evaluation& of(const Case& c, const std::string& plugin) {
    for (const auto& a : c.results.analyses)
      if (a.plugin == plugin) return a.evaluation;
    throw std::runtime_error("no " + plugin);
  }

  static std::optional<double> result(const Evaluation& e, const std::string& name) {
    for (const Value& v : e.values)
      if (v.name == name) return v.value;
    return std::nullopt;
  }

  /// Readings of one target and direction but for the first run, or all of them, are taken away.
  static void take_away(Case& c, double target, int direction, bool all) {
    Observations& o = c.observations.front();
    const auto& axis = o.axes.front();
    for (std::size_t i = o.size(); i-- > 0;) {
      if (axis.position[i] != target || axis.approach[i] != direction || (o.run[i] == 1 && !all))
        continue;
      const auto at = static_cast<std::ptrdiff_t>(i);
      o.deviation.erase(o.deviation.begin() + at);
      o.u.erase(o.u.begin() + at);
      o.run.erase(o.run.begin() + at);
      o.material.erase(o.material.begin() + at);
      o.axes.front().position.erase(o.axes.front().position.begin() + at);
      o.axes.front().approach.erase(o.axes.front().approach.begin() + at);
      ++o.missing;
    }
  }

  void analyse(Case& c, const std::string& incomplete) {
    for (const Analysis& a : plugins.analyses) {
      Settings options = defaults(a.info);
      options.values["incomplete_targets"] = incomplete;
      auto e =
          a.analyse({c.campaign, c.campaign.measurements.front(), c.observations.front(), options});
      ASSERT_TRUE(e) << e.error().message;
      c.results.analyses.push_back(
          {a.info.name, a.info.version, c.campaign.measurements.front().id, std::move(*e)});
    }
  }

  /// A bracket is as long as the result of its name.
  void hold(const Case& c) {
    for (const auto& [kind, plugin] : {std::pair("iso", "iso230-2"), {"vdi", "vdi-dgq-3441"}}) {
      const Evaluation& e = of(c, plugin);
      for (const reports::Plot& plot : plots(c, kind)) {
        for (const auto& span : plot.spans) {
          const auto value = result(e, span.text);
          ASSERT_TRUE(value) << plugin << " " << span.text << ": a bracket without a result";
          EXPECT_NEAR(span.to - span.from, 1e6 * *value, 1e-6) << plugin << " " << span.text;
        }
      }
    }
  }

  /// At how many targets the band of one direction is drawn.
  std::size_t drawn(const Case& c, bool plus) {
    const auto all = plots(c, "iso");
    std::size_t n = 0;
    for (const auto& curve : all.front().curves) {
      if (curve.kind != reports::Plot::Curve::Kind::band ||
          (curve.dash == reports::Dash::solid) != plus)
        continue;
      for (std::size_t i = 0; i < curve.y.size(); ++i)
        n += std::isfinite(curve.y[i]) && std::isfinite(curve.y2[i]) ? 1U : 0U;
    }
    return n;
  }

  static std::size_t rows_with(const Case& c, const char* column) {
    const auto* values = of(c, "iso230-2").points.column(column);
    return values == nullptr ? 0
                             : static_cast<std::size_t>(
                                   std::count_if(values->values.begin(), values->values.end(),
                                                 [](double v) { return std::isfinite(v); }));
  }
};

TEST_F(Figures, BracketsAreAsLongAsTheResults) {
  Case c = simple_case();
  c.add("X", {});
  analyse(c, "refuse");
  hold(c);
  EXPECT_EQ(plots(c, "iso").front().spans.size(), 2U);
  EXPECT_EQ(drawn(c, true), 21U);
}

// One reading at a target is no scatter: neither in the row nor in the picture.
TEST_F(Figures, NoBandWhereTheRowHasNoScatter) {
  for (const char* incomplete : {"refuse", "leave-out"})
    for (const bool all : {false, true}) {
      SCOPED_TRACE(std::string(incomplete) +
                   (all ? " without one direction" : " one reading left"));
      Case c = simple_case();
      c.add("X", {});
      const double target = c.observations.front().axes.front().position[10];
      take_away(c, target, 1, all);
      analyse(c, incomplete);
      hold(c);
      EXPECT_EQ(drawn(c, true), rows_with(c, "s+"));
      EXPECT_EQ(drawn(c, false), rows_with(c, "s-"));
    }
}

// Targets that are not met exactly again count as two, each with one direction.
TEST_F(Figures, NoBracketWhereNoTargetHasBothDirections) {
  Case c = simple_case();
  c.add("X", {});
  auto& axis = c.observations.front().axes.front();
  for (std::size_t i = 0; i < axis.position.size(); ++i)
    if (axis.approach[i] < 0) axis.position[i] += 0.01;
  analyse(c, "refuse");
  hold(c);
  for (const char* kind : {"iso", "vdi"})
    for (const auto& plot : plots(c, kind)) EXPECT_TRUE(plot.spans.empty()) << kind;
}

}  // namespace
}  // namespace nonio::fixtures::figures_test
