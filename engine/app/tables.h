// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "campaign/config/terminal_words.h"
#include "nonio/sdk/units.h"

namespace nonio::app {

/// Example: "0.71 um".
std::string with_unit(double value, Quantity quantity);
/// Uses the decimal sign of the language.
std::string with_unit(double value, Quantity quantity, const config::TerminalWords&);
/// Returns "-" if `json` lacks the value.
std::string with_unit(const nlohmann::ordered_json& json, const std::string& name,
                      const config::TerminalWords&);
/// Prints a name with its value, or a sentence, wrapped to the width of the terminal.
void line(std::ostream& out, const std::string& name, const std::string& value);
void sentence(std::ostream& out, std::size_t indent, const std::string& text);

/// Print one part of the documents nonio-compare/1 (in full and without residuals) and
/// nonio-explain/1 (of one campaign and of several). `folder` is inserted in the suggested command.
/// `all` includes every candidate and the reasons why effects could not be tested.
void print_comparison(std::ostream& out, const nlohmann::ordered_json& part,
                      const config::TerminalWords& say);
void print_model(std::ostream& out, const nlohmann::ordered_json& part,
                 const config::TerminalWords& say);
void print_explanation(std::ostream& out, const nlohmann::ordered_json& part,
                       const std::string& folder, bool all, const config::TerminalWords& say);
void print_together(std::ostream& out, const nlohmann::ordered_json& document,
                    const config::TerminalWords& say);
/// Prints a change of the model (nonio-model/1): RMS values before and after as numbers and bars,
/// and the parameters of the changed model.
void print_change(std::ostream& out, const nlohmann::ordered_json& change,
                  const config::TerminalWords& say);
/// Prints a step that excludes readings or changes a period as one line; an empty line for other
/// steps.
void print_step(std::ostream& out, const nlohmann::ordered_json& step,
                const config::TerminalWords& say);
void print_history(std::ostream& out, const nlohmann::ordered_json& history,
                   const config::TerminalWords& say);

}  // namespace nonio::app
