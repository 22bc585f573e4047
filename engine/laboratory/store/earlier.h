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

/// The entry of a campaign before its results were replaced: OUT/<campaign>/earlier.json, which
/// exists only if that entry was different.
namespace nonio::store {

inline constexpr const char* earlier_name = "earlier.json";

/// One evaluation in the chain of a campaign, oldest first.
struct Known {
  evaluation::IndexedSince since;
  Entry entry;
};

/// What the output folder of a campaign states.
struct FolderHistory {
  std::vector<Known> evaluations;            ///< each supersedes the one before
  std::vector<CertificateRow> certificates;  ///< all numbers that it was issued
};

/// The results that count: those of the record, or the last good ones where it failed for a reason
/// that may pass. Empty if nothing was evaluated yet. An error names the file that is damaged.
Expected<FolderHistory> history_of(const std::filesystem::path& folder, const std::string& id);

/// The runs of those evaluations, without reading the results.
Expected<std::vector<std::uint64_t>> runs_of(const std::filesystem::path& folder);

/// What is to be stored in addition to new results, so that earlier knowledge is kept.
struct Carried {
  std::optional<evaluation::IndexedSince> indexed{};
  std::string earlier{};  ///< bytes of earlier.json; empty: none
};

/// Before `fresh`, the record of these new results, takes the place of what is in the folder.
Expected<Carried> carry_over(const std::filesystem::path& folder, const evaluation::Record& fresh,
                             std::string_view results, const std::string& id);

}  // namespace nonio::store
