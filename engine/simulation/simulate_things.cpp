// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "platform/storage/nearest.h"
#include "simulation/simulate_spec.h"

namespace nonio::simulation {

void read_points(config::TableReader& reader, const config::Key& key, std::vector<Vector>& to) {
  const auto numbers = config::value_of<std::vector<double>>(reader, key);
  if (!numbers) return;
  if (numbers->empty() || numbers->size() % 3 != 0)
    return reader.error(key.name,
                        "expected three numbers, along X, Y and Z, or three more of each further "
                        "one; found " +
                            std::to_string(numbers->size()));
  for (std::size_t i = 0; i < numbers->size(); i += 3)
    to.push_back(
        {key.scale * (*numbers)[i], key.scale * (*numbers)[i + 1], key.scale * (*numbers)[i + 2]});
}

void read_directions(config::TableReader& reader, const config::Key& key, std::vector<Vector>& to) {
  read_points(reader, key, to);
  for (Vector& direction : to) {
    const double size = std::hypot(direction[0], direction[1], direction[2]);
    if (!(size > 0.0)) reader.error(key.name, "expected a direction, found 0, 0, 0");
    for (double& x : direction) x /= size > 0.0 ? size : 1.0;
  }
}

namespace {

template <class To>
void read_one(void (*read)(config::TableReader&, const config::Key&, std::vector<Vector>&),
              config::TableReader& reader, const config::Key& key, To& to) {
  std::vector<Vector> found;
  read(reader, key, found);
  if (found.size() > 1) reader.error(key.name, "expected three numbers");
  if (!found.empty()) to = found.front();
}

}  // namespace

void read_point(config::TableReader& reader, const config::Key& key, Vector& to) {
  read_one(read_points, reader, key, to);
}
void read_direction(config::TableReader& reader, const config::Key& key, Vector& to) {
  read_one(read_directions, reader, key, to);
}
void read_optional_point(config::TableReader& reader, const config::Key& key,
                         std::optional<Vector>& to) {
  read_one(read_points, reader, key, to);
}
void read_optional_direction(config::TableReader& reader, const config::Key& key,
                             std::optional<Vector>& to) {
  read_one(read_directions, reader, key, to);
}

void check_rotary(config::TableReader& reader, RotarySpec& r, Specification& s) {
  std::vector<std::string> axes;
  for (const Axis& axis : s.campaign.machine.axes)
    if (axis.rotary) axes.push_back(axis.name);
  if (!r.axis.empty() && std::find(axes.begin(), axes.end(), r.axis) == axes.end())
    reader.error("axis", "the machine has no rotary axis \"" + r.axis + "\"" +
                             storage::suggestion(r.axis, axes));
  if (s.rotary(r.axis) != &r) reader.error("axis", r.axis + " is given twice");
}

void check_square(config::TableReader& reader, SquareSpec& q, Specification& s) {
  std::vector<std::string> squares;
  for (const Square& square : s.campaign.squares) squares.push_back(square.name);
  if (!q.name.empty() && std::find(squares.begin(), squares.end(), q.name) == squares.end())
    reader.error("name", "no [[square]] is called \"" + q.name + "\"" +
                             storage::suggestion(q.name, squares));
}

}  // namespace nonio::simulation
