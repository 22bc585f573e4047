// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/manifest.h"
#include "campaign/config/toml_reader.h"

namespace nonio::config {

/// `[mail]` of site.toml. No password leaves without encryption.
Mail read_mail(TableReader& reader);

}  // namespace nonio::config
