// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace nonio::evaluation {

/// Outcome of a campaign; `none` means that it was not evaluated yet.
enum class Status : char { none, ok, attention, failed };

/// Returns "ok", "attention" or "failed", the words in JSON, the summary and the terminal; "" for
/// `none`.
const char* to_text(Status status);
/// Returns the status with this word; none if no status has it.
std::optional<Status> status_named(std::string_view word);

}  // namespace nonio::evaluation
