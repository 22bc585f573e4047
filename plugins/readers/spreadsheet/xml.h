// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

/// One node of an XML document, in document order; names without namespace prefix.
struct Node {
  enum class Kind { begins, ends, text };
  Kind kind = Kind::text;
  std::string_view name;  ///< name of an element
  std::string_view text;
  /// Value of an attribute, empty if missing; only valid at the start of an element.
  std::function<std::string(const char*)> attribute;
};

/// Calls `take` for each node until an error. Entities and external files are not resolved; a
/// document type is an error. `enough`: polled; true skips the rest.
Expected<void> read_xml(
    std::string_view xml, const std::function<Expected<void>(const Node&)>& take,
    const std::function<bool()>& enough = [] { return false; });

}  // namespace nonio::spreadsheet
