// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace nonio::evaluation {

/// What came of a campaign. `none`: not evaluated yet.
enum class Status : char { none, ok, attention, failed };

/// "ok", "attention", "failed"; "" of `none`. JSON, the summary and the terminal have these words.
const char* to_text(Status status);
/// None if no evaluated campaign has this word.
std::optional<Status> status_named(std::string_view word);

}  // namespace nonio::evaluation
