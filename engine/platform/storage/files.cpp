// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/files.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>

#include "platform/storage/digest.h"
#include "platform/storage/pack.h"

namespace nonio::storage {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view leftover_suffix = ".nonio-tmp";

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_;
};

std::function<int(const fs::path&)>& opener() {
  static std::function<int(const fs::path&)> set;
  return set;
}

/// O_NONBLOCK, because a named pipe must not block the run.
Descriptor open_to_read(const fs::path& path) {
  if (opener()) return Descriptor(opener()(path));
  return Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
}

tl::unexpected<Error> system_error(std::string_view what, const fs::path& path) {
  const int code = errno;
  return fail(std::string(what) + " " + path.string() + ": " + std::strerror(code));
}

Expected<Descriptor> write_new(const fs::path& path, std::string_view bytes) {
  Descriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0644));
  if (!file) return system_error("cannot write", path);
  while (!bytes.empty()) {
    const ssize_t n = ::write(file.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("cannot write", path);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  ::sync_file_range(file.get(), 0, 0, SYNC_FILE_RANGE_WRITE);
  return file;
}

Expected<void> flush_folder(const fs::path& folder) {
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd || ::fsync(fd.get()) != 0) return system_error("cannot flush folder", folder);
  return {};
}

}  // namespace

void open_files_with(std::function<int(const fs::path&)> how) { opener() = std::move(how); }

Expected<MappedFile> MappedFile::open(const fs::path& path) {
  const Descriptor file = open_to_read(path);
  struct stat info {};
  if (!file || ::fstat(file.get(), &info) != 0) return system_error("cannot read", path);
  if (!S_ISREG(info.st_mode)) return fail("cannot read " + path.string() + ": not a file");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size == 0) return MappedFile("", 0);
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (data == MAP_FAILED) return system_error("cannot read", path);
  ::madvise(data, size, MADV_SEQUENTIAL);
  return MappedFile(static_cast<const char*>(data), size);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(other.data_), size_(std::exchange(other.size_, 0)) {}

MappedFile::~MappedFile() {
  if (size_ != 0) ::munmap(const_cast<char*>(data_), size_);
}

namespace {

bool same_state(const struct stat& a, const struct stat& b) {
  const auto same = [](const timespec& x, const timespec& y) {
    return x.tv_sec == y.tv_sec && x.tv_nsec == y.tv_nsec;
  };
  return a.st_size == b.st_size && same(a.st_mtim, b.st_mtim) && same(a.st_ctim, b.st_ctim);
}

Expected<std::size_t> read_into(int file, char* to, std::size_t room, const fs::path& path) {
  std::size_t size = 0;
  while (size < room) {
    const ssize_t n = ::read(file, to + size, room - size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("cannot read", path);
    if (n == 0) break;
    size += static_cast<std::size_t>(n);
  }
  return size;
}

}  // namespace

Expected<ReadFile> ReadFile::open(const fs::path& path) {
  constexpr int tries = 5;
  for (int i = 0; i < tries; ++i) {
    const Descriptor file = open_to_read(path);
    struct stat before {};
    if (!file || ::fstat(file.get(), &before) != 0) return system_error("cannot read", path);
    if (!S_ISREG(before.st_mode)) return fail("cannot read " + path.string() + ": not a file");
    const std::size_t room = static_cast<std::size_t>(before.st_size) + 1;
    void* data = ::mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data == MAP_FAILED) return system_error("cannot read", path);
    ReadFile read(static_cast<char*>(data), 0, room);
    NONIO_TRY(read.size_, read_into(file.get(), read.data_, room, path));
    struct stat after {};
    if (::fstat(file.get(), &after) != 0) return system_error("cannot read", path);
    if (same_state(before, after) && read.size_ + 1 == room) return read;
    ::usleep(100'000);
  }
  return fail(
      "cannot read " + path.string() +
      ": another process is writing to it; expected a file that does not change while it is read");
}

ReadFile::ReadFile(ReadFile&& other) noexcept
    : data_(other.data_),
      size_(other.size_),
      mapped_(std::exchange(other.mapped_, 0)),
      released_(other.released_) {}

ReadFile::~ReadFile() {
  if (mapped_ > released_) ::munmap(data_ + released_, mapped_ - released_);
}

void ReadFile::release(std::size_t offset) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t whole = std::min(offset, size_) / page * page;
  if (whole > released_ && ::munmap(data_ + released_, whole - released_) == 0) released_ = whole;
}

namespace {

struct RegularFile {
  Descriptor descriptor;
  std::size_t size;
};

Expected<RegularFile> open_regular(const fs::path& path) {
  Descriptor file = open_to_read(path);
  struct stat info {};
  if (!file || ::fstat(file.get(), &info) != 0) return system_error("cannot read", path);
  if (!S_ISREG(info.st_mode)) return fail("cannot read " + path.string() + ": not a file");
  return RegularFile{std::move(file), static_cast<std::size_t>(info.st_size)};
}

}  // namespace

namespace {

std::optional<Expected<std::string>> read_from_pack(const fs::path& path) {
  const auto at = opener() ? std::nullopt : in_pack(path);
  if (!at) return std::nullopt;
  NONIO_TRY(auto bytes, read_packed(*at));
  if (!bytes) return fail("cannot read " + path.string() + ": the pack has no such file");
  return std::move(*bytes);
}

}  // namespace

Expected<void> read_parts(const fs::path& path, const std::function<void(std::string_view)>& take) {
  if (const auto packed = read_from_pack(path)) {
    if (!*packed) return fail(packed->error());
    take(**packed);
    return {};
  }
  NONIO_TRY(const auto file, open_regular(path));
  std::string buffer(std::min<std::size_t>(file.size + 1, 1 << 20), '\0');
  for (;;) {
    const ssize_t n = ::read(file.descriptor.get(), buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("cannot read", path);
    if (n == 0) return {};
    take(std::string_view(buffer).substr(0, static_cast<std::size_t>(n)));
  }
}

Expected<std::string> read_file(const fs::path& path) {
  constexpr std::size_t most_at_once = 1 << 28;
  if (auto packed = read_from_pack(path)) return std::move(*packed);
  NONIO_TRY(const auto file, open_regular(path));
  std::string bytes;
  // One byte more than the size is requested, because a shorter read indicates the end of the file.
  for (std::size_t size = 0, room = std::min(file.size, most_at_once) + 1;; room *= 2) {
    bytes.resize(room);
    NONIO_TRY(const auto read,
              read_into(file.descriptor.get(), bytes.data() + size, room - size, path));
    size += read;
    if (size == room) continue;
    bytes.resize(size);
    return bytes;
  }
}

Expected<bool> is_there(const fs::path& path) {
  if (const auto packed = in_pack(path)) {
    NONIO_TRY(const auto size, size_packed(*packed));
    return size.has_value();
  }
  struct stat info {};
  if (::lstat(path.c_str(), &info) == 0) return true;
  if (errno == ENOENT || errno == ENOTDIR) return false;
  return system_error("cannot look at", path);
}

Expected<std::string> read_small_file(const fs::path& path) {
  constexpr off_t most = 1'000'000;
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && info.st_size > most)
    return fail("has " + std::to_string(info.st_size) +
                " bytes and is not read; expected at most 1 MB (1000000 bytes)");
  std::string bytes;
  bool too_long = false;
  const auto read = read_parts(path, [&](std::string_view part) {
    too_long = too_long || bytes.size() + part.size() > static_cast<std::size_t>(most);
    if (!too_long) bytes += part;
  });
  if (!read) return fail(read.error());
  if (too_long) return fail("grew while it was read; expected at most 1 MB (1000000 bytes)");
  return bytes;
}

namespace {

std::size_t size_of_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t size = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : byte(0) >= 0xC2 ? 2 : 0;
  if (size == 0 || byte(0) > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  const bool too_long = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
  const bool none = (byte(0) == 0xED && byte(1) > 0x9F) || (byte(0) == 0xF4 && byte(1) > 0x8F);
  return too_long || none ? 0 : size;
}

}  // namespace

std::string path_text(std::string_view path) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  while (!path.empty()) {
    const std::size_t size = size_of_character(path);
    if (size == 0) {
      const auto byte = static_cast<unsigned char>(path.front());
      out += {'\\', 'x', digits[byte >> 4U], digits[byte & 15U]};
    } else {
      out += path.substr(0, size);
    }
    path.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return out;
}

namespace {

bool is_plain_file_in(const fs::path& folder, const std::string& name) {
  struct stat info {};
  return name.find('/') == std::string::npos && name != "." && name != ".." &&
         ::lstat((folder / name).c_str(), &info) == 0 && S_ISREG(info.st_mode);
}

}  // namespace

Expected<fs::path> path_inside(const fs::path& base, const std::string& relative) {
  std::error_code error;
  const fs::path root = real_folder(base, error);
  if (error) return fail("cannot find the folder " + base.string() + ": " + error.message());
  if (relative.empty() || fs::path(relative).is_absolute() ||
      relative.find('\0') != std::string::npos)
    return fail("\"" + relative + "\" is not a path below the campaign's folder");
  if (is_plain_file_in(root, relative)) return root / relative;
  const fs::path full = fs::weakly_canonical(root / relative, error);
  if (error) return fail("cannot resolve \"" + relative + "\": " + error.message());
  const fs::path below = full.lexically_relative(root);
  if (below.empty() || *below.begin() == ".." || below == ".")
    return fail("\"" + relative + "\" leads outside the campaign's folder");
  return full;
}

bool is_artifact_name(std::string_view name) {
  if (name.empty() || name.size() > 200 || name.front() == '.') return false;
  for (const char* own : {"results.json", "run.json", "earlier.json", "last-good"})
    if (name == own) return false;
  if (name.ends_with(leftover_suffix)) return false;  // reserved: a later run would remove the file
  for (const char c : name)
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
  return true;
}

namespace {

std::string& temporary_suffix() {
  static std::string suffix(leftover_suffix);
  return suffix;
}

}  // namespace

void take_own_names(const std::string& token) {
  temporary_suffix() = "." + token + std::string(leftover_suffix);
}
bool is_temporary_name(std::string_view name) {
  return name.starts_with('.') && name.ends_with(leftover_suffix);
}
bool has_own_names() { return temporary_suffix() != leftover_suffix; }

fs::path temporary_path(const fs::path& folder, const std::string& name) {
  return folder / ("." + name + temporary_suffix());
}

Expected<void> rename_file(const fs::path& from, const fs::path& to,
                           const std::function<bool()>& is_ours) {
  struct stat before {};
  struct stat after {};
  const bool known = !is_ours && ::lstat(from.c_str(), &before) == 0;
  if (::rename(from.c_str(), to.c_str()) == 0) return {};
  const int code = errno;
  if (code == ENOENT && is_ours && is_ours()) return {};
  if (code == ENOENT && known && ::lstat(to.c_str(), &after) == 0 &&
      before.st_dev == after.st_dev && before.st_ino == after.st_ino)
    return {};
  errno = code;
  return system_error("cannot write", to);
}

Expected<void> rename_temporaries(const fs::path& folder, const std::vector<std::string>& names,
                                  const std::function<bool(const std::string&)>& is_ours) {
  for (const std::string& name : names) {
    // All other names are flushed before the last file is renamed.
    if (&name == &names.back() && names.size() > 1)
      if (auto flushed = flush_folder(folder); !flushed) return flushed;
    std::function<bool()> this_is_ours;
    if (is_ours) this_is_ours = [&] { return is_ours(name); };
    if (auto renamed = rename_file(temporary_path(folder, name), folder / name, this_is_ours);
        !renamed)
      return renamed;
  }
  return flush_folder(folder);
}

namespace {

Expected<std::vector<Descriptor>> fill(const fs::path& folder, const std::vector<Artifact>& files) {
  std::vector<Descriptor> open;
  for (const Artifact& file : files) {
    NONIO_TRY(auto written, write_new(temporary_path(folder, file.name), file.bytes));
    open.push_back(std::move(written));
  }
  return open;
}

std::vector<std::string> names_of(const std::vector<Artifact>& files) {
  std::vector<std::string> names;
  for (const Artifact& file : files) names.push_back(file.name);
  return names;
}

Expected<bool> make_folder(const fs::path& folder) {
  std::error_code error;
  const bool is_new = fs::create_directories(folder, error);
  if (error) return fail("cannot make the folder " + folder.string() + ": " + error.message());
  return is_new;
}

/// Fills all files before it flushes the first, so that the file system commits them together, and
/// compares each file on the disk with its bytes.
Expected<void> fill_and_flush(const fs::path& folder, const std::vector<Artifact>& files) {
  NONIO_TRY(const auto open, fill(folder, files));
  for (std::size_t i = 0; i < open.size(); ++i)
    if (::fsync(open[i].get()) != 0) return system_error("cannot flush", folder / files[i].name);
  for (const Artifact& file : files) {
    const fs::path path = temporary_path(folder, file.name);
    drop_cached(path);
    NONIO_TRY(const auto now, read_file(path));
    if (now != file.bytes)
      return fail("the disk does not give back what was written to it: " +
                  (folder / file.name).string());
  }
  return {};
}

}  // namespace

Expected<void> publish(const fs::path& folder, const std::vector<Artifact>& files) {
  if (files.empty()) return {};
  NONIO_TRY(const auto is_new, make_folder(folder));
  auto done = fill_and_flush(folder, files);
  // A journaling file system commits the new folder together with the files, so the parent folder
  // is flushed after them.
  if (done && is_new) done = flush_folder(fs::absolute(folder).parent_path());
  const std::vector<std::string> names = names_of(files);
  const auto is_ours = [&](const std::string& name) {
    const auto file =
        std::find_if(files.begin(), files.end(), [&](const Artifact& a) { return a.name == name; });
    const auto now = read_file(folder / name);
    return file != files.end() && now && *now == file->bytes;
  };
  if (done) done = rename_temporaries(folder, names, is_ours);
  if (!done) remove_temporaries(folder, names);
  return done;
}

Expected<void> write_temporaries(const fs::path& folder, const std::vector<Artifact>& files) {
  if (const auto made = make_folder(folder); !made) return fail(made.error());
  const auto filled = fill(folder, files);
  if (filled) return {};
  remove_temporaries(folder, names_of(files));
  return fail(filled.error());
}

Expected<std::vector<std::string>> temporaries(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.') && name.ends_with(temporary_suffix()))
      names.push_back(name.substr(1, name.size() - 1 - temporary_suffix().size()));
  }
  if (error && error != std::errc::no_such_file_or_directory)
    return fail("cannot read the folder " + folder.string() + ": " + error.message());
  std::sort(names.begin(), names.end());
  return names;
}

void drop_cached(const fs::path& path) {
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (fd) ::posix_fadvise(fd.get(), 0, 0, POSIX_FADV_DONTNEED);
}

Expected<bool> disk_gives_back(const fs::path& path, std::uint64_t size, std::string_view sha256) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!file) return system_error("cannot read", path);
  ::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED);
  // One byte more than expected is requested, because a shorter read indicates the end of the file.
  std::string buffer(std::min<std::uint64_t>(size + 1, 1 << 20), '\0');
  RunningDigest digest;
  std::uint64_t seen = 0;
  while (seen <= size) {
    const std::size_t wanted = std::min<std::uint64_t>(buffer.size(), size + 1 - seen);
    const ssize_t n = ::read(file.get(), buffer.data(), wanted);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("cannot read", path);
    digest.add(std::string_view(buffer).substr(0, static_cast<std::size_t>(n)));
    seen += static_cast<std::uint64_t>(n);
    if (static_cast<std::size_t>(n) < wanted && (n == 0 || seen == size)) break;
  }
  return seen == size && digest.hex() == sha256;
}

void remove_temporaries(const fs::path& folder, const std::vector<std::string>& names) {
  constexpr int tries = 3;
  for (const std::string& name : names)
    for (int i = 0; i < tries; ++i) {
      std::error_code error;
      fs::remove(temporary_path(folder, name), error);
      if (!error) break;
    }
}

void remove_leftovers(const fs::path& folder) {
  if (const auto names = temporaries(folder)) remove_temporaries(folder, *names);
}

namespace fs = std::filesystem;

fs::path real_folder(const fs::path& folder, std::error_code& error) {
  struct Known {
    fs::path path, real;
    struct stat at {};
  };
  thread_local Known parent;
  const auto same = [](const struct stat& a, const struct stat& b) {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
  };
  struct stat own {};
  struct stat above {};
  struct stat there {};
  if (!folder.is_absolute() || !folder.has_filename() || folder.filename() == "." ||
      folder.filename() == ".." || ::lstat(folder.c_str(), &own) != 0 || !S_ISDIR(own.st_mode))
    return fs::canonical(folder, error);
  const fs::path path = folder.parent_path();
  if (::stat(path.c_str(), &above) != 0) return fs::canonical(folder, error);
  if (path != parent.path || !same(above, parent.at) || ::lstat(parent.real.c_str(), &there) != 0 ||
      !same(above, there)) {
    parent = {};
    fs::path real = fs::canonical(path, error);
    if (error) return {};
    parent = {path, std::move(real), above};
  }
  error.clear();
  return parent.real / folder.filename();
}

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(const std::string& purpose, const fs::path& below) {
  std::error_code error;
  std::string name =
      ((below.empty() ? fs::temp_directory_path(error) : fs::absolute(below, error)) /
       ("nonio-" + purpose + "-" + std::string(6, 'X')))
          .string();
  if (!error && ::mkdtemp(name.data()) != nullptr) path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace nonio::storage
