// SPDX-License-Identifier: Apache-2.0
//
// Random axes of which one pass, or one direction, was written with the other sign or from its other end,
// and axes that look alike and have no mistake.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "campaign/reading/plausibility/plausibility_strokes.h"

namespace nonio::reading::turned_test {
namespace {

constexpr double um = 1e-6, pi = std::numbers::pi;
constexpr std::uint32_t seed = 20261128;

enum class Elastic { none, one_end, both_ends, turn };
enum class Mistake { none, pass_sign, direction_sign, direction_order };

struct Made {
  bool rotary = false;
  bool pitch = true;
  int runs = 3;
  double scatter = 0.5 * um;
  Elastic elastic = Elastic::none;
  Mistake mistake = Mistake::none;
};

class Axes {
 public:
  explicit Axes(std::uint32_t with) : random_(with) { std::cout << "seed " << with << '\n'; }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double normal() { return std::normal_distribution<double>()(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  Made random(bool rotary, Mistake mistake) {
    Made made{.rotary = rotary, .mistake = mistake};
    constexpr int runs[] = {2, 3, 5};
    made.runs = runs[whole(0, 2)];
    made.scatter = uniform(0.3, 1.0) * um;
    made.elastic =
        rotary ? (whole(0, 1) ? Elastic::turn : Elastic::none) : static_cast<Elastic>(whole(0, 2));
    return made;
  }

  /// 9 to 13 targets; a pitch curve with a slope and waves of up to four periods.
  Observations measure(const Made& made) {
    const int m = whole(9, 13);
    const double slope = made.rotary ? 0.0 : 8.0 * um * normal(), lost = uniform(-6.0, 0.0) * um;
    const double half = uniform(1.0, 5.0) * um, from = uniform(0.0, 2.0 * pi);
    double amplitude[4], phase[4];
    for (int k = 0; k < 4; ++k)
      amplitude[k] = uniform(2.0, 8.0) * um / std::sqrt(k + 1.0), phase[k] = uniform(0.0, 2.0 * pi);
    const auto curve = [&](double p, int d) {
      double e = made.pitch ? slope * p : 0.0;
      for (int k = 0; k < 4 && made.pitch; ++k)
        e += amplitude[k] * std::sin(2.0 * pi * (k + 1) * p + phase[k]);
      const double wound = made.elastic == Elastic::none      ? 0.0
                           : made.elastic == Elastic::one_end ? half * p
                           : made.elastic == Elastic::both_ends
                               ? half * 4.0 * p * (1.0 - p)
                               : half * std::sin(2.0 * pi * p + from);
      return e + d * (lost / 2.0 - wound);
    };
    const int wrong_run = whole(1, made.runs), wrong = whole(0, 1) ? 1 : -1;
    Observations o;
    o.angular = made.rotary;
    o.axes.push_back({made.rotary ? "C" : "X", made.rotary, {}, {}});
    for (int run = 1; run <= made.runs; ++run)
      for (const int d : {1, -1}) {
        const double offset = 0.2 * um * normal();
        std::vector<double> share, value;
        for (int k = 0; k < m; ++k) {
          share.push_back(made.rotary ? k / static_cast<double>(m) : k / (m - 1.0));
          value.push_back(curve(share.back(), d) + offset + made.scatter * normal());
        }
        const bool own = d == wrong, one = own && run == wrong_run;
        if ((made.mistake == Mistake::pass_sign && one) ||
            (made.mistake == Mistake::direction_sign && own))
          for (double& v : value) v = -v;
        if (made.mistake == Mistake::direction_order && own)
          std::reverse(value.begin(), value.end());
        for (int j = 0; j < m; ++j) {
          const auto k = static_cast<std::size_t>(d > 0 ? j : m - 1 - j);
          o.axes[0].position.push_back(share[k] * (made.rotary ? 2.0 * pi : 0.8));
          o.axes[0].approach.push_back(static_cast<std::int8_t>(d));
          o.run.push_back(static_cast<std::uint32_t>(run));
          o.deviation.push_back(std::round(value[k] / (0.001 * um)) * 0.001 * um);
        }
      }
    return o;
  }

 private:
  std::mt19937 random_;
};

/// The finding that withholds tables, or "".
std::string accused(const Observations& o) {
  std::vector<Finding> found;
  implausible_passes(passes_of(o), o, true, found);
  for (const Finding& f : found)
    if (f.attention) return f.id;
  return "";
}

constexpr int campaigns = 400;

TEST(TurnedPasses, EachMistakeIsFoundInNineteenOfTwenty) {
  Axes axes(seed);
  const std::pair<const char*, Mistake> all[] = {{"one pass, sign", Mistake::pass_sign},
                                                 {"direction, sign", Mistake::direction_sign},
                                                 {"direction, order", Mistake::direction_order}};
  for (const bool rotary : {false, true})
    for (const auto& [name, mistake] : all) {
      std::map<std::string, int> found;
      for (int n = 0; n < campaigns; ++n)
        ++found[accused(axes.measure(axes.random(rotary, mistake)))];
      std::cout << (rotary ? "rotary " : "linear ") << name << ":";
      for (const auto& [id, count] : found)
        std::cout << " " << (id.empty() ? "nothing" : id) << " " << count;
      std::cout << " of " << campaigns << '\n';
      EXPECT_LE(found[""], campaigns / 20) << name;
    }
}

TEST(TurnedPasses, RightFilesAreNotAccused) {
  Axes axes(seed + 1);
  for (const bool rotary : {false, true})
    for (const bool pitch : {true, false})
      for (const Elastic elastic :
           {Elastic::none, Elastic::one_end, Elastic::both_ends, Elastic::turn}) {
        if (rotary && (elastic == Elastic::one_end || elastic == Elastic::both_ends)) continue;
        std::map<std::string, int> found;
        for (int n = 0; n < campaigns; ++n) {
          Made made = axes.random(rotary, Mistake::none);
          made.pitch = pitch, made.elastic = elastic;
          ++found[accused(axes.measure(made))];
        }
        std::cout << (rotary ? "rotary" : "linear") << (pitch ? "" : ", no pitch error")
                  << ", elastic " << static_cast<int>(elastic) << ":";
        for (const auto& [id, count] : found)
          std::cout << " " << (id.empty() ? "nothing" : id) << " " << count;
        std::cout << '\n';
        EXPECT_GE(found[""], campaigns - campaigns / 200);
      }
}

}  // namespace
}  // namespace nonio::reading::turned_test
