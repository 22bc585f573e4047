// SPDX-License-Identifier: Apache-2.0
#include "fit/weights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nonio::model {

namespace {

std::vector<double> weights_of(const std::vector<std::optional<double>>& frequencies) {
  std::vector<Term> terms;
  for (const auto& frequency : frequencies) {
    Term& term = terms.emplace_back(Term{nullptr, {}});
    term.frequency = frequency;
    term.weight = 3.0;
  }
  set_weights(terms, 0.0);
  std::vector<double> out;
  for (const Term& term : terms) out.push_back(term.weight);
  return out;
}

}  // namespace

TEST(Weights, AreHalfEqualAndHalfByFrequency) {
  const auto weights = weights_of({0.3, 0.1, 0.1, 0.1});
  EXPECT_NEAR(weights[0], 0.5 + 0.5 * 2.0, 1e-12);
  EXPECT_NEAR(weights[1], 0.5 + 0.5 / 1.5, 1e-12);
}

TEST(Weights, AreOneWithoutCounts) {
  EXPECT_EQ(weights_of({std::nullopt, std::nullopt}), std::vector<double>(2, 1.0));
  const auto weights = weights_of({0.4, std::nullopt, 0.2});
  EXPECT_EQ(weights[1], 1.0);
  EXPECT_NEAR(weights[0] + weights[2], 2.0, 1e-12);
}

TEST(Weights, HaveAMeanOfAtMostOne) {
  for (const std::size_t others : {1, 5, 40, 200}) {
    std::vector<std::optional<double>> frequencies(others, 0.01);
    frequencies.emplace_back(0.9);
    double sum = 0.0;
    for (const double w : weights_of(frequencies)) {
      EXPECT_GE(w, 0.5);
      EXPECT_LE(w, 8.0);
      sum += w;
    }
    EXPECT_LE(sum, static_cast<double>(others + 1) * (1.0 + 1e-12)) << others;
  }
}

/// Weights of an effect with a usual size, in u of a size, and of one as frequent without.
std::pair<double, double> sized(double median, double deviation) {
  constexpr double u = 1e-7;
  std::vector<Term> terms(12, Term{nullptr, {}});
  for (Term& term : terms) term.frequency = 0.1;
  terms[0].usual_size = {u * median, u * deviation};
  set_weights(terms, u);
  double sum = 0.0;
  for (const Term& term : terms) sum += term.weight;
  EXPECT_NEAR(sum, 12.0, 1e-9);
  return {terms[0].weight, terms[1].weight};
}

TEST(Weights, AreLargerNearTheLimitOfDetectionThanFarFromIt) {
  for (const double near : {3.0, 4.0}) {
    const auto [own, other] = sized(near, 0.5);
    EXPECT_GT(own, 1.3 * other) << near;
  }
  for (const double far : {0.5, 30.0}) {
    const auto [own, other] = sized(far, 0.0);
    EXPECT_LT(own, other) << far;
    EXPECT_GE(own, 0.7 * other) << far;
  }
}

TEST(Weights, AddTheirEvidence) {
  EXPECT_EQ(evidence_of_weight(1.0), 0.0);
  EXPECT_NEAR(evidence_of_weight(0.5), -2.0 * std::log(2.0), 1e-12);
}

}  // namespace nonio::model
