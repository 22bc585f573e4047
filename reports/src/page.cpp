// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/page.h"

#include <algorithm>
#include <iterator>

#include "nonio/sdk/text.h"
#include "page_files.h"

namespace nonio::reports {

Html html_of(std::string_view text) { return {escaped_markup(text, Markup::attribute)}; }

View& View::set(const char* name, std::string text) {
  values_.emplace_back(name, std::move(text));
  return *this;
}

View& View::set(const char* name, Html html) {
  values_.emplace_back(name, std::move(html));
  return *this;
}

View& View::add(const char* name) {
  for (auto& [known, value] : values_)
    if (known == std::string_view(name)) return std::get<std::list<View>>(value).emplace_back();
  values_.emplace_back(name, std::list<View>(1));
  return std::get<std::list<View>>(values_.back().second).back();
}

const View::Value* View::find(std::string_view name) const {
  for (const auto& [known, value] : values_)
    if (known == name) return &value;
  return nullptr;
}

/// Writes the page while parsing it; list sections are parsed once per view.
class PageWriter {
 public:
  PageWriter(const PageFiles& files, const Wording& words) : files_(files), words_(words) {}

  std::string out;

  Expected<void> file(const std::string& name) {
    const auto file = files_.find(name);
    if (file == files_.end()) return fail(Error{"this page is missing", path_of(name)});
    constexpr std::size_t deepest = 8;
    if (open_.size() >= deepest) return fail(Error{"the page contains itself", path_of(name)});
    open_.push_back({name, file->second});
    std::size_t at = 0;
    auto done = part(at, true, {});
    open_.pop_back();
    return done;
  }

  void enter(const View& view) { views_.push_back(&view); }

 private:
  struct Open {
    std::string name;
    std::string_view text;
  };

  static std::string path_of(const std::string& name) {
    return "templates/pages/" + name + ".html";
  }

  tl::unexpected<Error> wrong(std::string what, std::size_t at) const {
    const auto& [name, text] = open_.back();
    const auto before = text.substr(0, at);
    return fail(
        Error{std::move(what), path_of(name),
              1 + static_cast<std::uint64_t>(std::count(before.begin(), before.end(), '\n'))});
  }

  const View::Value* find(std::string_view name) const {
    for (auto view = views_.rbegin(); view != views_.rend(); ++view)
      if (const auto* value = (*view)->find(name)) return value;
    return nullptr;
  }

  Expected<void> part(std::size_t& at, bool written, std::string_view section) {
    const std::string_view text = open_.back().text;
    const std::size_t begin = at;
    for (;;) {
      const std::size_t tag = text.find("{{", at);
      if (written) out += text.substr(at, std::min(tag, text.size()) - at);
      if (tag == text.npos) break;
      const std::size_t end = text.find("}}", tag);
      if (end == text.npos) return wrong("\"{{\" has no \"}}\"", tag);
      std::string_view name = text.substr(tag + 2, end - tag - 2);
      const char kind = name.empty() ? ' ' : name.front();
      at = end + 2;
      if (kind == '/') {
        if (name.substr(1) != section)
          return wrong("{{" + std::string(name) + "}} ends no open part", tag);
        return {};
      }
      Expected<void> done;
      if (kind == '#' || kind == '^')
        done = sections(at, written, name.substr(1), kind == '^');
      else if (kind == '>' && written)
        done = file(std::string(name.substr(1)));
      else if (written)
        done = value(name, tag);
      if (!done) return done;
    }
    if (!section.empty()) return wrong("{{#" + std::string(section) + "}} has no end", begin);
    return {};
  }

  Expected<void> sections(std::size_t& at, bool written, std::string_view name, bool inverted) {
    const View::Value* value = written ? find(name) : nullptr;
    const auto* list = value == nullptr ? nullptr : std::get_if<std::list<View>>(value);
    const std::size_t begin = at;
    if (list == nullptr || list->empty() || inverted)
      return part(at, written && is_empty(value) == inverted, name);
    for (const View& view : *list) {
      at = begin;
      views_.push_back(&view);
      auto done = part(at, true, name);
      views_.pop_back();
      if (!done) return done;
    }
    return {};
  }

  static bool is_empty(const View::Value* value) {
    if (value == nullptr) return true;
    if (const auto* text = std::get_if<std::string>(value)) return text->empty();
    if (const auto* html = std::get_if<Html>(value)) return html->text.empty();
    return std::get<std::list<View>>(*value).empty();
  }

  Expected<void> value(std::string_view name, std::size_t tag) {
    constexpr std::string_view word = "words.";
    if (name.starts_with(word)) {
      out += html_of(words_.get(name.substr(word.size()))).text;
      return {};
    }
    const View::Value* value = find(name);
    if (value == nullptr || std::holds_alternative<std::list<View>>(*value))
      return wrong("the page has no value \"" + std::string(name) + "\"", tag);
    if (const auto* text = std::get_if<std::string>(value))
      out += html_of(*text).text;
    else
      out += std::get<Html>(*value).text;
    return {};
  }

  const PageFiles& files_;
  const Wording& words_;
  std::vector<Open> open_;
  std::vector<const View*> views_;
};

const PageFiles& page_files() {
  static const PageFiles all(std::begin(embedded_pages), std::end(embedded_pages));
  return all;
}

Expected<std::string> page_text(const std::string& name, const View& view, const Wording& words,
                                const PageFiles& files) {
  PageWriter writer(files, words);
  writer.enter(view);
  if (auto done = writer.file(name); !done) return fail(done.error());
  return std::move(writer.out);
}

}  // namespace nonio::reports
