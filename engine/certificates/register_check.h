// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "certificates/register.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// What a verification needs of the register of a site. It is read before a stranger's file is: the
/// process that reads that file may not open a connection to a server.
struct RegisterRows {
  bool asked = false;     ///< a site was named
  std::string no_answer;  ///< why the register could not be read; empty: it could
  bool exists = false;
  std::string id;
  std::vector<RegisterEntry> entries;
  std::map<std::string, std::string> issued;  ///< number, by the SHA-256 of an issued file
};

/// Of the site's register; not checked where `site` is empty.
RegisterRows register_rows(const std::filesystem::path& site);

/// "no verdict on FILE, because the register cannot be read: ..."
std::string no_verdict(const RegisterRows& rows, const std::string& what);

/// The register that issued these bytes, for `sign::Verifier::issued_by`; empty: none of them. The
/// bytes of a PDF may end with updates.
std::string issued_by(const RegisterRows& rows, std::string_view bytes);

/// The state of a signed file in the register of a site (`register.state`): that this very file was
/// issued under its number, and that the number is in force. None where the file has no number that
/// a register gives. An error if the register is required and did not answer.
Expected<std::optional<sign::Check>> check_register(const sign::Verified& verified,
                                                    std::string_view bytes,
                                                    const RegisterRows& rows);

}  // namespace nonio::certificates
