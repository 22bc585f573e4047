// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// Returns a symbol of one of Nonio's libraries, which is loaded at its first use and never
/// unloaded. The clients of servers need thirty third-party libraries, whose loading would take
/// half of the start-up time of every command. The process must be permitted to open files.
Expected<const void*> exported(const char* library, const char* symbol);

template <class T>
Expected<const T*> exported_as(const char* library, const char* symbol) {
  NONIO_TRY(const auto found, exported(library, symbol));
  return static_cast<const T*>(found);
}

}  // namespace nonio::storage

/// Declares a constant that `exported` finds.
#define NONIO_EXPORTED extern "C" __attribute__((visibility("default")))
