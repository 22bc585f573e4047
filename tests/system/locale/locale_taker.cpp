// SPDX-License-Identifier: Apache-2.0
// Takes the locale of the environment for the whole process, before its main begins.
#include <clocale>
#include <locale>
#include <stdexcept>

namespace {

[[gnu::constructor]] void take() {
  std::setlocale(LC_ALL, "");
  try {
    std::locale::global(std::locale(""));
  } catch (const std::runtime_error&) {  // no such locale: what decimal_point writes will say so
  }
}

}  // namespace
