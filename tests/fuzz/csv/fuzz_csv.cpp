// SPDX-License-Identifier: Apache-2.0
// Any bytes give observations that hold together, or an error in readable words.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "csv.h"
#include "nonio/sdk/fields.h"

namespace {

void must(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "does not hold: " << what << std::endl;
  std::abort();
}

void check_error(const nonio::Error& error, std::string_view bytes) {
  must(!error.message.empty(), "an error has words");
  must(error.message.size() < 1000, "an error is short");
  must(nonio::is_utf8(error.message) && nonio::is_utf8(error.column), "words are UTF-8");
  for (const std::string* words : {&error.message, &error.column})
    for (const char c : *words)
      must(static_cast<unsigned char>(c) >= 0x20, "words have no control characters");
  must(error.line <= bytes.size() + 1, "a line is a line of the file");
}

void check_column(const std::vector<double>& column, std::size_t size) {
  must(column.empty() || column.size() == size, "columns are of one size");
  for (const double x : column) must(std::isnan(x) || std::fabs(x) < 1e19, "no mark is a value");
}

void check_observations(const nonio::Observations& obs, std::string_view bytes) {
  const std::size_t n = obs.size();
  must(n > 0 && n + obs.missing <= bytes.size(), "there are readings, and no more than rows");
  must(obs.axes.size() == 1 && obs.lines.size() == 1, "one axis, one line");
  must(obs.run.size() == n && obs.source_line.size() == n, "run and line of each reading");
  must(obs.axes[0].position.size() == n && obs.axes[0].approach.size() == n,
       "target of each reading");
  std::set<std::tuple<std::uint32_t, int, double>> keys;
  for (std::size_t i = 0; i < n; ++i) {
    must(std::isfinite(obs.deviation[i]) && std::isfinite(obs.axes[0].position[i]), "finite");
    must(obs.run[i] >= 1 && std::abs(obs.axes[0].approach[i]) == 1, "run and direction");
    must(keys.emplace(obs.run[i], obs.axes[0].approach[i], obs.axes[0].position[i]).second,
         "a reading is there once");
    must(i == 0 || obs.source_line[i] > obs.source_line[i - 1], "in the order of the file");
  }
  for (const auto* column : {&obs.time, &obs.material, &obs.air, &obs.pressure, &obs.humidity})
    check_column(*column, n);
}

/// What holds of measurements of several axes.
/// directed: each reading is sensed in a direction; a length has none.
void check_spatial(const nonio::Observations& obs, std::string_view bytes, bool directed) {
  const std::size_t n = obs.size();
  must(n > 0 && n + obs.missing <= 3 * bytes.size(), "there are readings");
  must(obs.run.size() == n && obs.source_line.size() == n, "run and line of each reading");
  must(obs.sense.empty() || obs.sense.size() == n, "a sense for each reading, or for none");
  must(obs.line.empty() ? obs.lines.size() == 1 : obs.line.size() == n, "a line of each reading");
  for (const auto& axis : obs.axes)
    must(axis.position.size() == n && (axis.approach.empty() || axis.approach.size() == n),
         "a position of each axis");
  for (std::size_t i = 0; i < n; ++i) {
    must(std::isfinite(obs.deviation[i]), "finite");
    for (const auto& axis : obs.axes) must(std::isfinite(axis.position[i]), "finite");
    must(obs.line.empty() || obs.line[i] < obs.lines.size(), "a line that is there");
    const auto& sense = obs.sense_of(i);
    const double size = std::hypot(sense[0], sense[1], sense[2]);
    // The direction of a displacement over time may be unknown.
    must(std::fabs(size - (directed ? 1.0 : 0.0)) < 1e-9 || (!obs.channels.empty() && size == 0.0),
         "a unit vector");
  }
  for (const auto* column : {&obs.time, &obs.material, &obs.air, &obs.pressure, &obs.humidity})
    check_column(*column, n);
}

struct World {
  static constexpr std::array spatial_kinds{"diagonal",     "step-diagonal", "ball-centres",
                                            "observations", "circle",        "rtcp",
                                            "thermal",      "spindle",       "lengths"};
  static constexpr std::array<std::pair<std::string_view, std::size_t>, 10> spatial_by_words{
      {{"#diagonal", 0},
       {"moved", 1},
       {"angle", 2},
       {"nx", 3},
       {"#circle", 4},
       {"tx", 5},
       {"speed_rpm", 6},
       {"ball_deg", 7},
       {"length_mm", 8},
       {"#exercised", 9}}};

  nonio::Campaign campaign;
  nonio::Measurement linear, rotary, straightness;
  std::vector<nonio::Measurement> spatial;
  nonio::Settings options;

  World() {
    nonio::Axis x, c;
    x.name = "X";
    c.name = "C";
    c.rotary = true;
    campaign.machine.axes = {x, c};
    linear.kind = rotary.kind = "axis";
    straightness.kind = "straightness";
    straightness.lateral = "Y";
    linear.axis = straightness.axis = "X";
    rotary.axis = "C";
    for (const char* kind : spatial_kinds) {
      nonio::Measurement m;
      m.id = m.kind = kind;
      m.axis = "C";
      m.from = {{"X", 0.0}, {"Y", 0.0}, {"Z", 1.0}};
      m.to = {{"X", 0.8}, {"Y", 0.6}, {"Z", m.kind == "diagonal" ? 1.0 : 1.6}};
      if (m.kind == "circle") {
        m.from = {{"X", 0.4}, {"Y", 0.2}};
        m.to = {{"X", 0.5}, {"Y", 0.2}};
      }
      if (m.kind == "thermal") m.axis = "";
      if (m.kind == "lengths") m.from.clear(), m.to.clear();
      spatial.push_back(m);
    }
    // An axis that is exercised.
    spatial.push_back(spatial[6]);
    spatial.back().axis = "X";
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const World world;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  nonio::csv::recognises(bytes);
  // The file says by its columns, or in a comment, what it is to be.
  const auto says = [&](std::string_view words) { return bytes.find(words) != bytes.npos; };
  for (const auto& [words, kind] : World::spatial_by_words) {
    if (!says(words)) continue;
    const nonio::Measurement& m = world.spatial[kind];
    const auto table = nonio::csv::read({bytes, world.campaign, m, world.options, {}});
    if (table)
      check_spatial(*table, bytes, m.kind != "lengths" || table->axes[0].axis == "point");
    else
      check_error(table.error(), bytes);
  }
  const nonio::Measurement& measurement = says("_deg")            ? world.rotary
                                          : says("#straightness") ? world.straightness
                                                                  : world.linear;
  const auto read = nonio::csv::read({bytes, world.campaign, measurement, world.options, {}});
  if (read)
    check_observations(*read, bytes);
  else
    check_error(read.error(), bytes);
  return 0;
}
