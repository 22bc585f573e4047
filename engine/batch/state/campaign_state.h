// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "batch/state/kept_text.h"
#include "campaign/evaluation/status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// One campaign of the run, as it is known so far. Small, since there may be ten million: 56 bytes and its texts. What
/// its record holds (findings) is read again for the summary.
class CampaignState {
 public:
  KeptText id;
  KeptText folder;   ///< relative to the site, in the bytes of the file system
  KeptText reason;   ///< why it is to do, or why not
  KeptText history;  ///< where `shows_history`: digest of it; empty: not known when it was written
  enum class Action : char { todo, done, unchanged } action = Action::todo;
  evaluation::Status status = evaluation::Status::none;  ///< none while it is to do
  bool named_by_folder = false;                          ///< its manifest gives no id
  bool is_campaign = true;     ///< false: a folder whose content is unknown
  bool shows_history = false;  ///< a document shows the machine's history

  using TwinBefore = std::pair<std::uint64_t, std::string>;
  using Twin = std::pair<std::uint64_t, std::uint32_t>;

  const std::vector<Error>& errors() const { return seldom().errors; }
  void set_errors(std::vector<Error> errors);
  /// Of the manifest: keys with former names. Not kept for the next run.
  const std::vector<Error>& warnings() const { return seldom().warnings; }
  void set_warnings(std::vector<Error> warnings);
  /// Begin of the SHA-256 of files that another campaign has too, and its position in the list of campaigns.
  const std::vector<Twin>& twins() const { return seldom().twins; }
  void add_twin(Twin twin) { change().twins.push_back(twin); }
  /// The same as its record knew it, with the other one's id.
  const std::vector<TwinBefore>& twins_before() const { return seldom().twins_before; }
  void set_twins_before(std::vector<TwinBefore> twins);
  /// Begin of the SHA-256 of each of its files, until they are compared with those of the others.
  std::vector<std::uint64_t> readings() const;
  void set_readings(std::span<const std::uint64_t> digests);

 private:
  /// What few campaigns have.
  struct Seldom {
    std::vector<Error> errors, warnings;
    std::vector<Twin> twins;
    std::vector<TwinBefore> twins_before;
  };
  /// Nothing, or one that is copied with it.
  class Held {
   public:
    Held() = default;
    Held(const Held& other) : at(other.at ? new Seldom(*other.at) : nullptr) {}
    Held(Held&&) noexcept = default;
    Held& operator=(Held other) noexcept {
      at = std::move(other.at);
      return *this;
    }
    ~Held() = default;
    std::unique_ptr<Seldom> at;
  };
  const Seldom& seldom() const;
  Seldom& change();

  enum class Readings : char { none, one, several } has_ = Readings::none;
  std::uint64_t readings_ = 0;  ///< the digest of the only one, or where the text of several is
  Held seldom_;
};

}  // namespace nonio::batch
