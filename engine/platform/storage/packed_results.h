// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

/// Finds the results of a campaign: in a folder of their own, or in a pack (pack.h).
namespace nonio::storage {

/// Returns the campaign's own folder of results, to which links in pages refer: OUT/<id>; in a
/// hashed output folder OUT/ab/<id> with the first two digits of the SHA-256 of the id.
std::filesystem::path own_folder(const std::filesystem::path& out, const std::string& id);
/// File whose presence marks a hashed output folder.
inline constexpr const char* hashed_mark = ".nonio/hashed";
/// Returns the place from which results are read: the address in the pack that the catalogue names
/// (OUT/.nonio/packs/NAME.sqlar/<id>); the campaign's own folder if it contains a record, or if no
/// pack is named. A missing or damaged pack is an error when it is read; the campaign is not
/// treated as one without results.
std::filesystem::path results_folder(const std::filesystem::path& out, const std::string& id);
/// Calls `take` with every folder and every address in a pack that may contain results of a
/// campaign, in no particular order. The last part of the path is the id of the campaign. If the
/// output folder is missing, `take` is not called.
Expected<void> each_results_folder(const std::filesystem::path& out,
                                   const std::function<void(const std::filesystem::path&)>& take);

/// Returns the file on the disk that contains a file or folder of results: the pack, if the path is
/// an address in a pack, otherwise the path itself.
std::filesystem::path stored_in(const std::filesystem::path& path);
/// Returns the names of the files that a pack contains for a campaign. Empty if the results are in
/// a folder of their own, because people may put other files into it.
Expected<std::vector<std::string>> names_in_store(const std::filesystem::path& results);

struct PackFile {
  std::string name;  ///< name of the file in OUT/.nonio/packs
  std::uint64_t size = 0;
  std::string sha256;
};

/// Assigns campaigns to packs: OUT/.nonio/packs/catalogue, a text file that appears completely or
/// not at all. A campaign with a record in its own folder is not in a pack, even if the catalogue
/// has an entry.
class Catalogue {
 public:
  /// Reads the catalogue; it has no entries if the file does not exist.
  static Expected<Catalogue> read(const std::filesystem::path& out);
  /// Returns the pack of a campaign; null if there is none.
  const PackFile* find(std::string_view id) const;
  void each(const std::function<void(std::string_view id, const PackFile& pack)>& take) const;

  /// An entry that `publish_with` adds to the catalogue. The entries must be sorted by id; they
  /// replace entries of the same campaigns.
  struct Entry {
    std::string id;
    const PackFile* pack;
  };
  Expected<void> publish_with(const std::filesystem::path& out,
                              const std::vector<Entry>& more) const;

 private:
  static Expected<Catalogue> parse(const std::string& text);
  const PackFile* pack_in(std::string_view row) const;
  std::vector<PackFile> packs_{};
  std::string rows_{};  ///< lines "id\tnumber of the pack\n", sorted by id
};

/// Whether this is a plain file name with the suffix of a pack.
bool is_pack_name(std::string_view name);
inline constexpr const char* catalogue_name = "catalogue";
Expected<void> check_catalogue(const std::filesystem::path& out);

/// Removes packs to which the catalogue assigns no campaign, and incomplete copies.
Expected<void> sweep_packs(const std::filesystem::path& out);

/// Size of a results file in bytes, and modification time (s and ns since 1970) of the file or of
/// the pack that contains it.
struct Written {
  std::uint64_t size = 0;
  std::int64_t seconds = 0, nanoseconds = 0;
};
Expected<std::optional<Written>> written_at(const std::filesystem::path& file);
/// Returns when the record of a campaign was written; for a campaign in a pack, when the catalogue
/// was written. None if that file does not exist.
Expected<std::optional<Written>> record_written_at(const std::filesystem::path& folder);

}  // namespace nonio::storage
