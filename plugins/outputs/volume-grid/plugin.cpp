// SPDX-License-Identifier: Apache-2.0
// Errors of the tool point on a grid as JSON for volumetric compensation, with predicted residuals.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>

#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::volume_grid {

using Vector = std::array<double, 3>;

constexpr std::array<const char*, 3> places{"X", "Y", "Z"}, errors{"e_x", "e_y", "e_z"},
    uncertainties{"U_x", "U_y", "U_z"};

/// Nodes over X, Y, Z; Z varies fastest.
struct Grid {
  std::string measurement;
  std::array<std::vector<double>, 3> nodes;
  std::vector<Vector> error, U;

  std::size_t index(const std::array<std::size_t, 3>& i) const {
    return (i[0] * nodes[1].size() + i[1]) * nodes[2].size() + i[2];
  }
};

std::optional<Grid> grid_of(const Results::Analysed& a) {
  const PointTable& rows = a.evaluation.rows;
  Grid g{a.measurement, {}, {}, {}};
  std::array<const PointTable::Column*, 3> at{}, e{}, U{};
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = rows.column(places[k]), e[k] = rows.column(errors[k]);
    U[k] = rows.column(uncertainties[k]);
    if (at[k] == nullptr || e[k] == nullptr) return {};
    const std::set<double> all(at[k]->values.begin(), at[k]->values.end());
    g.nodes[k].assign(all.begin(), all.end());
  }
  const std::size_t count = at[0]->values.size();
  if (count == 0 || g.nodes[0].size() * g.nodes[1].size() * g.nodes[2].size() != count) return {};
  for (std::size_t i = 0; i < count; ++i) {
    g.error.push_back({e[0]->values[i], e[1]->values[i], e[2]->values[i]});
    if (U[0] != nullptr && U[1] != nullptr && U[2] != nullptr)
      g.U.push_back({U[0]->values[i], U[1]->values[i], U[2]->values[i]});
  }
  return g;
}

/// Interval of a coordinate and the relative position in it. Outside of the grid, the values of the
/// edge apply.
struct Cell {
  std::size_t low = 0, high = 0;
  double part = 0.0;
};

Cell cell_of(const std::vector<double>& nodes, double at) {
  if (nodes.size() < 2) return {};
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, at);
  const auto high = static_cast<std::size_t>(above - nodes.begin());
  const double part = (at - nodes[high - 1]) / (nodes[high] - nodes[high - 1]);
  return {high - 1, high, std::clamp(part, 0.0, 1.0)};
}

Vector interpolated(const Grid& g, const Vector& at) {
  std::array<Cell, 3> cell;
  for (std::size_t k = 0; k < 3; ++k) cell[k] = cell_of(g.nodes[k], at[k]);
  Vector out{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<std::size_t, 3> index{};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool up = (corner >> k & 1U) != 0;
      weight *= up ? cell[k].part : 1.0 - cell[k].part;
      index[k] = up ? cell[k].high : cell[k].low;
    }
    for (std::size_t k = 0; k < 3; ++k) out[k] += weight * g.error[g.index(index)][k];
  }
  return out;
}

Vector place_of(const Grid& g, const Measurement& m, const Observations& o, std::size_t row) {
  Vector at{};
  for (std::size_t k = 0; k < 3; ++k) at[k] = (g.nodes[k].front() + g.nodes[k].back()) / 2.0;
  for (const auto& [axis, position] : m.at)
    if (const std::size_t k = coordinate_of(axis); k < 3) at[k] = position;
  for (const auto& column : o.axes)
    if (const std::size_t k = coordinate_of(column.axis); k < 3 && !column.rotary)
      at[k] = column.position[row];
  return at;
}

struct Predicted {
  double before = 0.0, after = 0.0;
  std::size_t readings = 0;
};

Predicted predicted(const Grid& g, const Measurement& m, const Observations& o) {
  Predicted p;
  for (std::uint32_t line = 0; line < o.lines.size(); ++line) {
    std::vector<std::array<double, 2>> values;
    for (std::size_t i = 0; i < o.size(); ++i) {
      if (o.line_of(i) != line) continue;
      const Vector e = interpolated(g, place_of(g, m, o, i));
      double seen = 0.0;
      for (std::size_t k = 0; k < 3; ++k) seen += e[k] * o.sense_of(i)[k];
      values.push_back({o.deviation[i], o.deviation[i] - seen});
    }
    std::array<double, 2> mean{};
    for (const auto& v : values)
      for (std::size_t s = 0; s < 2; ++s) mean[s] += v[s] / static_cast<double>(values.size());
    for (const auto& v : values) {
      p.before += (v[0] - mean[0]) * (v[0] - mean[0]);
      p.after += (v[1] - mean[1]) * (v[1] - mean[1]);
      ++p.readings;
    }
  }
  if (p.readings > 0) {
    p.before = std::sqrt(p.before / static_cast<double>(p.readings));
    p.after = std::sqrt(p.after / static_cast<double>(p.readings));
  }
  return p;
}

/// Only lengths along axes and diagonals, because mirrors and straightedges have unknown slopes.
bool counts(const Measurement& m) { return m.kind == "axis" || m.kind == "diagonal"; }

double in_um(double si) { return printed(si, Quantity::deviation); }

void put_numbers(JsonWriter& json, std::span<const double> si, Quantity q) {
  json.begin_array();
  for (const double v : si) json.value(printed(v, q));
  json.end_array();
}

std::string json_of(const OutputInput& in, const Grid& g, OutputResult& result) {
  JsonWriter json;
  json.begin_object();
  json.member("schema", "nonio-volume-grid/1");
  json.member("campaign", in.campaign.id);
  json.member("measurement", g.measurement);
  json.member("sign", "error = actual - commanded; a control subtracts it");
  json.member("interpolation", "linear in X, Y and Z; the edge outside");
  json.member("order", "X slowest, Z fastest");
  for (std::size_t k = 0; k < 3; ++k) {
    json.key(std::string(places[k]) + "_mm");
    put_numbers(json, g.nodes[k], Quantity::length);
  }
  for (const auto& [name, vectors] : {std::pair{"error_um", &g.error}, {"U_um", &g.U}}) {
    if (vectors->empty()) continue;
    json.list(name, *vectors, [&](const Vector& v) { put_numbers(json, v, Quantity::deviation); });
  }
  json.key("predicted");
  json.begin_array();
  const auto& measurements = in.campaign.measurements;
  for (std::size_t i = 0; i < measurements.size() && i < in.observations.size(); ++i) {
    const Measurement &m = measurements[i], *of = nullptr;
    for (const Measurement& one : measurements)
      if (one.id == g.measurement) of = &one;
    const bool same = of != nullptr && (state_of(m).empty() || state_of(m) == state_of(*of));
    if (!counts(m) || !same || in.observations[i].size() == 0) continue;
    const Predicted p = predicted(g, m, in.observations[i]);
    json.begin_object();
    json.member("measurement", m.id);
    json.member("readings", static_cast<std::uint64_t>(p.readings));
    json.member("rms_before_um", in_um(p.before));
    json.member("rms_after_um", in_um(p.after));
    json.end_object();
    result.notes.push_back({.id = "volume-grid.predicted",
                            .evidence = {{"before", p.before, Quantity::deviation},
                                         {"after", p.after, Quantity::deviation}},
                            .texts = {{"measurement", m.id}}});
  }
  json.end_array();
  json.end_object();
  return json.take();
}

std::string file_part(std::string name) {
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
  return name;
}

Expected<OutputResult> write(const OutputInput& in) {
  OutputResult result;
  for (const Results::Analysed& a : in.results.analyses)
    if (const auto g = grid_of(a))
      result.artifacts.push_back(
          {"volume-grid-" + file_part(a.measurement) + ".json", json_of(in, *g, result)});
  if (result.artifacts.empty())
    result.findings.push_back({.id = "volume-grid.none", .attention = true});
  return result;
}

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"volume-grid",
                 "1.0.0",
                 "The error vector at the nodes of a grid as JSON, with what it would leave.",
                 {},
                 true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::volume_grid
