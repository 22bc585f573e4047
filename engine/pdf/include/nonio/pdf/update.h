// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/reader.h"
#include "nonio/sdk/error.h"

/// Incremental updates of a signed file. An update adds revocation data, or a time stamp over all
/// preceding bytes, or both (EN 319 142-1, levels B-LT and B-LTA). To check an update of a file, it
/// is written again by `Updater` and compared byte by byte, so that it cannot contain anything
/// else.
namespace nonio::pdf {

/// Revocation data in DER of a PDF's document security store: certificates, OCSP responses
/// (`answers`) and certificate revocation lists (`lists`).
struct Store {
  std::vector<std::string> certificates, answers, lists;
  bool empty() const { return certificates.empty() && answers.empty() && lists.empty(); }
};

struct Update {
  Store store;
  bool has_stamp = false;
  /// In the result of `write`, the space for the time stamp contains zeros.
  std::string bytes;
  /// Positions of the "<" of the time stamp and of the byte after its ">" in the file.
  std::size_t gap = 0, after = 0;
};

inline constexpr std::size_t most_updates = 20, most_stored = 100;
/// Largest total size of the updates of a file, bytes.
inline constexpr std::size_t most_update_bytes = 10'000'000;

/// Returns the positions in bytes at which the signed file and each of its updates end; the last
/// one is the size of the file. Only the cross-reference tables at the end of each part are read.
/// If they do not divide the file, it is one part; at most `most_updates` updates are separated.
std::vector<std::size_t> ends_of_parts(std::string_view bytes);

/// Writes or reads the successive updates of one signed file.
class Updater {
 public:
  /// The file must outlive the updater. Error: it does not have the form that `reserve` writes.
  static Expected<Updater> of(const File& signed_file);

  /// Returns the next update, to be appended to the file. It adds `more` to the stored revocation
  /// data and, if `has_stamp`, space for a time stamp. Error: there is nothing to add, or more than
  /// `most_stored` items would be stored.
  Expected<Update> write(const Store& more, bool has_stamp);
  /// Returns the next update, which ends at byte `end`. Error: apart from the time stamp, it
  /// differs from what `write` would have written.
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
  /// Positions of the end of the file so far and of the last cross-reference table, bytes.
  std::size_t end_ = 0, last_table_ = 0;
  std::size_t size_ = 0;  ///< smallest unused object number
  /// Number of the object that lists all revocation data; 0 without such data.
  std::size_t store_ = 0;
  std::vector<std::size_t> certificates_, answers_, lists_, fields_;
};

}  // namespace nonio::pdf
