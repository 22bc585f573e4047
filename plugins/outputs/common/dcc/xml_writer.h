// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::dcc {

/// XML written from front to back, elements indented by one. Text is escaped; characters that XML
/// does not know are left out.
class XmlWriter {
 public:
  XmlWriter() : out_("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") {}

  void open(std::string_view name, std::string_view attributes = {}) {
    indent();
    out_ += '<';
    out_ += name;
    if (!attributes.empty()) (out_ += ' ') += attributes;
    out_ += ">\n";
    open_.emplace_back(name);
  }
  void close() {
    const std::string name = std::move(open_.back());
    open_.pop_back();
    indent();
    out_ += "</" + name + ">\n";
  }
  void element(std::string_view name, std::string_view text, std::string_view attributes = {}) {
    indent();
    out_ += '<';
    out_ += name;
    if (!attributes.empty()) (out_ += ' ') += attributes;
    out_ += '>';
    escape(text);
    out_ += "</";
    out_ += name;
    out_ += ">\n";
  }
  std::string take() { return std::move(out_); }

 private:
  void indent() { out_.append(open_.size(), ' '); }
  void escape(std::string_view text) {
    for (const char c : text) {
      if (c == '&')
        out_ += "&amp;";
      else if (c == '<')
        out_ += "&lt;";
      else if (c == '>')
        out_ += "&gt;";
      else if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n')
        out_ += c;
    }
  }

  std::string out_;
  std::vector<std::string> open_;
};

}  // namespace nonio::dcc
