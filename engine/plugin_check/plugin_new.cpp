// SPDX-License-Identifier: Apache-2.0
#include "plugin_check/plugin_new.h"

#include <algorithm>

#include "platform/storage/files.h"
#include "platform/storage/nearest.h"

namespace nonio::plugin_check {
namespace fs = std::filesystem;

namespace {

bool is_name_of_plugin(const std::string& name) {
  const auto small = [](char c) { return c >= 'a' && c <= 'z'; };
  return !name.empty() && name.size() <= 60 && small(name.front()) && name.back() != '-' &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return small(c) || (c >= '0' && c <= '9') || c == '-'; });
}

std::string with_names(std::string text, const std::string& name) {
  std::string file = name;
  std::replace(file.begin(), file.end(), '-', '_');
  for (const auto& [place, word] :
       {std::pair<std::string, std::string>{"@name@", name}, {"@file@", file}})
    for (std::size_t at = 0; (at = text.find(place, at)) != text.npos; at += word.size())
      text.replace(at, place.size(), word);
  return text;
}

std::vector<std::string> kinds_in(const fs::path& skeletons) {
  std::vector<std::string> kinds;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(skeletons, error))
    if (entry.is_directory()) kinds.push_back(entry.path().filename().string());
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

}  // namespace

Expected<std::vector<std::string>> new_plugin(const fs::path& skeletons, const std::string& kind,
                                              const std::string& name, const fs::path& folder) {
  const auto kinds = kinds_in(skeletons);
  if (kinds.empty())
    return fail("what a plugin begins with is not in " + skeletons.string() +
                "; it belongs to the headers: on Debian, the package libnonio-dev");
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    std::string list;
    for (const std::string& k : kinds) list += (list.empty() ? "" : ", ") + k;
    return fail("there is no kind \"" + kind + "\"" + storage::suggestion(kind, kinds) +
                "; there are " + list);
  }
  if (!is_name_of_plugin(name))
    return fail("the name \"" + name +
                "\": expected small letters, digits and '-', a letter first");
  if (fs::exists(fs::symlink_status(folder)))
    return fail(folder.string() + " exists: nothing is written over it");
  std::vector<fs::path> sources;
  for (const auto& entry : fs::recursive_directory_iterator(skeletons / kind))
    if (entry.is_regular_file() && entry.path().extension() == ".in")
      sources.push_back(entry.path());
  std::sort(sources.begin(), sources.end());
  std::vector<std::string> written;
  for (const fs::path& source : sources) {
    NONIO_TRY(const auto text, storage::read_file(source));
    const std::string relative = source.lexically_relative(skeletons / kind).string();
    const fs::path target = folder / with_names(relative.substr(0, relative.size() - 3), name);
    const Artifact file{target.filename().string(), with_names(text, name)};
    if (auto done = storage::publish(target.parent_path(), {file}); !done)
      return fail(done.error());
    written.push_back(target.string());
  }
  return written;
}

}  // namespace nonio::plugin_check
