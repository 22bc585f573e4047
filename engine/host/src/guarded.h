// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <new>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::host {

/// Nobody throws on purpose; whatever a plugin does throw ends here, with its name.
template <class Call>
auto guarded(const std::string& who, const Call& call) -> decltype(call()) {
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
}

}  // namespace nonio::host
