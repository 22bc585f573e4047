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

/// Where the results of a campaign lie: in a folder of their own, or in a pack (pack.h).
namespace nonio::storage {

/// Folder of a campaign's results, to which links lead: OUT/<id>, or OUT/ab/<id> where campaigns
/// are sorted by the first two digits of the SHA-256 of their ids.
std::filesystem::path own_folder(const std::filesystem::path& out, const std::string& id);
/// A file that marks such an output folder, next to the files of the run.
inline constexpr const char* hashed_mark = ".nonio/hashed";
/// Where they are to be read: its own folder, if there is a record; else the pack that the catalogue names for it, as
/// an address that the functions of files.h take (OUT/.nonio/packs/NAME.sqlar/<id>); else its own folder. A pack that
/// is missing or damaged is an error where it is read, never a campaign without results.
std::filesystem::path results_folder(const std::filesystem::path& out, const std::string& id);
/// Every place in which results of a campaign may lie, in no order: folders, and addresses in
/// packs. The id is its last part. An output folder that is missing has none.
Expected<void> each_results_folder(const std::filesystem::path& out,
                                   const std::function<void(const std::filesystem::path&)>& take);

/// The file of the disk that has a file of results, or all of them: the path itself, or the pack that an address leads into.
std::filesystem::path stored_in(const std::filesystem::path& path);
/// Names that the store itself has of a campaign. A folder has none of its own: people may put files into it.
Expected<std::vector<std::string>> names_in_store(const std::filesystem::path& results);

struct PackFile {
  std::string name;  ///< in OUT/.nonio/packs
  std::uint64_t size = 0;
  std::string sha256;
};

/// Which campaign is in which pack: OUT/.nonio/packs/catalogue, a text that appears whole or not at
/// all. A campaign with a record in its own folder is not in a pack, whatever the catalogue states.
class Catalogue {
 public:
  /// Without an entry if there is none.
  static Expected<Catalogue> read(const std::filesystem::path& out);
  /// Null: in none.
  const PackFile* find(std::string_view id) const;
  void each(const std::function<void(std::string_view id, const PackFile& pack)>& take) const;

  /// `more`, in order of the ids, takes the place of entries of the same campaigns.
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
  std::string rows_{};  ///< "id\tnumber of the pack\n", in order
};

/// A plain name that ends as packs do.
bool is_pack_name(std::string_view name);
inline constexpr const char* catalogue_name = "catalogue";
Expected<void> check_catalogue(const std::filesystem::path& out);

/// Removes the packs that contain no campaign, and incomplete copies.
Expected<void> sweep_packs(const std::filesystem::path& out);

/// Size of a file of results and when it, or its pack, was written. None: it is missing.
struct Written {
  std::uint64_t size = 0;
  std::int64_t seconds = 0, nanoseconds = 0;
};
Expected<std::optional<Written>> written_at(const std::filesystem::path& file);
/// When the record was written; in a pack: when the catalogue that names it was.
Expected<std::optional<Written>> record_written_at(const std::filesystem::path& folder);

}  // namespace nonio::storage
