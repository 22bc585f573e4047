// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// A symbol of a library of Nonio in the folder of this one, which is loaded at its first use and
/// never unloaded: clients of servers bring thirty third-party libraries, half of the start of
/// every command. Not for processes that may open no file any more.
Expected<const void*> exported(const char* library, const char* symbol);

template <class T>
Expected<const T*> exported_as(const char* library, const char* symbol) {
  const auto found = exported(library, symbol);
  if (!found) return fail(found.error());
  return static_cast<const T*>(*found);
}

}  // namespace nonio::storage

/// For a constant that `exported` finds.
#define NONIO_EXPORTED extern "C" __attribute__((visibility("default")))
