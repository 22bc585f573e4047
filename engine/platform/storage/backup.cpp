// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/backup.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "platform/storage/database.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"
#include "platform/storage/tar.h"

namespace nonio::storage {
namespace fs = std::filesystem;

namespace {

Error of_system(const fs::path& path) { return Error{std::strerror(errno), path.string()}; }

/// Packs are not regarded as databases: they never change, and their name contains their digest.
bool is_database(const fs::path& path) {
  constexpr std::string_view magic("SQLite format 3\0", 16);
  std::string head(magic.size(), '\0');
  return path.extension() != pack_suffix &&
         std::ifstream(path, std::ios::binary).read(head.data(), 16) && head == magic;
}

bool is_passing(const fs::path& path, const std::set<fs::path>& databases) {
  const std::string name = path.filename().string();
  if (is_temporary_name(name) || name == backup_digests) return true;
  if (path.parent_path().filename() == ".nonio" && (name == "lock" || name == "user")) return true;
  for (const char* suffix : {"-journal", "-wal", "-shm"})
    if (name.ends_with(suffix) &&
        databases.contains(path.parent_path() / name.substr(0, name.size() - strlen(suffix))))
      return true;
  return false;
}

using FileState = std::array<std::int64_t, 5>;

class Backup {
 public:
  Backup(const fs::path& folder, TarWriter& tar) : folder_(folder), tar_(tar) {}

  Expected<BackupSummary> write() {
    if (auto done = list(); !done) return fail(done.error());
    for (const fs::path& path : identities_) {
      const auto state = [&] {
        States one;
        note_state(path, one);
        return Expected<States>(std::move(one));
      };
      if (auto done = add_until_same(state, path); !done) return fail(done.error());
    }
    for (const fs::path& path : databases_)
      if (auto done = add_database(path); !done) return fail(done.error());
    for (const fs::path& path : folders_)
      if (auto done = add_folder(path); !done) return fail(done.error());
    const TarEntry last{.name = backup_digests, .mode = 0644, .size = digests_.size()};
    auto done = tar_.add(last, [&](const auto& take) -> Expected<void> {
      take(digests_);
      return {};
    });
    if (done) done = tar_.end();
    if (!done) return fail(done.error());
    return std::move(summary_);
  }

 private:
  Expected<void> list() {
    std::error_code error;
    folders_.push_back(folder_);
    std::vector<fs::path> files;
    for (fs::recursive_directory_iterator it(folder_, error), end; !error && it != end;
         it.increment(error)) {
      if (it->is_symlink()) continue;
      if (it->is_directory()) folders_.push_back(it->path());
      if (it->is_regular_file()) files.push_back(it->path());
    }
    if (error) return fail(Error{error.message(), folder_.string()});
    std::sort(folders_.begin(), folders_.end());
    for (const fs::path& path : files) {
      if (is_database(path) && !is_passing(path, {})) databases_.insert(path);
      if (path.extension() == ".identity" || path.filename() == "certificates.register")
        identities_.insert(path);
    }
    return {};
  }

  std::string name_of(const fs::path& path) const {
    return path.lexically_relative(folder_).generic_string();
  }

  Expected<void> add(const fs::path& path, const fs::path& from) {
    struct stat of {};
    if (::lstat(path.c_str(), &of) != 0) return fail(of_system(path));
    TarEntry entry{.name = name_of(path),
                   .mode = of.st_mode & 07777U,
                   .changed = static_cast<std::int64_t>(of.st_mtime)};
    if (entry.name.find_first_of("\n\\") != std::string::npos)
      return fail(
          Error{"expected a name without line feed and backslash", path_text(path.native())});
    if (S_ISLNK(of.st_mode)) {
      std::error_code error;
      entry.kind = TarEntry::Kind::link;
      entry.target = fs::read_symlink(path, error).string();
      if (const auto to = fs::weakly_canonical(path, error).lexically_relative(folder_);
          !error && (to.empty() || *to.begin() == ".."))
        summary_.left_out.push_back(entry.name);
      return error ? fail(Error{error.message(), path.string()}) : tar_.add(entry);
    }
    if (!S_ISREG(of.st_mode)) {
      summary_.left_out.push_back(entry.name);
      return {};
    }
    std::error_code error;
    entry.size = fs::file_size(from, error);
    if (error) return fail(Error{error.message(), from.string()});
    RunningDigest digest;
    auto done = tar_.add(entry, [&](const auto& take) {
      return read_parts(from, [&](std::string_view part) {
        digest.add(part);
        take(part);
      });
    });
    if (!done) return done;
    digests_ += digest.hex() + "  " + entry.name + "\n";
    ++summary_.files;
    summary_.bytes += entry.size;
    return {};
  }

  Expected<void> add_database(const fs::path& path) {
    const ScratchFolder scratch("backup");
    const fs::path copy = scratch.path() / "copy";
    if (scratch.path().empty()) return fail("no folder for temporary files could be made");
    if (auto done = copy_database(path, copy); !done) return done;
    NONIO_TRY(auto database, Database::open(copy, Database::Use::read));
    const std::string sound = database.first("PRAGMA quick_check(1)");
    if (auto well = database.take_error(); !well || sound != "ok")
      return fail(Error{"the database is damaged: " + (well ? sound : well.error().message),
                        path.string()});
    return add(path, copy);
  }

  using States = std::map<fs::path, FileState>;

  static void note_state(const fs::path& path, States& states) {
    struct stat of {};
    if (::lstat(path.c_str(), &of) == 0 && !S_ISDIR(of.st_mode))
      states[path] = {static_cast<std::int64_t>(of.st_ino), of.st_size, of.st_mtim.tv_sec,
                      of.st_mtim.tv_nsec, static_cast<std::int64_t>(of.st_mode)};
  }

  Expected<States> states_in(const fs::path& folder) const {
    States states;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      const fs::path& path = it->path();
      if (!databases_.contains(path) && !identities_.contains(path) &&
          !is_passing(path, databases_))
        note_state(path, states);
    }
    if (error && error != std::errc::no_such_file_or_directory)
      return fail(Error{error.message(), folder.string()});
    return states;
  }

  Expected<void> add_folder(const fs::path& folder) {
    struct stat of {};
    if (::lstat(folder.c_str(), &of) != 0) return {};
    if (folder != folder_)
      if (auto done = tar_.add({.name = name_of(folder),
                                .kind = TarEntry::Kind::folder,
                                .mode = of.st_mode & 07777U,
                                .changed = static_cast<std::int64_t>(of.st_mtime)});
          !done)
        return done;
    return add_until_same([&] { return states_in(folder); }, folder);
  }

  Expected<void> add_until_same(const std::function<Expected<States>()>& states,
                                const fs::path& of) {
    constexpr int most = 50;
    constexpr std::chrono::milliseconds pause{100};
    const std::int64_t position = tar_.position();
    for (int attempt = 0; attempt < most; ++attempt) {
      const std::size_t listed = digests_.size();
      const BackupSummary summary = summary_;
      NONIO_TRY(const auto before, states());
      Expected<void> done;
      for (const auto& [path, state] : before)
        if (done = add(path, path); !done) break;
      NONIO_TRY(const auto after, states());
      if (before == after) return done;
      digests_.resize(listed);
      summary_ = summary;
      if (auto back = tar_.back_to(position); !back) return back;
      std::this_thread::sleep_for(pause);
    }
    return fail(Error{"the files change all the time", of.string()});
  }

  const fs::path folder_;
  TarWriter& tar_;
  std::vector<fs::path> folders_{};
  std::set<fs::path> identities_{}, databases_{};
  std::string digests_{};
  BackupSummary summary_{};
};

bool is_safe(const std::string& name) {
  const fs::path path(name);
  return !name.empty() && !path.is_absolute() && name.find('\0') == std::string::npos &&
         std::none_of(path.begin(), path.end(),
                      [](const fs::path& part) { return part == ".." || part == "."; });
}

class Restore {
 public:
  Restore(const fs::path& file, fs::path into) : file_(file), into_(std::move(into)) {}

  Expected<BackupSummary> read() {
    auto done = read_tar(file_, {[&](const TarEntry& entry) { return begin(entry); },
                                 [&](std::string_view part) { return take(part); }});
    if (done) done = end_file();
    if (done) done = below_no_link();
    if (done) done = compare();
    if (done && !into_.empty()) done = finish();
    if (!done) return fail(done.error());
    return std::move(summary_);
  }

 private:
  Expected<void> wrong(const std::string& why) const {
    return fail(Error{"is no sound backup: " + why, file_.string()});
  }

  Expected<void> begin(const TarEntry& entry) {
    if (auto done = end_file(); !done) return done;
    if (!is_safe(entry.name)) return wrong("it has a name outside of its folder: " + entry.name);
    if (!names_.insert(entry.name).second) return wrong("it has " + entry.name + " twice");
    if (entry.kind == TarEntry::Kind::link) links_.insert(entry.name);
    now_ = entry;
    if (entry.kind == TarEntry::Kind::file) digest_.emplace();
    if (entry.name == backup_digests || into_.empty()) return {};
    if (entry.kind != TarEntry::Kind::file) {
      later_.push_back(entry);
      return {};
    }
    const fs::path path = into_ / entry.name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) return fail(Error{error.message(), path.string()});
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    return fd_ < 0 ? Expected<void>(fail(of_system(path))) : Expected<void>();
  }

  Expected<void> take(std::string_view part) {
    if (digest_) digest_->add(part);
    if (now_.name == backup_digests) {
      list_ += part;
      constexpr std::size_t most = 1U << 30U;
      return list_.size() > most ? wrong("its list of digests is too long") : Expected<void>();
    }
    while (fd_ >= 0 && !part.empty()) {
      const ssize_t written = ::write(fd_, part.data(), part.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return fail(of_system(into_ / now_.name));
      part.remove_prefix(static_cast<std::size_t>(written));
    }
    return {};
  }

  Expected<void> end_file() {
    if (digest_ && now_.name != backup_digests) {
      digests_[now_.name] = digest_->hex();
      ++summary_.files;
      summary_.bytes += now_.size;
    }
    digest_.reset();
    if (fd_ < 0) return {};
    const timespec times[2] = {{now_.changed, 0}, {now_.changed, 0}};
    const bool well =
        ::fchmod(fd_, now_.mode & 0777U) == 0 && ::futimens(fd_, times) == 0 && ::fsync(fd_) == 0;
    const Error error = of_system(into_ / now_.name);
    ::close(fd_);
    fd_ = -1;
    return well ? Expected<void>() : fail(error);
  }

  /// Rejects an archive with a name below a link, because that file would be written to the target
  /// of the link.
  Expected<void> below_no_link() const {
    for (const std::string& name : names_)
      for (fs::path above = fs::path(name).parent_path(); !links_.empty() && !above.empty();
           above = above.parent_path())
        if (links_.contains(above.string())) return wrong("it has a name below a link: " + name);
    return {};
  }

  Expected<void> compare() const {
    std::map<std::string, std::string> listed;
    for (std::size_t at = 0; at < list_.size();) {
      const std::size_t end = std::min(list_.find('\n', at), list_.size());
      const std::string line = list_.substr(at, end - at);
      if (line.size() > 66) listed[line.substr(66)] = line.substr(0, 64);
      at = end + 1;
    }
    if (!names_.contains(backup_digests)) return wrong("it has no " + std::string(backup_digests));
    for (const auto& [name, sha256] : listed) {
      const auto found = digests_.find(name);
      if (found == digests_.end()) return wrong(name + " is missing");
      if (found->second != sha256) return wrong(name + " does not have its SHA-256");
    }
    for (const auto& [name, sha256] : digests_)
      if (!listed.contains(name)) return wrong(name + " is not in its list of digests");
    return {};
  }

  /// Links are created last, so that no file is written through one; permissions are set from the
  /// innermost folder outwards.
  Expected<void> finish() const {
    std::error_code error;
    for (const bool link : {false, true})
      for (const TarEntry& entry : later_) {
        const fs::path path = into_ / entry.name;
        if ((entry.kind == TarEntry::Kind::link) != link) continue;
        fs::create_directories(link ? path.parent_path() : path, error);
        if (!error && link) fs::create_symlink(entry.target, path, error);
        if (error) return fail(Error{error.message(), path.string()});
      }
    for (auto entry = later_.rbegin(); entry != later_.rend(); ++entry)
      if (entry->kind == TarEntry::Kind::folder &&
          ::chmod((into_ / entry->name).c_str(), entry->mode & 0777U) != 0)
        return fail(of_system(into_ / entry->name));
    return {};
  }

  const fs::path& file_;
  const fs::path into_;
  TarEntry now_{};
  std::optional<RunningDigest> digest_{};
  int fd_ = -1;
  std::string list_{};
  std::set<std::string> names_{}, links_{};
  std::map<std::string, std::string> digests_{};
  std::vector<TarEntry> later_{};
  BackupSummary summary_{};
};

}  // namespace

Expected<BackupSummary> write_backup(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path from = fs::canonical(folder, error);
  if (error) return fail(Error{error.message(), folder.string()});
  const fs::path to = fs::weakly_canonical(fs::absolute(file), error);
  NONIO_TRY(const bool there, is_there(to));
  if (there) return fail(Error{"exists already; expected a new file", file.string()});
  const fs::path way = to.lexically_relative(from);
  if (!way.empty() && *way.begin() != "..")
    return fail(Error{"is in the folder itself; expected it elsewhere", file.string()});
  const fs::path temporary = temporary_path(to.parent_path(), to.filename().string());
  const auto written = [&]() -> Expected<BackupSummary> {
    NONIO_TRY(auto tar, TarWriter::create(temporary));
    NONIO_TRY(auto summary, Backup(from, tar).write());
    drop_cached(temporary);
    NONIO_TRY(const auto read, Restore(temporary, {}).read());
    if (auto done = rename_temporaries(to.parent_path(), {to.filename().string()}); !done)
      return fail(done.error());
    return summary;
  }();
  if (!written) remove_temporaries(to.parent_path(), {to.filename().string()});
  return written;
}

Expected<BackupSummary> restore_backup(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path to = fs::absolute(folder / "", error).parent_path().lexically_normal();
  const auto status = fs::symlink_status(to, error);
  if (fs::exists(status) && (!fs::is_directory(status) || !fs::is_empty(to, error) || error))
    return fail(Error{"has content; expected a new or an empty folder", folder.string()});
  if (const auto sound = Restore(file, {}).read(); !sound) return fail(sound.error());
  const fs::path temporary = temporary_path(to.parent_path(), to.filename().string());
  fs::create_directories(to.parent_path(), error);
  if (!error && !fs::create_directory(temporary, error) && !error)
    return fail(Error{"exists already: another restore is running, or was interrupted; remove it",
                      temporary.string()});
  // The original permissions are not known yet, and a site may contain keys and passwords.
  if (!error) fs::permissions(temporary, fs::perms::owner_all, error);
  if (error) return fail(Error{error.message(), temporary.string()});
  auto restored = Restore(file, temporary).read();
  if (restored) fs::rename(temporary, to, error);
  if (restored && error) restored = fail(Error{error.message(), to.string()});
  if (!restored) fs::remove_all(temporary, error);
  return restored;
}

}  // namespace nonio::storage
