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

/// Register data for a verification. They are read before the file, because the process that reads
/// an untrusted file must not connect to a server.
struct RegisterRows {
  bool asked = false;     ///< whether a site was named
  std::string no_answer;  ///< why the register could not be read; otherwise empty
  bool exists = false;
  std::string id;
  std::vector<RegisterEntry> entries;
  std::map<std::string, std::string> issued;  ///< numbers by the SHA-256 of the issued files
};

/// Returns empty rows if `site` is empty. If the register cannot be read, `no_answer` states why.
RegisterRows register_rows(const std::filesystem::path& site);

/// Returns the message "no verdict on FILE, because the register cannot be read: ...".
std::string no_verdict(const RegisterRows& rows, const std::string& what);

/// Returns an empty text unless the register issued the signed part of these bytes.
std::string issued_by(const RegisterRows& rows, std::string_view bytes);

/// Checks that the register of a site issued this very file under its number, and that the number
/// is in force. Returns nullopt if the file states no number. An error if the register is required
/// and could not be read.
Expected<std::optional<sign::Check>> check_register(const sign::Verified& verified,
                                                    std::string_view bytes,
                                                    const RegisterRows& rows);

}  // namespace nonio::certificates
