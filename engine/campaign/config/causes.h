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

/// The library of causes: effects as formulas that no plugin has, in causes/*.toml of the templates
/// and in SITE/causes/*.toml.
namespace nonio::config {

/// Files of SITE/causes among the templates.
inline constexpr std::string_view site_causes = "causes/site/";

struct Cause {
  Formula formula;  ///< without an axis: of every axis of its kind
  bool rotary = false;
  std::string title, is, size, appearance, similar, remedy;  ///< English
  std::map<std::string, std::string> titles{};               ///< by language
  std::string prior;                                         ///< common, rare, very-rare
  std::vector<std::string> columns{};  ///< "time_s": readings without times do not show it
  bool compensable = false;
  std::string file;  ///< of the formula's line

  /// 2 ln of the odds against it before there are readings, an effect of the catalogue being even.
  double price() const;
  /// `tried` as in `formula_effect`.
  Expected<Effect> effect(bool tried) const;
};

/// Whether a file of the templates is one of the library.
bool is_causes_file(std::string_view name);

using Library = std::shared_ptr<const std::vector<Cause>>;

/// All causes in these templates, in the order of their files; a name may be there once. Those of
/// the site are tried.
Checked<Library> causes_in(const Templates& templates);

/// Keys with former names in these files, each with file and line.
std::vector<Error> warnings_of_causes(const Templates& templates);

/// Adds their texts to the words of the effects.
void add_words(const std::vector<Cause>& causes, Templates& templates);

}  // namespace nonio::config
