// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/late_library.h"

#include <dlfcn.h>

#include <string>

namespace nonio::storage {

// Boost.DLL, which loads plugins, requires a path; dlopen finds a library by its name.
Expected<const void*> exported(const char* library, const char* symbol) {
  const auto why = [&] {
    const char* const words = ::dlerror();
    return fail("cannot load a part of Nonio, " + std::string(library) + ": " +
                (words == nullptr ? "" : words) + "; expected it as it was installed");
  };
  void* const loaded = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (loaded == nullptr) return why();
  const void* const found = ::dlsym(loaded, symbol);
  if (found == nullptr) return why();
  return found;
}

}  // namespace nonio::storage
