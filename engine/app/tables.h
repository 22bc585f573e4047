// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "campaign/modelling/model_json.h"

/// Terminal output of compare, explain and model.
namespace nonio::app {

/// Returns a value with its unit, for example "0.71 um".
std::string with_unit(double value, Quantity quantity);
/// Returns a value with its unit and with the decimal sign of the language.
std::string with_unit(double value, Quantity quantity, const config::TerminalWords&);
/// Prints a name and its value, or a sentence, wrapped to the width of the terminal.
void line(std::ostream& out, const std::string& name, const std::string& value);
void sentence(std::ostream& out, std::size_t indent, const std::string& text);

void print_comparison(std::ostream& out, const modelling::Compared& compared,
                      const Campaign& campaign, const modelling::ModelWords& words);
/// Prints an explanation. `folder` is that of the campaign, for the command to continue with. If
/// `all`, every candidate is printed, and why effects could not be tested.
void print_explanation(std::ostream& out, const modelling::Explained& explained,
                       const Campaign& campaign, const std::string& folder, bool all,
                       const modelling::ModelWords& words);
/// Prints values before and after a change as numbers and as bars, in which "|" marks the noise
/// floor; then, if the changed model was fitted, its parameters.
void print_change(std::ostream& out, const modelling::Change& change,
                  const modelling::ModelWords& words);
/// Prints the effects with their values, and the residuals.
void print_model(std::ostream& out, const modelling::Compared& compared,
                 const modelling::ModelWords& words);
/// Prints how one more run, or other further readings, would change the uncertainties of the model
/// and the evidence.
void print_foresight(std::ostream& out, const modelling::Explained& e,
                     const config::TerminalWords& say);
/// Prints excluded readings or a changed period, which are steps of the model's history, in one
/// line; for other steps, an empty line.
void print_step(std::ostream& out, const modelling::ModelStep& step,
                const config::TerminalWords& say);
void print_history(std::ostream& out, const std::vector<modelling::ModelStep>& history,
                   const config::TerminalWords& say);

}  // namespace nonio::app
