// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/manifest.h"

namespace nonio::config {

/// `[certificate]`: the keys that site.toml and a campaign share, those of a campaign alone, those
/// of site.toml alone.
/// The values of the campaign, else those of the site, else the defaults.
CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign);

}  // namespace nonio::config
