// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "live/guard.h"
#include "nonio/sdk/error.h"

/// Work of the user on the page of a campaign, without files, processes or clock.
namespace nonio::live {

/// `row` counts the readings of the part in the order of the files.
struct Excluded {
  std::string part;
  std::size_t row = 0;
  std::string measurement, file;
  std::uint32_t measurement_row = 0;  ///< row in the table of the measurement
  std::uint64_t line = 0;             ///< line in the file; 0 if unknown
  std::string why;
  bool operator==(const Excluded&) const = default;
};

/// Data on which a fit depends, apart from the files.
struct Trial {
  std::vector<std::string> model;           ///< effects in the order in which they would be saved
  std::vector<Excluded> excluded;           ///< sorted by part and row
  std::map<std::string, double> period_mm;  ///< tried periods by axis
  bool operator==(const Trial&) const = default;
};

struct Step {
  std::size_t n = 0;
  std::string name;
  std::string what;  ///< for example "+ backlash:X"
  Trial trial;
};

/// Success, or a sentence for the user; its name is without the prefix "refused.".
using Done = tl::expected<void, Said>;

class Session {
 public:
  Session() = default;
  /// Starts with the model in campaign.toml.
  explicit Session(std::vector<std::string> saved);

  std::uint64_t version() const { return version_; }
  const Trial& trial() const { return steps_[at_].trial; }
  const std::vector<Step>& steps() const { return steps_; }
  std::size_t at() const { return at_; }
  const std::vector<std::string>& saved() const { return saved_; }
  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < steps_.size(); }

  // The following functions change the trial, unless they return an error. The caller must check
  // that an effect exists.
  Done add(const std::string& effect);
  Done drop(const std::string& effect);
  Done set(const std::vector<std::string>& model);
  Done undo();
  Done redo();
  Done go_to(std::size_t n);
  Done name(std::size_t n, const std::string& name);
  /// Readings that are already excluded get the new reason.
  Done exclude(const std::vector<Excluded>& readings);
  Done include(const std::string& part, const std::vector<std::size_t>& rows);
  /// Sets the period of an axis; 0 restores that of campaign.toml.
  Done period(const std::string& axis, double period_mm);

  /// Must be called after the model was written to campaign.toml.
  void was_saved(const std::vector<std::string>& model);
  /// Must be called after the files were read again. Exclusions are removed, because readings may
  /// have changed; model and periods are those of the file.
  void was_read_again(const std::vector<std::string>& model);
  /// Marks a change of the page that does not affect the trial.
  void touch() { ++version_; }

 private:
  tl::unexpected<Said> no_step(std::size_t n) const;
  void take(Trial trial, std::string what);
  std::vector<std::string> in_order(const std::vector<std::string>& model) const;

  std::uint64_t version_ = 1;
  std::vector<Step> steps_{Step{}};
  std::size_t at_ = 0;
  std::vector<std::string> saved_;
};

/// Returns the commands that change the model `saved` to the trial; empty if they are equal.
std::string command_of(const std::string& campaign, const std::vector<std::string>& saved,
                       const Trial& trial);
/// Omits changes that no command can make, such as including readings again.
std::string command_between(const std::string& campaign, const Trial& from, const Trial& to);
std::string quoted_for_shell(const std::string& word);

}  // namespace nonio::live
