// SPDX-License-Identifier: Apache-2.0
// Lengths measured by a machine with its probe, and points on a sphere.
#include <cmath>
#include <map>

#include "nonio/sdk/fields.h"
#include "rows.h"
#include "spatial.h"

namespace nonio::csv {

namespace {

/// One line per test and position (E0 1, E0 2, ..., EL 1); the run is the number of the repetition.
Expected<Observations> read_errors(const ReadInput& input, const Table& table) {
  Observations obs = begin(input.measurement, table);
  obs.axes = {{"length", false, {}, {}}};
  const auto &position = *table.column("position"), &repeat = *table.column("repeat"),
             &length = *table.column("length_mm"), &deviation = *table.column("deviation_um");
  const auto& test = table.words.find("test")->second;
  constexpr std::size_t most = 5000;  // far above the 105 lengths of the ISO 10360-2 plan
  if (table.size() > most)
    return fail("expected at most 5000 lengths, found " + std::to_string(table.size()));
  std::map<std::pair<std::string, double>, std::uint32_t> lines;
  std::map<std::array<double, 3>, std::map<std::string, std::uint32_t>> taken;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const auto wrong = [&](const char* column, std::string message) {
      return fail(at_line(table.line[row], column, std::move(message)));
    };
    if (!(length[row] > 0.0 && length[row] <= 1e6))
      return wrong("length_mm", "expected a length above 0, at most 1000000 mm");
    auto& before = taken[{position[row], length[row], repeat[row]}][test[row]];
    if (before > 0)
      return wrong("repeat", "this length was read in line " + std::to_string(before) +
                                 " with the same repeat; expected another one");
    before = table.line[row];
    const auto [line, fresh] =
        lines.try_emplace({test[row], position[row]}, static_cast<std::uint32_t>(lines.size()));
    if (fresh)
      obs.lines.push_back(
          {test[row] + " " + std::to_string(static_cast<std::uint32_t>(position[row])), {}});
    if (!std::isfinite(deviation[row])) {
      ++obs.missing;
      continue;
    }
    obs.axes[0].position.push_back(length[row] * 1e-3);
    obs.deviation.push_back(deviation[row] * 1e-6);
    obs.run.push_back(static_cast<std::uint32_t>(repeat[row]));
    obs.line.push_back(line->second);
    if (const auto* c = table.column("material_c")) obs.material.push_back((*c)[row]);
    if (const auto* c = table.column("air_c")) obs.air.push_back((*c)[row]);
    obs.source_line.push_back(table.line[row]);
  }
  return obs;
}

/// Three readings per point, one per coordinate; the deviation is the coordinate.
Expected<Observations> read_points(const ReadInput& input, const Table& table) {
  Observations obs = begin(input.measurement, table);
  obs.axes = {{"point", false, {}, {}}};
  obs.lines = {{"P", {}}};
  std::uint32_t number = 0;
  for (std::size_t row = 0; row < table.size(); ++row) {
    std::array<double, 3> p{};
    bool whole = true;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = (*table.column(std::string{"xyz"[k]} + "_mm"))[row];
      whole = whole && std::isfinite(p[k]);
    }
    if (!whole) {
      ++obs.missing;
      continue;
    }
    ++number;
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> sense{};
      sense[k] = 1.0;
      obs.axes[0].position.push_back(static_cast<double>(number));
      obs.deviation.push_back(p[k] * 1e-3);
      obs.sense.push_back(sense);
      obs.run.push_back(1);
      obs.line.push_back(0);
      obs.source_line.push_back(table.line[row]);
    }
  }
  return obs;
}

}  // namespace

Expected<Observations> read_lengths(const ReadInput& input) {
  const bool points = input.bytes.substr(0, 65536).find("x_mm") != std::string_view::npos;
  auto table = points ? read_table(input.bytes, {{"x_mm", Kind::number, true},
                                                 {"y_mm", Kind::number, true},
                                                 {"z_mm", Kind::number, true}})
                      : read_table(input.bytes, {{"test", Kind::word, true, {"E0", "EL"}},
                                                 {"position", Kind::whole, true},
                                                 {"length_mm", Kind::place, true},
                                                 {"repeat", Kind::whole, true},
                                                 {"deviation_um", Kind::number, true},
                                                 {"material_c"},
                                                 {"air_c"}});
  auto obs = !table   ? Expected<Observations>(fail(table.error()))
             : points ? read_points(input, *table)
                      : read_errors(input, *table);
  return in_file(obs ? complete(std::move(*obs)) : std::move(obs), input);
}

}  // namespace nonio::csv
