// SPDX-License-Identifier: Apache-2.0
#include "context.h"

#include <algorithm>

#include "json_values.h"
#include "nonio/host/digest.h"
#include "nonio/host/files.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

Expected<std::optional<std::string>> read_settings(const fs::path& site) {
  const auto there = is_there(site / site_name);
  if (!there) return fail(there.error());
  if (!*there) return std::nullopt;
  auto text = read_small_file(site / site_name);
  if (!text) return fail(Error{text.error().message, site_name});
  return std::move(*text);
}

}  // namespace

Checked<SiteFile> site_in(const SiteFiles& files, std::string& digest) {
  digest = sha256(files.settings.value_or(""));
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
  const fs::path own = site / "templates";
  const auto there = is_there(own);
  if (!there) return fail(there.error());
  std::error_code error;
  const auto kind = fs::status(own, error).type();
  if (*there && error) return fail("cannot read " + own.string() + ": " + error.message());
  if (*there && kind == fs::file_type::directory) folders.push_back(own);
  return folders;
}

namespace {

/// Every file below a folder, links to folders followed, as paths relative to it.
Expected<std::map<std::string, fs::path>> files_below(const fs::path& folder) {
  std::map<std::string, fs::path> files;
  std::error_code error;
  std::vector<fs::path> above{fs::canonical(folder, error)};  // the folders that the walk is in
  fs::recursive_directory_iterator it(folder, fs::directory_options::follow_directory_symlink,
                                      error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const auto kind = fs::status(it->path(), error).type();
    if (kind == fs::file_type::not_found) error.clear();
    if (kind == fs::file_type::regular)
      files[it->path().lexically_relative(folder).generic_string()] = it->path();
    if (error) break;
    if (kind != fs::file_type::directory) continue;
    above.resize(static_cast<std::size_t>(it.depth()) + 1);
    const fs::path real = fs::canonical(it->path(), error);
    if (!error && std::find(above.begin(), above.end(), real) != above.end())
      return fail("the template folder " + it->path().string() +
                  " is a link back to a folder that it lies in; wanted files");
    if (error) break;
    above.push_back(real);
  }
  if (error)
    return fail("cannot read the templates in " + folder.string() + ": " + error.message());
  return files;
}

}  // namespace

Expected<SiteFiles> read_site_files(const fs::path& site,
                                    const std::function<void(const fs::path&)>& reading) {
  SiteFiles files;
  reading(site / site_name);
  auto settings = read_settings(site);
  if (!settings) return fail(settings.error());
  files.settings = std::move(*settings);
  // Read again where they are used; here a share that hangs is noticed.
  reading(site / machines_folder);
  if (const auto machines = read_machines(site); !machines) return fail(machines.error());
  reading(site / "templates");
  const auto own = with_site_templates({}, site);
  if (!own) return fail(own.error());
  if (own->empty()) return files;
  files.templates.folder = own->front();
  const auto paths = files_below(own->front());
  if (!paths) return fail(paths.error());
  for (const auto& [name, path] : *paths) {
    reading(path);
    auto bytes = read_file(path);
    if (!bytes) return fail(bytes.error());
    files.templates.files[name] = std::move(*bytes);
  }
  return files;
}

namespace {

/// Fonts have megabytes, and every installation has them.
bool travels(std::string_view name) { return !name.starts_with("fonts/"); }

}  // namespace

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
    if (value(text[i]) < 0 || value(text[i + 1]) < 0) return fail("wanted hexadecimal digits");
    out += static_cast<char>(value(text[i]) * 16 + value(text[i + 1]));
  }
  if (text.size() % 2 != 0) return fail("wanted hexadecimal digits");
  return out;
}

namespace {

std::string line_of(const std::string& name, const std::string& digest) {
  return name + " " + digest + "\n";
}

Expected<void> keep(Templates& templates, const std::string& name, std::string bytes,
                    const std::string& path) {
  if (!name.ends_with(".toml")) {
    templates.files[name] = std::move(bytes);
    return {};
  }
  auto settings = parse_settings(bytes, path);
  if (!settings) return fail(settings.error());
  templates.tables[name.substr(0, name.size() - 5)] = std::move(*settings);
  return {};
}

}  // namespace

Expected<Templates> read_templates(const std::vector<fs::path>& folders, std::string& digest,
                                   std::string* json, const TemplateFiles& own,
                                   std::string_view below) {
  std::map<std::string, fs::path> files;
  for (const fs::path& folder : folders) {
    auto here = files_below(folder);
    if (!here) return fail(here.error());
    for (auto& [name, path] : *here) files[name] = std::move(path);
  }
  for (const auto& [name, bytes] : own.files) files[name] = own.folder / name;
  std::erase_if(files, [&](const auto& file) { return !file.first.starts_with(below); });
  Templates templates;
  std::string all;
  Json carried = Json::object();
  for (const auto& [name, path] : files) {
    const auto of_site = own.files.find(name);
    auto bytes =
        of_site == own.files.end() ? read_file(path) : Expected<std::string>(of_site->second);
    if (!bytes) return fail(bytes.error());
    const std::string sum = sha256(*bytes);
    all += line_of(name, sum);
    if (json != nullptr)
      carried[name] = !travels(name)            ? Json{{"sha256", sum}}
                      : name.ends_with(".toml") ? Json{{"text", *bytes}}
                                                : Json{{"hex", to_hex(*bytes)}};
    if (auto kept = keep(templates, name, std::move(*bytes), path.string()); !kept)
      return fail(kept.error());
  }
  digest = sha256(all);
  if (json != nullptr)
    *json = dump(Json{{"schema", "nonio-templates/1"}, {"files", std::move(carried)}});
  return templates;
}

Expected<CarriedTemplates> templates_from(std::string_view text, const Templates& installed,
                                          std::string_view installed_text) {
  const Json json = Json::parse(text, nullptr, false),
             ours = Json::parse(installed_text, nullptr, false);
  if (!json.is_object() || !json.contains("files") || !json["files"].is_object() ||
      dump(json) != text)
    return fail("the attached templates are none, or are written in another way");
  CarriedTemplates out;
  std::string all;
  for (const auto& item : json["files"].items()) {
    const std::string& name = item.key();
    const auto of = [&file = item.value()](const char* key) {
      return file.is_object() && file.contains(key) && file[key].is_string()
                 ? std::optional(file[key].get<std::string>())
                 : std::nullopt;
    };
    std::string bytes, sum;
    if (const auto digest = of("sha256"); digest && !travels(name)) {
      const auto own = installed.files.find(name);
      if (own == installed.files.end() || sha256(own->second) != *digest)
        out.missing = name;
      else
        bytes = own->second;
      sum = *digest;
    } else if (const auto plain = of("text"); plain && travels(name)) {
      bytes = *plain;
    } else if (const auto digits = of("hex"); digits && travels(name)) {
      auto packed = from_hex(*digits);
      if (!packed) return fail("the template " + name + ": " + packed.error().message);
      bytes = std::move(*packed);
    } else {
      return fail("the template " + name + " is not attached as Nonio attaches one");
    }
    const bool known = ours.is_object() && ours.contains("files") && ours["files"].contains(name) &&
                       ours["files"][name] == item.value();
    if (!known) out.strange.push_back(name);
    all += line_of(name, sum.empty() ? sha256(bytes) : sum);
    if (auto kept = keep(out.templates, name, std::move(bytes), name); !kept)
      return fail(kept.error());
  }
  if (ours.is_object() && ours.contains("files"))
    for (const auto& [name, file] : ours["files"].items())
      if (!json["files"].contains(name)) out.strange.push_back(name);
  out.sha256 = sha256(all);
  return out;
}

}  // namespace nonio::host
