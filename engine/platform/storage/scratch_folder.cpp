// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/scratch_folder.h"

#include <cstdlib>

namespace nonio::storage {
namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(const std::string& purpose, const fs::path& below) {
  std::error_code error;
  std::string name =
      ((below.empty() ? fs::temp_directory_path(error) : fs::absolute(below, error)) /
       ("nonio-" + purpose + "-" + std::string(6, 'X')))
          .string();
  if (!error && ::mkdtemp(name.data()) != nullptr) path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace nonio::storage
