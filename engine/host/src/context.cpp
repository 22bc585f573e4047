// SPDX-License-Identifier: Apache-2.0
#include "context.h"

#include "nonio/host/digest.h"
#include "nonio/host/files.h"

namespace nonio::host {
namespace fs = std::filesystem;

Checked<SiteFile> read_site(const fs::path& site, std::string& digest) {
  const fs::path path = site / site_name;
  std::error_code error;
  if (!fs::exists(path, error)) {
    digest = sha256("");
    return SiteFile{};
  }
  const auto text = read_file(path);
  if (!text) return tl::unexpected(std::vector<Error>{text.error()});
  digest = sha256(*text);
  return parse_site(*text, site_name);
}

namespace {

/// Every file below a folder, links to folders followed, as paths relative to it.
Expected<std::map<std::string, fs::path>> files_below(const fs::path& folder) {
  std::map<std::string, fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::follow_directory_symlink,
                                      error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error))
    if (it->is_regular_file())
      files[it->path().lexically_relative(folder).generic_string()] = it->path();
  if (error)
    return fail("cannot read the templates in " + folder.string() + ": " + error.message());
  return files;
}

}  // namespace

Expected<Templates> read_templates(const std::vector<fs::path>& folders, std::string& digest) {
  std::map<std::string, fs::path> files;
  for (const fs::path& folder : folders) {
    auto here = files_below(folder);
    if (!here) return fail(here.error());
    for (auto& [name, path] : *here) files[name] = std::move(path);
  }
  Templates templates;
  std::string all;
  for (const auto& [name, path] : files) {
    auto bytes = read_file(path);
    if (!bytes) return fail(bytes.error());
    all += name + " " + sha256(*bytes) + "\n";
    if (name.ends_with(".toml")) {
      auto settings = parse_settings(*bytes, path.string());
      if (!settings) return fail(settings.error());
      templates.tables[name.substr(0, name.size() - 5)] = std::move(*settings);
    } else {
      templates.files[name] = std::move(*bytes);
    }
  }
  digest = sha256(all);
  return templates;
}

}  // namespace nonio::host
