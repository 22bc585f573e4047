// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pages.h"

namespace nonio::pages {

/// The note with names and titles of the rules; null if the values belong to one method.
const Remark* rules_of(const Results::Analysed&);

/// One column per rule and one row per symbol; rules with equal values have a common column.
void add_rule_tables(const Source&, const Results::Analysed&, Blocks&);
/// Adds the decisions, a description of each rule, and the reasons why their values differ.
void add_rule_notes(const Source&, const Results::Analysed&, Blocks&);

}  // namespace nonio::pages
