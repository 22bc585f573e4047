// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/check.h"
#include "nonio/sdk/plugin.h"
#include "platform/process/guarded.h"

namespace nonio::reading {

/// Returns the bytes by which readers recognize a file.
inline std::string_view head_of(std::string_view bytes) { return bytes.substr(0, 4096); }

inline bool reads_columns_of(const Reader& reader, const Method* method) {
  return reader.reads_columns && method != nullptr && !method->columns.empty();
}

/// Readers recognize a method by its name if the method declares columns, otherwise by the kind of
/// its observations.
inline bool reads(const Reader& reader, const Measurement& m, const Method* method) {
  const bool of_its_own = method != nullptr && !method->columns.empty();
  return reader.reads(of_its_own ? method_name(m) : m.kind);
}

/// Returns an error if the observations are not consistent.
inline Expected<Observations> checked_read(const Reader& reader, const ReadInput& input) {
  const std::string who = "reader " + reader.info.name;
  auto observations = process::guarded(who, [&] { return reader.read(input); });
  if (observations)
    if (auto sound = check(*observations); !sound)
      return fail(who + " gave " + sound.error().message);
  return observations;
}

}  // namespace nonio::reading
