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

/// Data from the register of a site that a verification needs. They are read before the file to be
/// verified, because the process that reads an untrusted file must not connect to a server.
struct RegisterRows {
  bool asked = false;     ///< whether a site was named
  std::string no_answer;  ///< why the register could not be read; empty: it was read
  bool exists = false;
  std::string id;
  std::vector<RegisterEntry> entries;
  std::map<std::string, std::string> issued;  ///< certificate numbers, by the SHA-256 of the issued
                                              ///< files
};

/// Reads the site's register; returns empty rows if `site` is empty. If the register cannot be
/// read, `no_answer` states why.
RegisterRows register_rows(const std::filesystem::path& site);

/// Returns the message "no verdict on FILE, because the register cannot be read: ...".
std::string no_verdict(const RegisterRows& rows, const std::string& what);

/// Returns the statement that the register issued these bytes, for `sign::Verifier::issued_by`;
/// empty if it did not. Updates after the signed part of a PDF are ignored.
std::string issued_by(const RegisterRows& rows, std::string_view bytes);

/// Checks a signed file against the register of a site (`register.state`): this very file was
/// issued under its number, and the number is in force. Returns none if the file states no
/// certificate number. An error if the register is required and could not be read.
Expected<std::optional<sign::Check>> check_register(const sign::Verified& verified,
                                                    std::string_view bytes,
                                                    const RegisterRows& rows);

}  // namespace nonio::certificates
