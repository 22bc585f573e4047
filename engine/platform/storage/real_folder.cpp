// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/real_folder.h"

#include <sys/stat.h>

#include <utility>

namespace nonio::storage {
namespace fs = std::filesystem;

fs::path real_folder(const fs::path& folder, std::error_code& error) {
  struct Known {
    fs::path path, real;
    struct stat at {};
  };
  thread_local Known parent;
  const auto same = [](const struct stat& a, const struct stat& b) {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
  };
  struct stat own {};
  struct stat above {};
  struct stat there {};
  if (!folder.is_absolute() || !folder.has_filename() || folder.filename() == "." ||
      folder.filename() == ".." || ::lstat(folder.c_str(), &own) != 0 || !S_ISDIR(own.st_mode))
    return fs::canonical(folder, error);
  const fs::path path = folder.parent_path();
  if (::stat(path.c_str(), &above) != 0) return fs::canonical(folder, error);
  if (path != parent.path || !same(above, parent.at) || ::lstat(parent.real.c_str(), &there) != 0 ||
      !same(above, there)) {
    parent = {};
    fs::path real = fs::canonical(path, error);
    if (error) return {};
    parent = {path, std::move(real), above};
  }
  error.clear();
  return parent.real / folder.filename();
}

}  // namespace nonio::storage
