// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "nonio/reports/wording.h"

namespace nonio::reports {

/// Markup that is inserted unchanged; all other text is escaped.
struct Html {
  std::string text;
};
Html html_of(std::string_view text);

/// Content of a page: values by name, and lists of views. Names must be string literals.
class View {
 public:
  View& set(const char* name, std::string text);
  View& set(const char* name, Html);
  View& flag(const char* name, bool on) { return on ? set(name, std::string("yes")) : *this; }
  /// Appends a view to a list.
  View& add(const char* name);

 private:
  friend class PageWriter;
  using Value = std::variant<std::string, Html, std::list<View>>;
  const Value* find(std::string_view name) const;
  std::vector<std::pair<const char*, Value>> values_;
};

using PageFiles = std::map<std::string, std::string_view, std::less<>>;
/// Embedded files of templates/pages, by names such as "site/index".
const PageFiles& page_files();

/// Returns the page `name` with its values:
///
///     {{name}}              a value, escaped; one that is missing is an error
///     {{words.KEY}}         a word in the language of the page
///     {{#name}}...{{/name}} once for each view of a list, or once for a value that is not empty
///     {{^name}}...{{/name}} where the list or the value is empty or missing
///     {{>name}}             another file, with the same values
///
/// Within a list, a name that its view does not contain is looked up in the surrounding view.
Expected<std::string> page_text(const std::string& name, const View&, const Wording&,
                                const PageFiles& = page_files());

}  // namespace nonio::reports
