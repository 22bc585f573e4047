// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/storage/database.h"
#include "platform/storage/packed_results.h"

/// A pack: one file with the results of many campaigns. It is an SQLite archive (`sqlite3 -At -f
/// FILE` lists it) with a table `digest`. A name in it is the id of a campaign, '/' and the name of
/// a file. It contains no time: the same files give the same bytes.
///
/// PACK/ID/FILE is the address of a file in a pack. `read_file`, `read_parts`, `sha256_of_file` and `is_there` of
/// files.h take it as any other path. Whatever is read is compared with its digest.
namespace nonio::storage {

inline constexpr std::string_view packs_folder = ".nonio/packs";
inline constexpr const char* pack_suffix = ".sqlar";

struct PackAddress {
  std::filesystem::path pack;
  std::string name;
};
/// None if the path does not lead into a file of a folder `.nonio/packs`.
std::optional<PackAddress> in_pack(const std::filesystem::path& path);

class PackWriter {
 public:
  /// In a folder that no other process uses: nothing is flushed.
  static Expected<PackWriter> create(const std::filesystem::path& path);
  /// In the order of the names: it decides how the bytes lie.
  Expected<void> add(const std::string& name, std::string_view bytes);
  Expected<void> end();

 private:
  explicit PackWriter(Database database) : database_(std::move(database)) {}
  Database database_;
};

/// An error if there is no such pack, or if it is damaged there. None: it has no such file.
Expected<std::optional<std::string>> read_packed(const PackAddress& at);
/// The size of a file in a pack, without reading it.
Expected<std::optional<std::uint64_t>> size_packed(const PackAddress& at);
/// The names in a pack that begin with `folder` and '/', without it, in order.
Expected<std::vector<std::string>> names_packed(const PackAddress& folder);
/// Reads all of it. The error names campaign and file.
Expected<void> check_pack(const std::filesystem::path& pack);
/// Copies a pack into OUT/.nonio/packs, where it appears whole or not at all, under a name that begins so and holds
/// its digest: who writes other bytes writes another file.
Expected<PackFile> hand_over(const std::filesystem::path& pack, const std::filesystem::path& out,
                             const std::string& begin);
/// Whether the pack that was handed over is there as it was. An error if it is not names what is wrong with it.
Expected<void> check_handed_over(const std::filesystem::path& out, const PackFile& pack);
/// Packs are kept open; none is afterwards. A new process opens its own.
void close_packs();

}  // namespace nonio::storage
