// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

/// Effects whose value is stated instead of fitted: "squareness:XY = 12.3 arcsec".
namespace nonio::modelling {

struct Entry {
  std::string effect;
  std::optional<std::string> value{};  ///< "12.3 arcsec"; nullopt for a fitted effect
  std::string text() const { return value ? effect + " = " + *value : effect; }
};
Entry entry_of(const std::string& written);

/// Returns the entry with or without a value; null if the model lacks the effect.
const std::string* find_effect(const std::vector<std::string>& model, const std::string& effect);

/// Returns SI units. An error unless the effect has one parameter, no shapes and no groups, is not
/// a curve, and does not depend on a channel.
Expected<double> held_value(const Entry& entry, const Effect& effect, bool rotary);

}  // namespace nonio::modelling
