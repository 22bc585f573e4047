// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <random>

#include "loaded_analysis.h"
#include "nonio/sdk/plugin.h"

namespace nonio::fixtures::before_after_test {
namespace {

constexpr unsigned seed = 20261127;
constexpr double um = 1e-6, length = 1.0;
constexpr std::size_t stops = 11;
using Curve = std::function<double(double)>;

double error_of(double x) { return 12 * um * std::sin(5.0 * x) + 20 * um * x; }

struct Shop {
  Campaign campaign;
  std::vector<Observations> all;
  double scatter = 1 * um;
  std::mt19937 rng{seed};
  std::vector<int> directions{1, -1};
  std::uint32_t runs = 3;
  double half_reversal = 1 * um;  ///< of the lines from here on
  std::vector<double> targets;
  std::optional<ControlTable> control;

  Shop() {
    for (std::size_t i = 0; i < stops; ++i)
      targets.push_back(length * static_cast<double>(i) / static_cast<double>(stops - 1));
    campaign.machine.axes.push_back(Axis{.name = "X", .expansion = 1e-6});
    campaign.instrument.U_fixed = 1e-9, campaign.instrument.U_per_length = 1e-10;
    Environment& e = campaign.environment;
    e.misalignment = e.temperature_range = 1e-3, e.temperature_difference = 0.01;
    e.expansion_range = 1e-9, e.drift = 1e-10;
  }
  void line(const char* adjustment, const Curve& curve, double shift = 0.0) {
    std::normal_distribution<double> normal;
    Measurement m;
    m.id = std::string("X ") + adjustment;
    m.kind = "axis";
    m.axis = "X";
    m.adjustment = adjustment;
    Observations o;
    o.measurement = m.id;
    o.lines.push_back({m.id, {1.0, 0.0, 0.0}});
    o.axes.push_back({"X", false, {}, {}});
    for (std::uint32_t run = 1; run <= runs; ++run)
      for (const int direction : directions)
        for (const double x : targets) {
          o.axes[0].position.push_back(x + shift);
          o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
          o.deviation.push_back(curve(x) + direction * half_reversal + scatter * normal(rng));
          o.run.push_back(run);
        }
    campaign.measurements.push_back(std::move(m));
    all.push_back(std::move(o));
  }
  /// The last line as a body diagonal of 0.36 x 0.48 x 0.8 m along which X falls.
  void as_diagonal() {
    Measurement& m = campaign.measurements.back();
    m.kind = "diagonal", m.axis = "";
    m.from = {{"X", 0.36}, {"Y", 0.0}, {"Z", 0.0}}, m.to = {{"X", 0.0}, {"Y", 0.48}, {"Z", 0.8}};
    Observations& o = all.back();
    const auto along = o.axes[0];
    o.axes.clear();
    for (const auto& [axis, from] : m.from) {
      const double way = m.to.at(axis) - from;
      auto& column = o.axes.emplace_back(Observations::AxisColumn{axis, false, {}, {}});
      for (std::size_t i = 0; i < along.position.size(); ++i) {
        column.position.push_back(from + along.position[i] * way);
        column.approach.push_back(
            static_cast<std::int8_t>(way > 0.0 ? along.approach[i] : -along.approach[i]));
      }
    }
  }
  Evaluation evaluate() const {
    static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "before-after");
    const Settings none;
    EXPECT_FALSE(analysis.applies(campaign, campaign.measurements[0]));
    EXPECT_TRUE(analysis.applies(campaign, campaign.measurements[1]));
    const auto e = analysis.analyse(
        {campaign, campaign.measurements[1], all[1], none, &all, control ? &*control : nullptr});
    EXPECT_TRUE(e) << (e ? "" : e.error().message);
    return e.value_or(Evaluation{});
  }
};

std::string answer(const Evaluation& e) {
  for (const Finding& f : e.findings)
    if (f.id.rfind("before-after.", 0) == 0) return f.id.substr(13);
  return {};
}

/// The table compensates the measured error, so that its scatter is in the machine afterwards.
struct Story {
  const char* wanted;
  double kept;  ///< share of the error that is left
  Curve more = [](double) { return 0.0; };
};

TEST(BeforeAfter, NamesTheEffectOfTheTable) {
  std::cout << "seed " << seed << "\n";
  const std::vector<Story> stories{
      {"worked", 0.0},
      {"not-active", 1.0},
      {"wrong-sign", 2.0},
      {"something-else", 0.0, [](double x) { return x > 0.5 ? 6 * um : 0.0; }},
      {"something-else", 0.5}};
  for (const Story& story : stories) {
    std::map<std::string, int> told;
    double inside = 0.0;
    constexpr int campaigns = 800;
    for (int c = 0; c < campaigns; ++c) {
      Shop shop;
      shop.rng.seed(seed + static_cast<unsigned>(c));
      shop.line("before", error_of);
      // What the readings before said at each stop, both directions, from the first stop on.
      std::map<double, double> mean;
      const Observations& o = shop.all[0];
      for (std::size_t i = 0; i < o.size(); ++i)
        mean[o.axes[0].position[i]] += o.deviation[i] / (2.0 * shop.runs);
      const double taken = 1.0 - story.kept;
      shop.half_reversal = 0.0;  // its value worked
      shop.line("after", [&](double x) {
        return error_of(x) - taken * (mean.at(x) - mean.at(0.0)) + story.more(x);
      });
      const Evaluation e = shop.evaluate();
      ++told[answer(e)];
      for (const Value& v : e.values)
        if (v.name == "left_share") inside += std::fabs(v.value - story.kept) <= *v.U;
    }
    std::cout << story.wanted << " " << story.kept << ":";
    for (const auto& [name, count] : told) std::cout << " " << name << " " << count;
    std::cout << "; left_share " << 100.0 * inside / campaigns << " %\n";
    EXPECT_GE(told[story.wanted], static_cast<int>(0.97 * campaigns)) << story.wanted;
    if (story.more(1.0) != 0.0) continue;  // no share of the error
    EXPECT_GE(inside, 0.94 * campaigns) << story.wanted;
    if (story.kept > 0.0)  // U contains the steps of a table, which these tables do not have
      EXPECT_LE(inside, 0.965 * campaigns) << story.wanted;
  }
}

const Finding* finding_of(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings)
    if (f.id == "before-after." + id) return &f;
  return nullptr;
}

double number_of(const Finding& f, const std::string& name) {
  for (const Number& n : f.evidence)
    if (n.name == name) return n.value;
  return NAN;
}

/// What a control makes of these means: entries of step q at points of its own, no further apart than the stops,
/// linear between them, the last value outside.
Curve table_of(const std::map<double, double>& mean, double q, std::mt19937& rng) {
  std::vector<double> x, y;
  for (const auto& [at, value] : mean) x.push_back(at), y.push_back(value - mean.begin()->second);
  const auto line = [](const std::vector<double>& xs, const std::vector<double>& ys, double at) {
    if (at <= xs.front()) return ys.front();
    if (at >= xs.back()) return ys.back();
    const auto k =
        static_cast<std::size_t>(std::upper_bound(xs.begin(), xs.end(), at) - xs.begin());
    return ys[k - 1] + (ys[k] - ys[k - 1]) * (at - xs[k - 1]) / (xs[k] - xs[k - 1]);
  };
  double closest = INFINITY;
  for (std::size_t i = 1; i < x.size(); ++i) closest = std::min(closest, x[i] - x[i - 1]);
  const double step = closest * std::uniform_real_distribution<double>(0.4, 1.0)(rng);
  std::vector<double> points, entries;
  const double first = x.front() - step * std::uniform_real_distribution<double>(0.0, 1.0)(rng);
  for (double at = first; at < x.back() + step; at += step) {
    const double value = line(x, y, at);
    points.push_back(at), entries.push_back(q > 0.0 ? q * std::round(value / q) : value);
  }
  return [=](double at) { return line(points, entries, at); };
}

// Tables have points and entries of their own, and some are made from other readings.
TEST(BeforeAfter, KnowsWhatTablesOfOtherPointsDid) {
  std::cout << "seed " << seed << "\n";
  enum class After {
    doubled,
    doubled_exactly,
    doubled_by_older_table,
    worked,
    not_active,
    half,
    step
  };
  struct Case {
    After after;
    const char *name, *wanted;
  };
  for (const Case& one :
       {Case{After::doubled, "doubled", "wrong-sign"},
        {After::doubled_exactly, "exactly doubled", "wrong-sign"},
        {After::doubled_by_older_table, "doubled by an older table", "wrong-sign"},
        {After::worked, "worked", "worked"},
        {After::not_active, "unchanged", "not-active"},
        {After::half, "halved", "something-else"},
        {After::step, "a step came later", "something-else"}}) {
    std::map<std::string, int> told;
    constexpr int campaigns = 400;
    for (int c = 0; c < campaigns; ++c) {
      std::mt19937 rng(seed + 10000U + static_cast<unsigned>(c));
      const auto any = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(rng);
      };
      Shop shop;
      shop.rng.seed(seed + 20000U + static_cast<unsigned>(c));
      shop.scatter = any(0.1, 0.6) * um;
      shop.targets.clear();
      const int n = 9 + c % 5;
      for (int i = 0; i < n; ++i)
        shop.targets.push_back(length * (i + (i > 0 && i < n - 1 ? any(-0.2, 0.2) : 0.0)) /
                               (n - 1));
      const double slope = any(10, 20) * um, wave = any(3, 8) * um, phase = any(0, 6);
      const Curve e = [=](double x) {
        return slope * x + wave * (std::sin(5.0 * x + phase) - std::sin(phase));
      };
      const double q = std::array{0.0, 0.1 * um, 1.0 * um}[static_cast<std::size_t>(c % 3)];
      shop.control.emplace();
      shop.control->value_step.linear = q;
      shop.half_reversal = 0.0;
      const auto mean_of = [&](const Observations& o) {
        std::map<double, double> mean;
        for (std::size_t i = 0; i < o.size(); ++i)
          mean[o.axes[0].position[i]] += o.deviation[i] / (2.0 * shop.runs);
        return mean;
      };
      shop.line("before", e);
      auto mean = mean_of(shop.all.back());
      if (one.after == After::doubled_by_older_table) {
        shop.line("older", e);
        mean = mean_of(shop.all.back());
        shop.all.pop_back(), shop.campaign.measurements.pop_back();
      }
      const Curve table = table_of(mean, q, rng);
      shop.line("after", [&](double x) {
        switch (one.after) {
          case After::doubled:
          case After::doubled_by_older_table:
            return e(x) + table(x);
          case After::doubled_exactly:
            return 2.0 * e(x);
          case After::worked:
            return e(x) - table(x);
          case After::not_active:
            return e(x);
          case After::half:
            return e(x) - table(x) / 2.0;
          case After::step:
            return e(x) - table(x) + (x > 0.5 ? 6 * um : 0.0);
        }
        return 0.0;
      });
      const Evaluation found = shop.evaluate();
      ++told[answer(found)];
      if (const Finding* f = finding_of(found, "wrong-sign")) {
        const double at = number_of(*f, "largest_at");
        EXPECT_NEAR(number_of(*f, "right"), -e(at) + e(0.0), 1.5 * um);
        EXPECT_EQ(number_of(*f, "now"), -number_of(*f, "right"));
      }
    }
    std::cout << one.name << ":";
    for (const auto& [name, count] : told) std::cout << " " << name << " " << count;
    std::cout << "\n";
    EXPECT_GE(told[one.wanted], campaigns * 98 / 100) << one.name;
  }
}

// Errors of single targets, as of a scale, that a coarse table may miss: half of them fits no error at each stop.
TEST(BeforeAfter, HalfOfACoarseTableHasNotWorked) {
  std::cout << "seed " << seed << "\n";
  for (const double taken : {1.0, 0.5}) {
    std::map<std::string, int> told;
    constexpr int campaigns = 500;
    for (int c = 0; c < campaigns; ++c) {
      std::mt19937 rng(seed + 30000U + static_cast<unsigned>(c));
      std::normal_distribution<double> normal;
      Shop shop;
      shop.rng.seed(seed + 40000U + static_cast<unsigned>(c));
      shop.scatter = 0.3 * um, shop.half_reversal = 0.0;
      shop.control.emplace();
      shop.control->value_step.linear = 1.0 * um;
      std::map<double, double> error;
      for (const double x : shop.targets) error[x] = x == 0.0 ? 0.0 : 4 * um * normal(rng);
      shop.line("before", [&](double x) { return error.at(x); });
      shop.line("after", [&](double x) {
        const double entry = std::round(taken * error.at(x) / um) * um;
        return error.at(x) - entry;
      });
      ++told[answer(shop.evaluate())];
    }
    std::cout << taken << ":";
    for (const auto& [name, count] : told) std::cout << " " << name << " " << count;
    std::cout << "\n";
    if (taken == 1.0)
      EXPECT_GE(told["worked"], campaigns * 9 / 10);
    else
      EXPECT_LE(told["worked"], campaigns * 2 / 100);
  }
}

// The reversal has a value of its own: "worked" is said only if both did, and the value that would have
// worked is named.
TEST(BeforeAfter, JudgesTheReversalApartFromThePitch) {
  std::cout << "seed " << seed << "\n";
  struct Reversal {
    const char* wanted;
    double kept;  ///< share of the reversal that is left
  };
  constexpr double B = -8 * um;
  for (const Reversal& r : {Reversal{nullptr, 0.0},
                            {"reversal-something-else", 0.5},
                            {"reversal-not-active", 1.0},
                            {"reversal-wrong-sign", 2.0}})
    for (const double pitch : {0.0, 1.0}) {
      int mean = 0, told = 0, all = 0;
      constexpr int campaigns = 200;
      for (int c = 0; c < campaigns; ++c) {
        Shop shop;
        shop.rng.seed(seed + static_cast<unsigned>(c));
        shop.scatter = 0.3 * um;
        shop.half_reversal = B / 2.0;
        shop.line("before", error_of);
        shop.half_reversal = r.kept * B / 2.0;
        shop.line("after", [&](double x) { return pitch * error_of(x); });
        const Evaluation e = shop.evaluate();
        const std::string wanted = pitch > 0.0 ? "not-active"
                                   : r.wanted  ? "mean-as-predicted"
                                               : "worked";
        mean += answer(e) == wanted;
        const Finding* reversal = finding_of(e, r.wanted ? r.wanted : "reversal-as-predicted");
        told += reversal != nullptr;
        all += finding_of(e, "worked") != nullptr;
        if (reversal == nullptr || r.wanted == nullptr) continue;
        EXPECT_TRUE(reversal->attention);
        EXPECT_NEAR(number_of(*reversal, "right"), -B, 0.6 * um);
        EXPECT_NEAR(number_of(*reversal, "change"), -r.kept * B, 0.6 * um);
      }
      std::cout << "reversal kept " << r.kept << ", pitch kept " << pitch << ": mean " << mean
                << ", reversal " << told << " of " << campaigns << "\n";
      EXPECT_GE(mean, campaigns * 97 / 100);
      EXPECT_GE(told, campaigns * 97 / 100);
      if (r.wanted != nullptr || pitch > 0.0) EXPECT_EQ(all, 0);
    }
}

/// A control that takes whole steps of the backlash value leaves up to half a step: that is what was predicted.
TEST(BeforeAfter, AReversalIsRoundedToTheStepOfTheControl) {
  std::cout << "seed " << seed << "\n";
  constexpr double step = 2 * um;
  int rounded = 0, exact = 0, wrong = 0, campaigns = 0;
  for (int c = 0; c < 60; ++c) {
    for (const double left : {-0.9 * um, 0.6 * um, 5 * um}) {
      Shop shop;
      shop.rng.seed(seed + static_cast<unsigned>(c));
      shop.scatter = 0.1 * um;
      shop.half_reversal = -4.5 * um;
      shop.line("before", error_of);
      shop.half_reversal = left / 2.0;
      shop.line("after", [](double) { return 0.0; });
      const bool is_exact = finding_of(shop.evaluate(), "reversal-as-predicted") != nullptr;
      shop.control.emplace();
      shop.control->value_step.linear = step;
      const bool is_rounded = finding_of(shop.evaluate(), "reversal-as-predicted") != nullptr;
      (std::fabs(left) > step ? wrong : rounded) += is_rounded;
      exact += is_exact;
      campaigns += std::fabs(left) < step;
    }
  }
  EXPECT_GE(rounded, campaigns * 97 / 100);
  EXPECT_EQ(exact, 0);
  EXPECT_EQ(wrong, 0);
}

TEST(BeforeAfter, ADiagonalIsALineFromItsFirstCorner) {
  Shop shop;
  shop.scatter = 0.01 * um;
  shop.line("before", error_of), shop.as_diagonal();
  shop.line("after", [](double x) { return 2.0 * error_of(x); }), shop.as_diagonal();
  const Evaluation e = shop.evaluate();
  EXPECT_EQ(answer(e), "wrong-sign");
  const auto *target = e.points.column("target"), *before = e.points.column("before");
  ASSERT_TRUE(target != nullptr && before != nullptr);
  for (std::size_t i = 0; i < stops; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(stops - 1);
    EXPECT_NEAR(target->values[i], share, 1e-9) << "its length is 1 m";
    EXPECT_NEAR(before->values[i], error_of(share), 0.05 * um);
  }
}

TEST(BeforeAfter, RefusesWhatItCannotCompare) {
  Shop other;
  other.line("before", error_of), other.line("after", error_of, 0.01);
  EXPECT_EQ(answer(other.evaluate()), "stops");
  Shop once;
  once.runs = 1;
  once.line("before", error_of), once.line("after", error_of);
  EXPECT_EQ(answer(once.evaluate()), "no-repetition");
  Shop directions;
  directions.directions = {1};
  directions.line("before", error_of);
  directions.directions = {-1};
  directions.line("after", error_of);
  EXPECT_EQ(answer(directions.evaluate()), "directions");
  Shop small;  // no error to compensate
  const Curve none = [](double) { return 0.0; };
  small.line("before", none), small.line("after", none);
  EXPECT_EQ(answer(small.evaluate()), "cannot-tell");
}

}  // namespace
}  // namespace nonio::fixtures::before_after_test
