// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "campaign/config/toml_reader.h"
#include "platform/storage/files.h"
#include "platform/storage/nearest.h"
#include "simulation/simulate_spec.h"

namespace nonio::simulation {
namespace {

class CycleReader {
 public:
  CycleReader(config::TableReader& reader, const Specification& s)
      : campaign_(s.campaign), methods_(*s.methods), reader_(reader) {
    c_.line = reader.line();
  }

  CycleSpec read(const config::Key& key) {
    const auto id =
        config::value_of<std::string>(reader_, *config::find_key(key.keys, "measurement"));
    if (!id || !find_measurement(*id)) return c_;
    unit_ = c_.axis.rotary ? 1.0 / deg_per_rad : 1e-3;
    reader_.settle(config::cycle_axis, c_.along_axis() ? (c_.axis.rotary ? "rotary" : "linear")
                                       : c_.is("straightness")  ? "straightness"
                                       : c_.is("diagonal")      ? "diagonal"
                                       : c_.is("step-diagonal") ? "step-diagonal"
                                       : c_.is("ball-centres")  ? "ball-centres"
                                       : c_.is("circle")        ? "circle"
                                                                : "rtcp");
    set_defaults();
    reader_.fill(c_);
    if (c_.is("step-diagonal") && c_.steps == 0)
      reader_.error("steps", "is missing: the moves of each axis");
    if (!c_.is("step-diagonal") && !c_.is("circle")) check_targets();
    if (reader_.contains("direction") && c_.pendulum)
      reader_.error("direction", "is only allowed with order = \"unidirectional\"");
    if (c_.is("ball-centres")) check_centres();
    if (c_.is("rtcp")) check_gauges();
    reader_.finish();
    return c_;
  }

 private:
  bool find_measurement(const std::string& id) {
    std::vector<std::string> ids;
    for (const Measurement& m : campaign_.measurements) {
      ids.push_back(m.id);
      if (m.id == id) c_.measurement = m;
    }
    if (c_.measurement.id.empty()) {
      reader_.error("measurement",
                    "no [[measurement]] has the id \"" + id + "\"" + storage::suggestion(id, ids));
      return false;
    }
    static constexpr std::array made{"axis",         "straightness", "diagonal", "step-diagonal",
                                     "ball-centres", "rtcp",         "circle"};
    if (std::find(made.begin(), made.end(), method_name(c_.measurement)) == made.end()) {
      const auto method = std::find_if(methods_.begin(), methods_.end(), [&](const Method& m) {
        return method_name(c_.measurement) == m.info.name && !m.columns.empty() &&
               !c_.measurement.axis.empty();
      });
      if (method == methods_.end()) {
        reader_.error("measurement",
                      "expected a measurement of kind axis, straightness, diagonal, "
                      "step-diagonal, ball-centres, rtcp or circle, or of a method with columns "
                      "and an axis; found " +
                          method_name(c_.measurement));
        return false;
      }
      c_.method = &*method;
    }
    if (!storage::is_artifact_name(c_.measurement.file))
      reader_.error("measurement", "its file is not a plain name: " + c_.measurement.file);
    if (const Axis* axis = campaign_.machine.axis(c_.measurement.axis)) c_.axis = *axis;
    if ((c_.is("ball-centres") || c_.is("rtcp")) != c_.axis.rotary && !c_.along_axis()) {
      reader_.error("measurement", "expected a " +
                                       std::string(c_.axis.rotary ? "linear" : "rotary") +
                                       " axis for kind " + c_.measurement.kind);
      return false;
    }
    return true;
  }

  void set_defaults() {
    c_.feed = c_.axis.rotary ? 0.1 : 0.05;
    if (!c_.is("circle")) return;
    if (!c_.measurement.feed)
      reader_.error("measurement", "has no feed_mm_per_min, which a simulated circle needs");
    c_.feed = c_.measurement.feed.value_or(1.0);
    c_.dwell = 0.0;
  }

  void check_targets() {
    const std::string suffix = c_.axis.rotary ? "_deg" : "_mm";
    const std::string list = "targets" + suffix;
    const bool given = reader_.contains(list), ranged = c_.first || c_.last || c_.distance;
    if (c_.offset > 0.45)
      reader_.error("random_offset_pct", "expected at most 45, targets keep order");
    if (c_.steps > 0) {
      if (given || ranged) reader_.error("steps", "is not allowed with targets");
      c_.targets.clear();
      const double whole = length_of(c_.measurement) / unit_;
      for (std::uint32_t i = 0; i <= c_.steps; ++i) c_.targets.push_back(whole * i / c_.steps);
    } else if (given) {
      if (ranged) reader_.error(list, "is not allowed with a range");
    } else if (c_.first && c_.last && c_.distance && *c_.distance > 0.0 && *c_.last > *c_.first &&
               (*c_.last - *c_.first) / *c_.distance < 1e5) {
      for (int i = 0; *c_.first + i * *c_.distance <= *c_.last + 1e-9 * *c_.distance; ++i)
        c_.targets.push_back(*c_.first + i * *c_.distance);
    } else {
      return complain(reader_.place(list) + ": expected a list of targets, or a range by from" +
                      suffix + ", to" + suffix + " (the larger one) and step" + suffix);
    }
    const auto falls =
        std::adjacent_find(c_.targets.begin(), c_.targets.end(), std::greater_equal<>());
    if (c_.targets.size() < 2 || c_.targets.size() > 100000 || falls != c_.targets.end())
      return complain(reader_.place(list) +
                      ": expected 2 to 100000 targets, each larger than the one before; found " +
                      std::to_string(c_.targets.size()) + " targets");
    double least = c_.targets[1] - c_.targets[0];
    for (std::size_t i = 1; i < c_.targets.size(); ++i)
      least = std::min(least, c_.targets[i] - c_.targets[i - 1]);
    c_.offset = c_.offset * least * unit_;
    for (double& target : c_.targets) target *= unit_;
  }

  static double length_of(const Measurement& m) {
    double square = 0.0;
    for (const auto& [axis, from] : m.from)
      if (const auto to = m.to.find(axis); to != m.to.end())
        square += (to->second - from) * (to->second - from);
    return std::sqrt(square);
  }

  void check_centres() {
    check_balls();
    if (c_.balls.size() > 1) reader_.error("ball_mm", "expected one ball");
    const bool at = reader_.contains("carrier_deg");
    if (c_.carrier.empty() == at)
      reader_.error(at ? "carrier" : "carrier_deg",
                    at ? "is missing: the axis of carrier_deg"
                       : "is missing: the positions of axis " + c_.carrier);
    if (c_.carrier.empty() || !at) return;
    const Axis* axis = campaign_.machine.axis(c_.carrier);
    if (axis == nullptr || !axis->rotary || axis->name == c_.axis.name)
      reader_.error("carrier", "expected another rotary axis of the machine than " + c_.axis.name +
                                   ", found " + c_.carrier);
    if (c_.carrier_at.empty() || c_.carrier_at.size() > 1000)
      reader_.error("carrier_deg",
                    "expected 1 to 1000 positions, found " + std::to_string(c_.carrier_at.size()));
    for (double& position : c_.carrier_at) position /= deg_per_rad;
  }

  void check_gauges() {
    check_balls();
    if (c_.sensor.empty()) reader_.error("sensor", "is missing: turns, stationary or probe");
    if (c_.sensor == "probe" ? !c_.senses.empty() : c_.senses.empty())
      reader_.error("sense", c_.sensor == "probe" ? "is not allowed with a probe, which senses all"
                                                  : "is missing: where the gauge points");
  }

  void check_balls() {
    if (c_.balls.empty()) reader_.error("ball_mm", "is missing: where the ball is, [X, Y, Z]");
  }

  void complain(std::string message) {
    reader_.error(Error{std::move(message), reader_.file(), c_.line});
  }

  const Campaign& campaign_;
  const std::vector<Method>& methods_;
  CycleSpec c_;
  double unit_ = 1e-3;
  config::TableReader& reader_;
};

}  // namespace

void read_cycles(config::TableReader& top, const config::Key& key, std::vector<CycleSpec>& cycles,
                 Specification& s) {
  const auto complain = [&](std::uint64_t line, std::string message) {
    top.error(Error{std::move(message), top.file(), line});
  };
  std::vector<CycleSpec> found;
  for (config::TableReader& reader : top.tables(key))
    found.push_back(CycleReader(reader, s).read(key));
  for (const Measurement& m : s.campaign.measurements) {
    const auto is_its = [&](const CycleSpec& c) { return c.measurement.id == m.id; };
    const auto of_it = std::find_if(found.begin(), found.end(), is_its);
    if (of_it == found.end()) {
      if (!top.has_errors())
        complain(top.line_of("measurement"),
                 "measurement \"" + m.id + "\" has no [[cycle]] that states how it is taken");
      continue;
    }
    const auto again = std::find_if(of_it + 1, found.end(), is_its);
    if (again != found.end()) complain(again->line, "measurement \"" + m.id + "\" has two cycles");
    cycles.push_back(*of_it);
  }
}

}  // namespace nonio::simulation
