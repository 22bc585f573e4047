// SPDX-License-Identifier: Apache-2.0
#include "simulation/simulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "methods.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::simulate_test {
namespace {

Effect backlash() {
  Effect e;
  e.info = {"backlash", "1", "Constant reversal"};
  e.linear = {{"b", "reversal", Quantity::deviation, Quantity::angular_deviation}};
  e.applies = [](const Observations&, const Axis&) { return true; };
  e.columns = [](const Observations& o, const Axis& axis,
                 const std::vector<double>&) -> Expected<Effect::Columns> {
    auto r = readings_of(o, axis);
    for (double& d : r->d) d *= 0.5;
    return Effect::Columns{r->d};
  };
  return e;
}

/// A step at an instant, which has to be given.
Effect jump() {
  Effect e = backlash();
  e.info.name = "run-jump";
  e.linear = {{"j", "shift", Quantity::deviation, Quantity::angular_deviation}};
  e.shapes = {{{"instant", "when", Quantity::time}, [](const Observations&, const Axis&) {
                 return std::vector<double>{1.0, 2.0};
               }}};
  e.columns = [](const Observations& o, const Axis& axis,
                 const std::vector<double>& shape) -> Expected<Effect::Columns> {
    auto r = readings_of(o, axis);
    for (double& t : r->t) t = t > shape[0] ? 1.0 : 0.0;
    return Effect::Columns{r->t};
  };
  return e;
}

/// A curve of two columns.
Effect curve() {
  Effect e = backlash();
  e.info.name = "pitch-curve";
  e.curve = true;
  e.linear[0].name = "s";
  e.columns = [](const Observations& o, const Axis& axis,
                 const std::vector<double>&) -> Expected<Effect::Columns> {
    const auto r = readings_of(o, axis);
    Effect::Columns c(2, r->p);
    for (double& v : c[0]) v = v * v;
    for (double& v : c[1]) v = v * v * v;
    return c;
  };
  return e;
}

std::vector<Effect> effects() { return {backlash(), jump(), curve()}; }

const std::string manifest = R"(# hides a worn nut
format = 1
[campaign]
id = "a-1"   # of the site
[machine.axes.X]
kind = "linear"
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[simulation]
seed = 7
)";
const std::string cycle = R"([[cycle]]
measurement = "X"
from_mm = 0
to_mm = 100
step_mm = 10
runs = 2
)";
const std::string lost = "[[effect]]\nname = \"backlash:X\"\nb_um = -6\n";

struct Row {
  int run = 0;
  std::string direction;
  double target = 0.0, deviation = 0.0, time = 0.0;
};

std::vector<Row> rows(const simulation::Simulated& s) {
  std::istringstream lines(s.campaign.front().bytes);
  std::vector<Row> all;
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, simulation::simulated_mark);
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string run, direction, target, deviation, time;
    std::getline(fields, run, ',');
    std::getline(fields, direction, ',');
    std::getline(fields, target, ',');
    std::getline(fields, deviation, ',');
    std::getline(fields, time, ',');
    all.push_back({std::stoi(run), direction, std::stod(target), std::stod(deviation),
                   time.empty() ? 0.0 : std::stod(time)});
  }
  return all;
}

simulation::Simulated made(const std::string& text) {
  auto s = simulation::simulate(text, "spec.toml", effects(), own_methods());
  if (s) return std::move(*s);
  ADD_FAILURE() << s.error().front().line << ": " << s.error().front().message;
  return {};
}

/// The only complaint.
Error complaint(const std::string& text) {
  const auto s = simulation::simulate(text, "spec.toml", effects(), own_methods());
  if (s) return Error{"nothing was complained of"};
  EXPECT_EQ(s.error().size(), 1U) << s.error().back().message;
  EXPECT_EQ(s.error().front().file, "spec.toml");
  return s.error().front();
}

TEST(Simulate, an_effect_without_noise_is_what_was_put_in) {
  const auto all = rows(made(manifest + cycle + lost));
  ASSERT_EQ(all.size(), 44U);
  for (const Row& r : all) EXPECT_EQ(r.deviation, r.direction == "+" ? -3.0 : 3.0);
  EXPECT_EQ(all[10].target, 100.0);
  EXPECT_EQ(all[11].target, 100.0);  // pendulum
  EXPECT_EQ(all[11].direction, "-");
  EXPECT_GT(all[1].time, all[0].time);
  EXPECT_EQ(all[22].run, 2);
}

TEST(Simulate, unidirectional_runs_have_one_direction) {
  for (const Row& r :
       rows(made(manifest + cycle + "order = \"unidirectional\"\ndirection = \"-\"\n")))
    EXPECT_EQ(r.direction, "-");
}

TEST(Simulate, the_same_seed_gives_the_same_bytes_and_another_one_does_not) {
  const std::string noisy = manifest + cycle + "noise_um = 1\nrandom_offset_pct = 30\n" + lost;
  const simulation::Simulated one = made(noisy), two = made(noisy);
  EXPECT_EQ(one.campaign[0].bytes, two.campaign[0].bytes);
  EXPECT_EQ(one.truth, two.truth);
  std::string other = noisy;
  other.replace(other.find("seed = 7"), 8, "seed = 8");
  EXPECT_NE(one.campaign[0].bytes, made(other).campaign[0].bytes);
  // A further effect leaves the noise as it is.
  const auto before = rows(one), after = rows(made(noisy + "[[effect]]\nname = \"run-jump:X\"\n"
                                                           "j_um = 2\ninstant_s = 0\n"));
  for (std::size_t i = 1; i < before.size(); ++i)
    EXPECT_NEAR(after[i].deviation - before[i].deviation, 2.0, 0.0021);
}

TEST(Simulate, noise_and_misreadings_have_their_size) {
  std::string many = manifest + cycle + "noise_um = 0.5\n";
  many.replace(many.find("runs = 2"), 8, "runs = 500");
  double square = 0.0;
  const auto quiet = rows(made(many));
  for (const Row& r : quiet) square += r.deviation * r.deviation;
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(quiet.size())), 0.5, 0.02);
  int off = 0;
  for (const Row& r : rows(made(many + "misreadings = { fraction = 0.02, size = [20.0, 40.0] }\n")))
    if (std::fabs(r.deviation) > 5.0) ++off;
  EXPECT_NEAR(off / 11000.0, 0.02, 0.005);
}

TEST(Simulate, a_curve_has_the_asked_rms) {
  const auto all =
      rows(made(manifest + cycle + "[[effect]]\nname = \"pitch-curve:X\"\ns_um = 4\n"));
  double square = 0.0;
  for (const Row& r : all) square += r.deviation * r.deviation / static_cast<double>(all.size());
  EXPECT_NEAR(std::sqrt(square), 4.0, 0.001);
}

TEST(Simulate, targets_keep_their_order_and_their_range) {
  const auto all = rows(made(manifest + cycle + "random_offset_pct = 45\n"));
  for (std::size_t i = 1; i < 11; ++i) EXPECT_GT(all[i].target, all[i - 1].target);
  EXPECT_GE(all[0].target, 0.0);
  EXPECT_LE(all[10].target, 100.0);
  EXPECT_NE(all[5].target, 50.0);
}

TEST(Simulate, the_campaign_does_not_tell_the_truth) {
  const simulation::Simulated s = made(manifest + cycle + lost);
  const std::string& text = s.campaign.back().bytes;
  EXPECT_EQ(s.campaign.back().name, "campaign.toml");
  EXPECT_EQ(text.find("worn nut"), std::string::npos);
  EXPECT_EQ(text.find("effect"), std::string::npos);
  EXPECT_EQ(text.find("cycle"), std::string::npos);
  EXPECT_TRUE(text.starts_with(simulation::simulated_mark));
  const auto read = config::parse_manifest(text, "campaign.toml", own_methods());
  ASSERT_TRUE(read) << read.error().front().message;
  EXPECT_EQ(read->campaign.measurements.front().file, "x.csv");
  EXPECT_NE(s.truth.find("\"backlash:X\""), std::string::npos);
}

TEST(Simulate, errors_name_the_line_and_the_nearest_name) {
  const auto near = [](const Error& e, const char* words) {
    return e.message.find(words) != std::string::npos;
  };
  Error e = complaint(manifest + cycle + "[[effect]]\nname = \"backlsh:X\"\nb_um = 1\n");
  EXPECT_EQ(e.line, 21U);
  EXPECT_TRUE(near(e, "nearest: \"backlash\"")) << e.message;
  e = complaint(manifest + cycle + "[[effect]]\nname = \"backlash:Y\"\nb_um = 1\n");
  EXPECT_TRUE(near(e, "no axis \"Y\"")) << e.message;
  e = complaint(manifest + cycle + "[[effect]]\nname = \"backlash\"\n");
  EXPECT_TRUE(near(e, "kind:axis")) << e.message;
  e = complaint(manifest + cycle + "[[effect]]\nname = \"backlash:X\"\n");
  EXPECT_EQ(e.line, 20U);
  EXPECT_TRUE(near(e, "effect.b_um is missing")) << e.message;
  e = complaint(manifest + cycle + lost + "b_mm = 1\n");
  EXPECT_EQ(e.line, 23U);
  EXPECT_TRUE(near(e, "nearest: \"b_um\"")) << e.message;
  e = complaint(manifest + cycle + "[[effect]]\nname = \"run-jump:X\"\nj_um = 2\n");
  EXPECT_TRUE(near(e, "effect.instant_s is missing")) << e.message;
  e = complaint(manifest + cycle + "noise = 1\n");
  EXPECT_TRUE(near(e, "unknown key cycle.noise")) << e.message;
  e = complaint(manifest + "[[cycle]]\nmeasurement = \"Z\"\n");
  EXPECT_TRUE(near(e, "no [[measurement]] has the id \"Z\"")) << e.message;
  e = complaint(manifest);
  EXPECT_TRUE(near(e, "no [[cycle]]")) << e.message;
  e = complaint(manifest + cycle + cycle);
  EXPECT_TRUE(near(e, "two cycles")) << e.message;
  e = complaint(manifest + "[[cycle]]\nmeasurement = \"X\"\ntargets_mm = [0, 5, 5]\n");
  EXPECT_TRUE(near(e, "each larger than the one before")) << e.message;
  e = complaint(manifest + "[[cycle]]\nmeasurement = \"X\"\nfrom_mm = 0\n");
  EXPECT_TRUE(near(e, "to_mm")) << e.message;
  std::string broken = manifest + cycle;
  broken.replace(broken.find("kind = \"linear\""), 15, "kind = \"round\"");
  EXPECT_EQ(complaint(broken).line, 6U);
}

}  // namespace
}  // namespace nonio::simulate_test
