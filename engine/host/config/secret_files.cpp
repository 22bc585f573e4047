// SPDX-License-Identifier: Apache-2.0
#include "host/config/secret_files.h"

#include <cstdlib>

namespace nonio::host::config {
namespace fs = std::filesystem;

std::vector<fs::path> secret_files(const Signing& s, const fs::path& site) {
  std::vector<fs::path> files;
  for (const std::string& file : {s.pkcs12, s.password_file})
    if (!file.empty()) files.push_back(site / file);
  const char* folder = std::getenv("CREDENTIALS_DIRECTORY");
  if (!s.password_credential.empty() && folder != nullptr)
    files.push_back(fs::path(folder) / s.password_credential);
  return files;
}

}  // namespace nonio::host::config
