// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pages.h"

/// Values of several rules of one measurement, named "rule:symbol".
namespace nonio::pages {

/// The note that names the rules and their titles; null if the values are of one method.
const Remark* rules_of(const Results::Analysed&);

/// Its notes in sentences; formulas: how sure they are, or everything else.
enum class RuleNotes { sureness, others };
std::vector<std::string> rule_notes(const Source&, const Results::Analysed&, RuleNotes);

/// A column for each rule, a row for each symbol; rules that give the same values share a column.
/// Then what each rule does, and why they differ.
void add_rules(const Source&, const Results::Analysed&, Blocks&);

}  // namespace nonio::pages
