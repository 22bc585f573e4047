// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/terminal_words.h"

#include "nonio/sdk/format.h"

namespace nonio::config {

std::string TerminalWords::text_of(const std::string& name) const {
  std::string text = words(templates_, language_, "terminal." + name);
  return text.empty() ? words(templates_, "en", "terminal." + name) : text;
}

std::string TerminalWords::operator()(std::string_view name, const Parts& parts) const {
  const std::string text = text_of(std::string(name));
  if (text.empty()) return std::string(name);
  Finding places;
  places.texts = parts;
  return filled(text, places, language_);
}

std::string TerminalWords::counted(std::string_view name, std::size_t count, Parts parts) const {
  parts.emplace_back("count", std::to_string(count));
  return (*this)(std::string(name) + (count == 1 ? ".one" : ".many"), parts);
}

std::string TerminalWords::number(std::string text) const {
  return localised(std::move(text), language_);
}

std::string TerminalWords::of(std::string_view list, const std::string& text) const {
  const std::string found = text_of(std::string(list) + "." + text);
  return found.empty() ? text : found;
}

}  // namespace nonio::config
