// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

/// Adjusted p of the tests of one run, in the order of `p`. A test is significant if its adjusted p
/// is below the level.
namespace nonio::statistics {

/// Benjamini and Hochberg (1995): controls the expected fraction of false positives among the
/// significant tests, if these are independent or positively correlated.
std::vector<double> benjamini_hochberg(const std::vector<double>& p);
/// Holm (1979): controls the probability that any test is significant by chance.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace nonio::statistics
