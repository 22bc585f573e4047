// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/manifest.h"

namespace nonio::config {

/// A key has the value of the campaign, otherwise that of the site, otherwise the default.
CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign);

}  // namespace nonio::config
