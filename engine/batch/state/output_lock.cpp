// SPDX-License-Identifier: Apache-2.0
#include "batch/state/output_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "batch/state/run_state.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {
namespace fs = std::filesystem;
using storage::Json;

namespace {

constexpr const char* user_name = "user";

/// Content of OUT/.nonio/user. `machine` and `boot` identify the host and its present boot; empty
/// if unknown.
struct User {
  std::string host, machine, boot, job;
  long pid = 0;
};

std::string first_line(const char* path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

User own_user() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  const char* const job = std::getenv("NONIO_JOB");
  return {host.data(), first_line("/etc/machine-id"), first_line("/proc/sys/kernel/random/boot_id"),
          job != nullptr ? job : "", static_cast<long>(::getpid())};
}

std::string text_of(const User& user) {
  return storage::dump_line({{"host", user.host},
                             {"pid", user.pid},
                             {"job", user.job},
                             {"machine", user.machine},
                             {"boot", user.boot}}) +
         "\n";
}

/// An unreadable file gives a user without a host name, which blocks the folder too.
User user_in(const std::string& text) {
  const Json json = storage::parse_or_discard(text);
  if (!json.is_object()) return {};
  const auto word = [&](const char* key) {
    const auto it = json.find(key);
    return it != json.end() && it->is_string() ? it->get<std::string>() : "";
  };
  User user{word("host"), word("machine"), word("boot"), word("job")};
  if (const auto pid = json.find("pid"); pid != json.end() && pid->is_number_integer())
    user.pid = pid->get<long>();
  return user;
}

std::string words_for(const User& user) {
  if (user.host.empty()) return "a process of unknown name";
  return "process " + std::to_string(user.pid) + " on host " + user.host +
         (user.job.empty() ? "" : " (job " + user.job + ")");
}

/// Whether the process is known to have ended. The caller must have the flock of this host.
bool is_gone(const User& user, const User& own) {
  // A running process of this boot would have the flock.
  if (!user.boot.empty() && user.boot == own.boot) return true;
  return !user.machine.empty() && user.machine == own.machine && user.host == own.host;
}

/// Returns std::nullopt if the file does not exist.
Expected<std::optional<std::string>> read_user(const fs::path& path) {
  NONIO_TRY(const auto there, storage::is_there(path));
  if (!there) return std::nullopt;
  auto text = storage::read_small_file(path);
  if (text) return *text;
  const auto still = storage::is_there(path);
  if (still && !*still) return std::nullopt;
  return fail(text.error());
}

std::string temporary(const fs::path& path, const User& own) {
  return path.string() + "-" + own.boot.substr(0, own.boot.find('-')) + "-";
}

/// Removes temporary files of killed processes of this host. The caller must have the flock.
void sweep(const fs::path& path, const User& own) {
  const std::string front = temporary(path, own), all = path.string() + "-";
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path.parent_path(), error)) {
    const std::string file = entry.path().string();
    if (!file.starts_with(all)) continue;
    const auto text = storage::read_small_file(entry.path());  // of an earlier boot, if whole
    if (file.starts_with(front) || (text && is_gone(user_in(*text), own))) ::unlink(file.c_str());
  }
}

void remove_temporary(const std::string& path) {
  if (::unlink(path.c_str()) != 0) ::unlink(path.c_str());
}

enum class Made { done, taken, no_links };

/// Creates the file atomically by link(2), unless it exists. A network file system may report
/// EEXIST after a successful but repeated request; the link count 2 proves the success.
Expected<Made> make_user(const fs::path& path, const User& user, const std::string& says) {
  std::string own = temporary(path, user) + "XXXXXX";  // mkostemp replaces XXXXXX
  const int fd = ::mkostemp(own.data(), O_CLOEXEC);
  if (fd < 0) return fail("cannot write " + own + ": " + std::strerror(errno));
  const bool written = ::write(fd, says.data(), says.size()) == static_cast<ssize_t>(says.size()) &&
                       ::fchmod(fd, 0644) == 0 && ::fsync(fd) == 0;
  const int trouble = written ? 0 : errno;
  ::close(fd);
  if (!written) {
    remove_temporary(own);
    return fail("cannot write " + own + ": " + std::strerror(trouble));
  }
  const int linked = ::link(own.c_str(), path.c_str()) == 0 ? 0 : errno;
  struct stat state {};
  const bool two_names = ::stat(own.c_str(), &state) == 0 && state.st_nlink == 2;
  remove_temporary(own);
  if (linked == 0 || two_names) return Made::done;
  if (linked == EEXIST) return Made::taken;
  if (linked == EPERM || linked == EOPNOTSUPP || linked == ENOSYS || linked == EMLINK)
    // FAT and some network shares have no hard links; flock alone protects the folder.
    return Made::no_links;
  return fail("cannot write " + path.string() + ": " + std::strerror(linked));
}

/// Returns false on file systems without hard links, where only flock protects the folder. An error
/// if another process uses the folder.
Expected<bool> become_user(const fs::path& out, const fs::path& path, const User& own,
                           const std::string& says) {
  sweep(path, own);
  for (int i = 0; i < 5; ++i) {
    NONIO_TRY(const auto made, make_user(path, own, says));
    if (made != Made::taken) return made == Made::done;
    NONIO_TRY(const auto text, read_user(path));
    if (!text) continue;
    const User user = user_in(*text);
    if (!is_gone(user, own))
      return fail(words_for(user) + " is using the output folder " + out.string() +
                  ". Wait until it ends. If you are sure that it has ended: nonio run unlock " +
                  out.string());
    ::unlink(path.c_str());
  }
  return fail("cannot take the output folder " + out.string() + ": others take it all the time");
}

bool is_line_of(const std::string& text, const std::string& wanted) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (line == wanted) return true;
  return false;
}

int open_lock(const fs::path& out, int how) {
  return ::open((out / state_folder / "lock").c_str(), how | O_CLOEXEC, 0644);
}

bool is_held(const fs::path& out) {
  const int fd = open_lock(out, O_RDONLY);
  const bool held = fd >= 0 && ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (fd >= 0) ::close(fd);
  return held;
}

}  // namespace

std::string user_of(const fs::path& out) {
  const auto text = read_user(out / state_folder / user_name);
  const std::string named = text && *text ? words_for(user_in(**text)) : "";
  if (is_held(out)) return named.empty() ? "a process" : named;
  return named.empty() || is_gone(user_in(**text), own_user()) ? "" : named;
}

Expected<std::string> unlock(const fs::path& out, const std::optional<std::string>& alive) {
  const fs::path path = out / state_folder / user_name;
  NONIO_TRY(const auto text, read_user(path));
  if (!text) return std::string();
  const User user = user_in(*text);
  if (alive && user.job.empty())
    return fail(words_for(user) + ", which uses the output folder " + out.string() +
                ", was not started by a batch job. If you are sure that it has ended, repeat "
                "without --alive");
  if (alive && is_line_of(*alive, user.job))
    return fail(words_for(user) + " is using the output folder " + out.string() +
                ", and its job is alive; expected its end");
  if (is_held(out))
    return fail(words_for(user) + " holds the lock of the output folder " + out.string() +
                ", so it is not gone; expected its end");
  if (::unlink(path.c_str()) != 0 && errno != ENOENT)
    return fail("cannot remove " + path.string() + ": " + std::strerror(errno));
  return words_for(user);
}

Expected<OutputLock> OutputLock::take(const fs::path& out, Use use) {
  std::error_code error;
  fs::create_directories(out / state_folder, error);
  if (error) return fail("cannot use the output folder " + out.string() + ": " + error.message());
  const int fd = open_lock(out, O_RDWR | O_CREAT);
  if (fd < 0)
    return fail("cannot use the output folder " + out.string() + ": " + std::strerror(errno));
  OutputLock lock(fd);
  // Child processes of a killed run may end with a delay, so the lock is tried repeatedly.
  constexpr int tries = 50;
  int code = EWOULDBLOCK;
  for (int i = 0; i < tries && (code == EWOULDBLOCK || code == EINTR); ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    code = ::flock(fd, (use == Use::shard ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0 ? 0 : errno;
  }
  if (code == EWOULDBLOCK || code == EINTR)
    return fail((use == Use::planned ? "a run, or a shard of one, is using the output folder "
                                     : "another run is using the output folder ") +
                out.string());
  if (code != 0)
    return fail("cannot lock " + (out / state_folder / "lock").string() + ": " +
                std::strerror(code) +
                "; expected an output folder on a file system with locks (flock)");
  if (use == Use::shard) return lock;
  const User own = own_user();
  const fs::path path = out / state_folder / user_name;
  std::string says = text_of(own);
  NONIO_TRY(const auto ours, become_user(out, path, own, says));
  if (ours) {
    lock.user_ = path;
    lock.says_ = std::move(says);
    lock.pid_ = own.pid;
  }
  if (use == Use::planned) return lock;
  if (const auto free = check_not_planned(out); !free) return fail(free.error());
  return lock;
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      user_(std::exchange(other.user_, {})),
      says_(std::exchange(other.says_, {})),
      pid_(other.pid_) {}

OutputLock::~OutputLock() {
  if (fd_ < 0) return;
  if (!user_.empty() && pid_ == static_cast<long>(::getpid())) {
    const auto text = read_user(user_);
    if (text && *text == says_) ::unlink(user_.c_str());
  }
  // Releases the lock also for a child process that remains because its disk hangs.
  ::flock(fd_, LOCK_UN);
  ::close(fd_);
}

}  // namespace nonio::batch
