// SPDX-License-Identifier: Apache-2.0
#include "night_state.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "json_values.h"
#include "nonio/host/files.h"
#include "nonio/host/record.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

constexpr const char* state_name = "night.json";

Expected<void> write_state(const fs::path& out, const NightState& night, bool running) {
  Json json = {{"schema", "nonio-night/1"},
               {"night", night.number},
               {"state", running ? "running" : "complete"},
               {"force", night.force},
               {"site", night.site}};
  if (night.issued_before) json["issued_before"] = *night.issued_before;
  return publish(out / state_folder, {{state_name, dump(json)}});
}

/// Why the results of `site` may not go among those of `other`; empty if they may. A site that was
/// moved is the same one under another name, and its old folder is gone.
std::string other_site(const std::string& other, const std::string& site, const fs::path& out) {
  std::error_code error;
  if (other.empty() || other == site || !fs::is_directory(other, error) ||
      fs::equivalent(other, site, error))
    return {};
  return "the output folder " + out.string() + " holds the results of the site " + other +
         "; wanted a folder of its own for " + site;
}

/// How the first results that are met in an output folder lie; nothing if there are none.
std::optional<bool> lie_hashed(const fs::path& out) {
  std::error_code error;
  const auto has_results = [&](const fs::path& folder) {
    return fs::exists(folder / record_name, error);
  };
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    if (has_results(it->path())) return false;
    if (it->path().filename().string().size() != 2) continue;
    std::error_code ignored;
    for (const auto& inner : fs::directory_iterator(it->path(), ignored))
      if (has_results(inner.path())) return true;
  }
  return std::nullopt;
}

}  // namespace

Expected<NightState> begin_night(const fs::path& out, const fs::path& site, bool force,
                                 bool dry_run, std::optional<std::uint64_t> issued_so_far) {
  NightState night;
  std::error_code error;
  night.site = fs::weakly_canonical(site, error).string();
  night.force = force;
  night.issued_before = issued_so_far;
  if (const auto file = MappedFile::open(out / state_folder / state_name)) {
    const Json json = Json::parse(file->bytes(), nullptr, false);
    if (json.is_discarded() || !json.is_object() || !json.contains("night") ||
        !json["night"].is_number_unsigned())
      return fail((out / state_folder / state_name).string() +
                  " is damaged; remove it to do every campaign anew");
    if (const auto other = json.find("site"); other != json.end() && other->is_string())
      if (std::string why = other_site(other->get<std::string>(), night.site, out); !why.empty())
        return fail(std::move(why));
    night.resumed = json.value("state", "") == "running";
    night.number = json["night"].get<std::uint64_t>() + (night.resumed ? 0 : 1);
    // A forced run that was interrupted is finished as what it was.
    if (night.resumed) night.force = force || json.value("force", false);
    if (json.contains("issued_before") && json["issued_before"].is_number_unsigned())
      night.issued_before = json["issued_before"].get<std::uint64_t>();
  }
  if (dry_run) return night;
  if (auto written = write_state(out, night, true); !written) return fail(written.error());
  return night;
}

Expected<void> end_night(const fs::path& out, const NightState& night) {
  return write_state(out, night, false);
}

Expected<void> settle_folders(const fs::path& out, bool hashed, bool dry_run) {
  const auto marked = is_there(out / hashed_mark);
  if (!marked) return fail(marked.error());
  if (*marked && hashed) return {};
  const auto begun = is_there(out / state_folder / state_name);
  if (!begun) return fail(begun.error());
  const bool are_hashed = *marked || (!*begun && lie_hashed(out) == true);
  const bool are_flat = !are_hashed && (*begun || lie_hashed(out) == false);
  if (hashed ? are_flat : are_hashed)
    return fail("the output folder " + out.string() + " has its results in OUT/" +
                (hashed ? "<id>" : "ab/<id>") + ", and site.toml wants them in OUT/" +
                (hashed ? "ab/<id> ([results] folders = \"hashed\")" : "<id>") +
                "; wanted a new output folder, or the layout that is there");
  if (dry_run || !hashed) return {};
  return publish((out / hashed_mark).parent_path(),
                 {{(out / hashed_mark).filename().string(), "OUT/ab/<id>\n"}});
}

Expected<OutputLock> OutputLock::take(const fs::path& out) {
  std::error_code error;
  fs::create_directories(out / state_folder, error);
  if (error) return fail("cannot use the output folder " + out.string() + ": " + error.message());
  const fs::path path = out / state_folder / "lock";
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0)
    return fail("cannot use the output folder " + out.string() + ": " + std::strerror(errno));
  // What was killed has processes that end a moment later, as soon as the disk lets them.
  constexpr int tries = 50;
  for (int i = 0; i < tries; ++i) {
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return OutputLock(fd);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  ::close(fd);
  return fail("another run is using the output folder " + out.string());
}

OutputLock::OutputLock(OutputLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
OutputLock::~OutputLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace nonio::host
