// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

/// Many tests of one run: adjusted p, in the order of `p`. A test whose adjusted p is below the
/// level is news.
namespace nonio::statistics {

/// Benjamini and Hochberg 1995: of the news at most this share is false in the mean; tests that are
/// independent or positively correlated.
std::vector<double> benjamini_hochberg(const std::vector<double>& p);
/// Holm 1979: at most this chance of any false news.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace nonio::statistics
