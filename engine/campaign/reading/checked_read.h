// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/check.h"
#include "nonio/sdk/plugin.h"
#include "platform/process/guarded.h"

namespace nonio::reading {

/// Returns the first 4096 bytes of a file, by which readers recognize it.
inline std::string_view head_of(std::string_view bytes) { return bytes.substr(0, 4096); }

/// Whether a reader reads the columns that this method declares.
inline bool reads_columns_of(const Reader& reader, const Method* method) {
  return reader.reads_columns && method != nullptr && !method->columns.empty();
}

/// Whether a reader reads a measurement of this method. `Reader::reads` receives the name of the
/// method if the method declares columns, otherwise the kind as which the measurement is observed.
inline bool reads(const Reader& reader, const Measurement& m, const Method* method) {
  const bool of_its_own = method != nullptr && !method->columns.empty();
  return reader.reads(of_its_own ? method_name(m) : m.kind);
}

/// Reads a file and checks that the observations are consistent. An error names the reader.
inline Expected<Observations> checked_read(const Reader& reader, const ReadInput& input) {
  const std::string who = "reader " + reader.info.name;
  auto observations = process::guarded(who, [&] { return reader.read(input); });
  if (observations)
    if (auto sound = check(*observations); !sound)
      return fail(who + " gave " + sound.error().message);
  return observations;
}

}  // namespace nonio::reading
