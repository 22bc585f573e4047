// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/text.h"

namespace nonio::dcc {

/// Writes XML sequentially, indented by one blank per level. Text is escaped, and characters that
/// XML does not allow are omitted.
class XmlWriter {
 public:
  XmlWriter() : out_("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") {}

  /// Attributes with an empty value are omitted.
  using Attributes = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  void open(std::string_view name, Attributes attributes = {}) {
    indent();
    begin(name, attributes);
    out_ += '\n';
    open_.emplace_back(name);
  }
  void close() {
    const std::string name = std::move(open_.back());
    open_.pop_back();
    indent();
    out_ += "</" + name + ">\n";
  }
  void element(std::string_view name, std::string_view text, Attributes attributes = {}) {
    indent();
    begin(name, attributes);
    out_ += escaped_markup(text) + "</";
    out_ += name;
    out_ += ">\n";
  }
  std::string take() { return std::move(out_); }

 private:
  void indent() { out_.append(open_.size(), ' '); }
  void begin(std::string_view name, Attributes attributes) {
    (out_ += '<') += name;
    for (const auto& [key, value] : attributes)
      if (!value.empty())
        ((out_ += ' ') += key) += "=\"" + escaped_markup(value, Markup::attribute) + '"';
    out_ += '>';
  }

  std::string out_;
  std::vector<std::string> open_;
};

}  // namespace nonio::dcc
