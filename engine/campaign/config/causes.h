// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/formula.h"
#include "campaign/config/manifest.h"
#include "nonio/sdk/templates.h"

/// The library of causes: effects as formulas, in causes/*.toml of the templates and of the site.
namespace nonio::config {

/// Prefix of the files of SITE/causes among the templates.
inline constexpr std::string_view site_causes = "causes/site/";

struct Cause {
  Formula formula;  ///< formula of the deviation, for all linear or all rotary axes
  bool rotary = false;
  std::string title, is, size, appearance, similar, remedy;  ///< English texts for users
  std::map<std::string, std::string> titles{};  ///< titles by language code; "" is English
  std::string prior;                            ///< common, rare or very-rare
  /// Columns that readings need to show the cause, such as "time_s".
  std::vector<std::string> columns{};
  bool compensable = false;
  std::string file;  ///< file of the formula, for messages

  /// Returns 2 ln of the prior odds against the cause: 0 for a common cause, as for effects of
  /// plugins, otherwise 2 ln 10 (rare) or 2 ln 100 (very rare).
  double price() const;
  /// `tried`: the formula passed the trial on sample readings before.
  Expected<Effect> effect(bool tried) const;
};

bool is_causes_file(std::string_view name);

using Library = std::shared_ptr<const std::vector<Cause>>;

/// Returns the causes in the order of their files. Errors: an invalid file, a name that is used
/// twice, or an invalid formula of the site.
Checked<Library> causes_in(const Templates& templates);

/// Returns one warning for each former name of a key in a file, with the line of its first use.
std::vector<Error> warnings_of_causes(const Templates& templates);

/// Adds the texts of the causes to the words of a language.
void add_words(const std::vector<Cause>& causes, const std::string& language,
               TemplateTables::Map& tables);

}  // namespace nonio::config
