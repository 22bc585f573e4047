// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "certificates/register.h"

namespace nonio::certificates {

/// `[certificate]` of a site's site.toml.
Expected<config::Numbering> numbering_of(const std::filesystem::path& site);

/// All numbers of the site's register, with who released and withdrew them.
Expected<std::vector<RegisterEntry>> certificates_of(const std::filesystem::path& site,
                                                     const config::Numbering& numbering);

/// Takes a number back; `why` stays in the register, and `by` (may be empty).
Expected<void> withdraw(const std::filesystem::path& site, const config::Numbering& numbering,
                        const std::string& number, const std::string& why,
                        const std::string& by = {});

/// Whether the register is what it was written as; an error if that cannot be read.
Expected<Audit> audit(const std::filesystem::path& site, const config::Numbering& numbering);

/// Writes what was issued under all numbers into a folder: NUMBER.pdf, NUMBER-dcc.xml.
Expected<void> export_certificates(const std::filesystem::path& site,
                                   const config::Numbering& numbering,
                                   const std::filesystem::path& folder);

}  // namespace nonio::certificates
