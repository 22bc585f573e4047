// SPDX-License-Identifier: Apache-2.0
#include "host/config/secret_files.h"

#include <cstdlib>

#include "host/storage/files.h"

namespace nonio::host::config {
namespace fs = std::filesystem;

std::vector<fs::path> secret_files(const SiteFile& file, const fs::path& site) {
  std::vector<fs::path> files;
  const char* folder = std::getenv("CREDENTIALS_DIRECTORY");
  const auto add = [&](const std::string& path, const std::string& credential) {
    if (!path.empty()) files.push_back(site / path);
    if (!credential.empty() && folder != nullptr) files.push_back(fs::path(folder) / credential);
  };
  if (file.signing) {
    add(file.signing->pkcs12, {});
    add(file.signing->password_file, file.signing->password_credential);
  }
  if (file.database) add(file.database->password_file, {});
  if (file.mail) add(file.mail->password_file, file.mail->password_credential);
  return files;
}

Expected<std::string> read_password(const PasswordSource& source, const fs::path& site) {
  const std::string in = " in [" + source.section + "] of site.toml";
  if (!source.env.empty()) {
    const char* value = std::getenv(source.env.c_str());
    if (value == nullptr)
      return fail("the environment has no " + source.env + " (password_env" + in + ")");
    return std::string(value);
  }
  fs::path path = site / source.file;
  if (!source.credential.empty()) {
    const char* folder = std::getenv("CREDENTIALS_DIRECTORY");
    if (folder == nullptr)
      return fail("systemd gave no credentials (password_credential" + in +
                  "; LoadCredential= in the unit)");
    path = fs::path(folder) / source.credential;
  }
  auto text = storage::read_file(path);
  if (!text) return fail(source.what + ": " + text.error().message);
  while (text->ends_with('\n') || text->ends_with('\r')) text->pop_back();
  return text;
}

}  // namespace nonio::host::config
