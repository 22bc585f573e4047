// SPDX-License-Identifier: Apache-2.0
#include "colour.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace nonio::app {

namespace {

bool shows_colours(int descriptor) {
  const char* const no = std::getenv("NO_COLOR");
  if (no != nullptr && *no != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view(terminal) != "dumb" && ::isatty(descriptor) == 1;
}

const char* code_of(Colour colour) {
  switch (colour) {
    case Colour::red:
      return "31";
    case Colour::yellow:
      return "33";
    case Colour::green:
      return "32";
    case Colour::bold:
      break;
  }
  return "1";
}

}  // namespace

std::string coloured(const std::string& text, Colour colour, int descriptor) {
  if (!shows_colours(descriptor)) return text;
  return std::string("\033[") + code_of(colour) + "m" + text + "\033[0m";
}

Colour status_colour(const std::string& status) {
  if (status == "failed" || status == "does not conform") return Colour::red;
  return status == "ok" || status == "conforms" ? Colour::green : Colour::yellow;
}

std::string status_word(const std::string& status, int descriptor) {
  std::string word = status;
  word.resize(std::max<std::size_t>(word.size(), 9), ' ');
  return coloured(word, status_colour(status), descriptor);
}

}  // namespace nonio::app
