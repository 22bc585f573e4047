// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

/// Adjusted p of the tests of one run, in the order of `p`. A test is significant if its adjusted p
/// is below the level.
namespace nonio::statistics {

/// Returns the adjusted p according to Benjamini and Hochberg (1995), which limit the mean fraction
/// of false positives among the significant tests, if the tests are independent or positively
/// correlated.
std::vector<double> benjamini_hochberg(const std::vector<double>& p);
/// Returns the adjusted p according to Holm (1979), which limit the probability that any of the
/// tests is significant by chance.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace nonio::statistics
