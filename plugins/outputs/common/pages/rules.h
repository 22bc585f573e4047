// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pages.h"

/// Values of several rules of one measurement, named "rule:symbol".
namespace nonio::pages {

/// The note that names the rules and their titles; null if the values are of one method.
const Remark* rules_of(const Results::Analysed&);

/// A column for each rule, a row for each symbol; rules that give the same values share a column.
void add_rule_tables(const Source&, const Results::Analysed&, Blocks&);
/// Decisions, what each rule does, and why they differ.
void add_rule_notes(const Source&, const Results::Analysed&, Blocks&);

}  // namespace nonio::pages
