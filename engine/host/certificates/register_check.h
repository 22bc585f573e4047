// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "nonio/sign/verify.h"

namespace nonio::host::certificates {

/// What the register of a site says of a signed file (`register.state`): that this very file was
/// issued under its number, and that the number is in force. None where the file has no number that
/// a register gives.
std::optional<sign::Check> check_register(const sign::Verified& verified, std::string_view bytes,
                                          const std::filesystem::path& site);

}  // namespace nonio::host::certificates
