// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "rows.h"
#include "spatial.h"

namespace nonio::csv {
namespace {

using Pass = std::map<std::uint32_t, std::size_t>;

struct Corner {
  const char* name;
  Sense sign;
};
constexpr std::array<Corner, 4> corners = {
    {{"PPP", {1, 1, 1}}, {"NPP", {-1, 1, 1}}, {"PNP", {1, -1, 1}}, {"PPN", {1, 1, -1}}}};

class StepDiagonals {
 public:
  StepDiagonals(const Table& table, const Span& span, Observations& obs)
      : table_(table), span_(span), obs_(obs) {}

  Expected<void> read() {
    for (const Span::Side& side : span_.sides) obs_.axes.push_back({side.axis, false, {}, {}});
    if (auto sorted = sort_rows(); !sorted) return sorted;
    std::vector<std::pair<std::size_t, const std::pair<const Key, Pass>*>> in_order;
    for (const auto& pass : passes_) {
      std::size_t first = table_.size();
      for (const auto& [step, row] : pass.second) first = std::min(first, row);
      in_order.emplace_back(first, &pass);
    }
    std::sort(in_order.begin(), in_order.end());
    for (const auto& [first, pass] : in_order)
      if (auto done = take(pass->first, pass->second); !done) return done;
    if (repeated_ > 0)
      obs_.notes.push_back(
          {"csv.repeated-rows", {count("rows", repeated_), count("line", first_repeated_)}});
    return {};
  }

 private:
  using Key = std::pair<std::uint32_t, std::string>;  ///< run, diagonal

  double number(const char* column, std::size_t row) const {
    const auto* values = table_.column(column);
    return values == nullptr ? 1.0 : (*values)[row];
  }
  const std::string& word(const char* column, std::size_t row) const {
    return table_.words.find(column)->second[row];
  }
  bool same(std::size_t a, std::size_t b) const {
    const double x = number("deviation_um", a), y = number("deviation_um", b);
    return word("moved", a) == word("moved", b) && (x == y || (std::isnan(x) && std::isnan(y)));
  }

  Expected<void> sort_rows() {
    for (std::size_t row = 0; row < table_.size(); ++row) {
      const Key key{static_cast<std::uint32_t>(number("run", row)), word("diagonal", row)};
      const auto step = static_cast<std::uint32_t>(number("step", row));
      const auto [at, fresh] = passes_[key].try_emplace(step, row);
      if (fresh) continue;
      if (!same(at->second, row))
        return fail(at_line(table_.line[row], "step",
                            "a second reading of diagonal " + key.second + ", step " +
                                std::to_string(step) + ", different from the one in line " +
                                std::to_string(table_.line[at->second]) +
                                "; expected one, or an identical repetition"));
      if (repeated_++ == 0) first_repeated_ = table_.line[row];
    }
    return {};
  }

  Expected<void> take(const Key& key, const Pass& pass) {
    const std::string who = "diagonal " + key.second +
                            (key.first == 1 ? "" : ", run " + std::to_string(key.first)) + ": ";
    const std::uint64_t line = table_.line[pass.rbegin()->second];
    const std::uint32_t steps = pass.rbegin()->first;
    if (steps % 3 != 0)
      return fail(at_line(
          line, "step",
          who + "expected a number of steps that 3 divides, found " + std::to_string(steps)));
    std::uint32_t expected = 1;
    for (const auto& [step, row] : pass)
      if (step != expected++)
        return fail(at_line(table_.line[row], "step",
                            who + "expected step " + std::to_string(expected - 1) + ", found " +
                                std::to_string(step) +
                                "; a step that was not read is in the file without a value"));
    return walk(key, pass, who, steps / 3);
  }

  Expected<void> walk(const Key& key, const Pass& pass, const std::string& who, std::uint32_t n) {
    const Sense sign = std::find_if(corners.begin(), corners.end(), [&](const Corner& c) {
                         return c.name == key.second;
                       })->sign;
    Observations::Line line{obs_.measurement + " " + key.second +
                                (key.first == 1 ? "" : " run " + std::to_string(key.first)),
                            {}};
    for (std::size_t k = 0; k < 3; ++k)
      line.sense[k] = sign[k] * (span_.sides[k].to - span_.sides[k].from) / span_.length;
    obs_.lines.push_back(line);
    std::array<std::uint32_t, 3> moved{};
    for (const auto& [step, row] : pass) {
      const std::size_t axis = coordinates.find(word("moved", row)[0]);
      if (++moved[axis] > n)
        return fail(at_line(table_.line[row], "moved",
                            who + "expected " + std::to_string(n) + " moves of each axis in " +
                                std::to_string(3 * n) + " steps, found more of " +
                                word("moved", row)));
      put(row, sign, moved, n);
    }
    return {};
  }

  void put(std::size_t row, const Sense& sign, const std::array<std::uint32_t, 3>& moved,
           std::uint32_t n) {
    const double deviation = number("deviation_um", row);
    if (!std::isfinite(deviation)) {
      ++obs_.missing;
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Span::Side& side = span_.sides[k];
      const double start = sign[k] > 0.0 ? side.from : side.to, way = side.to - side.from;
      obs_.axes[k].position.push_back(start + sign[k] * way * moved[k] / n);
      obs_.axes[k].approach.push_back(sign[k] * way > 0.0 ? 1 : -1);
    }
    obs_.deviation.push_back(deviation * per_um);
    obs_.line.push_back(static_cast<std::uint32_t>(obs_.lines.size() - 1));
    put_common(obs_, table_, row);
  }

  const Table& table_;
  const Span& span_;
  Observations& obs_;
  std::map<Key, Pass> passes_;
  std::uint64_t repeated_ = 0, first_repeated_ = 0;
};

}  // namespace

Expected<Observations> read_step_diagonal(const ReadInput& input) {
  NONIO_TRY(const auto span, span_of(input.campaign, input.measurement));
  if (span.sides.size() != 3)
    return fail("measurement \"" + input.measurement.id +
                "\": expected `from` and `to` to differ in X, Y and Z");
  std::vector<std::string> names;
  for (const Corner& corner : corners) names.emplace_back(corner.name);
  static const std::vector<std::string> axes{"X", "Y", "Z"};
  NONIO_TRY(const auto table, table_of(input, with_common({{"diagonal", Kind::word, true, names},
                                                           {"step", Kind::whole, true},
                                                           {"moved", Kind::word, true, axes},
                                                           {"deviation_um", Kind::number, true}})));
  Observations obs = begin(input.measurement, table);
  if (auto read = StepDiagonals(table, span, obs).read(); !read)
    return in_file(Expected<Observations>(fail(read.error())), input);
  return in_file(complete(std::move(obs)), input);
}

}  // namespace nonio::csv
