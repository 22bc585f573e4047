// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <new>
#include <string>

#include "nonio/sdk/error.h"
#include "platform/process/apart.h"
#include "platform/process/process_state.h"

namespace nonio::process {

/// Returns the result of `call`, or an error if `call` changed the process state
/// (`restore_process_state`).
template <class Call>
auto leaving_all_as_it_is(const std::string& who, const Call& call) -> decltype(call()) {
  auto result = [&]() -> decltype(call()) {
    const Muted muted;
    return call();
  }();
  const std::string changed = restore_process_state();
  if (!changed.empty()) return fail(who + " changed " + changed + " of the process; refused");
  return result;
}

/// Returns the result of `call`. An exception becomes an error, and every error message begins with
/// the plugin's name `who`.
template <class Call>
auto guarded(const std::string& who, const Call& call) -> decltype(call()) {
  return leaving_all_as_it_is(who, [&]() -> decltype(call()) {
    try {
      auto result = call();
      if (!result) result.error().message = who + ": " + result.error().message;
      return result;
    } catch (const std::bad_alloc&) {
      return fail(who + ": out of memory (the limit for one campaign is in site.toml, [limits])");
    } catch (const std::exception& e) {
      return fail(who + " threw an exception: " + e.what());
    } catch (...) {
      return fail(who + " threw an exception of an unknown kind");
    }
  });
}

template <class Ask>
Expected<bool> guarded_answer(const std::string& who, const Ask& ask) {
  return guarded(who, [&]() -> Expected<bool> { return ask(); });
}

}  // namespace nonio::process
