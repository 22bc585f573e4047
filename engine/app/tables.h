// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "campaign/config/terminal_words.h"
#include "nonio/sdk/units.h"

/// Terminal output of compare, explain and model.
namespace nonio::app {

/// Returns a value with its unit, for example "0.71 um".
std::string with_unit(double value, Quantity quantity);
/// Returns a value with its unit and with the decimal sign of the language.
std::string with_unit(double value, Quantity quantity, const config::TerminalWords&);
/// Returns a value of a JSON object in the same way; "-" if the object lacks it.
std::string with_unit(const nlohmann::ordered_json& json, const std::string& name,
                      const config::TerminalWords&);
/// Prints a name and its value, or a sentence, wrapped to the width of the terminal.
void line(std::ostream& out, const std::string& name, const std::string& value);
void sentence(std::ostream& out, std::size_t indent, const std::string& text);

/// Print a part of a document that modelling/model_json.h or joint_model.h makes with the same
/// words: of nonio-compare/1 in full and without residuals, of nonio-explain/1, and of the latter
/// for several campaigns. `folder` is that of the campaign, for the command to continue with. If
/// `all`, every candidate is printed, and why effects could not be tested.
void print_comparison(std::ostream& out, const nlohmann::ordered_json& part,
                      const config::TerminalWords& say);
void print_model(std::ostream& out, const nlohmann::ordered_json& part,
                 const config::TerminalWords& say);
void print_explanation(std::ostream& out, const nlohmann::ordered_json& part,
                       const std::string& folder, bool all, const config::TerminalWords& say);
void print_together(std::ostream& out, const nlohmann::ordered_json& part,
                    const config::TerminalWords& say);
/// Prints nonio-model/1: values before and after a change as numbers and as bars; then, if the
/// changed model was fitted, its parameters.
void print_change(std::ostream& out, const nlohmann::ordered_json& change,
                  const config::TerminalWords& say);
/// Prints excluded readings or a changed period, which are steps of the model's history, in one
/// line; for other steps, an empty line.
void print_step(std::ostream& out, const nlohmann::ordered_json& step,
                const config::TerminalWords& say);
void print_history(std::ostream& out, const nlohmann::ordered_json& history,
                   const config::TerminalWords& say);

}  // namespace nonio::app
