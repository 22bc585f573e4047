// SPDX-License-Identifier: Apache-2.0
// The analysis step-diagonal from files to findings: what it gives, and what it refuses.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <regex>
#include <set>
#include <sstream>

#include "csv.h"
#include "nonio/sdk/check.h"
#include "nonio/sdk/plugin.h"
#include "workshop.h"

extern "C" const nonio::PluginEntry nonio_plugin;

namespace steps {
namespace {

using namespace nonio;

Analysis the_analysis() {
  struct Taker final : Registry {
    Analysis analysis;
    void add(Method) override { ADD_FAILURE() << "a method"; }
    void add(Reader) override { ADD_FAILURE() << "a reader"; }
    void add(Effect) override { ADD_FAILURE() << "an effect"; }
    void add(Output) override { ADD_FAILURE() << "an output"; }
    void add(Controller) override { ADD_FAILURE() << "a controller"; }
    void add(Analysis a) override { analysis = std::move(a); }
  } taker;
  nonio_plugin.add_to(taker);
  return taker.analysis;
}

const std::array<const char*, 4> names{"PPP", "NPP", "PNP", "PPN"};
constexpr double per_um = 1e6, per_mm = 1e3;

/// Lines of a file for one diagonal; `moved` names the axes of a cycle.
std::string rows(const StepDiagonals& d, std::size_t k, const std::string& moved = "XYZ") {
  std::ostringstream text;
  text << std::setprecision(12);
  for (std::size_t t = 0; t < 3 * d.n; ++t)
    text << names[k] << "," << t + 1 << "," << moved[t % 3] << ","
         << d.passes[k].reading[t] * per_um << "\n";
  return text.str();
}

std::string file_of(const StepDiagonals& d) {
  std::string text = "diagonal,step,moved,deviation_um\n";
  for (std::size_t k = 0; k < 4; ++k) text += rows(d, k);
  return text;
}

std::string axis_file(const math::AxisSeries& s, double stretch = 0.0) {
  std::ostringstream text;
  text << std::setprecision(12) << "run,direction,target_mm,deviation_um\n";
  for (const int run : {1, 2})
    for (std::size_t i = 0; i < s.position.size(); ++i)
      text << run << ",+," << s.position[i] * per_mm << ","
           << s.deviation[i] * per_um + stretch * s.position[i] + (run == 1 ? 0.05 : -0.05) << "\n";
  return text.str();
}

/// A campaign on the bench: files and options, then its evaluation.
struct Bench {
  Volume volume{{0.8, 0.6, 0.6}, 10};
  Campaign campaign;
  std::vector<std::string> files;
  Settings options;

  Bench() {
    for (const Option& o : the_analysis().info.options) options.values[o.name] = o.default_value;
    for (const char* name : {"X", "Y", "Z"}) {
      Axis axis;
      axis.name = name;
      campaign.machine.axes.push_back(axis);
    }
  }

  void steps(const std::string& text, const std::string& id = "SD") {
    Measurement m;
    m.id = id;
    m.kind = "step-diagonal";
    m.file = "sd.csv";
    for (const char axis : {'X', 'Y', 'Z'}) {
      m.from[std::string(1, axis)] = 0.0;
      m.to[std::string(1, axis)] = volume.travel[axis - 'X'];
    }
    campaign.measurements.push_back(m);
    files.push_back(text);
  }

  void axis(const std::string& id, const math::AxisSeries& s, double stretch = 0.0) {
    Measurement m;
    m.id = id;
    m.kind = "axis";
    m.axis = id.substr(0, 1);
    campaign.measurements.push_back(m);
    files.push_back(axis_file(s, stretch));
  }

  void axes(const machine::Errors& e, const std::string& which, double stretch = 0.0) {
    for (const char axis_name : which)
      axis(std::string(1, axis_name), lengths(e, volume, std::string(1, axis_name))[0], stretch);
  }

  Expected<Evaluation> evaluated(std::size_t measurement = 0) const {
    std::vector<Observations> all;
    const Settings none;
    for (std::size_t i = 0; i < files.size(); ++i) {
      auto read = csv::read({files[i], campaign, campaign.measurements[i], none, {}});
      if (!read) return fail(read.error());
      all.push_back(std::move(*read));
    }
    return the_analysis().analyse(
        {campaign, campaign.measurements[measurement], all[measurement], options, &all});
  }
};

std::string words_of(const std::string& id) {
  std::ifstream in(std::string(NONIO_WORDS) + "/en/steps.toml");
  std::string out;
  bool here = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("[")) here = line == "[finding.\"" + id + "\"]";
    if (here) out += line + "\n";
  }
  return out;
}

/// One whose words are the program's, not this plugin's.
const Finding* finding_of_host(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings)
    if (f.id == id) return &f;
  return nullptr;
}

/// The finding, whose words find all that they name.
const Finding* finding(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings) {
    if (f.id != id) continue;
    std::set<std::string> given;
    for (const auto& n : f.evidence) given.insert(n.name);
    for (const auto& [name, text] : f.texts) given.insert(name);
    const std::string words = words_of(id);
    EXPECT_FALSE(words.empty()) << id;
    static const std::regex place("\\{([^}]*)\\}");
    for (std::sregex_iterator it(words.begin(), words.end(), place), end; it != end; ++it)
      EXPECT_TRUE(given.contains((*it)[1])) << id << " {" << (*it)[1] << "}";
    return &f;
  }
  return nullptr;
}

const Series* series(const Evaluation& e, const std::string& name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

/// Readings with a little noise, of a machine with errors and mirrors askew.
StepDiagonals noisy(const machine::Errors& e, const Volume& v, double askew, double u = 0.05 * um) {
  std::mt19937 rng(7);
  auto d = measured(e, v, random_set_up(rng, askew, true));
  std::normal_distribution<double> noise(0.0, u);
  for (auto& pass : d.passes)
    for (double& r : pass.reading) r += noise(rng);
  return d;
}

machine::Errors some_errors(const Volume& v) {
  std::mt19937 rng(11);
  return random_errors(rng, v, 20 * um);
}

TEST(StepDiagonal, EachRunOfADiagonalHasAColumn) {
  Bench b;
  const auto d = noisy(some_errors(b.volume), b.volume, 0.2e-3);
  std::string text = "run,diagonal,step,moved,deviation_um\n";
  for (const char* run : {"1,", "2,"})
    for (std::size_t k = 0; k < 4; ++k) {
      std::istringstream lines(rows(d, k));
      for (std::string line; std::getline(lines, line);) text += run + line + "\n";
    }
  b.steps(text);
  const auto result = b.evaluated();
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->points.columns.size(), 9U);
  for (const char* pass : {"PPP", "PNP", "PPP-run-2", "PNP-run-2"})
    EXPECT_NE(result->points.column(pass), nullptr) << pass;
  EXPECT_TRUE(check(*result));
}

TEST(StepDiagonal, WithAxisRunsEverythingIsGiven) {
  Bench b;
  const auto e = some_errors(b.volume);
  b.steps(file_of(noisy(e, b.volume, 0.2e-3)));
  b.axes(e, "XYZ");
  const auto result = b.evaluated();
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->uses, (std::vector<std::string>{"X", "Y", "Z"}));
  ASSERT_EQ(result->values.size(), 4U);
  EXPECT_EQ(result->values[3].name, "D_max");
  double largest = 0.0;
  for (const char* pass : {"PPP", "NPP", "PNP", "PPN"}) {
    const auto* drawn = result->points.column(pass);
    ASSERT_NE(drawn, nullptr) << pass;
    ASSERT_EQ(drawn->values.size(), 11U);
    EXPECT_EQ(drawn->values.front(), 0.0);
    for (const double v : drawn->values) largest = std::max(largest, std::fabs(v));
  }
  EXPECT_GT(largest, 5.0 * um);
  EXPECT_EQ(result->values[3].value, largest);
  const auto square = true_squareness(e, b.volume);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(result->values[k].value, square[k], 0.5 * urad) << result->values[k].name;
    // The manifest has no budget: then the fit's repeatability, under its own name.
    EXPECT_FALSE(result->values[k].U);
    EXPECT_TRUE(result->values[k].repeatability);
  }
  EXPECT_NE(finding_of_host(*result, "uncertainty.no-data"), nullptr);
  EXPECT_FALSE(result->budget);
  ASSERT_EQ(result->series.size(), 9U);
  const Series* eyx = series(*result, "EYX");
  ASSERT_NE(eyx, nullptr);
  EXPECT_TRUE(eyx->U.empty());
  EXPECT_EQ(eyx->repeatability.size(), eyx->value.size());
  const auto wanted = levelled(sampled(e.EYX, 0.8, 10));
  EXPECT_LT(largest_difference(eyx->value, wanted), 0.3 * um);
  ASSERT_NE(series(*result, "EXX"), nullptr);
  EXPECT_TRUE(series(*result, "EXX")->U.empty());
  const Finding* askew = finding(*result, "step-diagonal.set-up-seen");
  ASSERT_NE(askew, nullptr);
  EXPECT_FALSE(askew->attention);
  EXPECT_EQ(finding(*result, "step-diagonal.scales-not-identified"), nullptr);
  EXPECT_EQ(finding(*result, "step-diagonal.lengths-disagree"), nullptr);
}

/// D_max is the largest of noisy readings, which leans upwards: 2,000 campaigns by
/// NONIO_CAMPAIGNS=2000 test_step_diagonal --gtest_filter=*Covers*
TEST(StepDiagonal, UOfTheLargestDeviationCoversTheExactMachine) {
  const char* asked = std::getenv("NONIO_CAMPAIGNS");
  const int campaigns = asked != nullptr ? std::atoi(asked) : 40;
  const unsigned seed = 20261130;
  for (const double size : {20 * um, 5 * um}) {
    std::mt19937 rng(seed);
    int in = 0;
    double above = 0.0;
    for (int i = 0; i < campaigns; ++i) {
      Bench b;
      const auto e = random_errors(rng, b.volume, size);
      const auto exact = measured(e, b.volume);
      double largest = 0.0;
      for (const auto& pass : exact.passes)
        for (std::size_t t = 2; t < pass.reading.size(); t += 3)
          largest = std::max(largest, std::fabs(pass.reading[t]));
      auto d = measured(e, b.volume, random_set_up(rng, 0.1e-3, true));
      std::normal_distribution<double> noise(0.0, 0.5 * um);
      for (auto& pass : d.passes) {
        const double start = noise(rng);  // the reading before the first move has it too
        for (double& r : pass.reading) r += noise(rng) - start;
      }
      b.steps(file_of(d));
      b.axes(e, "XYZ");
      const auto result = b.evaluated();
      ASSERT_TRUE(result) << result.error().message;
      const auto& v = result->values.back();
      ASSERT_EQ(v.name, "D_max");
      ASSERT_TRUE(v.repeatability);
      in += std::fabs(v.value - largest) <= *v.repeatability ? 1 : 0;
      above += (v.value - largest) / campaigns;
    }
    const double share = 100.0 * in / campaigns;
    std::printf("seed %u, errors of %.0f um, noise 0.5 um: %.1f %% of %d, %.2f um too large\n",
                seed, size / um, share, campaigns, above / um);
    EXPECT_NEAR(share, 95.0, std::max(2.0, 300.0 * std::sqrt(0.95 * 0.05 / campaigns)));
  }
}

TEST(StepDiagonal, WithoutLengthsThereAreNoScales) {
  Bench b;
  const auto e = some_errors(b.volume);
  b.steps(file_of(noisy(e, b.volume, 0.2e-3)));
  for (const char* method : {"least-squares", "averaging"}) {
    b.options.values["method"] = std::string(method);
    const auto result = b.evaluated();
    ASSERT_TRUE(result);
    EXPECT_EQ(result->values.size(), 4U);
    EXPECT_NE(finding(*result, "step-diagonal.scales-not-identified"), nullptr);
    EXPECT_EQ(series(*result, "EXX"), nullptr);
    ASSERT_NE(series(*result, "EXX_shape"), nullptr);
    EXPECT_NEAR(series(*result, "EXX_shape")->value.back(), 0.0, 1e-12);
    EXPECT_NE(series(*result, "EYX"), nullptr);
  }
}

TEST(StepDiagonal, LengthsOfAnotherOccasionAreNotUsed) {
  Bench b;
  b.steps(file_of(noisy({}, b.volume, 0.0)), "SD final");
  b.axes({}, "XYZ");
  auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->uses.empty());
  for (const char axis : {'X', 'Y', 'Z'})
    b.axis(std::string(1, axis) + " final", lengths({}, b.volume, std::string(1, axis))[0]);
  result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->uses, (std::vector<std::string>{"X final", "Y final", "Z final"}));
}

TEST(StepDiagonal, TwoMeasurementsOfAnAxisAreNotChosenFrom) {
  Bench b;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  b.axes({}, "XYZ");
  b.axis("X2", lengths({}, b.volume, "X")[0]);
  auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.lengths-ambiguous"), nullptr);
  EXPECT_EQ(result->uses, (std::vector<std::string>{"Y", "Z"}));
  b.options.values["lengths"] = std::vector<std::string>{"X", "Y", "Z"};
  result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_EQ(finding(*result, "step-diagonal.lengths-ambiguous"), nullptr);
}

void expect_refusal(const Bench& b, const std::string& id) {
  const auto result = b.evaluated();
  ASSERT_TRUE(result) << result.error().message;
  const Finding* f = finding(*result, id);
  ASSERT_NE(f, nullptr) << id;
  EXPECT_TRUE(f->attention);
  EXPECT_TRUE(result->values.empty());
  EXPECT_TRUE(result->series.empty());
}

TEST(StepDiagonal, AMissingDiagonalIsRefused) {
  Bench b;
  const auto d = noisy({}, b.volume, 0.0);
  b.steps("diagonal,step,moved,deviation_um\n" + rows(d, 0) + rows(d, 1) + rows(d, 3));
  expect_refusal(b, "step-diagonal.too-few-diagonals");
}

TEST(StepDiagonal, UnequalStepsAreRefused) {
  Bench b;
  const auto d = noisy({}, b.volume, 0.0), fewer = noisy({}, {b.volume.travel, 8}, 0.0);
  b.steps("diagonal,step,moved,deviation_um\n" + rows(d, 0) + rows(d, 1) + rows(fewer, 2) +
          rows(d, 3));
  expect_refusal(b, "step-diagonal.unequal-steps");
}

TEST(StepDiagonal, AnotherOrderOfMovesIsRefused) {
  Bench b;
  const auto d = noisy({}, b.volume, 0.0);
  b.steps("diagonal,step,moved,deviation_um\n" + rows(d, 0) + rows(d, 1, "YXZ") + rows(d, 2) +
          rows(d, 3));
  expect_refusal(b, "step-diagonal.order-differs");
}

TEST(StepDiagonal, AnOrderThatChangesUnderwayIsRefused) {
  Bench b;
  std::string text = file_of(noisy({}, b.volume, 0.0));
  const auto swap = [&](const std::string& a, const std::string& to) {
    const auto at = text.find(a);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, a.size(), to);
  };
  swap("PNP,4,X", "PNP,4,Y");
  swap("PNP,5,Y", "PNP,5,X");
  b.steps(text);
  expect_refusal(b, "step-diagonal.order-broken");
}

TEST(StepDiagonal, TooFewStepsAreRefused) {
  Bench b;
  b.volume.n = 2;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  expect_refusal(b, "step-diagonal.steps");
}

TEST(StepDiagonal, AMirrorThatCannotReachIsRefused) {
  Bench b;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  b.options.values["mirror_mm"] = 50.0;  // a step of 80 mm wanders 58 mm
  expect_refusal(b, "step-diagonal.mirror");
  b.options.values["mirror_mm"] = 65.0;
  EXPECT_EQ(finding(*b.evaluated(), "step-diagonal.mirror"), nullptr);
}

TEST(StepDiagonal, AveragingWithAMissingReadingIsRefused) {
  Bench b;
  auto d = noisy({}, b.volume, 0.0);
  d.passes[2].reading[13] = std::nan("");
  b.steps(file_of(d));
  EXPECT_FALSE(b.evaluated()->series.empty());
  b.options.values["method"] = std::string("averaging");
  expect_refusal(b, "step-diagonal.incomplete");
}

TEST(StepDiagonal, AnotherUnitIsAnError) {
  Bench b;
  std::string text = file_of(noisy({}, b.volume, 0.0));
  text.replace(text.find("deviation_um"), 12, "deviation_mm");
  b.steps(text);
  const auto result = b.evaluated();
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("deviation_mm"), std::string::npos);
  EXPECT_EQ(result.error().file, "sd.csv");
}

TEST(StepDiagonal, ASetUpSaidToBeSquareIsChecked) {
  Bench b;
  b.options.values["set_up_square"] = true;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(series(*result, "EXX"), nullptr);
  b.files[0] = file_of(noisy({}, b.volume, 0.2e-3));
  result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.set-up-not-square"), nullptr);
  EXPECT_EQ(series(*result, "EXX"), nullptr);
}

TEST(StepDiagonal, DriftIsSaid) {
  Bench b;
  auto d = noisy({}, b.volume, 0.0);
  for (std::size_t t = 0; t < 30; ++t)
    d.passes[2].reading[t] += 20 * um * (1.0 - std::exp(-static_cast<double>(t) / 15.0));
  b.steps(file_of(d));
  const auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.drift"), nullptr);
}

TEST(StepDiagonal, LengthsFromAnotherScaleDisagree) {
  Bench b;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  b.axes({}, "XYZ", 3.0);  // um per m
  const auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.lengths-disagree"), nullptr);
}

TEST(StepDiagonal, AngularErrorThroughTheMirrorIsSaid) {
  Bench b;
  machine::Errors e;
  e.ECY = [](double y) { return 100 * urad * y / 0.6; };
  b.steps(file_of(noisy(e, b.volume, 0.0)));
  b.axes(e, "XYZ");
  const auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.axis-disagrees"), nullptr);
}

TEST(StepDiagonal, StraightnessThatYawCouldMakeIsWithheld) {
  Bench b;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  b.options.values["angle_urad"] = 10.0;
  b.options.values["budget_um"] = 3.5;  // X: 4 um, Y: 3 um
  const auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.angles-too-large"), nullptr);
  EXPECT_EQ(series(*result, "EYX"), nullptr);
  EXPECT_EQ(series(*result, "EZX"), nullptr);
  EXPECT_NE(series(*result, "EZY"), nullptr);
}

TEST(StepDiagonal, FewStepsHaveNoUncertaintyUnlessItIsStated) {
  Bench b;
  b.volume.n = 4;
  b.steps(file_of(noisy({}, b.volume, 0.0)));
  auto result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_NE(finding(*result, "step-diagonal.no-uncertainty"), nullptr);
  EXPECT_FALSE(result->values[0].U);
  EXPECT_TRUE(result->series[1].U.empty());
  b.options.values["u_reading_um"] = 0.05;
  result = b.evaluated();
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->values[0].repeatability);
}

}  // namespace
}  // namespace steps
