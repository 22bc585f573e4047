// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// What a library of ours exports under this name. It lies beside this one and is loaded when it is first asked for,
/// and never unloaded: clients of servers bring thirty libraries of others, which would take half of the start of
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
