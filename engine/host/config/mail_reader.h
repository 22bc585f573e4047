// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/config/manifest.h"
#include "host/config/toml_reader.h"

namespace nonio::host::config {

/// `[mail]` of site.toml. No password leaves without encryption.
Mail read_mail(TableReader& reader);

}  // namespace nonio::host::config
