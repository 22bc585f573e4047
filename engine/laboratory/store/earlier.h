// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/evaluation/record.h"
#include "laboratory/store/entry.h"

/// File of a campaign with earlier evaluations. It exists only if an earlier evaluation differs.
namespace nonio::store {

inline constexpr const char* earlier_name = "earlier.json";

struct Known {
  evaluation::IndexedSince since;
  Entry entry;
};

struct FolderHistory {
  std::vector<Known> evaluations;            ///< oldest first; each supersedes the previous one
  std::vector<CertificateRow> certificates;  ///< all issued certificates
};

/// Reads the evaluations up to the one in force, which is the last good one after a temporary
/// failure. Empty before the first evaluation. An error names the damaged file.
Expected<FolderHistory> history_of(const std::filesystem::path& folder, const std::string& id);

/// Returns the runs of the evaluations of `history_of` without reading results.json.
Expected<std::vector<std::uint64_t>> runs_of(const std::filesystem::path& folder);

/// Data that must be stored with new results, so that earlier evaluations are kept.
struct Carried {
  std::optional<evaluation::IndexedSince> indexed{};
  std::string earlier{};  ///< content of earlier.json; empty if no file is needed
};

/// Call before new results with the record `fresh` replace the stored results.
Expected<Carried> carry_over(const std::filesystem::path& folder, const evaluation::Record& fresh,
                             std::string_view results, const std::string& id);

}  // namespace nonio::store
