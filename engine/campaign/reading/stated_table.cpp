// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/stated_table.h"

#include "platform/process/guarded.h"

namespace nonio::reading {

std::optional<StatedTable> stated_table(const loader::Plugins& plugins, std::string_view bytes,
                                        std::size_t most) {
  for (const Reader& r : plugins.readers()) {
    if (r.first_rows == nullptr) continue;
    auto rows =
        process::guarded("reader " + r.info.name, [&] { return r.first_rows(bytes, most); });
    if (rows && !rows->empty() && rows->front().size() > 1)
      return StatedTable{&r, std::move(*rows)};
  }
  return std::nullopt;
}

}  // namespace nonio::reading
