// SPDX-License-Identifier: Apache-2.0
#include "merge.h"

#include <optional>

#include "nonio/controllers/text.h"

namespace nonio::aerotech {
namespace {

class Blocks {
 public:
  std::int64_t axis_of(std::string_view line) {
    const auto words = controllers::words_of(line.substr(0, line.find_first_of(";'")));
    if (words.empty()) return axis_;
    const bool starts = words[0] == ":START" && !open_;
    if (starts)
      axis_ = controllers::whole(words.size() > 1 ? words[1] : std::string_view()).value_or(0);
    open_ = open_ || words[0].starts_with(":START");
    const std::int64_t here = axis_;
    if (words[0] == ":END") open_ = false, axis_ = 0;
    return here;
  }

 private:
  std::int64_t axis_ = 0;
  bool open_ = false;
};

bool has_tables(const std::string& text) { return text.find(":START") != std::string::npos; }

}  // namespace

Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  std::string fresh, words;
  std::int64_t axis = 0;
  Blocks blocks;
  for (const Artifact& f : in.table)
    for (const std::string_view line : controllers::lines_of(f.bytes)) {
      if (const std::int64_t of = blocks.axis_of(line); of != 0) {
        axis = of;
        fresh += words + std::string(line) + "\n";
        words.clear();
      } else if (line.starts_with(';')) {
        words += std::string(line) + "\n";
      }
    }
  if (axis == 0) return fail("no new table of axis " + in.axis);
  std::vector<Artifact> out;
  for (const Artifact& f : in.backup) {
    Blocks of_file;
    auto text = controllers::with_lines(
        controllers::without_origin(f.bytes, ";", in.axis, [](std::string_view) { return true; }),
        [&](std::string_view line) { return of_file.axis_of(line) == axis; }, fresh, {});
    if (!text) continue;
    if (!out.empty())
      return fail("two files of the backup hold tables of axis " + std::to_string(axis) +
                  ": the control adds them; take one out first");
    out.push_back({f.name, std::move(*text)});
  }
  for (const Artifact& f : in.backup)
    if (out.empty() && has_tables(f.bytes))
      out.push_back(
          {f.name, *controllers::with_lines(
                       f.bytes, [](std::string_view) { return false; }, fresh, f.bytes.size())});
  if (out.empty()) return fail("the backup holds no table (:START)");
  return out;
}

}  // namespace nonio::aerotech
