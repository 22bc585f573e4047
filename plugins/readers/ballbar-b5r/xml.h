// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::ballbar {

struct Element {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;          ///< directly in it, trimmed
  std::uint64_t number = 0;  ///< in the order in which elements begin, from 1
  std::uint64_t line = 0;

  /// Empty if there is none.
  std::string attribute(std::string_view key) const;
};

/// Gets an element, and those it stands in, outermost first (their texts are not whole yet).
using TakeElement = std::function<void(const Element&, const std::vector<Element>& within)>;

/// Every element of a well-formed document, innermost first. UTF-8; no document type (so no
/// entities but the five of XML), as nothing of a measurement needs one.
Expected<void> for_each_element(std::string_view bytes, const TakeElement& take);

}  // namespace nonio::ballbar
