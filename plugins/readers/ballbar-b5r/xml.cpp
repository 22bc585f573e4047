// SPDX-License-Identifier: Apache-2.0
#include "xml.h"

#include <algorithm>
#include <charconv>

#include "nonio/sdk/fields.h"
#include "nonio/sdk/text.h"
#include "runs.h"

namespace nonio::ballbar {
using namespace reading;

namespace {

constexpr std::size_t deepest = 200;
constexpr std::string_view white = " \t\r\n";

std::string_view stripped(std::string_view text) {
  const std::size_t first = text.find_first_not_of(white);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(white) - first + 1);
}

bool name_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.' || c == ':' || byte >= 0x80;
}

class Scanner {
 public:
  Scanner(std::string_view bytes, const TakeElement& take) : bytes_(bytes), take_(take) {
    at_ = bytes_.size() - without_mark(bytes_).size();
  }

  Expected<void> scan() {
    while (at_ < bytes_.size()) {
      const std::size_t open = std::min(bytes_.find('<', at_), bytes_.size());
      if (auto ok = text(bytes_.substr(at_, open - at_)); !ok) return ok;
      at_ = open;
      if (at_ == bytes_.size()) break;
      if (auto ok = markup(); !ok) return ok;
    }
    if (!open_.empty()) return wrong("</" + open_.back().name + "> is missing; was the file cut?");
    if (!root_) return wrong("expected an XML document, found none");
    return {};
  }

 private:
  tl::unexpected<Error> wrong(const std::string& what) const {
    const auto line =
        1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    return fail(at_line(static_cast<std::uint64_t>(line), what));
  }
  bool next_is(std::string_view what) const { return bytes_.substr(at_).starts_with(what); }

  /// Goes behind `end`; an error if it does not come.
  Expected<std::string_view> until(std::string_view end) {
    const std::size_t found = bytes_.find(end, at_);
    if (found == bytes_.npos)
      return wrong("expected " + shown(end) + ", found the end of the file");
    const std::string_view between = bytes_.substr(at_, found - at_);
    at_ = found + end.size();
    return between;
  }

  Expected<void> markup() {
    if (next_is("<!--")) return skip("-->");
    if (next_is("<?")) return skip("?>");
    if (next_is("<![CDATA[")) {
      at_ += 9;
      const auto inside = until("]]>");
      if (!inside) return fail(inside.error());
      if (open_.empty()) return wrong("expected text only inside elements");
      open_.back().text += *inside;
      return {};
    }
    if (next_is("<!")) return wrong("expected no document type in a measurement's file");
    return next_is("</") ? close() : open();
  }
  Expected<void> skip(std::string_view end) {
    const auto between = until(end);
    return between ? Expected<void>{} : fail(between.error());
  }

  std::string name() {
    const std::size_t from = at_;
    while (at_ < bytes_.size() && name_character(bytes_[at_])) ++at_;
    return std::string(bytes_.substr(from, at_ - from));
  }
  void blanks() {
    while (at_ < bytes_.size() && white.find(bytes_[at_]) != white.npos) ++at_;
  }

  Expected<void> open() {
    Element element;
    element.number = ++elements_;
    element.line = static_cast<std::uint64_t>(
        1 +
        std::count(bytes_.begin() + static_cast<std::ptrdiff_t>(counted_),
                   bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n') +
        static_cast<std::ptrdiff_t>(lines_));
    lines_ = element.line - 1;
    counted_ = at_;
    ++at_;
    element.name = name();
    if (element.name.empty()) return wrong("expected the name of an element behind \"<\"");
    if (open_.empty() && root_) return wrong("expected one root element, found another");
    root_ = true;
    if (open_.size() == deepest) return wrong("elements are nested too deep");
    for (;;) {
      blanks();
      if (next_is("/>") || next_is(">")) break;
      if (auto ok = attribute(element); !ok) return ok;
    }
    const bool empty = next_is("/>");
    at_ += empty ? 2 : 1;
    open_.push_back(std::move(element));
    if (empty) finish();
    return {};
  }

  Expected<void> attribute(Element& element) {
    const std::string key = name();
    blanks();
    if (key.empty() || !next_is("=")) return wrong("expected NAME=\"VALUE\" in an element");
    ++at_;
    blanks();
    if (!next_is("\"") && !next_is("'")) return wrong("expected a value in quotes");
    const std::string_view quote = bytes_.substr(at_++, 1);
    const auto value = until(quote);
    if (!value) return fail(value.error());
    auto plain = resolved(*value);
    if (!plain) return fail(plain.error());
    if (!element.attribute(key).empty())
      return wrong("attribute " + shown(key) + " is there twice");
    element.attributes.emplace_back(key, std::move(*plain));
    return {};
  }

  Expected<void> close() {
    at_ += 2;
    const std::string closed = name();
    blanks();
    if (!next_is(">")) return wrong("expected > behind </" + closed);
    if (open_.empty() || open_.back().name != closed)
      return wrong("expected " + (open_.empty() ? "no </...>" : "</" + open_.back().name + ">") +
                   ", found " + shown("</" + closed + ">"));
    ++at_;
    finish();
    return {};
  }
  void finish() {
    Element element = std::move(open_.back());
    open_.pop_back();
    element.text = std::string(stripped(element.text));
    take_(element, open_);
  }

  Expected<void> text(std::string_view raw) {
    if (open_.empty()) {
      if (stripped(raw).empty()) return {};
      return wrong("expected text only inside elements, found " + shown(stripped(raw)));
    }
    auto plain = resolved(raw);
    if (!plain) return fail(plain.error());
    open_.back().text += *plain;
    return {};
  }

  Expected<std::string> resolved(std::string_view raw) const {
    std::string out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] != '&') {
        out += raw[i];
        continue;
      }
      const std::size_t end = raw.find(';', i);
      const std::string_view entity = raw.substr(i + 1, std::min(end, raw.size()) - i - 1);
      if (end == raw.npos || !append_entity(out, entity))
        return wrong(
            "expected one of &lt; &gt; &amp; &quot; &apos; or a character's number, found " +
            shown("&" + std::string(entity.substr(0, 20))));
      i = end;
    }
    return out;
  }
  static bool append_entity(std::string& out, std::string_view entity) {
    static constexpr std::pair<std::string_view, char> known[] = {
        {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
    for (const auto& [name, c] : known)
      if (entity == name) {
        out += c;
        return true;
      }
    if (!entity.starts_with('#')) return false;
    const bool hex = entity.substr(1).starts_with('x');
    const std::string_view digits = entity.substr(hex ? 2 : 1);
    std::uint32_t code = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, hex ? 16 : 10);
    if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
      return false;
    if (code < 0x20 || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000))
      return code == 9 || code == 10 || code == 13;
    append_utf8(out, code);
    return true;
  }

  std::string_view bytes_;
  const TakeElement& take_;
  std::size_t at_ = 0;
  std::size_t counted_ = 0;  ///< up to here lines were counted
  std::uint64_t lines_ = 0;  ///< ends of lines before that
  bool root_ = false;
  std::uint64_t elements_ = 0;
  std::vector<Element> open_;
};

}  // namespace

std::string Element::attribute(std::string_view key) const {
  for (const auto& [its_name, value] : attributes)
    if (its_name == key) return value;
  return {};
}

Expected<void> for_each_element(std::string_view bytes, const TakeElement& take) {
  if (bytes.find('\0') != bytes.npos || !is_utf8(bytes))
    return fail("expected XML in UTF-8, found other bytes; is the file UTF-16?");
  return Scanner(bytes, take).scan();
}

}  // namespace nonio::ballbar
