// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/manifest.h"

namespace nonio::config {

/// Returns `[certificate]` of a campaign combined with that of site.toml: for each key the value of
/// the campaign, otherwise that of the site, otherwise the default.
CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign);

}  // namespace nonio::config
