// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace nonio {

/// What went wrong, in words for the user: what was wanted, what was found. The place (file,
/// line, column) grows outward: the innermost function that knows a part of it fills it in.
struct Error {
  std::string message;
  std::string file{};      ///< relative to the campaign's directory; empty if no file is to blame
  std::uint64_t line = 0;  ///< 1-based; 0 if no line is to blame
  std::string column{};    ///< name of the column, empty if none
  /// The plugin's own option (`axes`) or the key of the manifest (`campaign.customer`) that is to
  /// blame: the host knows its file and line. Empty if none.
  std::string key{};
};

template <class T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

inline tl::unexpected<Error> fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

}  // namespace nonio
