// SPDX-License-Identifier: Apache-2.0
#include "merge.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "nonio/controllers/text.h"

namespace nonio::siemens_840d {
namespace {

/// Parts of a line such as "$AN_CEC_STEP[3]=50".
struct Line {
  std::string name;
  std::vector<std::string> index;
  std::string value;
};

std::optional<Line> line_of(std::string_view text) {
  text = controllers::trimmed(text.substr(0, text.find(';')));
  const std::size_t open = text.find('['), close = text.find(']'), equals = text.find('=');
  if (text.empty() || text.front() != '$' || close == std::string_view::npos ||
      equals == std::string_view::npos || !(open < close && close < equals))
    return std::nullopt;
  Line line{std::string(text.substr(1, open - 1)),
            {},
            std::string(controllers::trimmed(text.substr(equals + 1)))};
  for (const auto word : controllers::words_of(text.substr(open + 1, close - open - 1), ", \t"))
    line.index.emplace_back(word);
  return line;
}

using IsOwn = std::function<bool(const Line&)>;

bool is_comment(std::string_view line) { return controllers::trimmed(line).starts_with(';'); }

std::optional<std::string> replaced(const std::string& before, const IsOwn& is_own,
                                    const std::string& axis, const std::string& lines, bool add) {
  const std::string text =
      controllers::without_origin(before, ";", axis, [&](std::string_view one) {
        const auto line = line_of(one);
        return line && is_own(*line);
      });
  std::optional<std::size_t> end;
  for (const std::string_view one : controllers::lines_of(text))
    if (add && controllers::trimmed(one) == "M17")
      end = static_cast<std::size_t>(one.data() - text.data());
  return controllers::with_lines(
      text,
      [&](std::string_view one) {
        const auto line = line_of(one);
        return line && is_own(*line);
      },
      lines, end);
}

std::string body_of(const std::string& text) {
  std::string out;
  for (const std::string_view line : controllers::lines_of(text))
    if (line_of(line) || is_comment(line)) out += std::string(controllers::trimmed(line)) + "\n";
  return out;
}

std::vector<Line> lines_in(const std::vector<Artifact>& files) {
  std::vector<Line> out;
  for (const Artifact& f : files)
    for (const std::string_view text : controllers::lines_of(f.bytes))
      if (auto line = line_of(text)) out.push_back(std::move(*line));
  return out;
}

/// An axis with a name other than AXn could be the axis of the new table.
Expected<void> only_numbered(const std::vector<Artifact>& files) {
  const auto check = [](std::string_view axis) -> Expected<void> {
    const auto number =
        axis.starts_with("AX") ? controllers::whole(axis.substr(2)) : std::optional<std::int64_t>();
    if (number) return {};
    return fail("the backup calls an axis " + controllers::plain(axis) +
                ": expected AX1, AX2 and so on, which states whose table it is; save it so");
  };
  for (const Line& l : lines_in(files)) {
    const bool axis_last = l.name.rfind("AA_ENC_COMP", 0) == 0 || l.name == "MA_BACKLASH";
    if (axis_last && !l.index.empty())
      if (auto ok = check(l.index.back()); !ok) return ok;
    if ((l.name == "AN_CEC_INPUT_AXIS" || l.name == "AN_CEC_OUTPUT_AXIS") && l.value.size() > 2)
      if (auto ok = check(std::string_view(l.value).substr(1, l.value.size() - 2)); !ok) return ok;
  }
  return {};
}

struct Cec {
  std::string input, output, direction;
};

std::map<std::string, Cec> tables_in(const std::vector<Artifact>& files) {
  std::map<std::string, Cec> tables;
  const auto axis = [](const std::string& v) {
    return v.size() > 2 ? v.substr(1, v.size() - 2) : v;
  };
  for (const Line& l : lines_in(files)) {
    if (l.name.rfind("AN_CEC", 0) != 0 || l.index.empty()) continue;
    Cec& t = tables[l.index[0]];
    if (l.name == "AN_CEC_INPUT_AXIS") t.input = axis(l.value);
    if (l.name == "AN_CEC_OUTPUT_AXIS") t.output = axis(l.value);
    if (l.name == "AN_CEC_DIRECTION") t.direction = l.value;
  }
  return tables;
}

bool is_taken(std::int64_t number, const Settings& options) {
  const auto used = controllers::ranges_of(options.texts("taken"));
  return std::any_of(used.begin(), used.end(),
                     [&](const auto& r) { return r.first <= number && number <= r.second; });
}

Expected<std::map<std::string, std::string>> numbers_for(const std::map<std::string, Cec>& fresh,
                                                         const std::map<std::string, Cec>& present,
                                                         const Settings& options) {
  std::map<std::string, std::string> numbers;
  std::set<std::string> used;
  for (const auto& [number, t] : present) used.insert(number);
  for (const auto& [number, t] : fresh) {
    for (const auto& [old, p] : present)
      if (p.input == t.input && p.output == t.output && p.direction == t.direction) {
        if (numbers.contains(number))
          return fail("the backup has two tables of " + t.output + " in direction " + t.direction);
        numbers[number] = old;
      } else if (p.input == t.input && p.output == t.output && p.direction == "0") {
        return fail("table " + old + " of the backup compensates " + t.output +
                    " in both directions: take it out first");
      }
    for (std::int64_t k = 0; !numbers.contains(number) && k <= 127; ++k)
      if (!is_taken(k, options) && used.insert(std::to_string(k)).second)
        numbers[number] = std::to_string(k);
    if (!numbers.contains(number)) return fail("no number of a CEC table is free");
  }
  return numbers;
}

class Merger {
 public:
  explicit Merger(const MergeInput& in) : in_(in), files_(in.backup), changed_(in.backup.size()) {}

  Expected<void> take(const Artifact& table) {
    const std::string lines = body_of(table.bytes);
    const std::vector<Line> assignments = lines_in({table});
    if (assignments.empty()) return {};
    const Line* const first = &assignments.front();
    if (first->name.rfind("AN_CEC", 0) == 0) return take_directions(table);
    const bool backlash = first->name == "MA_BACKLASH";
    const std::string axis = first->index.back(), system = first->index.front();
    const auto own = [&](const Line& l) {
      return l.index.size() > 1 && l.index.front() == system && l.index.back() == axis &&
             (backlash ? l.name == "MA_BACKLASH" : l.name.rfind("AA_ENC_COMP", 0) == 0);
    };
    if (put(own, lines, backlash ? "MA_BACKLASH" : "AA_ENC_COMP")) return {};
    if (!backlash) return fail("the backup holds no $AA_ENC_COMP");
    added_.push_back(table);
    return {};
  }

  std::vector<Artifact> changed() const {
    std::vector<Artifact> out;
    for (std::size_t i = 0; i < files_.size(); ++i)
      if (changed_[i]) out.push_back(files_[i]);
    out.insert(out.end(), added_.begin(), added_.end());
    return out;
  }

 private:
  Expected<void> take_directions(const Artifact& table) {
    const auto numbers = numbers_for(tables_in({table}), tables_in(files_), in_.options);
    if (!numbers) return fail(numbers.error());
    std::string lines;
    std::set<std::string> own;
    for (const std::string_view text : controllers::lines_of(table.bytes))
      if (is_comment(text)) {
        lines += std::string(controllers::trimmed(text)) + "\n";
      } else if (const auto l = line_of(text)) {
        const std::string& to = numbers->at(l->index[0]);
        own.insert(to);
        lines += "$" + l->name + "[" + to + (l->index.size() > 1 ? "," + l->index[1] : "") +
                 "]=" + l->value + "\n";
      }
    const auto is_own = [&](const Line& l) {
      return l.name.rfind("AN_CEC", 0) == 0 && !l.index.empty() && own.contains(l.index[0]);
    };
    if (put(is_own, lines, "AN_CEC")) return {};
    return fail("the backup holds no $AN_CEC: load the new file as it is");
  }

  bool put(const IsOwn& is_own, const std::string& lines, const std::string& kind) {
    for (const bool add : {false, true})
      for (std::size_t i = 0; i < files_.size(); ++i) {
        if (add && files_[i].bytes.find("$" + kind) == std::string::npos) continue;
        auto text = replaced(files_[i].bytes, is_own, in_.axis, lines, add);
        if (!text) continue;
        changed_[i] = *text != files_[i].bytes;
        files_[i].bytes = std::move(*text);
        return true;
      }
    return false;
  }

  const MergeInput& in_;
  std::vector<Artifact> files_, added_;
  std::vector<bool> changed_;
};

}  // namespace

Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  if (auto ok = only_numbered(in.backup); !ok) return fail(ok.error());
  Merger merger(in);
  for (const Artifact& table : in.table)
    if (auto done = merger.take(table); !done) return fail(done.error());
  return merger.changed();
}

}  // namespace nonio::siemens_840d
