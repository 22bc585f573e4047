// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/packed_results.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <mutex>
#include <set>

#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"

namespace nonio::storage {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view first_line = "nonio-packs/1\n";

std::optional<std::string_view> cut(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at + 1);
  return part;
}

std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string_view row_at(const std::string& rows, std::size_t at) {
  return std::string_view(rows).substr(at, rows.find('\n', at) - at);
}
std::string_view id_in(std::string_view row) { return row.substr(0, row.find('\t')); }

/// Uses stat, because access() makes the kernel copy the credentials of the process.
bool is_there_to_read(const fs::path& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0;
}

}  // namespace

bool is_pack_name(std::string_view name) {
  return name.ends_with(pack_suffix) && is_artifact_name(name) && name.find('\t') == name.npos;
}

Expected<Catalogue> Catalogue::parse(const std::string& text) {
  Catalogue made;
  const auto digest_at = text.rfind("sha256\t");
  if (!text.starts_with(first_line) || digest_at == std::string::npos ||
      std::string_view(text).substr(digest_at) !=
          "sha256\t" + sha256(std::string_view(text).substr(0, digest_at)) + "\n")
    return fail("it is not as it was written");
  std::string_view rest = std::string_view(text).substr(0, digest_at);
  rest.remove_prefix(first_line.size());
  while (rest.starts_with("pack\t")) {
    rest.remove_prefix(5);
    const auto name = cut(rest, '\t'), size = cut(rest, '\t'), sha256 = cut(rest, '\n');
    if (!name || !size || !sha256 || !is_pack_name(*name) || !number_in(*size))
      return fail("a line of a pack is not one");
    made.packs_.push_back({std::string(*name), *number_in(*size), std::string(*sha256)});
  }
  made.rows_ = rest;
  std::string_view before;
  while (!rest.empty()) {
    const auto row = cut(rest, '\n');
    if (!row || made.pack_in(*row) == nullptr || id_in(*row) <= before)
      return fail("a line of a campaign is not one");
    before = id_in(*row);
  }
  return made;
}

Expected<Catalogue> Catalogue::read(const fs::path& out) {
  const fs::path path = out / packs_folder / catalogue_name;
  NONIO_TRY(const auto there, is_there(path));
  if (!there) return Catalogue();
  NONIO_TRY(const auto text, read_file(path));
  auto made = parse(text);
  if (!made)
    return fail(path.string() + ", the index of the packs, is damaged: " + made.error().message +
                "; bring it back from a copy of the output folder, or remove it to do those "
                "campaigns anew, without what was known of them before");
  return made;
}

const PackFile* Catalogue::pack_in(std::string_view row) const {
  const std::size_t tab = row.find('\t');
  if (tab == std::string_view::npos) return nullptr;
  const auto number = number_in(row.substr(tab + 1));
  return number && *number < packs_.size() ? &packs_[*number] : nullptr;
}

const PackFile* Catalogue::find(std::string_view id) const {
  std::size_t from = 0, to = rows_.size();
  while (from < to) {
    std::size_t middle = from + (to - from) / 2;
    while (middle > from && rows_[middle - 1] != '\n') --middle;
    const std::string_view row = row_at(rows_, middle);
    if (id_in(row) == id) return pack_in(row);
    if (id_in(row) < id)
      from = middle + row.size() + 1;
    else
      to = middle;
  }
  return nullptr;
}

void Catalogue::each(const std::function<void(std::string_view, const PackFile&)>& take) const {
  for (std::size_t at = 0; at < rows_.size();) {
    const std::string_view row = row_at(rows_, at);
    take(id_in(row), *pack_in(row));
    at += row.size() + 1;
  }
}

Expected<void> Catalogue::publish_with(const fs::path& out, const std::vector<Entry>& more) const {
  std::map<std::string, std::size_t> number;
  std::string packs, rows;
  const auto add = [&](std::string_view id, const PackFile& pack) {
    const auto [at, is_new] = number.emplace(pack.name, number.size());
    if (is_new)
      packs += "pack\t" + pack.name + "\t" + std::to_string(pack.size) + "\t" + pack.sha256 + "\n";
    rows += std::string(id) + "\t" + std::to_string(at->second) + "\n";
  };
  auto next = more.begin();
  each([&](std::string_view id, const PackFile& pack) {
    for (; next != more.end() && next->id < id; ++next) add(next->id, *next->pack);
    if (next == more.end() || next->id != id) add(id, pack);
  });
  for (; next != more.end(); ++next) add(next->id, *next->pack);
  std::string text = std::string(first_line) + packs + rows;
  text += "sha256\t" + sha256(text) + "\n";
  return publish(out / packs_folder, {{catalogue_name, std::move(text)}});
}

Expected<void> check_catalogue(const fs::path& out) {
  NONIO_TRY(const auto read, Catalogue::read(out));
  return {};
}

namespace {

struct KnownCatalogue {
  struct stat at {};
  std::shared_ptr<const Catalogue> catalogue;
};

struct Known {
  std::mutex mutex;
  std::map<std::string, KnownCatalogue> by_out;
};

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_size == b.st_size &&
         a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

/// Returns false if the output folder has no catalogue. Sets `catalogue` to null if it cannot be
/// read.
bool catalogue_of(const fs::path& out, std::shared_ptr<const Catalogue>& catalogue) {
  static auto* const known = new Known;
  const fs::path path = out / packs_folder / catalogue_name;
  struct stat now {};
  if (::stat(path.c_str(), &now) != 0 && (errno == ENOENT || errno == ENOTDIR)) return false;
  const std::lock_guard lock(known->mutex);
  KnownCatalogue& entry = known->by_out[out.native()];
  if (!entry.catalogue || !same_file(entry.at, now)) {
    auto read = Catalogue::read(out);
    entry = {now, read ? std::make_shared<const Catalogue>(std::move(*read)) : nullptr};
  }
  catalogue = entry.catalogue;
  return true;
}

bool has_record(const fs::path& folder) {
  return is_there_to_read(folder) &&
         (is_there_to_read(folder / "run.json") || is_there_to_read(folder / ".run.json.before"));
}

bool is_hashed(const fs::path& out) { return is_there_to_read(out / hashed_mark); }

void each_folder_in(const fs::path& folder, std::error_code& error,
                    const std::function<void(const fs::path&)>& take) {
  std::error_code here;
  fs::directory_iterator it(folder, here);
  if (here == std::errc::no_such_file_or_directory) return;
  for (; !here && it != fs::directory_iterator(); it.increment(here))
    if (it->is_directory(here)) take(it->path());
  if (here) error = here;
}

}  // namespace

fs::path own_folder(const fs::path& out, const std::string& id) {
  return is_hashed(out) ? out / sha256(id).substr(0, 2) / id : out / id;
}

fs::path results_folder(const fs::path& out, const std::string& id) {
  fs::path own = own_folder(out, id);
  std::shared_ptr<const Catalogue> catalogue;
  if (!catalogue_of(out, catalogue)) return own;
  // Reading this address returns the error message about the catalogue.
  if (!catalogue) return out / packs_folder / catalogue_name / id;
  const PackFile* pack = catalogue->find(id);
  if (pack == nullptr || has_record(own)) return own;
  return out / packs_folder / pack->name / id;
}

Expected<void> each_results_folder(const fs::path& out,
                                   const std::function<void(const fs::path&)>& take) {
  NONIO_TRY(const auto catalogue, Catalogue::read(out));
  std::set<std::string> in_folders;
  std::error_code error;
  const auto take_folder = [&](const fs::path& folder) {
    const std::string id = folder.filename().string();
    if (catalogue.find(id) != nullptr && !has_record(folder)) return;
    if (catalogue.find(id) != nullptr) in_folders.insert(id);
    take(folder);
  };
  const bool hashed = is_hashed(out);
  each_folder_in(out, error, [&](const fs::path& folder) {
    if (!hashed)
      take_folder(folder);
    else if (folder.filename().string().size() == 2)
      each_folder_in(folder, error, take_folder);
  });
  if (error) return fail("cannot list the output folder " + out.string() + ": " + error.message());
  catalogue.each([&](std::string_view id, const PackFile& pack) {
    if (!in_folders.contains(std::string(id))) take(out / packs_folder / pack.name / id);
  });
  return {};
}

fs::path stored_in(const fs::path& path) {
  const auto packed = in_pack(path);
  return packed ? packed->pack : path;
}

Expected<std::vector<std::string>> names_in_store(const fs::path& results) {
  const auto packed = in_pack(results);
  return packed ? names_packed(*packed) : std::vector<std::string>();
}

Expected<void> sweep_packs(const fs::path& out) {
  NONIO_TRY(const auto catalogue, Catalogue::read(out));
  std::set<std::string> used;
  catalogue.each([&](std::string_view, const PackFile& pack) { used.insert(pack.name); });
  remove_leftovers(out / packs_folder);
  std::error_code error;
  std::vector<fs::path> unused;
  for (fs::directory_iterator it(out / packs_folder, error), end; !error && it != end;
       it.increment(error))
    if (const std::string name = it->path().filename().string();
        name.ends_with(pack_suffix) && !used.contains(name))
      unused.push_back(it->path());
  for (const fs::path& path : unused) fs::remove(path, error);
  return {};
}

namespace {

Expected<std::optional<Written>> written(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0)
    return Written{static_cast<std::uint64_t>(info.st_size), info.st_mtim.tv_sec,
                   info.st_mtim.tv_nsec};
  if (errno == ENOENT || errno == ENOTDIR) return std::nullopt;
  const int code = errno;
  return fail("cannot look at " + path.string() + ": " + std::strerror(code));
}

}  // namespace

Expected<std::optional<Written>> written_at(const fs::path& file) {
  const auto packed = in_pack(file);
  if (!packed) return written(file);
  NONIO_TRY(const auto size, size_packed(*packed));
  if (!size) return std::nullopt;
  auto pack = written(packed->pack);
  if (pack && *pack) (*pack)->size = *size;
  return pack;
}

Expected<std::optional<Written>> record_written_at(const fs::path& folder) {
  if (const auto packed = in_pack(folder))
    return written(packed->pack.parent_path() / catalogue_name);
  return written(folder / "run.json");
}

}  // namespace nonio::storage
