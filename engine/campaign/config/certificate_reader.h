// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/manifest.h"
#include "campaign/config/toml_reader.h"

namespace nonio::config {

/// `[certificate]`: the keys that site.toml and a campaign share, those of a campaign alone, those
/// of site.toml alone.
CertificateTexts read_certificate(TableReader&);
void read_certificate_of_campaign(TableReader&, CertificateTexts& into);
Numbering read_numbering(TableReader&);

/// The values of the campaign, else those of the site, else the defaults.
CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign);

}  // namespace nonio::config
