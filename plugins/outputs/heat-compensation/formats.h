// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "law.h"

/// Files of a compensation law for each control; README.md states the sources.
namespace nonio::heat_compensation {

struct Format {
  const char* name;  ///< choice of option `control`
  const char* note;  ///< id of the remark about inferred facts, or null
  /// Returns the id of the finding that refuses the law, or an empty text.
  std::string (*refusal)(const Law&);
  std::vector<Artifact> (*files)(const OutputInput&, const Law&);
};

const std::vector<Format>& formats();

}  // namespace nonio::heat_compensation
