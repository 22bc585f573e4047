// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

/// One node of an XML document, in the order of the document. Names without their prefix.
struct Node {
  enum class Kind { begins, ends, text };
  Kind kind = Kind::text;
  std::string_view name;  ///< of an element
  std::string_view text;
  /// The value of an attribute; empty if there is none. Only while the element begins.
  std::function<std::string(const char*)> attribute;
};

/// Calls `take` for each node until it returns an error. Entities are not resolved and nothing else is
/// opened; a document type is an error.
/// `enough`: asked now and then whether the rest is not needed.
Expected<void> read_xml(
    std::string_view xml, const std::function<Expected<void>(const Node&)>& take,
    const std::function<bool()>& enough = [] { return false; });

}  // namespace nonio::spreadsheet
