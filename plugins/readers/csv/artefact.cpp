// SPDX-License-Identifier: Apache-2.0
// Balls of an artefact: centers probed by the machine, and certified positions or lengths.
#include <algorithm>
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

/// Three lines per ball, one per coordinate, named by the ball and x, y or z.
class BallLines {
 public:
  BallLines(Observations& obs, std::vector<std::size_t> coordinates)
      : obs_(obs), coordinates_(std::move(coordinates)) {}
  std::uint32_t first(const std::string& ball) {
    const auto [at, fresh] =
        first_.try_emplace(ball, static_cast<std::uint32_t>(obs_.lines.size()));
    for (const std::size_t k : coordinates_) {
      if (!fresh) break;
      Observations::Line line{ball + " " + "xyz" [k], {}};
      line.sense[k] = 1.0;
      obs_.lines.push_back(std::move(line));
    }
    return at->second;
  }

 private:
  Observations& obs_;
  std::vector<std::size_t> coordinates_;
  std::map<std::string, std::uint32_t> first_;
};

constexpr const char* coordinate_columns[] = {"x_mm", "y_mm", "z_mm"};

/// A hole in a plate has no height.
std::vector<std::size_t> coordinates_in(const Table& table) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < 3; ++k)
    if (table.column(coordinate_columns[k]) != nullptr) out.push_back(k);
  return out;
}

double coordinate_in(const Table& table, std::size_t k, std::size_t row) {
  return (*table.column(coordinate_columns[k]))[row] * per_mm;
}

Expected<void> few_enough(const Table& table) {
  if (table.size() <= most_rows) return {};
  return fail("expected at most 20000 rows, found " + std::to_string(table.size()));
}

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
  const auto coordinates = coordinates_in(table);
  if (coordinates.size() < 2)
    return fail(
        "missing column: expected two of x_mm, y_mm and z_mm, and all three that were measured");
  for (const std::size_t k : coordinates)
    obs.axes.push_back({std::string(1, "XYZ"[k]), false, {}, {}});
  BallLines lines(obs, coordinates);
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
    std::vector<double> centre;
    for (const std::size_t k : coordinates) centre.push_back(coordinate_in(table, k, row));
    if (std::any_of(centre.begin(), centre.end(), [](double c) { return !std::isfinite(c); })) {
      ++obs.missing;
      continue;
    }
    const std::uint32_t line = lines.first(balls[row]);
    for (std::size_t k = 0; k < centre.size(); ++k) {
      for (std::size_t c = 0; c < centre.size(); ++c) obs.axes[c].position.push_back(centre[c]);
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

/// Coordinates are stored as lines of centers, lengths as one line per pair of balls.
Expected<Observations> certificate_of(const ReadInput& input, const Table& table, bool lengths) {
  if (auto few = few_enough(table); !few) return fail(few.error());
  Observations obs = begin(input.measurement, table);
  obs.axes = {{"certificate", false, {}, {}}};
  BallLines lines(obs, {0, 1, 2});
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
    NONIO_TRY(const auto u, stated_u(table, row));
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
      put(row, length, u, static_cast<std::uint32_t>(obs.lines.size() - 1));
      continue;
    }
    if (auto first = once.see(balls[row], table, row, "a ball"); !first) return fail(first.error());
    const std::uint32_t line = lines.first(balls[row]);
    for (std::size_t k = 0; k < 3; ++k)
      put(row, coordinate_in(table, k, row), u, line + static_cast<std::uint32_t>(k));
  }
  return obs;
}

}  // namespace

Expected<Observations> read_artefact(const ReadInput& input) {
  NONIO_TRY(const auto table, table_of(input, with_common({{"ball", Kind::word, true},
                                                           {"x_mm", Kind::number},
                                                           {"y_mm", Kind::number},
                                                           {"z_mm", Kind::number}})));
  auto obs = centres_of(input, table);
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
