// SPDX-License-Identifier: Apache-2.0
// Wire frame of the volume, nominal and with exaggerated errors, from the curves of step diagonals
// or from an error map on a grid.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "nonio/reports/number.h"
#include "pages.h"

namespace nonio::pages {

using namespace reports;
using Curve = Plot::Curve;

namespace {

using Vector = std::array<double, 3>;
using Place = std::array<std::size_t, 3>;

class Volume {
 public:
  explicit Volume(const Evaluation& e) {
    for (const Series& s : e.series) {
      const std::size_t along = coordinate(s.name, 1), axis = coordinate(s.name, 2);
      if (s.name.size() != 3 || along > 2 || axis > 2 || s.position.size() < 2) continue;
      if (!axes_[axis].position.empty() && axes_[axis].position.size() != s.position.size())
        continue;
      axes_[axis].name = s.over;
      axes_[axis].position = s.position;
      axes_[axis].error[along] = s.value;
    }
    for (const Value& v : e.values) {
      if (v.name == "C0Y") C0Y_ = v.value;
      if (v.name == "B0Z") B0Z_ = v.value;
      if (v.name == "A0Z") A0Z_ = v.value;
    }
    if (!known()) take_map(e);
  }

  bool known() const {
    if (mapped()) return true;
    return C0Y_ && B0Z_ && A0Z_ && std::all_of(axes_.begin(), axes_.end(), [](const auto& a) {
             return !a.position.empty();
           });
  }
  /// A map is relative to the center of the volume.
  bool mapped() const { return !map_[0].empty(); }
  const std::string& name(std::size_t axis) const { return axes_[axis].name; }
  std::size_t last(std::size_t axis) const { return axes_[axis].position.size() - 1; }
  double position(std::size_t axis, std::size_t i) const { return axes_[axis].position[i]; }
  std::string left_out() const {
    std::string out;
    for (std::size_t k = 0; k < 3 && !mapped(); ++k)
      if (axes_[k].error[k].empty())
        out += (out.empty() ? "" : ", ") + ("E" + std::string(2, "XYZ"[k]));
    return out;
  }

  Vector nominal(const Place& p) const {
    return {position(0, p[0]), position(1, p[1]), position(2, p[2])};
  }
  /// Error of the tool at a node relative to the corner, m (ISO 230-1: C0Y rotates +Y towards -X,
  /// B0Z +Z towards +X, A0Z +Z towards -Y).
  Vector error(const Place& p) const {
    Vector e{};
    if (mapped()) {
      const std::size_t i = (p[0] * (last(1) + 1) + p[1]) * (last(2) + 1) + p[2];
      for (std::size_t k = 0; k < 3; ++k) e[k] = map_[k][i];
      return e;
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t along = 0; along < 3; ++along)
        if (const auto& curve = axes_[axis].error[along]; !curve.empty())
          e[along] += curve[p[axis]] - curve.front();
    const double y = way(1, p), z = way(2, p);
    e[0] += *B0Z_ * z - *C0Y_ * y;
    e[1] -= *A0Z_ * z;
    return e;
  }

 private:
  struct AxisErrors {
    std::string name;
    std::vector<double> position;
    std::array<std::vector<double>, 3> error;
  };
  static std::size_t coordinate(const std::string& name, std::size_t letter) {
    return name.size() > letter ? std::string_view("XYZ").find(name[letter]) : 3;
  }
  /// Rows X Y Z e_x e_y e_z of all grid nodes; X varies slowest, Z fastest.
  void take_map(const Evaluation& e) {
    static constexpr std::array<const char*, 3> places{"X", "Y", "Z"}, errors{"e_x", "e_y", "e_z"};
    std::array<std::vector<double>, 3> nodes;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto *at = e.rows.column(places[k]), *error = e.rows.column(errors[k]);
      if (at == nullptr || error == nullptr) return;
      nodes[k] = at->values;
      std::sort(nodes[k].begin(), nodes[k].end());
      nodes[k].erase(std::unique(nodes[k].begin(), nodes[k].end()), nodes[k].end());
      if (nodes[k].size() < 2) return;
    }
    if (nodes[0].size() * nodes[1].size() * nodes[2].size() != e.rows.column("X")->values.size())
      return;
    for (std::size_t k = 0; k < 3; ++k) {
      axes_[k] = {places[k], std::move(nodes[k]), {}};
      map_[k] = e.rows.column(errors[k])->values;
    }
  }
  double way(std::size_t axis, const Place& p) const {
    return axes_[axis].position[p[axis]] - axes_[axis].position.front();
  }

  std::array<AxisErrors, 3> axes_;
  std::array<std::vector<double>, 3> map_;
  std::optional<double> C0Y_, B0Z_, A0Z_;
};

/// Projection from the front right and above: X to the right, Y into the page, Z up.
std::pair<double, double> seen(const Vector& p) {
  constexpr double turn = 32.0 * std::numbers::pi / 180, above = 22.0 * std::numbers::pi / 180;
  return {
      p[0] * std::cos(turn) + p[1] * std::sin(turn),
      (p[1] * std::cos(turn) - p[0] * std::sin(turn)) * std::sin(above) + p[2] * std::cos(above)};
}

struct Largest {
  double size = 0.0;
  Place at{};
};

Largest largest(const Volume& v) {
  std::size_t parts = 8;
  if (v.mapped()) parts = std::max({parts, v.last(0), v.last(1), v.last(2)});
  Largest most;
  for (std::size_t i = 0; i <= parts; ++i)
    for (std::size_t j = 0; j <= parts; ++j)
      for (std::size_t k = 0; k <= parts; ++k) {
        const Place p{i * v.last(0) / parts, j * v.last(1) / parts, k * v.last(2) / parts};
        const Vector e = v.error(p);
        const double size = std::hypot(e[0], e[1], e[2]);
        if (size > most.size) most = {size, p};
      }
  return most;
}

enum class Wires { seen, hidden, faces };

/// Selects visible edges, hidden edges, or center lines of visible faces, which are those of the
/// largest X, the smallest Y and the largest Z.
bool drawn(Wires what, std::size_t axis, const Place& half) {
  constexpr Place face{2, 0, 2};
  std::size_t in_front = 0, middle = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (k == axis) continue;
    in_front += half[k] == face[k] ? 1 : 0;
    middle += half[k] == 1 ? 1 : 0;
  }
  if (what == Wires::faces) return middle == 1 && in_front == 1;
  return middle == 0 && (in_front > 0) == (what == Wires::seen);
}

std::vector<Curve> wires(const Volume& v, double factor, Wires what, Colour colour, double width) {
  std::vector<Curve> out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t j = 0; j <= 2; ++j)
      for (std::size_t k = 0; k <= 2; ++k) {
        Place half{};
        half[(axis + 1) % 3] = j, half[(axis + 2) % 3] = k;
        if (!drawn(what, axis, half)) continue;
        Place p{};
        for (std::size_t n = 0; n < 3; ++n) p[n] = half[n] * v.last(n) / 2;
        Curve c;
        c.colour = colour, c.width = width;
        if (what == Wires::hidden) c.dash = Dash::dotted;
        for (p[axis] = 0; p[axis] <= v.last(axis); ++p[axis]) {
          Vector at = v.nominal(p);
          const Vector e = v.error(p);
          for (std::size_t n = 0; n < 3; ++n) at[n] += factor * e[n];
          const auto [x, y] = seen(at);
          c.x.push_back(x), c.y.push_back(y);
        }
        out.push_back(std::move(c));
      }
  return out;
}

std::string millimetres(const Source& source, double si) {
  return printed_number(si, Quantity::length, decimals_for({si}, Quantity::length, 3),
                        source.language());
}

std::vector<Plot::Label> edge_labels(const Volume& v) {
  std::vector<Plot::Label> labels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Place p{axis == 1 ? v.last(0) : 0, 0, 0};
    p[axis] = v.last(axis) / 2;
    const auto [x, y] = seen(v.nominal(p));
    labels.push_back({x, y, v.name(axis)});
  }
  return labels;
}

std::string extent(const Source& source, const Volume& v) {
  std::string out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out += (out.empty() ? "" : ", ") + v.name(axis) + " " +
           millimetres(source, v.position(axis, 0)) + " – " +
           millimetres(source, v.position(axis, v.last(axis)));
  return out + " " + unit_text(Quantity::length) + ".";
}

Plot volume_plot(const Source& source, const Volume& v) {
  const Style& style = source.look.style;
  const Largest most = largest(v);
  double travel = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
    travel = std::max(travel, std::fabs(v.position(k, v.last(k)) - v.position(k, 0)));
  const double factor = most.size > 0.0 ? round_factor(0.2 * travel / most.size) : 1.0;
  const std::string times = printed_number(factor, Quantity::count, 0, source.language());
  Plot plot;
  plot.title = source.words.get("plot.volume", {{"factor", times}});
  const std::string missing = v.left_out();
  plot.x_title = extent(source, v) + " " +
                 source.words.get(v.mapped() ? "plot.volume_scale_middle" : "plot.volume_scale",
                                  {{"factor", times}});
  if (!source.certificate)  // the largest error has no U
    plot.x_title +=
        " " +
        source.words.get(
            "plot.volume_largest",
            {{"largest", printed_number(most.size, Quantity::deviation, 1, source.language())},
             {"unit", unit_text(Quantity::deviation)},
             {"x", millimetres(source, v.position(0, most.at[0]))},
             {"y", millimetres(source, v.position(1, most.at[1]))},
             {"z", millimetres(source, v.position(2, most.at[2]))}});
  if (!missing.empty())
    plot.x_title += " " + source.words.get("plot.volume_without", {{"curves", missing}});
  plot.language = source.language();
  plot.empty_text = source.words.get("plot.nothing");
  plot.scales = false;
  plot.height = 1.9 * style.plot_height;
  for (const Wires what : {Wires::seen, Wires::hidden}) {
    auto nominal = wires(v, 0.0, what, style.muted, 0.35);
    if (what == Wires::seen) nominal.front().legend = source.words.get("plot.nominal");
    std::move(nominal.begin(), nominal.end(), std::back_inserter(plot.curves));
  }
  for (const auto& [what, width] :
       {std::pair{Wires::hidden, 0.6}, {Wires::faces, 0.4}, {Wires::seen, 1.1}}) {
    auto machine = wires(v, factor, what, style.accent, width);
    if (what == Wires::seen) machine.front().legend = source.words.get("plot.drawn");
    std::move(machine.begin(), machine.end(), std::back_inserter(plot.curves));
  }
  plot.labels = edge_labels(v);
  return plot;
}

}  // namespace

double round_factor(double v) {
  const double ten = std::pow(10.0, std::floor(std::log10(v)));
  return ten * (v >= 5.0 * ten ? 5.0 : v >= 2.0 * ten ? 2.0 : 1.0);
}

void add_volume(const Source& source, const Measured& m, std::vector<Plot>& plots) {
  for (const auto* a : m.analyses)
    if (const Volume v(a->evaluation); v.known()) plots.push_back(volume_plot(source, v));
}

}  // namespace nonio::pages
