// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

/// A node of an XML document; names without namespace prefix.
struct Node {
  enum class Kind { begins, ends, text };
  Kind kind = Kind::text;
  std::string_view name;
  std::string_view text;
  /// Empty if the attribute is missing; only valid at the start of an element.
  std::function<std::string(const char*)> attribute;
};

/// Calls `take` for each node in document order until an error, or until `enough` returns true.
/// Entities and external files are not resolved; a document type is an error.
Expected<void> read_xml(
    std::string_view xml, const std::function<Expected<void>(const Node&)>& take,
    const std::function<bool()>& enough = [] { return false; });

}  // namespace nonio::spreadsheet
