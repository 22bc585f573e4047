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

/// File with the earlier evaluations of a campaign, OUT/<campaign>/earlier.json. It exists only if
/// an earlier evaluation differed.
namespace nonio::store {

inline constexpr const char* earlier_name = "earlier.json";

/// One evaluation of a campaign.
struct Known {
  evaluation::IndexedSince since;
  Entry entry;
};

/// The evaluations and certificates in the output folder of a campaign.
struct FolderHistory {
  std::vector<Known> evaluations;            ///< oldest first; each supersedes the one before
  std::vector<CertificateRow> certificates;  ///< all certificates issued for the campaign
};

/// Reads the evaluations up to the one in force: that of the record, or the last good one if the
/// campaign failed temporarily. Empty if nothing was evaluated yet. An error names the damaged
/// file.
Expected<FolderHistory> history_of(const std::filesystem::path& folder, const std::string& id);

/// Returns the runs of the evaluations that `history_of` returns, without reading results.json.
Expected<std::vector<std::uint64_t>> runs_of(const std::filesystem::path& folder);

/// Data to be stored with new results, so that earlier evaluations are kept.
struct Carried {
  std::optional<evaluation::IndexedSince> indexed{};
  std::string earlier{};  ///< bytes of earlier.json; empty: none
};

/// Returns what has to be stored before the new results with the record `fresh` replace those in
/// the folder.
Expected<Carried> carry_over(const std::filesystem::path& folder, const evaluation::Record& fresh,
                             std::string_view results, const std::string& id);

}  // namespace nonio::store
