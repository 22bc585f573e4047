// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "nonio/host/evaluate.h"
#include "nonio/sign/verify.h"

namespace nonio::host {

/// What is attached to a signed PDF evaluated again by the installed plugins: `content.values`,
/// whether the readings give the attached results; `content.printed`, whether the output that made
/// it draws the same pages from them.
std::vector<sign::Check> check_content(const sign::Verified& verified, std::string_view pdf,
                                       const Context& context);

const sign::Attachment* find_attachment(const sign::Verified& verified, std::string_view name);

}  // namespace nonio::host
