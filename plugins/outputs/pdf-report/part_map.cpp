// SPDX-License-Identifier: Apache-2.0
// Errors of the features of machined parts as lines from their nominal places, without the effects
// of the model and with them.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;

namespace {

struct Feature {
  std::array<double, 2> at{}, before{}, after{};  // m
};

struct PartMap {
  std::string id;
  std::vector<Feature> features;
};

/// Deviation of each reading without the effects of the machine: the model's set-up is subtracted.
std::vector<double> without_effects(const ModelFit& fit) {
  std::vector<double> out = fit.residual;
  for (const ModelFit::Effect& effect : fit.effects)
    for (std::size_t i = 0; !effect.is_set_up && i < out.size(); ++i)
      out[i] += effect.contribution[i];
  return out;
}

/// `before`: `without_effects`. std::nullopt if the measurement is not a part with features in X and Y.
std::optional<PartMap> map_of(const Source& source, const ModelFit& fit,
                              const std::vector<double>& before, std::uint32_t m) {
  const auto& all = source.in.campaign.measurements;
  const auto measurement = std::find_if(
      all.begin(), all.end(), [&](const auto& one) { return one.id == fit.measurements[m]; });
  const auto at = static_cast<std::size_t>(measurement - all.begin());
  if (at >= source.in.observations.size()) return std::nullopt;  // or no such measurement
  const Observations& o = source.in.observations[at];
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < fit.measurement.size(); ++i)
    if (fit.measurement[i] == m) rows.push_back(i);
  const auto *x = o.axis("X"), *y = o.axis("Y");
  const bool is_part = std::any_of(o.lines.begin(), o.lines.end(),
                                   [](const auto& line) { return !line.body.empty(); });
  if (!is_part || x == nullptr || y == nullptr || rows.size() != o.size()) return std::nullopt;
  std::map<std::uint32_t, Feature> features;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    Feature& f = features[o.source_line_of(j)];
    f.at = {x->position[j], y->position[j]};
    for (std::size_t k = 0; k < 2; ++k) {
      f.before[k] += o.sense_of(j)[k] * before[rows[j]];
      f.after[k] += o.sense_of(j)[k] * fit.residual[rows[j]];
    }
  }
  PartMap out{fit.measurements[m], {}};
  for (const auto& [line, feature] : features) out.features.push_back(feature);
  return out;
}

/// Factor of the form 1, 2 or 5 times a power of ten with which the largest error is drawn with an
/// eighth of the largest extent of the parts.
double enlargement(const std::vector<PartMap>& maps) {
  double largest = 0.0, extent = 0.0;
  for (const PartMap& map : maps)
    for (const Feature& f : map.features) {
      largest = std::max(
          {largest, std::hypot(f.before[0], f.before[1]), std::hypot(f.after[0], f.after[1])});
      for (std::size_t k = 0; k < 2; ++k)
        extent = std::max(extent, std::fabs(f.at[k] - map.features.front().at[k]));
    }
  if (!(largest > 0.0) || !(extent > 0.0)) return 1.0;
  const double wanted = extent / 8.0 / largest,
               power = std::pow(10.0, std::floor(std::log10(wanted)));
  return power * (wanted >= 5.0 * power ? 5.0 : wanted >= 2.0 * power ? 2.0 : 1.0);
}

Plot drawn(const Source& source, const PartMap& map, std::array<double, 2> Feature::*error,
           const char* title, double factor) {
  const double mm = unit_of(Quantity::length).per_si;
  Plot plot;
  Plot::Curve ways, places;
  ways.colour = source.look.style.accent;
  places.kind = Plot::Curve::Kind::points;
  places.colour = source.look.style.text;
  places.marker = Marker::dot;
  places.marker_size = 0.8;
  double squares = 0.0;
  for (const Feature& f : map.features) {
    const auto& e = f.*error;
    squares += e[0] * e[0] + e[1] * e[1];
    ways.x.insert(ways.x.end(), {f.at[0] * mm, (f.at[0] + factor * e[0]) * mm, std::nan("")});
    ways.y.insert(ways.y.end(), {f.at[1] * mm, (f.at[1] + factor * e[1]) * mm, std::nan("")});
    places.x.push_back(f.at[0] * mm), places.y.push_back(f.at[1] * mm);
  }
  const Quantity q = Quantity::deviation;
  const double rms = std::sqrt(squares / (2.0 * static_cast<double>(map.features.size())));
  plot.title = source.pictures.get(
      title, {{"part", map.id},
              {"rms", localised(short_text(printed(rms, q)), source.pictures.language())},
              {"unit", unit_text(q)}});
  plot.x_title = source.pictures.get("picture.position.x",
                                     {{"axis", "X"}, {"unit", unit_text(Quantity::length)}});
  plot.y_title = source.pictures.get("picture.position.x",
                                     {{"axis", "Y"}, {"unit", unit_text(Quantity::length)}});
  plot.language = source.pictures.language();
  plot.same_scale = true;
  plot.zero_line = false;
  plot.height = 215;
  plot.curves = {std::move(ways), std::move(places)};
  return plot;
}

constexpr std::size_t most_maps = 4;  // two on a page

/// Leaves the parts with the largest remainders, in their order.
void leave_worst(std::vector<PartMap>& maps) {
  if (maps.size() <= most_maps) return;
  const auto mean_square = [](const PartMap& map) {
    double sum = 0.0;
    for (const Feature& f : map.features) sum += f.after[0] * f.after[0] + f.after[1] * f.after[1];
    return sum / static_cast<double>(map.features.size());
  };
  std::vector<double> squares;
  for (const PartMap& map : maps) squares.push_back(mean_square(map));
  std::nth_element(squares.begin(), squares.begin() + (most_maps - 1), squares.end(),
                   std::greater<>());
  const double least = squares[most_maps - 1];
  std::erase_if(maps, [&](const PartMap& map) { return mean_square(map) < least; });
}

}  // namespace

bool add_part_maps(const Source& source, const ModelFit& fit, Blocks& blocks) {
  const std::string field = "map of the errors of " + fit.part;
  const std::vector<double> before = without_effects(fit);
  std::vector<PartMap> maps;
  for (std::uint32_t m = 0; m < fit.measurements.size(); ++m) {
    auto map = map_of(source, fit, before, m);
    if (!map || map->features.empty()) return false;
    maps.push_back(std::move(*map));
  }
  if (maps.empty()) return false;
  const std::size_t all = maps.size();
  leave_worst(maps);
  const double factor = enlargement(maps);
  blocks.push_back({Spacer{4}});
  for (const PartMap& map : maps) {
    Columns row;
    for (const auto& [error, title] : {std::pair{&Feature::before, "picture.map.before"},
                                       std::pair{&Feature::after, "picture.map.after"}})
      row.parts.push_back({{drawn(source, map, error, title, factor), field}});
    blocks.push_back({std::move(row), field});
    blocks.push_back({Spacer{4}});
  }
  std::string says = source.pictures.get("picture.map.says", {{"factor", fixed_text(factor, 0)}});
  if (maps.size() < all)
    says += " " + source.pictures.get("picture.map.some", {{"count", std::to_string(all)}});
  blocks.push_back({Paragraph{says, Paragraph::Look::muted}, field});
  return true;
}

}  // namespace nonio::pdf_report
