// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "nonio/host/model_json.h"

/// What compare, explain and model show in the terminal.
namespace nonio::app {

/// "0.71 um"
std::string with_unit(double value, Quantity quantity);

void print_comparison(std::ostream& out, const host::Compared& compared, const Campaign& campaign,
                      const host::ModelWords& words);
void print_explanation(std::ostream& out, const host::Explained& explained,
                       const Campaign& campaign, const host::ModelWords& words);
/// Before and after with bars that fall; "|" is the noise floor.
void print_change(std::ostream& out, const host::Change& change, const host::ModelWords& words);
/// The effects with their values, and what they leave.
void print_model(std::ostream& out, const host::Compared& compared, const host::ModelWords& words);
void print_history(std::ostream& out, const std::vector<host::ModelStep>& history,
                   const host::TerminalWords& say);

}  // namespace nonio::app
