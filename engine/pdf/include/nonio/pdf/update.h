// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/reader.h"
#include "nonio/sdk/error.h"

/// What may be added to a signed file: revocation data and time stamps over all bytes before them
/// (EN 319 142-1, B-LT and B-LTA), each time as an incremental update of one form. What is read is
/// written again and compared byte by byte, so that an update contains nothing else.
namespace nonio::pdf {

/// DER, as the document security store holds them.
struct Store {
  std::vector<std::string> certificates, answers, lists;
  bool empty() const { return certificates.empty() && answers.empty() && lists.empty(); }
};

/// An update at the end of a file, present or planned.
struct Update {
  Store store;  ///< what is new in it
  bool has_stamp = false;
  std::string bytes;  ///< of a time stamp, zeros
  std::size_t gap = 0,
              after = 0;  ///< in the file: position of the stamp's "<", and of what follows its ">"
};

inline constexpr std::size_t most_updates = 20, most_stored = 100;
/// Of all updates of a file together.
inline constexpr std::size_t most_update_bytes = 10'000'000;

/// Where the file as it was signed ends, then each update. By the tables at the end of each;
/// nothing else is read. What cannot be taken apart is one part.
std::vector<std::size_t> ends_of_parts(std::string_view bytes);

/// Writes updates of one file, one after the other.
class Updater {
 public:
  /// `signed_file` must outlive it. An error if it is not as `reserve` makes it.
  static Expected<Updater> of(const File& signed_file);

  /// What follows at this place of the file. An error if there is nothing to write, or too much.
  Expected<Update> write(const Store& more, bool has_stamp);
  /// The next update, which ends at `end`: the same, but for the time stamp, as `write` would have
  /// written it.
  Expected<Update> read(std::string_view bytes, std::size_t end);

 private:
  class Objects;
  explicit Updater(const File& file);
  Expected<Store> read_store(std::string_view bytes, std::size_t& at) const;
  std::string object_of_catalogue() const;
  std::string object_of_page() const;
  std::string table(const std::vector<std::pair<std::size_t, std::size_t>>& places, std::size_t at,
                    const std::string& body) const;

  const File* file_;
  std::size_t catalogue_ = 0, page_ = 0;
  std::size_t end_ = 0, last_table_ = 0;  ///< of what precedes the next update
  std::size_t size_ = 0;                  ///< the first number that is free
  std::size_t store_ = 0;                 ///< the object with the whole store; 0: there is none
  std::vector<std::size_t> certificates_, answers_, lists_, fields_;
};

}  // namespace nonio::pdf
