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

namespace nonio::storage {

/// Folder of a campaign's results to which links in pages refer: OUT/<id>; in a hashed output
/// folder OUT/ab/<id>, where ab are the first two digits of the SHA-256 of the id.
std::filesystem::path own_folder(const std::filesystem::path& out, const std::string& id);
inline constexpr const char* hashed_mark = ".nonio/hashed";
/// Location from which results are read: the campaign's own folder if it contains a record or if
/// the catalogue names no pack, otherwise the address in the pack
/// (OUT/.nonio/packs/NAME.sqlar/<id>). A missing or damaged pack is an error when it is read.
std::filesystem::path results_folder(const std::filesystem::path& out, const std::string& id);
/// Calls `take` with every folder and pack address that may contain results of a campaign, in no
/// particular order; the last part of the path is the campaign id. A missing output folder is no
/// error.
Expected<void> each_results_folder(const std::filesystem::path& out,
                                   const std::function<void(const std::filesystem::path&)>& take);

/// Returns the file on the disk: the pack if the path is an address in a pack, otherwise the path
/// itself.
std::filesystem::path stored_in(const std::filesystem::path& path);
/// Returns the file names that a pack contains for a campaign. Empty if the results have their own
/// folder, because people may put other files into it.
Expected<std::vector<std::string>> names_in_store(const std::filesystem::path& results);

struct PackFile {
  std::string name;  ///< name in OUT/.nonio/packs
  std::uint64_t size = 0;
  std::string sha256;
};

/// Assignment of campaigns to packs: OUT/.nonio/packs/catalogue, a text file that appears
/// completely or not at all. A record in a campaign's own folder has precedence over the catalogue.
class Catalogue {
 public:
  /// A missing file gives a catalogue without entries.
  static Expected<Catalogue> read(const std::filesystem::path& out);
  /// Null if the campaign is in no pack.
  const PackFile* find(std::string_view id) const;
  void each(const std::function<void(std::string_view id, const PackFile& pack)>& take) const;

  /// Entry for `publish_with`; entries must be sorted by id and replace entries of the same
  /// campaigns.
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
  std::string rows_{};  ///< lines "id\tindex of the pack\n", sorted by id
};

/// Whether this is a plain file name with the suffix of a pack.
bool is_pack_name(std::string_view name);
inline constexpr const char* catalogue_name = "catalogue";
Expected<void> check_catalogue(const std::filesystem::path& out);

/// Removes packs to which the catalogue assigns no campaign, and incomplete copies.
Expected<void> sweep_packs(const std::filesystem::path& out);

/// Size in bytes, and modification time (s and ns since 1970) of the file or of the pack that
/// contains it.
struct Written {
  std::uint64_t size = 0;
  std::int64_t seconds = 0, nanoseconds = 0;
};
Expected<std::optional<Written>> written_at(const std::filesystem::path& file);
/// Returns the time of the catalogue for a campaign in a pack; std::nullopt if the file does not
/// exist.
Expected<std::optional<Written>> record_written_at(const std::filesystem::path& folder);

}  // namespace nonio::storage
