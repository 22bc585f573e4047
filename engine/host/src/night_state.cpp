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

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

constexpr const char* state_folder = ".nonio";
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
