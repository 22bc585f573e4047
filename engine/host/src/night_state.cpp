// SPDX-License-Identifier: Apache-2.0
#include "night_state.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
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
               {"force", night.force}};
  if (night.issued_before) json["issued_before"] = *night.issued_before;
  return publish(out / state_folder, {{state_name, dump(json)}});
}

}  // namespace

Expected<NightState> begin_night(const fs::path& out, bool force, bool dry_run,
                                 std::optional<std::uint64_t> issued_so_far) {
  NightState night;
  night.force = force;
  night.issued_before = issued_so_far;
  if (const auto file = MappedFile::open(out / state_folder / state_name)) {
    const Json json = Json::parse(file->bytes(), nullptr, false);
    if (json.is_discarded() || !json.is_object() || !json.contains("night") ||
        !json["night"].is_number_unsigned())
      return fail((out / state_folder / state_name).string() +
                  " is damaged; remove it to do every campaign anew");
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
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    return fail("another run is using the output folder " + out.string());
  }
  return OutputLock(fd);
}

OutputLock::OutputLock(OutputLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
OutputLock::~OutputLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace nonio::host
