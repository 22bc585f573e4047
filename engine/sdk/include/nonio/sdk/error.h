// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace nonio {

/// An error message for the user. Each function adds the part of the location (file, line, column)
/// that is available to it.
struct Error {
  std::string message;
  /// Path relative to the campaign's folder; empty if the error is not in a file.
  std::string file{};
  std::uint64_t line = 0;  ///< 1-based; 0 if the error is not in a line
  std::string column{};
  /// The plugin option (`axes`) or manifest key (`campaign.customer`) that caused the error,
  /// otherwise empty; the host adds its file and line.
  std::string key{};
};

template <class T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

inline tl::unexpected<Error> fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

/// Declares a variable with the value of an Expected, or returns its error from the enclosing
/// function: NONIO_TRY(const auto axis, axis_of(input));
#define NONIO_TRY(declaration, ...) \
  NONIO_TRY_NAMED_(NONIO_JOINED_(tried_in_line_, __LINE__), declaration, __VA_ARGS__)
#define NONIO_TRY_NAMED_(tried, declaration, ...)             \
  auto tried = __VA_ARGS__;                                   \
  if (!tried) return ::nonio::fail(std::move(tried).error()); \
  declaration = *std::move(tried)
#define NONIO_JOINED_(a, b) NONIO_JOINED_AS_IT_IS_(a, b)
#define NONIO_JOINED_AS_IT_IS_(a, b) a##b

}  // namespace nonio
