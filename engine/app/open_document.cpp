// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/packed_results.h"
#include "shown_results.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct OpenWish {
  std::string folder, out;
};

Expected<Json> json_file(const fs::path& path) {
  NONIO_TRY(const auto text, storage::read_file(path));
  Json json = storage::parse_or_discard(text);
  if (json.is_discarded() || !json.is_object())
    return fail(path.string() + " is not a JSON object");
  return json;
}

Expected<fs::path> document_of(const fs::path& results) {
  NONIO_TRY(const auto json, json_file(results / evaluation::results_name));
  std::vector<std::string> files;
  for (const Json& o : json.value("outputs", Json::array()))
    if (o.is_object()) files.push_back(o.value("file", ""));
  std::stable_partition(files.begin(), files.end(),
                        [](const std::string& file) { return file.starts_with("report"); });
  for (const char* ending : {".pdf", ".html"})
    for (const std::string& file : files)
      if (file.ends_with(ending)) return results / file;
  return results / evaluation::results_name;
}

Expected<fs::path> document_of_night(const fs::path& out, const Common& common) {
  NONIO_TRY(const auto summary, json_file(out / "summary.json"));
  std::string first;
  for (const char* list : {"attention", "failed"})
    for (const Json& c : summary.value(list, Json::array())) {
      const std::string id = c.is_object() ? c.value("id", "") : "";
      if (id.empty()) continue;
      if (!common.quiet) std::cerr << status_word(list, STDERR_FILENO) << " " << id << "\n";
      if (first.empty()) first = id;
    }
  return first.empty() ? out / "summary.txt" : document_of(storage::results_folder(out, first));
}

Expected<fs::path> document(const OpenWish& wish, const Common& common) {
  const fs::path folder = !wish.folder.empty()                ? results_at(wish.folder)
                          : what_holds(".") != Holds::nothing ? fs::path(".")
                                                              : fs::path(wish.out);
  switch (what_holds(folder)) {
    case Holds::results:
      return document_of(folder);
    case Holds::run:
      return document_of_night(folder, common);
    case Holds::campaign: {
      const fs::path results = storage::results_folder(wish.out, id_of_campaign(folder));
      if (what_holds(results) == Holds::results) return document_of(results);
      return fail("there are no results of " + folder.string() + " in " + wish.out +
                  "; expected --out OUT, the folder that `nonio run` wrote them to");
    }
    case Holds::nothing:
      break;
  }
  return fail(holds_nothing(folder));
}

std::string no_desktop() {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr)
    return "there is no desktop here (neither DISPLAY nor WAYLAND_DISPLAY is set)";
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / "xdg-open").c_str(), X_OK) == 0) return {};
  return "xdg-open is not installed (Debian: xdg-utils)";
}

/// xdg-open gets its own session, so that it outlives this program and its terminal.
bool open_in_background(const std::string& path) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::string program = "xdg-open", argument = path;
  const std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  pid_t process = 0;
  const int error =
      posix_spawnp(&process, "xdg-open", &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error == 0;
}

}  // namespace

int open_document(const std::string& folder, const std::string& out, const Common& common) {
  const auto found = document({folder, out}, common);
  if (!found) return complain(text_of(found.error()));
  std::error_code error;
  const fs::path path = fs::absolute(*found).lexically_normal();
  if (const fs::path stored = storage::stored_in(path); stored != path)
    return complain(path.filename().string() + " is in the pack " + stored.string() +
                        "; `nonio export " + path.parent_path().filename().string() +
                        " --out OUT` writes it out",
                    exit_failed);
  if (!fs::is_regular_file(path, error))
    return complain("there is no " + path.string() + "; `nonio run` makes it anew", exit_failed);
  std::string why_not = no_desktop();
  if (why_not.empty() && !open_in_background(path.string())) why_not = "xdg-open cannot be started";
  if (common.json)
    print_json(
        Json{{"schema", "nonio-open/1"}, {"file", path.string()}, {"opened", why_not.empty()}});
  else
    std::cout << path.string() << "\n";
  if (!why_not.empty() && !common.quiet) complain("not opened: " + why_not);
  return exit_done;
}

}  // namespace nonio::app
