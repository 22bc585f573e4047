// SPDX-License-Identifier: Apache-2.0
//
// Balls of an artefact: their centres as the machine probed them, and what its certificate states.
#include <cmath>
#include <map>

#include "rows.h"
#include "spatial.h"

namespace nonio::csv {

namespace {

constexpr std::size_t most_rows = 20000, longest_name = 20;

Expected<void> sound_name(const std::string& name, const Table& table, std::size_t row,
                          const char* column) {
  if (!name.empty() && name.size() <= longest_name && name.find(' ') == name.npos) return {};
  return fail(at_line(
      table.line[row], column,
      "expected the name of a ball, up to 20 characters without a blank, found \"" + name + "\""));
}

/// Lines of balls: three each, along X, Y and Z, whose names are that of the ball and x, y or z.
class BallLines {
 public:
  explicit BallLines(Observations& obs) : obs_(obs) {}
  std::uint32_t first(const std::string& ball) {
    const auto [at, fresh] =
        first_.try_emplace(ball, static_cast<std::uint32_t>(obs_.lines.size()));
    for (std::size_t k = 0; k < 3 && fresh; ++k) {
      Observations::Line line{ball + " " + "xyz" [k], {}};
      line.sense[k] = 1.0;
      obs_.lines.push_back(std::move(line));
    }
    return at->second;
  }

 private:
  Observations& obs_;
  std::map<std::string, std::uint32_t> first_;
};

std::array<double, 3> centre_in(const Table& table, std::size_t row) {
  return {(*table.column("x_mm"))[row] * per_mm, (*table.column("y_mm"))[row] * per_mm,
          (*table.column("z_mm"))[row] * per_mm};
}

Expected<void> few_enough(const Table& table) {
  if (table.size() <= most_rows) return {};
  return fail("expected at most 20000 rows, found " + std::to_string(table.size()));
}

/// The same ball, or pair of balls, once.
class Once {
 public:
  Expected<void> see(std::string what, const Table& table, std::size_t row, const char* meant) {
    const auto [at, fresh] = seen_.try_emplace(std::move(what), table.line[row]);
    if (fresh) return {};
    return fail(at_line(table.line[row], "ball",
                        std::string("expected ") + meant + " once, found it in line " +
                            std::to_string(at->second) + " too"));
  }

 private:
  std::map<std::string, std::uint32_t> seen_;
};

Expected<Observations> centres_of(const ReadInput& input, const Table& table) {
  if (auto few = few_enough(table); !few) return fail(few.error());
  Observations obs = begin(input.measurement, table);
  obs.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  BallLines lines(obs);
  Once once;
  const auto& balls = table.words.find("ball")->second;
  const auto* run = table.column("run");
  for (std::size_t row = 0; row < table.size(); ++row) {
    if (auto sound = sound_name(balls[row], table, row, "ball"); !sound) return fail(sound.error());
    const auto number = run == nullptr ? 1L : std::lround((*run)[row]);
    if (auto first =
            once.see(balls[row] + " " + std::to_string(number), table, row, "a ball and run");
        !first)
      return fail(first.error());
    const auto centre = centre_in(table, row);
    if (!std::isfinite(centre[0] + centre[1] + centre[2])) {
      ++obs.missing;
      continue;
    }
    const std::uint32_t line = lines.first(balls[row]);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) obs.axes[c].position.push_back(centre[c]);
      obs.deviation.push_back(centre[k]);
      obs.line.push_back(line + static_cast<std::uint32_t>(k));
      put_common(obs, table, row);
    }
  }
  return obs;
}

Expected<double> stated_u(const Table& table, std::size_t row) {
  const double U = (*table.column("U_um"))[row];
  if (U > 0.0 && U <= 1e6) return U * per_um / 2.0;
  return fail(at_line(table.line[row], "U_um", "expected an expanded uncertainty (k = 2) above 0"));
}

/// Coordinates: as of centres. Lengths: a line for each, named by both balls.
Expected<Observations> certificate_of(const ReadInput& input, const Table& table, bool lengths) {
  if (auto few = few_enough(table); !few) return fail(few.error());
  Observations obs = begin(input.measurement, table);
  obs.axes = {{"certificate", false, {}, {}}};
  BallLines lines(obs);
  Once once;
  const auto put = [&](std::size_t row, double value, double u, std::uint32_t line) {
    obs.axes[0].position.push_back(static_cast<double>(row + 1));
    obs.deviation.push_back(value);
    obs.u.push_back(u);
    obs.line.push_back(line);
    obs.run.push_back(1);
    obs.source_line.push_back(table.line[row]);
  };
  const auto& balls = table.words.find("ball")->second;
  for (std::size_t row = 0; row < table.size(); ++row) {
    if (auto sound = sound_name(balls[row], table, row, "ball"); !sound) return fail(sound.error());
    const auto u = stated_u(table, row);
    if (!u) return fail(u.error());
    if (lengths) {
      const std::string& other = table.words.find("other")->second[row];
      if (auto sound = sound_name(other, table, row, "other"); !sound) return fail(sound.error());
      const double length = (*table.column("length_mm"))[row] * per_mm;
      if (!(length > 0.0 && length <= 1e3) || other == balls[row])
        return fail(at_line(table.line[row], "length_mm",
                            "expected the distance of two balls above 0, at most 1000000 mm"));
      if (auto first = once.see(std::min(balls[row], other) + " " + std::max(balls[row], other),
                                table, row, "the length between two balls");
          !first)
        return fail(first.error());
      obs.lines.push_back({balls[row] + " " + other, {}});
      put(row, length, *u, static_cast<std::uint32_t>(obs.lines.size() - 1));
      continue;
    }
    if (auto first = once.see(balls[row], table, row, "a ball"); !first) return fail(first.error());
    const auto centre = centre_in(table, row);
    const std::uint32_t line = lines.first(balls[row]);
    for (std::size_t k = 0; k < 3; ++k)
      put(row, centre[k], *u, line + static_cast<std::uint32_t>(k));
  }
  return obs;
}

}  // namespace

Expected<Observations> read_artefact(const ReadInput& input) {
  const auto table = table_of(input, with_common({{"ball", Kind::word, true},
                                                  {"x_mm", Kind::number, true},
                                                  {"y_mm", Kind::number, true},
                                                  {"z_mm", Kind::number, true}}));
  if (!table) return fail(table.error());
  auto obs = centres_of(input, *table);
  return in_file(obs ? complete(std::move(*obs)) : std::move(obs), input);
}

Expected<Observations> read_artefact_certificate(const ReadInput& input) {
  const bool lengths = input.bytes.substr(0, 65536).find("length_mm") != std::string_view::npos;
  const auto table = lengths ? read_table(input.bytes, {{"ball", Kind::word, true},
                                                        {"other", Kind::word, true},
                                                        {"length_mm", Kind::place, true},
                                                        {"U_um", Kind::place, true}})
                             : read_table(input.bytes, {{"ball", Kind::word, true},
                                                        {"x_mm", Kind::place, true},
                                                        {"y_mm", Kind::place, true},
                                                        {"z_mm", Kind::place, true},
                                                        {"U_um", Kind::place, true}});
  auto obs =
      table ? certificate_of(input, *table, lengths) : Expected<Observations>(fail(table.error()));
  return in_file(obs ? complete(std::move(*obs)) : std::move(obs), input);
}

}  // namespace nonio::csv
