// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pages.h"

/// Values of several rules of one measurement, named "rule:symbol".
namespace nonio::pages {

/// Returns the note that names the rules and their titles; null if the values belong to one method.
const Remark* rules_of(const Results::Analysed&);

/// Adds a table with one column per rule and one row per symbol; rules with equal values share a
/// column.
void add_rule_tables(const Source&, const Results::Analysed&, Blocks&);
/// Adds the decisions, a description of each rule, and the reasons why their values differ.
void add_rule_notes(const Source&, const Results::Analysed&, Blocks&);

}  // namespace nonio::pages
