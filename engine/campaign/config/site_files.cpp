// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/site_files.h"

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

}  // namespace nonio::config
