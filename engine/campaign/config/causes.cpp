// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/causes.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "campaign/config/checks.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::config {

namespace {

constexpr int values_of_a_range = 24;

/// Returns the path of the file in the site or in the templates, for messages.
std::string place_of(std::string_view name) {
  return name.starts_with(site_causes)
             ? std::string(causes_folder) + "/" + std::string(name.substr(site_causes.size()))
             : std::string(templates_folder) + "/" + std::string(name);
}

}  // namespace

void check_cause(TableReader& reader, Cause& c, Causes& causes) {
  c.file = reader.file();
  c.formula.line = reader.line_of("expression");
  for (const char* language : {"", "en"})
    if (const auto found = c.titles.find(language); found != c.titles.end())
      c.title = found->second;
  if (c.title.empty() && reader.contains("title"))
    reader.error("title", "expected a text, or one for en among the texts by language");
  const auto [first, is_new] = causes.places->try_emplace(
      c.formula.name, c.file + ":" + std::to_string(reader.line_of("name")));
  if (!is_new)
    reader.error("name", "\"" + c.formula.name + "\" is in " + first->second +
                             " already; give one of them another name");
  if (!reader.has_errors() && causes.of_site)
    if (const auto effect = c.effect(false); !effect)
      reader.error("expression", effect.error().message);
}

double Cause::price() const {
  return 2.0 * std::log(prior == "very-rare" ? 100.0 : prior == "rare" ? 10.0 : 1.0);
}

Expected<Effect> Cause::effect(bool tried) const {
  Axis axis;
  axis.rotary = rotary;
  auto made = formula_effect(formula, axis, tried, values_of_a_range);
  if (!made) return made;
  made->info.summary = title;
  made->compensable = compensable;
  if (std::find(columns.begin(), columns.end(), "time_s") != columns.end())
    made->applies = [inner = made->applies](const Observations& o, const Axis& a) {
      if (!inner(o, a)) return false;
      const auto r = readings_of(o, a);
      return r && r->timed;
    };
  return made;
}

bool is_causes_file(std::string_view name) {
  const std::size_t under = name.starts_with(site_causes) ? site_causes.size()
                            : name.starts_with("causes/") ? std::string_view("causes/").size()
                                                          : 0;
  return under > 0 && name.ends_with(".toml") && name.find('/', under) == std::string_view::npos &&
         name.substr(under) != manifest_name;
}

namespace {

struct Read {
  std::map<std::string, std::string> files;
  std::vector<Cause> causes{};
  std::vector<Error> errors{}, warnings{};
};

void read_file(const std::string& name, std::string_view text,
               std::map<std::string, std::string>& there, Read& out) {
  const std::string file = place_of(name);
  auto root = parse_toml(text, file);
  if (!root) {
    out.errors.push_back(root.error());
    return;
  }
  for (Error& warning : warnings_of(rename_former_keys(*root, causes_file()), file))
    out.warnings.push_back(std::move(warning));
  TableReader top(*root, causes_file(), file, out.errors);
  Causes causes{.places = &there, .of_site = name.starts_with(site_causes)};
  top.fill(causes);
  top.finish();
  std::move(causes.all.begin(), causes.all.end(), std::back_inserter(out.causes));
}

/// The last result is kept, because every campaign needs it.
std::shared_ptr<const Read> read_in(const Templates& templates) {
  static std::mutex one_at_a_time;
  static std::shared_ptr<const Read> last;
  std::map<std::string_view, std::string_view> files;
  for (const auto& [name, text] : templates.files)
    if (is_causes_file(name)) files[name] = text;
  const std::lock_guard lock(one_at_a_time);
  const auto same = [](const auto& a, const auto& b) {
    return a.first == b.first && a.second == b.second;
  };
  if (last && std::equal(files.begin(), files.end(), last->files.begin(), last->files.end(), same))
    return last;
  Read now{{files.begin(), files.end()}};
  std::map<std::string, std::string> there;  // file and line of each cause, by its name
  for (const auto& [name, text] : now.files) read_file(name, text, there, now);
  last = std::make_shared<const Read>(std::move(now));
  return last;
}

}  // namespace

Checked<Library> causes_in(const Templates& templates) {
  const auto read = read_in(templates);
  if (!read->errors.empty()) return tl::unexpected(read->errors);
  return Library(read, &read->causes);
}

std::vector<Error> warnings_of_causes(const Templates& templates) {
  return read_in(templates)->warnings;
}

void add_words(const std::vector<Cause>& causes, const std::string& language,
               TemplateTables::Map& tables) {
  for (const Cause& c : causes) {
    const std::string at = "effect." + c.formula.name + ".";
    const auto put = [&](const char* key, const std::string& text) {
      if (!text.empty()) tables["words/" + language + "/causes"].values[at + key] = text;
    };
    if (language == "en") {
      put("title", c.title), put("is", c.is), put("size", c.size);
      put("appearance", c.appearance), put("similar", c.similar), put("remedy", c.remedy);
    } else if (const auto title = c.titles.find(language); title != c.titles.end()) {
      put("title", title->second);
    }
  }
}

}  // namespace nonio::config
