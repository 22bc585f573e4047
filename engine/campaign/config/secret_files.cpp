// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/secret_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "platform/storage/files.h"

namespace nonio::config {
namespace fs = std::filesystem;

std::vector<fs::path> secret_files(const SiteFile& file, const fs::path& site) {
  std::vector<fs::path> files{site / users_name};
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
  if (file.webhook) add(file.webhook->secret_file, {});
  return files;
}

Expected<void> check_secret(const fs::path& path, const std::string& what) {
  constexpr mode_t others = S_IRWXG | S_IRWXO;
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || (info.st_mode & others) == 0) return {};
  std::array<char, 8> mode{};
  std::snprintf(mode.data(), mode.size(), "%04o", info.st_mode & 07777U);
  return fail("other users can get at " + what + " " + path.string() + " (mode " + mode.data() +
              "); expected a file for the user alone who runs this: chmod 600 " + path.string() +
              (info.st_uid == ::geteuid()
                   ? ""
                   : ", and chown " + std::to_string(::geteuid()) + " " + path.string()));
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
  if (!source.file.empty())
    if (auto alone = check_secret(path, source.what); !alone) return fail(alone.error());
  auto text = storage::read_file(path);
  if (!text) return fail(source.what + ": " + text.error().message);
  while (text->ends_with('\n') || text->ends_with('\r')) text->pop_back();
  return text;
}

}  // namespace nonio::config
