// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/template_files.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "campaign/config/causes.h"
#include "campaign/config/site_files.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::config {
namespace fs = std::filesystem;

Expected<std::map<std::string, fs::path>> template_paths(const fs::path& folder) {
  std::map<std::string, fs::path> files;
  std::error_code error;
  std::vector<fs::path> above{fs::canonical(folder, error)};
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
                  " is a link to one of its parent folders; expected files");
    if (error) break;
    above.push_back(real);
  }
  if (error)
    return fail("cannot read the templates in " + folder.string() + ": " + error.message());
  return files;
}

namespace {

/// Fonts are not attached to signed files, because they are large and part of every installation.
bool travels(std::string_view name) { return !name.starts_with("fonts/"); }

}  // namespace

namespace {

fs::path path_of(const TemplateFiles& own, const std::string& name) {
  return name.starts_with(site_causes)
             ? own.folder.parent_path() / causes_folder / name.substr(site_causes.size())
             : own.folder / name;
}

/// Language of "words/LANGUAGE/FILE.toml"; empty for other files.
std::string language_of(const std::string& name) {
  constexpr std::string_view words = "words/";
  const std::size_t end = name.find('/', words.size());
  return name.starts_with(words) && name.ends_with(".toml") && end != std::string::npos
             ? name.substr(words.size(), end - words.size())
             : "";
}

std::string line_of(const std::string& name, const std::string& digest) {
  return name + " " + digest + "\n";
}

/// Of the program's own fonts, one has 4 MB and is rarely drawn with.
Expected<SharedBytes> bytes_of(const fs::path& path, bool is_mapped) {
  if (!is_mapped)
    return storage::read_file(path).map([](std::string b) { return SharedBytes(std::move(b)); });
  NONIO_TRY(auto file, storage::MappedFile::open(path));
  const auto kept = std::make_shared<const storage::MappedFile>(std::move(file));
  return SharedBytes(kept, kept->bytes());
}

std::string table_name(const std::string& file) { return file.substr(0, file.size() - 5); }

Expected<void> keep(Templates& templates, const std::string& name, const SharedBytes& bytes,
                    const std::string& path) {
  if (!name.ends_with(".toml") || is_causes_file(name)) {
    templates.files[name] = bytes;
    return {};
  }
  NONIO_TRY(auto settings, parse_settings(bytes, path));
  templates.tables[table_name(name)] = std::move(settings);
  return {};
}

/// Files of words that are not parsed yet, by language and name.
struct UnreadFile {
  SharedBytes bytes;
  std::string path;
};
using Unread = std::map<std::string, std::map<std::string, UnreadFile>>;

/// The program's own files are valid, so an error is one of the installation.
void add_tables(const std::map<std::string, UnreadFile>& files, TemplateTables::Map& tables) {
  for (const auto& [name, file] : files) {
    auto settings = parse_settings(file.bytes, file.path);
    if (!settings)
      throw std::runtime_error(file.path + ":" + std::to_string(settings.error().line) + ": " +
                               settings.error().message + "; install the program again");
    tables[table_name(name)] = std::move(*settings);
  }
}

/// Adds the words of causes, and `unread` when it is needed.
Expected<void> complete(Templates& templates, Unread unread) {
  auto causes = causes_in(templates);
  if (!causes) return fail(causes.error().front());
  std::set<std::string> languages{"en"};
  for (const auto& [name, table] : templates.tables)
    if (const std::string language = language_of(name + ".toml"); !language.empty())
      languages.insert(language);
  for (const auto& [language, files] : unread) languages.insert(language);
  for (const Cause& cause : **causes)
    for (const auto& [language, title] : cause.titles)
      if (!language.empty()) languages.insert(language);
  templates.tables.read_later(std::move(languages),
                              [causes = std::move(*causes), unread = std::move(unread)](
                                  const std::string& language, TemplateTables::Map& tables) {
                                if (const auto files = unread.find(language); files != unread.end())
                                  add_tables(files->second, tables);
                                add_words(*causes, language, tables);
                              });
  return {};
}

}  // namespace

Expected<Templates> read_templates(const std::vector<fs::path>& folders, const TemplateFiles& own,
                                   const std::vector<std::string>& below, TemplateTexts* texts,
                                   bool with_json) {
  std::map<std::string, fs::path> files;
  for (const fs::path& folder : folders) {
    NONIO_TRY(auto here, template_paths(folder));
    const std::string under = folder.filename() == causes_folder ? std::string(site_causes) : "";
    for (auto& [name, path] : here)
      if (under.empty() || is_causes_file(under + name)) files[under + name] = std::move(path);
  }
  for (const auto& [name, bytes] : own.files) files[name] = path_of(own, name);
  std::erase_if(files, [&](const auto& file) {
    return !below.empty() &&
           std::none_of(below.begin(), below.end(),
                        [&](const std::string& start) { return file.first.starts_with(start); });
  });
  Templates templates;
  Unread unread;
  std::string all;
  storage::Json carried = storage::Json::object();
  for (const auto& [name, path] : files) {
    const auto of_site = own.files.find(name);
    const bool is_installed = path == folders.front() / name;
    NONIO_TRY(const auto bytes, of_site == own.files.end()
                                    ? bytes_of(path, is_installed && !travels(name))
                                    : Expected<SharedBytes>(of_site->second));
    if (texts != nullptr) {
      const std::string sum = storage::sha256(bytes);
      all += line_of(name, sum);
      if (with_json)
        carried[name] = !travels(name)            ? storage::Json{{"sha256", sum}}
                        : name.ends_with(".toml") ? storage::Json{{"text", std::string_view(bytes)}}
                                                  : storage::Json{{"hex", to_hex(bytes)}};
    }
    if (const std::string language = language_of(name); is_installed && !language.empty())
      unread[language][name] = {bytes, path.string()};
    else if (auto kept = keep(templates, name, bytes, path.string()); !kept)
      return fail(kept.error());
  }
  if (auto done = complete(templates, std::move(unread)); !done) return fail(done.error());
  if (texts == nullptr) return templates;
  texts->sha256 = storage::sha256(all);
  if (with_json)
    texts->json = storage::dump(
        storage::Json{{"schema", "nonio-templates/1"}, {"files", std::move(carried)}});
  return templates;
}

std::vector<std::string> words_in(const std::string& language) {
  return {"words/en/", "words/" + language + "/", "causes/"};
}

Expected<CarriedTemplates> templates_from(std::string_view text, const Templates& installed,
                                          std::string_view installed_text) {
  const storage::Json json = storage::parse_or_discard(text),
                      ours = storage::parse_or_discard(installed_text);
  if (!json.is_object() || !json.contains("files") || !json["files"].is_object() ||
      storage::dump(json) != text)
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
    SharedBytes bytes;
    std::string sum;
    if (const auto digest = of("sha256"); digest && !travels(name)) {
      const auto own = installed.files.find(name);
      if (own == installed.files.end() || storage::sha256(own->second) != *digest)
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
    if (!known && travels(name)) out.strange.push_back(name);
    all += line_of(name, sum.empty() ? storage::sha256(bytes) : sum);
    if (auto kept = keep(out.templates, name, bytes, name); !kept) return fail(kept.error());
  }
  if (ours.is_object() && ours.contains("files"))
    for (const auto& [name, file] : ours["files"].items())
      if (!json["files"].contains(name) && travels(name)) out.strange.push_back(name);
  if (auto done = complete(out.templates, {}); !done) return fail(done.error());
  out.sha256 = storage::sha256(all);
  return out;
}

}  // namespace nonio::config
