// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "live/guard.h"
#include "nonio/sdk/error.h"

/// What a person does on the page of a campaign: a value without files, processes or clock.
namespace nonio::live {

/// A reading that a person has excluded; `row` counts the readings of its part as the files have
/// them.
struct Excluded {
  std::string part;
  std::size_t row = 0;
  std::string measurement, file;
  std::uint32_t measurement_row = 0;  ///< of the measurement's table
  std::uint64_t line = 0;             ///< 0: the reader does not state it
  std::string why;
  bool operator==(const Excluded&) const = default;
};

/// Everything that a fit depends on apart from the files.
struct Trial {
  std::vector<std::string> model;           ///< in the order in which saving would write it
  std::vector<Excluded> excluded;           ///< by part and row
  std::map<std::string, double> period_mm;  ///< of axes whose period is tried
  bool operator==(const Trial&) const = default;
};

struct Step {
  std::size_t n = 0;
  std::string name;  ///< what a person calls it
  std::string what;  ///< "+ backlash:X"
  Trial trial;
};

/// Else a sentence for the person, its name without "refused." in front.
using Done = tl::expected<void, Said>;

class Session {
 public:
  Session() = default;
  /// Begins with the model of campaign.toml.
  explicit Session(std::vector<std::string> saved);

  std::uint64_t version() const { return version_; }
  const Trial& trial() const { return steps_[at_].trial; }
  const std::vector<Step>& steps() const { return steps_; }
  std::size_t at() const { return at_; }
  const std::vector<std::string>& saved() const { return saved_; }
  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < steps_.size(); }

  // What changes it; an error leaves it as it is. Whether an effect exists is the caller's concern.
  Done add(const std::string& effect);
  Done drop(const std::string& effect);
  Done set(const std::vector<std::string>& model);
  Done undo();
  Done redo();
  Done go_to(std::size_t n);
  Done name(std::size_t n, const std::string& name);
  /// Those that are excluded already get the new reason.
  Done exclude(const std::vector<Excluded>& readings);
  Done include(const std::string& part, const std::vector<std::size_t>& rows);
  /// 0: as campaign.toml has it.
  Done period(const std::string& axis, double period_mm);

  /// The model was written to campaign.toml, or read from it anew.
  void was_saved(const std::vector<std::string>& model);
  /// The files were read again: readings may be others, so none is excluded any more. Model and
  /// periods are those of the file.
  void was_read_again(const std::vector<std::string>& model);
  /// Something that the page shows has changed, apart from the trial.
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

/// What does on a terminal what leads from campaign.toml with this model to the trial; "" where they
/// are the same.
std::string command_of(const std::string& campaign, const std::vector<std::string>& saved,
                       const Trial& trial);
/// From one trial to the next: what a terminal cannot take back is left out.
std::string command_between(const std::string& campaign, const Trial& from, const Trial& to);
/// A word as a shell takes it.
std::string quoted_for_shell(const std::string& word);

}  // namespace nonio::live
