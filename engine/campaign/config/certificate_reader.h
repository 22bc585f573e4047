// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/manifest.h"

namespace nonio::config {

/// Combines `[certificate]` of a campaign and of site.toml: for each key the campaign's value,
/// otherwise the site's, otherwise the default.
CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign);

}  // namespace nonio::config
