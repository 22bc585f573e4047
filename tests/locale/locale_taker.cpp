// SPDX-License-Identifier: Apache-2.0
// Takes the locale of the environment for the whole process, and writes 1.5 as this locale does.
#include <clocale>
#include <cstdio>
#include <locale>
#include <stdexcept>

#include "nonio/sdk/plugin.h"

namespace {

using namespace nonio;

Expected<OutputResult> write(const OutputInput&) {
  char number[16];
  std::snprintf(number, sizeof number, "%.1f\n", 1.5);
  OutputResult result;
  result.artifacts.push_back({"decimal-point.txt", number});
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  std::setlocale(LC_ALL, "");
  try {
    std::locale::global(std::locale(""));
  } catch (const std::runtime_error&) {  // no such locale: the file below will say so
  }
  registry.add(Output{{"decimal-point", "1", "Writes 1.5 with printf", {}},
                      Output::Stage::document,
                      [](const Campaign&) { return true; },
                      write,
                      nullptr});
}
