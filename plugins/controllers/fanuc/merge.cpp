// SPDX-License-Identifier: Apache-2.0
#include "merge.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "nonio/controllers/axes.h"
#include "nonio/controllers/text.h"

namespace nonio::fanuc {
namespace {

constexpr std::int64_t first_pitch = 10000;

/// One value of a punched text (N1851A3P12). A block can have several axes; axis 0 is a common
/// value.
struct Word {
  std::int64_t number = 0, axis = 0, value = 0;
  std::size_t at = 0, size = 0;
};

std::optional<std::int64_t> digits_at(std::string_view text, std::size_t at, std::size_t& end) {
  end = at;
  if (end < text.size() && (text[end] == '-' || text[end] == '+')) ++end;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
  return controllers::whole(text.substr(at, end - at));
}

std::vector<Word> words_in(std::string_view text) {
  std::vector<Word> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end_of_line = std::min(text.find('\n', at), text.size());
    Word word;
    bool numbered = false;
    while (at < end_of_line) {
      const char letter = text[at++];
      std::size_t end = at;
      const auto value = digits_at(text.substr(0, end_of_line), at, end);
      if (!value) continue;
      if (letter == 'N') word = {*value, 0, 0, 0, 0}, numbered = true;
      if (letter == 'A') word.axis = *value;
      if (letter == 'P' && numbered) {
        word.value = *value, word.at = at, word.size = end - at;
        words.push_back(word);
      }
      at = end;
    }
    at = end_of_line + 1;
  }
  return words;
}

using Values = std::map<std::int64_t, std::int64_t>;

struct Range {
  std::int64_t low, high;
  bool meets(const Range& other) const { return low <= other.high && other.low <= high; }
};

std::vector<Range> ranges_of(const Values& p) {
  const auto at = [&](std::int64_t n) {
    const auto it = p.find(n);
    return it == p.end() ? 0 : it->second;
  };
  if (at(3624) <= 0 || at(3622) <= at(3621)) return {};
  std::vector<Range> out{{at(3621), at(3622)}};
  if (at(3626) > 0) out.push_back({at(3626), at(3626) + at(3622) - at(3621)});
  return out;
}

class Backup {
 public:
  explicit Backup(const Artifact& file) : file_(file) { read(); }

  bool has_axis(std::int64_t axis) const { return axes_.contains(axis); }
  std::vector<Range> own(std::int64_t axis) const {
    const auto it = axes_.find(axis);
    return it == axes_.end() ? std::vector<Range>{} : ranges_of(it->second);
  }
  std::optional<std::int64_t> parameter(std::int64_t axis, std::int64_t number) const {
    const auto it = axes_.find(axis);
    const auto value = it == axes_.end() ? Values::const_iterator{} : it->second.find(number);
    return it == axes_.end() || value == it->second.end() ? std::nullopt
                                                          : std::optional(value->second);
  }
  std::vector<Range> foreign(std::int64_t axis) const {
    std::vector<Range> out;
    for (const auto& [other, values] : axes_)
      if (other != axis)
        for (const Range& r : ranges_of(values)) out.push_back(r);
    const auto mine = own(axis);
    for (const auto& [point, value] : pitch_)
      if (const Range one{point, point};
          value != 0 &&
          std::none_of(mine.begin(), mine.end(), [&](const Range& r) { return r.meets(one); }))
        out.push_back(one);
    return out;
  }

  void set(std::int64_t number, std::int64_t axis, std::int64_t value) {
    for (const Word& w : words_in(file_.bytes))
      if (w.number == number && w.axis == axis) {
        if (w.value != value) file_.bytes.replace(w.at, w.size, std::to_string(value));
        return;
      }
    const std::size_t end = file_.bytes.rfind('%');
    const std::size_t before = end == 0 ? 0 : file_.bytes.rfind('\n', end - 1);
    const bool returns =
        before != std::string::npos && before > 0 && file_.bytes[before - 1] == '\r';
    file_.bytes.insert(end, "N" + std::to_string(number) +
                                (axis == 0 ? "" : "A" + std::to_string(axis)) + "P" +
                                std::to_string(value) + (returns ? "\r\n" : "\n"));
  }
  const Artifact& file() const { return file_; }

 private:
  void read() {
    for (const Word& w : words_in(file_.bytes)) {
      if (w.number >= first_pitch && w.axis == 0) pitch_[w.number - first_pitch] = w.value;
      if (w.number < first_pitch && w.axis != 0) axes_[w.axis][w.number] = w.value;
    }
  }
  Artifact file_;
  std::map<std::int64_t, Values> axes_;
  Values pitch_;
};

/// Offset of the new point numbers to the range of the axis in the backup, or to the first free
/// range.
Expected<std::int64_t> shift_of(const std::vector<Range>& fresh, const Backup& backup,
                                std::int64_t axis, const MergeInput& in) {
  const auto mine = backup.own(axis);
  std::vector<Range> foreign = backup.foreign(axis);
  for (const auto& [low, high] : controllers::ranges_of(in.options.texts("taken")))
    if (mine.empty() || !mine.front().meets({low, high})) foreign.push_back({low, high});
  const std::int64_t last = in.options.integer("last_number", 1023);
  const auto fits = [&](std::int64_t low) {
    const std::int64_t by = low - fresh.front().low;
    if (low < 0 || fresh.front().high + by > last) return false;
    return std::none_of(fresh.begin(), fresh.end(), [&](const Range& r) {
      return std::any_of(foreign.begin(), foreign.end(), [&](const Range& f) {
        return f.meets({r.low + by, r.high + by});
      });
    });
  };
  if (!mine.empty() && fits(mine.front().low)) return mine.front().low - fresh.front().low;
  for (std::int64_t low = 0; low <= last; ++low)
    if (fits(low)) return low - fresh.front().low;
  return fail("axis " + in.axis + ": no " +
              std::to_string(fresh.front().high - fresh.front().low + 1) + " numbers of 0.." +
              std::to_string(last) + " are free in the backup: set a larger step_mm");
}

}  // namespace

Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  const auto punched = [](const Artifact& a) { return a.bytes.rfind('%', 0) == 0; };
  const auto table = std::find_if(in.table.begin(), in.table.end(), punched);
  if (table == in.table.end()) return fail("no new table of axis " + in.axis);
  if (std::count_if(in.backup.begin(), in.backup.end(), punched) != 1)
    return fail("expected one punched file, with the parameters and the pitch data of all axes");
  Backup backup(*std::find_if(in.backup.begin(), in.backup.end(), punched));
  const auto words = words_in(table->bytes);
  Values parameters;
  std::int64_t axis = 0;
  for (const Word& w : words)
    if (w.axis != 0) parameters[w.number] = w.value, axis = w.axis;
  const auto fresh = ranges_of(parameters);
  if (axis == 0 || fresh.empty()) return fail("no new table of axis " + in.axis);
  if (!backup.has_axis(axis))
    return fail("the backup holds no parameters of controlled axis " + std::to_string(axis));
  const bool two = parameters.contains(3626);
  if (const auto bits = backup.parameter(axis, 3605); bits && (*bits % 10 == 1) != two)
    return fail("3605#0 of controlled axis " + std::to_string(axis) +
                " does not fit the new table, which has " + (two ? "two directions" : "one set") +
                ": set it on the control and save again, or change option directions");
  NONIO_TRY(const auto shift, shift_of(fresh, backup, axis, in));
  const std::set<std::int64_t> points{3620, 3621, 3622, 3626};
  for (const Word& w : words) {
    const bool moves = w.axis != 0 ? points.contains(w.number) : w.number >= first_pitch;
    const std::int64_t number = w.axis == 0 && moves ? w.number + shift : w.number;
    backup.set(number, w.axis, w.axis != 0 && moves ? w.value + shift : w.value);
  }
  return std::vector<Artifact>{backup.file()};
}

}  // namespace nonio::fanuc
