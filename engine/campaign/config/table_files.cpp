// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/table_files.h"

#include <algorithm>
#include <utility>

#include "platform/storage/files.h"

namespace nonio::config {
namespace {

template <class Read>
Expected<std::vector<Artifact>> read_list(const std::string& list, const Read& read) {
  std::vector<Artifact> files;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    const std::filesystem::path path = list.substr(from, comma - from);
    auto bytes = read(path);
    if (!bytes) return tl::unexpected<Error>(bytes.error());
    files.push_back({path.filename().string(), std::move(*bytes)});
    from = comma + 1;
  }
  return files;
}

}  // namespace

Expected<std::vector<Artifact>> read_table_files(const std::string& list) {
  return read_list(list,
                   [](const std::filesystem::path& path) { return storage::read_file(path); });
}

Expected<std::vector<Artifact>> read_table_files(const std::string& list,
                                                 const std::filesystem::path& base) {
  return read_list(list, [&](const std::filesystem::path& path) -> Expected<std::string> {
    NONIO_TRY(const auto inside, storage::path_inside(base, path.string()));
    auto bytes = storage::read_small_file(inside);
    if (!bytes) return fail(path.string() + ": " + bytes.error().message);
    return bytes;
  });
}

}  // namespace nonio::config
