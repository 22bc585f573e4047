// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace nonio::evaluation {

/// `none`: not evaluated yet.
enum class Status : char { none, ok, attention, failed };

/// Returns the text for JSON and the terminal; "" for `none`.
const char* to_text(Status status);
std::optional<Status> status_named(std::string_view word);

}  // namespace nonio::evaluation
