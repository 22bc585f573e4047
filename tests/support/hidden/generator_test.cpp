// SPDX-License-Identifier: Apache-2.0
#include "hidden/generator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "cycle.h"
#include "hidden/random.h"

using namespace nonio;
using namespace nonio::hidden;

namespace {

constexpr Kind kinds[] = {Kind::one,           Kind::several,          Kind::complete,
                          Kind::outside,       Kind::wave_under_curve, Kind::screw_and_curve,
                          Kind::beside,        Kind::grouped,          Kind::short_misread,
                          Kind::short_complete};
constexpr std::uint64_t campaigns = 40;  // of each kind

std::string read(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class HiddenCampaigns : public testing::TestWithParam<Kind> {
 protected:
  template <class Check>
  void each(Check check) {
    for (std::uint64_t seed = 1; seed <= campaigns; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      check(generate(random_scenario(GetParam(), seed)));
    }
  }
};

/// Mean and RMS about it of what is left when the causes are taken out of sound readings.
std::pair<double, double> noise_of(const Hidden& h) {
  std::vector<double> left;
  std::vector<char> sound(h.table.size(), 1);
  for (const std::size_t row : h.misread) sound[row] = 0;
  for (std::size_t i = 0; i < h.table.size(); ++i) {
    double e = h.table.deviation[i];
    for (const auto& cause : h.causes) e -= cause[i];
    if (sound[i]) left.push_back(e);
  }
  double mean = 0.0;
  for (const double e : left) mean += e / static_cast<double>(left.size());
  return {mean, rms_about_mean(left)};
}

TEST_P(HiddenCampaigns, causes_have_the_asked_rms) {
  each([](const Hidden& h) {
    std::vector<Piece> pieces = h.scenario.model;
    pieces.insert(pieces.end(), h.scenario.hidden.begin(), h.scenario.hidden.end());
    ASSERT_EQ(h.causes.size(), pieces.size());
    for (std::size_t k = 0; k < pieces.size(); ++k)
      EXPECT_NEAR(rms_about_mean(h.causes[k]) / h.scenario.noise, pieces[k].size, 1e-5)
          << to_text(pieces[k].source);
  });
}

TEST_P(HiddenCampaigns, the_noise_is_as_said_and_only_few_readings_are_misread) {
  double share = 0.0;
  each([&](const Hidden& h) {
    const auto [zero, noise] = noise_of(h);
    const double n = static_cast<double>(h.table.size());
    EXPECT_NEAR(noise / h.scenario.noise, 1.0, 4.0 / std::sqrt(2.0 * n));
    EXPECT_LT(std::fabs(zero), 11.0 * h.scenario.noise);
    share += static_cast<double>(h.misread.size()) / n / static_cast<double>(campaigns);
    if (h.scenario.misread == 0.0) {
      EXPECT_EQ(h.misread.size(), h.scenario.one_misread ? 1U : 0U);
    }
  });
  if (GetParam() == Kind::several) {
    EXPECT_NEAR(share, 0.01, 0.005);
  }
}

TEST_P(HiddenCampaigns, the_named_effect_describes_its_cause) {
  each([](const Hidden& h) {
    for (const double left : h.truth.imperfection)
      if (!std::isnan(left)) {
        EXPECT_LT(left, 0.03 * 9.0);
      }
  });
}

TEST_P(HiddenCampaigns, the_same_seed_gives_the_same_campaign) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Hidden one = generate(random_scenario(GetParam(), seed));
    const Hidden two = generate(random_scenario(GetParam(), seed));
    EXPECT_EQ(one.table.deviation, two.table.deviation);
    EXPECT_EQ(one.table.time, two.table.time);
    EXPECT_EQ(one.truth.hidden, two.truth.hidden);
    const Hidden other = generate(random_scenario(GetParam(), seed + 1000));
    EXPECT_NE(one.table.deviation, other.table.deviation);
  }
}

TEST_P(HiddenCampaigns, the_truth_is_of_its_kind) {
  each([](const Hidden& h) {
    const Truth& t = h.truth;
    switch (GetParam()) {
      case Kind::one:
      case Kind::beside:
      case Kind::grouped:
      case Kind::fixed_end:
      case Kind::blank_temperatures:
      case Kind::day_wave:
      case Kind::smallest:
      case Kind::short_misread:
        EXPECT_EQ(t.hidden.size(), 1U);
        EXPECT_TRUE(t.model.empty());
        EXPECT_EQ(t.verdict, "missing");
        break;
      case Kind::wave_under_curve:
        EXPECT_EQ(t.hidden, std::vector<std::string>{"periodic:X"});
        EXPECT_EQ(t.model, std::vector<std::string>{"pitch-curve:X"});
        break;
      case Kind::screw_and_curve:
      case Kind::several:
        EXPECT_GE(t.hidden.size(), 2U);
        EXPECT_EQ(t.verdict, "missing");
        break;
      case Kind::short_complete:
        EXPECT_TRUE(t.hidden.empty());
        EXPECT_EQ(t.verdict, "nothing");
        break;
      case Kind::complete:
        EXPECT_TRUE(t.hidden.empty());
        EXPECT_GE(t.model.size(), 1U);
        EXPECT_EQ(t.verdict, "nothing");
        break;
      case Kind::outside:
        EXPECT_TRUE(t.hidden.empty());
        EXPECT_LE(t.model.size(), 2U);
        EXPECT_TRUE(t.verdict == "unknown" || t.verdict == "unrepeatable") << t.verdict;
        EXPECT_EQ(t.places.empty(), h.scenario.hidden[0].source == Source::contradiction);
        break;
    }
    EXPECT_EQ(h.campaign.model, t.model);
  });
}

INSTANTIATE_TEST_SUITE_P(Kinds, HiddenCampaigns, testing::ValuesIn(kinds));

Scenario bare(Source source, bool rotary) {
  Scenario s;
  s.seed = 17;
  s.rotary = rotary;
  s.length = rotary ? 2.0 * std::numbers::pi : 1.0;
  s.feed = s.length / 20.0;
  s.hidden = {{source, 5.0}};
  return s;
}

TEST(HiddenTruth, values_follow_from_the_mechanism) {
  // Lost motion: the reversal is twice the size of either side, and negative for what trails.
  const Hidden nut = generate(bare(Source::preload_loss, false));
  ASSERT_EQ(nut.truth.values.size(), 1U);
  EXPECT_EQ(nut.truth.values[0].effect, "backlash:X");
  EXPECT_NEAR(std::fabs(nut.truth.values[0].value), 2.0 * 5.0 * nut.scenario.noise, 1e-9);
  // Eccentric scale: to first order e/R, whatever its direction; its RMS is e/R/sqrt(2).
  const Hidden disc = generate(bare(Source::eccentric_scale, true));
  ASSERT_EQ(disc.truth.values.size(), 2U);
  EXPECT_NEAR(std::hypot(disc.truth.values[0].value, disc.truth.values[1].value),
              5.0 * disc.scenario.noise * std::numbers::sqrt2, 0.1 * disc.scenario.noise);
}

TEST(HiddenTruth, a_dent_sits_at_its_target) {
  const Hidden h = generate(bare(Source::dent, false));
  ASSERT_TRUE(h.truth.at);
  std::size_t largest = 0;
  for (std::size_t i = 0; i < h.table.size(); ++i)
    if (std::fabs(h.causes[0][i]) > std::fabs(h.causes[0][largest])) largest = i;
  EXPECT_DOUBLE_EQ(h.table.axes[0].position[largest], *h.truth.at);
}

TEST(HiddenPhysics, heat_balance_of_the_screw) {
  // Without loss every kelvin-metre put in is still there: growth = heating * t * p, near enough.
  Cycle c;
  for (int i = 0; i <= 10; ++i) {
    c.p.push_back(0.05 * i - 0.25);
    c.position.push_back(c.p.back());
    c.t.push_back(100.0);
  }
  c.length = 0.5;
  const auto growth = heated_screw(c, 0.0, 1e9, Random(1));
  for (std::size_t i = 0; i < c.size(); ++i)
    EXPECT_NEAR(growth[i], 100.0 * c.p[i], 100.0 * 0.25 * 0.02);
}

TEST(HiddenPhysics, refractivity_of_air) {
  // Sensitivities at 20 degC, 1013.25 hPa, 50 % humidity; Birch and Downs give -0.93e-6/K,
  // 0.27e-6/hPa, -0.0086e-6 for 1 % of humidity (23.4 Pa).
  const double n = air_refractivity(20.0, 101325.0, 1170.0);
  EXPECT_NEAR(n, 271.4e-6, 0.3e-6);
  EXPECT_NEAR(air_refractivity(21.0, 101325.0, 1170.0) - n, -0.93e-6, 0.01e-6);
  EXPECT_NEAR(air_refractivity(20.0, 101425.0, 1170.0) - n, 0.268e-6, 0.002e-6);
  EXPECT_NEAR(air_refractivity(20.0, 101325.0, 1193.4) - n, -0.0086e-6, 0.0002e-6);
}

TEST(HiddenRandom, moments_and_independent_streams) {
  Random random(3);
  double mean = 0.0, square = 0.0, fourth = 0.0;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    mean += x / n, square += x * x / n, fourth += x * x * x * x / n;
  }
  EXPECT_NEAR(mean, 0.0, 0.01);
  EXPECT_NEAR(square, 1.0, 0.02);
  EXPECT_NEAR(fourth, 3.0, 0.15);
  EXPECT_NE(Random(3, 1).uniform(), Random(3, 2).uniform());
  EXPECT_NE(Random(3, 1).uniform(), Random(4, 0).uniform());
}

TEST(HiddenFiles, written_whole_and_the_same_again) {
  const std::filesystem::path folder = testing::TempDir() + "nonio-hidden-campaign";
  const std::filesystem::path truth = testing::TempDir() + "nonio-hidden-truth.json";
  const Hidden h = generate(random_scenario(Kind::several, 2));
  ASSERT_TRUE(write(h, folder, truth));
  const std::string manifest = read(folder / "campaign.toml"), rows = read(folder / "readings.csv"),
                    said = read(truth);
  EXPECT_NE(manifest.find("[[measurement]]"), std::string::npos);
  EXPECT_EQ(static_cast<std::size_t>(std::count(rows.begin(), rows.end(), '\n')),
            h.table.size() + 1);
  for (const std::string& effect : h.truth.hidden) {
    EXPECT_NE(said.find(effect), std::string::npos);
    EXPECT_EQ(manifest.find(effect), std::string::npos);  // the campaign does not give it away
  }
  ASSERT_TRUE(write(generate(random_scenario(Kind::several, 2)), folder, truth));
  EXPECT_EQ(rows, read(folder / "readings.csv"));
  std::filesystem::remove_all(folder);
  std::filesystem::remove(truth);
}

}  // namespace
