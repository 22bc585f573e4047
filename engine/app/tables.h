// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "campaign/modelling/model_json.h"

/// What compare, explain and model show in the terminal.
namespace nonio::app {

/// "0.71 um"
std::string with_unit(double value, Quantity quantity);
/// With the decimal sign of the language of the words.
std::string with_unit(double value, Quantity quantity, const config::TerminalWords&);
/// A name and its value; a sentence, wrapped to the terminal.
void line(std::ostream& out, const std::string& name, const std::string& value);
void sentence(std::ostream& out, std::size_t indent, const std::string& text);

void print_comparison(std::ostream& out, const modelling::Compared& compared,
                      const Campaign& campaign, const modelling::ModelWords& words);
/// `folder`: of the campaign, for the command that goes on. `all`: every candidate, and why an effect
/// could not be tested.
void print_explanation(std::ostream& out, const modelling::Explained& explained,
                       const Campaign& campaign, const std::string& folder, bool all,
                       const modelling::ModelWords& words);
/// Before and after with bars that fall; "|" is the noise floor.
void print_change(std::ostream& out, const modelling::Change& change,
                  const modelling::ModelWords& words);
/// The effects with their values, and what they leave.
void print_model(std::ostream& out, const modelling::Compared& compared,
                 const modelling::ModelWords& words);
/// What one more run would do to the uncertainties of the model and to the evidence.
void print_foresight(std::ostream& out, const modelling::Explained& e,
                     const config::TerminalWords& say);
/// Readings that were excluded, or a period that was set, in one line.
void print_step(std::ostream& out, const modelling::ModelStep& step,
                const config::TerminalWords& say);
void print_history(std::ostream& out, const std::vector<modelling::ModelStep>& history,
                   const config::TerminalWords& say);

}  // namespace nonio::app
