// SPDX-License-Identifier: Apache-2.0
//
// Reads the rotary axes and squares of a specification.
#include <algorithm>
#include <cmath>

#include "platform/storage/nearest.h"
#include "simulation/simulate_spec.h"

namespace nonio::simulation {

std::vector<std::array<double, 3>> vectors_at(config::TableReader& reader, std::string_view key,
                                              double scale) {
  std::vector<std::array<double, 3>> out;
  const auto numbers = reader.numbers(key);
  if (!numbers) return out;
  if (numbers->empty() || numbers->size() % 3 != 0) {
    reader.error(key,
                 "expected three numbers, along X, Y and Z, or three more of each further "
                 "one; found " +
                     std::to_string(numbers->size()));
    return out;
  }
  for (std::size_t i = 0; i < numbers->size(); i += 3)
    out.push_back({scale * (*numbers)[i], scale * (*numbers)[i + 1], scale * (*numbers)[i + 2]});
  return out;
}

namespace {

using Vector = std::array<double, 3>;

std::optional<Vector> one_vector(config::TableReader& reader, std::string_view key, double scale) {
  const auto found = vectors_at(reader, key, scale);
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) reader.error(key, "expected three numbers");
  return found.front();
}

std::optional<Vector> one_direction(config::TableReader& reader, std::string_view key) {
  auto found = one_vector(reader, key, 1.0);
  if (!found) return found;
  const double size = std::hypot((*found)[0], (*found)[1], (*found)[2]);
  if (!(size > 0.0)) reader.error(key, "expected a direction, found 0, 0, 0");
  for (double& x : *found) x /= size > 0.0 ? size : 1.0;
  return found;
}

}  // namespace

void read_things(config::TableReader& simulation, Specification& s) {
  std::vector<std::string> axes, squares;
  for (const Axis& axis : s.campaign.machine.axes)
    if (axis.rotary) axes.push_back(axis.name);
  for (const Square& square : s.campaign.squares) squares.push_back(square.name);
  for (config::TableReader& reader : simulation.tables("rotary")) {
    RotarySpec r;
    r.axis = reader.text("axis");
    if (!r.axis.empty() && std::find(axes.begin(), axes.end(), r.axis) == axes.end())
      reader.error("axis", "the machine has no rotary axis \"" + r.axis + "\"" +
                               storage::suggestion(r.axis, axes));
    if (s.rotary(r.axis) != nullptr) reader.error("axis", r.axis + " is given twice");
    r.centre = one_vector(reader, "centre_mm", 1e-3).value_or(Vector{});
    r.direction = one_direction(reader, "direction").value_or(Vector{0.0, 0.0, 1.0});
    r.control_centre = one_vector(reader, "control_centre_mm", 1e-3);
    r.control_direction = one_direction(reader, "control_direction");
    r.carries = reader.text("carries");
    reader.finish();
    s.rotaries.push_back(std::move(r));
  }
  for (config::TableReader& reader : simulation.tables("square")) {
    SquareSpec q;
    q.name = reader.text("name");
    if (!q.name.empty() && std::find(squares.begin(), squares.end(), q.name) == squares.end())
      reader.error("name", "no [[square]] is called \"" + q.name + "\"" +
                               storage::suggestion(q.name, squares));
    q.error = reader.number("error_urad").value_or(0.0);
    q.set_up = reader.number("set_up_urad").value_or(0.0);
    reader.finish();
    s.squares.push_back(std::move(q));
  }
}

}  // namespace nonio::simulation
