// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/site_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "campaign/config/causes.h"
#include "campaign/config/machines.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::config {

namespace fs = std::filesystem;

namespace {

Expected<std::optional<std::string>> read_settings(const fs::path& site) {
  NONIO_TRY(const auto there, storage::is_there(site / site_name));
  if (!there) return std::nullopt;
  auto text = storage::read_small_file(site / site_name);
  if (!text) return fail(Error{text.error().message, site_name});
  return std::move(*text);
}

}  // namespace

Checked<SiteFile> site_in(const SiteFiles& files, std::string& digest) {
  digest = storage::sha256(files.settings.value_or(""));
  if (!files.settings) return SiteFile{};
  return parse_site(*files.settings, site_name);
}

Checked<SiteFile> read_site(const fs::path& site, std::string& digest) {
  auto settings = read_settings(site);
  if (!settings) return tl::unexpected(std::vector<Error>{settings.error()});
  return site_in({std::move(*settings)}, digest);
}

Expected<std::vector<fs::path>> with_site_templates(std::vector<fs::path> folders,
                                                    const fs::path& site) {
  for (const char* name : {templates_folder, causes_folder}) {
    const fs::path own = site / name;
    NONIO_TRY(const auto there, storage::is_there(own));
    std::error_code error;
    const auto kind = fs::status(own, error).type();
    if (there && error) return fail("cannot read " + own.string() + ": " + error.message());
    if (there && kind == fs::file_type::directory) folders.push_back(own);
  }
  return folders;
}

Expected<SiteFiles> read_site_files(const fs::path& site,
                                    const std::function<void(const fs::path&)>& reading) {
  SiteFiles files;
  reading(site / site_name);
  NONIO_TRY(auto settings, read_settings(site));
  files.settings = std::move(settings);
  // The records are read here to detect a network share that does not respond; later code reads
  // them again.
  reading(site / machines_folder);
  if (const auto machines = read_machines(site); !machines) return fail(machines.error());
  reading(site / "templates");
  NONIO_TRY(const auto own, with_site_templates({}, site));
  files.templates.folder = site / templates_folder;
  for (const fs::path& folder : own) {
    NONIO_TRY(const auto paths, template_paths(folder));
    const std::string under = folder.filename() == causes_folder ? std::string(site_causes) : "";
    for (const auto& [name, path] : paths) {
      if (!under.empty() && !is_causes_file(under + name)) continue;
      reading(path);
      NONIO_TRY(auto bytes, storage::read_file(path));
      files.templates.files[under + name] = std::move(bytes);
    }
  }
  return files;
}

std::string to_hex(std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  for (const char c : bytes) {
    out += digits[static_cast<unsigned char>(c) >> 4];
    out += digits[static_cast<unsigned char>(c) & 15];
  }
  return out;
}

Expected<std::string> from_hex(const std::string& text) {
  std::string out;
  const auto value = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    if (value(text[i]) < 0 || value(text[i + 1]) < 0) return fail("expected hexadecimal digits");
    out += static_cast<char>(value(text[i]) * 16 + value(text[i + 1]));
  }
  if (text.size() % 2 != 0) return fail("expected hexadecimal digits");
  return out;
}

fs::path site_of(const fs::path& campaign) {
  std::error_code error;
  const fs::path start = fs::canonical(campaign, error);
  // An inaccessible path is treated as existing, so that reading it reports the error.
  const auto has = [](const char* name) {
    return
        [name](const fs::path& folder) { return storage::is_there(folder / name).value_or(true); };
  };
  const auto nearest = [&](const auto& is_it) -> std::optional<fs::path> {
    for (fs::path folder = start; !error && !folder.empty(); folder = folder.parent_path()) {
      if (is_it(folder)) return folder;
      if (folder == folder.parent_path()) break;
    }
    return std::nullopt;
  };
  if (const auto site = nearest(has(site_name))) return *site;
  if (auto site = nearest(has(machines_folder))) return *site;
  return nearest(has(causes_folder)).value_or(campaign);
}

namespace {

template <class Read>
Expected<std::vector<Artifact>> read_list(const std::string& list, const Read& read) {
  std::vector<Artifact> files;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    const std::filesystem::path path = list.substr(from, comma - from);
    NONIO_TRY(auto bytes, read(path));
    files.push_back({path.filename().string(), std::move(bytes)});
    from = comma + 1;
  }
  return files;
}

}  // namespace

Expected<std::vector<Artifact>> read_table_files(const std::string& list) {
  return read_list(list,
                   [](const std::filesystem::path& path) { return storage::read_file(path); });
}

Expected<std::vector<Artifact>> read_table_files(const std::string& list,
                                                 const std::filesystem::path& base) {
  return read_list(list, [&](const std::filesystem::path& path) -> Expected<std::string> {
    NONIO_TRY(const auto inside, storage::path_inside(base, path.string()));
    auto bytes = storage::read_small_file(inside);
    if (!bytes) return fail(path.string() + ": " + bytes.error().message);
    return bytes;
  });
}

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
