// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "certificates/register.h"

namespace nonio::certificates {

/// Reads `[certificate]` of a site's site.toml.
Expected<config::Numbering> numbering_of(const std::filesystem::path& site);

/// Returns all numbers of the site's register, with the persons who approved and withdrew them.
Expected<std::vector<RegisterEntry>> certificates_of(const std::filesystem::path& site,
                                                     const config::Numbering& numbering);

/// The register keeps the reason `why` and the name `by`, which may be empty.
Expected<void> withdraw(const std::filesystem::path& site, const config::Numbering& numbering,
                        const std::string& number, const std::string& why,
                        const std::string& by = {});

/// Checks that the register was not changed outside of this program; an error if it cannot be read.
Expected<Audit> audit(const std::filesystem::path& site, const config::Numbering& numbering);

/// Writes all issued files into a folder: NUMBER.pdf and NUMBER-dcc.xml, and for files of other
/// outputs NUMBER-OUTPUT-NAME.
Expected<void> export_certificates(const std::filesystem::path& site,
                                   const config::Numbering& numbering,
                                   const std::filesystem::path& folder);

}  // namespace nonio::certificates
