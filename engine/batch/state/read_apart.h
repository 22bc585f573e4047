// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <string>

#include "batch/state/wire.h"
#include "platform/process/watched.h"

namespace nonio::batch {

/// Runs `read` in a child process, or in this process if none can be started. The child may take
/// `seconds` without a sign of life. An error names `what`, or is "interrupted" if a stop is
/// requested; the child may then remain.
Expected<std::string> bytes_apart(const std::string& what, double seconds,
                                  const std::function<std::string(process::SignsOfLife&)>& read);

/// Returns the value of `read`, which runs in a child process, so that a disk that hangs does not
/// block a request to stop. An error names `what` if the child shows no sign of life for `seconds`
/// or ends without a value.
template <class T, class Read>
Expected<T> read_apart(const std::string& what, double seconds, const Read& read) {
  const auto bytes = bytes_apart(what, seconds, [&](process::SignsOfLife& signs) {
    try {
      const Expected<T> got = read(signs);
      return got ? storage::pack(std::optional<T>(*got), Error{})
                 : storage::pack(std::optional<T>(), got.error());
    } catch (const std::bad_alloc&) {
      return storage::pack(std::optional<T>(), Error{"out of memory while reading " + what});
    } catch (const std::exception& e) {
      return storage::pack(std::optional<T>(), Error{"cannot read " + what + ": " + e.what()});
    }
  });
  if (!bytes) return fail(bytes.error());
  std::optional<T> value;
  Error why;
  if (!storage::unpack(*bytes, value, why))
    return fail("cannot read " + what + ": no whole answer");
  if (!value) return fail(std::move(why));
  return std::move(*value);
}

}  // namespace nonio::batch
