// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/formula.h"
#include "campaign/config/manifest.h"
#include "nonio/sdk/settings.h"

/// The library of causes: effects as formulas that no plugin provides, in causes/*.toml of the
/// templates and in SITE/causes/*.toml.
namespace nonio::config {

/// Prefix of the files of SITE/causes among the templates.
inline constexpr std::string_view site_causes = "causes/site/";

struct Cause {
  Formula formula;  ///< formula of the deviation, for all linear or all rotary axes
  bool rotary = false;
  std::string title, is, size, appearance, similar, remedy;  ///< English texts for users
  std::map<std::string, std::string> titles{};  ///< titles by language code; "": English
  std::string prior;  ///< frequency of the cause: common, rare or very-rare
  /// Columns that readings need to show the cause, such as "time_s".
  std::vector<std::string> columns{};
  bool compensable = false;
  std::string file;  ///< file of the formula, for messages

  /// Returns 2 ln of the odds against the cause before readings are known: 0 for a common one, as
  /// for effects of plugins, otherwise 2 ln 10 (rare) or 2 ln 100 (very rare).
  double price() const;
  /// Returns the effect of the formula. If `tried`, the formula passed the trial on sample readings
  /// (finite, linear, unit of a deviation) before, and the trial is not repeated.
  Expected<Effect> effect(bool tried) const;
};

/// Whether a file of the templates belongs to the library of causes.
bool is_causes_file(std::string_view name);

using Library = std::shared_ptr<const std::vector<Cause>>;

/// Returns all causes in these templates in the order of their files. Errors: a file is not valid,
/// a name is used twice, or a formula of the site is not valid.
Checked<Library> causes_in(const Templates& templates);

/// Returns one warning for each former name of a key in a file, with the line of its first use.
std::vector<Error> warnings_of_causes(const Templates& templates);

/// Adds the texts of the causes to the words for effects in the templates.
void add_words(const std::vector<Cause>& causes, Templates& templates);

}  // namespace nonio::config
