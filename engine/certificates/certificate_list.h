// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "certificates/register.h"

namespace nonio::certificates {

/// Reads `[certificate]` of a site's site.toml.
Expected<config::Numbering> numbering_of(const std::filesystem::path& site);

/// Returns the campaigns whose drafts wait for an approval now.
Expected<std::set<std::string>> waiting_campaigns(const std::filesystem::path& site);

/// Returns the numbers that are no longer in force.
Expected<std::set<std::string>> out_of_force(const std::filesystem::path& site);

/// Returns an error if the file was issued under a number that is no longer in force.
Expected<void> not_out_of_force(const std::filesystem::path& site, const std::string& sha256);

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
