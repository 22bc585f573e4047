// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "nonio/host/evaluate.h"

namespace nonio::host {

/// SHA-256 of the files of readings, one behind the other, as they were evaluated.
Expected<std::string> readings_digest(const Inputs& inputs, const std::filesystem::path& folder);

/// What a night does with the site's register. Every call opens it by itself: no process inherits
/// it from another.
class Numbers {
 public:
  /// `today`: the day of the night, YYYY-MM-DD. `can_sign`: there is a key, or nothing is drawn.
  Numbers(std::filesystem::path site, const Context& context, std::string today, bool can_sign)
      : site_(std::move(site)), context_(context), today_(std::move(today)), can_sign_(can_sign) {}

  /// See `Draw`.
  Expected<Certificate> draw(const Evaluated& evaluated, const std::filesystem::path& folder,
                             std::vector<std::string>& missing) const;
  /// After signing: enters what is issued into the register, and gives the campaign what the
  /// register holds. Of what was issued before it is said if its numbers are others now.
  Expected<void> issue(Evaluated& evaluated) const;
  /// A number that was drawn for a campaign keeps the reason why it is not issued. Silent: there is
  /// nobody left to tell.
  void note_failure(const std::string& campaign, const std::string& why) const;

 private:
  bool has_register() const;
  void note_differences(Evaluated& evaluated) const;

  const std::filesystem::path site_;
  const Context& context_;
  const std::string today_;
  const bool can_sign_;
};

}  // namespace nonio::host
