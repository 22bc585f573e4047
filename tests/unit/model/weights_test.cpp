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
  set_weights(terms);
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

TEST(Weights, AddTheirEvidence) {
  EXPECT_EQ(evidence_of_weight(1.0), 0.0);
  EXPECT_NEAR(evidence_of_weight(0.5), -2.0 * std::log(2.0), 1e-12);
}

}  // namespace nonio::model
