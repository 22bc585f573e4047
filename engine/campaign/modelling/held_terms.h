// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

/// Effects of a model whose value is stated instead of fitted: "squareness:XY = 12.3 arcsec".
namespace nonio::modelling {

/// An entry of [model] effects.
struct Entry {
  std::string effect;                  ///< name of the effect: "squareness:XY"
  std::optional<std::string> value{};  ///< stated value: "12.3 arcsec"; none: it is fitted
  /// Returns the entry as a manifest has it: one blank around "=" and before the unit.
  std::string text() const { return value ? effect + " = " + *value : effect; }
};
Entry entry_of(const std::string& written);

/// Returns the entry for an effect, whether it is fitted or its value is stated; null if the model
/// does not contain it.
const std::string* find_effect(const std::vector<std::string>& model, const std::string& effect);

/// Returns the stated value in SI units. If `rotary`, the axis of the effect is rotary. An error
/// states what was expected: only an effect with one parameter, without shapes and without groups,
/// that is neither a curve nor depends on a recorded channel, can have a stated value.
Expected<double> held_value(const Entry& entry, const Effect& effect, bool rotary);

}  // namespace nonio::modelling
