// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "law.h"

/// The files of one law for one kind of control; README.md has the source of every fact.
namespace nonio::heat_compensation {

struct Format {
  const char* name;  ///< choice of option `control`
  const char* note;  ///< id of the remark on what is inferred; null: all is documented
  /// Empty where the control can have this law; else id of the finding that refuses it.
  std::string (*refusal)(const Law&);
  std::vector<Artifact> (*files)(const OutputInput&, const Law&);
};

const std::vector<Format>& formats();

}  // namespace nonio::heat_compensation
