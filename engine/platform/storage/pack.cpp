// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/pack.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <list>
#include <mutex>
#include <utility>

#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::storage {
namespace fs = std::filesystem;

std::optional<PackAddress> in_pack(const fs::path& path) {
  constexpr std::string_view folder = "/.nonio/packs/";
  static_assert(folder.substr(1, folder.size() - 2) == packs_folder);
  const std::string& text = path.native();
  const std::size_t at = text.rfind(folder);
  if (at == std::string::npos) return std::nullopt;
  const std::size_t slash = text.find('/', at + folder.size());
  if (slash == std::string::npos || slash + 1 == text.size()) return std::nullopt;
  return PackAddress{text.substr(0, slash), text.substr(slash + 1)};
}

namespace {

constexpr const char* tables =
    "CREATE TABLE sqlar(name TEXT PRIMARY KEY, mode INT, mtime INT, sz INT, data BLOB);"
    "CREATE TABLE digest(name TEXT PRIMARY KEY, sha256 TEXT NOT NULL) WITHOUT ROWID";
constexpr std::int64_t plain_file = 0100644;

std::string trouble_of(Database& database) {
  const auto well = database.take_error();
  return well ? std::string() : well.error().message;
}

struct OpenPack {
  std::string path;
  Database database;
};

struct Opened {
  std::mutex mutex;
  pid_t process = 0;
  std::list<OpenPack> packs;
};
Opened& opened() {
  // Never destroyed, because a child that exits must not close connections of its parent.
  static auto* const all = new Opened;
  return *all;
}
constexpr std::size_t most_open = 16;

Error damaged(const fs::path& pack, const std::string& what, const std::string& why) {
  return Error{"the pack " + pack.string() + " is damaged" + (what.empty() ? "" : " at " + what) +
               ": " + why + "; bring it back from a copy of the output folder"};
}

Expected<Database*> open_pack(Opened& all, const fs::path& pack) {
  if (all.process != ::getpid()) {
    // The parent's connections are leaked on purpose: closing them in a child could damage them.
    if (all.process != 0) new std::list<OpenPack>(std::move(all.packs));
    all.packs.clear();
    all.process = ::getpid();
  }
  for (auto it = all.packs.begin(); it != all.packs.end(); ++it)
    if (it->path == pack.native()) {
      all.packs.splice(all.packs.begin(), all.packs, it);
      return &all.packs.front().database;
    }
  if (pack.filename() == catalogue_name)
    if (const auto sound = check_catalogue(pack.parent_path().parent_path().parent_path()); !sound)
      return fail(sound.error());
  std::error_code error;
  if (const auto status = fs::symlink_status(pack, error); status.type() != fs::file_type::regular)
    return fail("the pack " + pack.string() +
                (status.type() == fs::file_type::not_found ? " is not there" : " is not a file") +
                "; bring it back from a copy of the output folder");
  auto database = Database::open(pack, Database::Use::read);
  if (!database) return fail(damaged(pack, "", database.error().message));
  // A view could have the name of a table, and its content could depend on anything.
  const std::string both = database->first(
      "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('sqlar', 'digest')");
  if (const std::string why = trouble_of(*database); !why.empty() || both != "2")
    return fail(damaged(pack, "", why.empty() ? "expected the tables sqlar and digest" : why));
  all.packs.push_front({pack.native(), std::move(*database)});
  if (all.packs.size() > most_open) all.packs.pop_back();
  return &all.packs.front().database;
}

std::optional<std::uint64_t> number(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Returns std::nullopt if the file does not exist; an error unless it is a plain, uncompressed
/// file of the stated size.
Expected<std::optional<std::uint64_t>> size_in(Database& database, const PackAddress& at) {
  const auto rows = database.rows(
      "SELECT mode, sz, length(data), typeof(data) FROM sqlar WHERE name = ?", {at.name});
  if (const std::string why = trouble_of(database); !why.empty())
    return fail(damaged(at.pack, at.name, why));
  if (rows.empty()) return std::nullopt;
  const auto& row = rows.front();
  if (row[0] != std::to_string(plain_file))
    return fail(damaged(at.pack, at.name, "it is not a plain file (mode " + row[0] + ")"));
  const auto size = number(row[1]);
  if (!size || row[3] != "blob" || row[1] != row[2])
    return fail(
        damaged(at.pack, at.name, "it states that it has " + row[1] + " bytes and has " + row[2]));
  return size;
}

Expected<std::optional<std::string>> read_in(Database& database, const PackAddress& at) {
  NONIO_TRY(const auto size, size_in(database, at));
  if (!size) return std::nullopt;
  std::string bytes = database.first("SELECT data FROM sqlar WHERE name = ?", {at.name});
  const std::string sha256_noted =
      database.first("SELECT sha256 FROM digest WHERE name = ?", {at.name});
  if (const std::string why = trouble_of(database); !why.empty())
    return fail(damaged(at.pack, at.name, why));
  if (sha256(bytes) != sha256_noted)
    return fail(damaged(at.pack, at.name, "its bytes do not have their digest"));
  return bytes;
}

}  // namespace

Expected<PackWriter> PackWriter::create(const fs::path& path) {
  NONIO_TRY(auto database, Database::open(path, Database::Use::create));
  for (const char* sql : {"PRAGMA page_size = 16384", "PRAGMA journal_mode = OFF",
                          "PRAGMA synchronous = OFF", "BEGIN"})
    database.rows(sql);
  database.script(tables);
  if (auto well = database.take_error(); !well) return fail(well.error());
  return PackWriter(std::move(database));
}

Expected<void> PackWriter::add(const std::string& name, std::string_view bytes) {
  const auto size = static_cast<std::int64_t>(bytes.size());
  database_.put("INSERT INTO sqlar VALUES (?, ?, 0, ?, ?)",
                {name, plain_file, size, Database::Blob{bytes}});
  database_.put("INSERT INTO digest VALUES (?, ?)", {name, sha256(bytes)});
  if (const auto well = database_.take_error(); !well)
    return fail("cannot pack " + name + ": " + well.error().message);
  return {};
}

Expected<void> PackWriter::end() {
  database_.rows("COMMIT");
  return database_.take_error();
}

namespace {

template <class Use>
auto with_pack(const fs::path& pack, const Use& use) -> decltype(use(std::declval<Database&>())) {
  Opened& all = opened();
  const std::lock_guard lock(all.mutex);
  NONIO_TRY(const auto database, open_pack(all, pack));
  return use(*database);
}

Expected<std::vector<std::string>> names_in(Database& database, const PackAddress& folder) {
  const std::string from = folder.name + "/", to = folder.name + "0";
  std::vector<std::string> names;
  for (const auto& row : database.rows(
           "SELECT name FROM sqlar WHERE name >= ? AND name < ? ORDER BY name", {from, to}))
    names.push_back(row[0].substr(from.size()));
  if (const std::string why = trouble_of(database); !why.empty())
    return fail(damaged(folder.pack, folder.name, why));
  return names;
}

Expected<void> check_in(Database& database, const fs::path& pack) {
  const auto names = database.rows("SELECT name FROM sqlar ORDER BY name");
  if (const std::string why = trouble_of(database); !why.empty())
    return fail(damaged(pack, "", why));
  for (const auto& row : names)
    if (const auto read = read_in(database, {pack, row[0]}); !read) return fail(read.error());
  const auto well = database.rows("PRAGMA integrity_check(1)");
  const std::string why = trouble_of(database);
  if (!why.empty() || well.empty() || well[0][0] != "ok")
    return fail(damaged(pack, "", why.empty() && !well.empty() ? well[0][0] : why));
  return {};
}

}  // namespace

Expected<std::optional<std::string>> read_packed(const PackAddress& at) {
  return with_pack(at.pack, [&](Database& pack) { return read_in(pack, at); });
}

Expected<std::optional<std::uint64_t>> size_packed(const PackAddress& at) {
  return with_pack(at.pack, [&](Database& pack) { return size_in(pack, at); });
}

Expected<std::vector<std::string>> names_packed(const PackAddress& folder) {
  return with_pack(folder.pack, [&](Database& pack) { return names_in(pack, folder); });
}

Expected<void> check_pack(const fs::path& pack) {
  close_packs();
  return with_pack(pack, [&](Database& open) { return check_in(open, pack); });
}

namespace {

Expected<void> copy_flushed(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) return fail("cannot write " + to.string() + ": " + error.message());
  const int file = ::open(to.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  const bool flushed = file >= 0 && ::fsync(file) == 0;
  const int code = errno;
  if (file >= 0) ::close(file);
  if (!flushed) return fail("cannot flush " + to.string() + ": " + std::strerror(code));
  return {};
}

}  // namespace

Expected<PackFile> hand_over(const fs::path& pack, const fs::path& out, const std::string& begin) {
  std::error_code error;
  const fs::path folder = out / packs_folder;
  NONIO_TRY(const auto digest, sha256_of_file(pack));
  PackFile file{begin + "-" + digest.substr(0, 16) + pack_suffix, fs::file_size(pack, error),
                digest};
  fs::create_directories(folder, error);
  if (error) return fail("cannot make the folder " + folder.string() + ": " + error.message());
  const fs::path temporary = temporary_path(folder, file.name);
  auto done = copy_flushed(pack, temporary);
  if (done) {
    const auto same = disk_gives_back(temporary, file.size, file.sha256);
    if (!same || !*same)
      done = fail("the disk does not give back what was written to it: " +
                  (folder / file.name).string());
  }
  if (done)
    done = rename_temporaries(folder, {file.name}, [&](const std::string& name) {
      return sha256_of_file(folder / name).value_or("") == file.sha256;
    });
  if (done) return file;
  remove_temporaries(folder, {file.name});
  return fail(done.error());
}

Expected<void> check_handed_over(const fs::path& out, const PackFile& pack) {
  const fs::path path = out / packs_folder / pack.name;
  NONIO_TRY(const auto digest, sha256_of_file(path));
  if (digest == pack.sha256) return {};
  if (const auto sound = check_pack(path); !sound) return fail(sound.error());
  return fail(damaged(path, "", "it does not have the digest that its shard has reported"));
}

void close_packs() {
  Opened& all = opened();
  const std::lock_guard lock(all.mutex);
  if (all.process == ::getpid()) all.packs.clear();
}

}  // namespace nonio::storage
