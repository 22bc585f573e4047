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

/// Reads one [[cycle]].
class CycleReader {
 public:
  CycleReader(const config::TableReader& reader, std::vector<Error>& errors)
      : reader_(reader), errors_(errors) {
    c_.line = reader.line();
  }

  CycleSpec read(const Campaign& campaign, const std::vector<Method>& methods) {
    if (!find_measurement(campaign, methods)) return c_;
    unit_ = c_.axis.rotary ? 1.0 / deg_per_rad : 1e-3;
    const bool angular = c_.along_axis() && c_.axis.rotary;
    reader_.settle(config::cycle_axis, c_.along_axis()          ? (angular ? "rotary" : "linear")
                                       : c_.is("straightness")  ? "straightness"
                                       : c_.is("diagonal")      ? "diagonal"
                                       : c_.is("step-diagonal") ? "step-diagonal"
                                       : c_.is("ball-centres")  ? "ball-centres"
                                       : c_.is("circle")        ? "circle"
                                                                : "rtcp");
    read_steps();
    if (!c_.is("step-diagonal") && !c_.is("circle")) read_targets();
    if (!c_.is("step-diagonal")) read_order();
    if (const auto runs = reader_.integer("runs")) c_.runs = static_cast<std::uint32_t>(*runs);
    read_times();
    c_.noise =
        (angular ? reader_.number("noise_arcsec") : reader_.number("noise_um")).value_or(0.0);
    if (c_.is("straightness")) c_.set_up = reader_.number("set_up_urad").value_or(0.0);
    read_balls(campaign);
    read_misreadings();
    read_temperature();
    reader_.finish();
    return c_;
  }

 private:
  bool find_measurement(const Campaign& campaign, const std::vector<Method>& methods) {
    const std::string id = reader_.text("measurement");
    std::vector<std::string> ids;
    for (const Measurement& m : campaign.measurements) {
      ids.push_back(m.id);
      if (m.id == id) c_.measurement = m;
    }
    if (c_.measurement.id.empty()) {
      if (!id.empty())
        reader_.error("measurement", "no [[measurement]] has the id \"" + id + "\"" +
                                         storage::suggestion(id, ids));
      return false;
    }
    static constexpr std::array made{"axis",         "straightness", "diagonal", "step-diagonal",
                                     "ball-centres", "rtcp",         "circle"};
    if (std::find(made.begin(), made.end(), method_name(c_.measurement)) == made.end()) {
      const auto method = std::find_if(methods.begin(), methods.end(), [&](const Method& m) {
        return method_name(c_.measurement) == m.info.name && !m.columns.empty() &&
               !c_.measurement.axis.empty();
      });
      if (method == methods.end()) {
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
    if (const Axis* axis = campaign.machine.axis(c_.measurement.axis)) c_.axis = *axis;
    if ((c_.is("ball-centres") || c_.is("rtcp")) != c_.axis.rotary && !c_.along_axis()) {
      reader_.error("measurement", "expected a " +
                                       std::string(c_.axis.rotary ? "linear" : "rotary") +
                                       " axis for kind " + c_.measurement.kind);
      return false;
    }
    return true;
  }

  void read_targets() {
    const std::string suffix = c_.axis.rotary ? "_deg" : "_mm";
    const std::string list = "targets" + suffix, from = "from" + suffix, to = "to" + suffix,
                      step = "step" + suffix;
    const auto given = reader_.numbers(list);
    const auto first = reader_.number(from), last = reader_.number(to),
               distance = reader_.number(step);
    const double share = reader_.number("random_offset_pct").value_or(0.0);
    if (share > 0.45) reader_.error("random_offset_pct", "expected at most 45, targets keep order");
    if (c_.steps > 0) {
      if (given || first || last || distance) reader_.error("steps", "is not allowed with targets");
      const double whole = length_of(c_.measurement) / unit_;
      for (std::uint32_t i = 0; i <= c_.steps; ++i) c_.targets.push_back(whole * i / c_.steps);
    } else if (given) {
      if (first || last || distance) reader_.error(list, "is not allowed with a range");
      c_.targets = *given;
    } else if (first && last && distance && *distance > 0.0 && *last > *first &&
               (*last - *first) / *distance < 1e5) {
      for (int i = 0; *first + i * *distance <= *last + 1e-9 * *distance; ++i)
        c_.targets.push_back(*first + i * *distance);
    } else {
      complain(reader_.place(list) + ": expected a list of targets, or a range by " + from + ", " +
               to + " (the larger one) and " + step);
      return;
    }
    const auto falls =
        std::adjacent_find(c_.targets.begin(), c_.targets.end(), std::greater_equal<>());
    if (c_.targets.size() < 2 || c_.targets.size() > 100000 || falls != c_.targets.end()) {
      complain(reader_.place(list) +
               ": expected 2 to 100000 targets, each larger than the one before; found " +
               std::to_string(c_.targets.size()) + " targets");
      return;
    }
    double least = c_.targets[1] - c_.targets[0];
    for (std::size_t i = 1; i < c_.targets.size(); ++i)
      least = std::min(least, c_.targets[i] - c_.targets[i - 1]);
    c_.offset = share * least * unit_;
    for (double& target : c_.targets) target *= unit_;
  }

  static double length_of(const Measurement& m) {
    double square = 0.0;
    for (const auto& [axis, from] : m.from)
      if (const auto to = m.to.find(axis); to != m.to.end())
        square += (to->second - from) * (to->second - from);
    return std::sqrt(square);
  }

  void read_steps() {
    if (!c_.is("diagonal") && !c_.is("step-diagonal")) return;
    if (const auto steps = reader_.integer("steps")) c_.steps = static_cast<std::uint32_t>(*steps);
    if (c_.is("step-diagonal") && c_.steps == 0)
      reader_.error("steps", "is missing: the moves of each axis");
  }

  void read_carrier(const Campaign& campaign) {
    c_.carrier = reader_.text("carrier");
    const auto at = reader_.numbers("carrier_deg");
    if (c_.carrier.empty() != !at)
      reader_.error(c_.carrier.empty() ? "carrier" : "carrier_deg",
                    c_.carrier.empty() ? "is missing: the axis of carrier_deg"
                                       : "is missing: the positions of axis " + c_.carrier);
    if (c_.carrier.empty() || !at) return;
    const Axis* axis = campaign.machine.axis(c_.carrier);
    if (axis == nullptr || !axis->rotary || axis->name == c_.axis.name)
      reader_.error("carrier", "expected another rotary axis of the machine than " + c_.axis.name +
                                   ", found " + c_.carrier);
    if (at->empty() || at->size() > 1000)
      reader_.error("carrier_deg",
                    "expected 1 to 1000 positions, found " + std::to_string(at->size()));
    for (const double degrees : *at) c_.carrier_at.push_back(degrees / deg_per_rad);
  }

  void read_balls(const Campaign& campaign) {
    if (!c_.is("ball-centres") && !c_.is("rtcp")) return;
    c_.balls = vectors_at(reader_, "ball_mm", 1e-3);
    if (c_.balls.empty()) reader_.error("ball_mm", "is missing: where the ball is, [X, Y, Z]");
    if (c_.is("ball-centres")) {
      if (c_.balls.size() > 1) reader_.error("ball_mm", "expected one ball");
      read_carrier(campaign);
      return;
    }
    c_.sensor = reader_.text("sensor");
    c_.senses = vectors_at(reader_, "sense", 1.0);
    for (auto& sense : c_.senses) {
      const double size = std::hypot(sense[0], sense[1], sense[2]);
      if (!(size > 0.0)) reader_.error("sense", "expected a direction, found 0, 0, 0");
      for (double& x : sense) x /= size > 0.0 ? size : 1.0;
    }
    if (const auto offset = vectors_at(reader_, "ball_offset_um", 1e-6); !offset.empty())
      c_.ball_offset = offset.front();
    if (c_.sensor.empty()) reader_.error("sensor", "is missing: turns, stationary or probe");
    if (c_.sensor == "probe" ? !c_.senses.empty() : c_.senses.empty())
      reader_.error("sense", c_.sensor == "probe" ? "is not allowed with a probe, which senses all"
                                                  : "is missing: where the gauge points");
  }

  void read_temperature() {
    auto t = reader_.table("temperature");
    if (!t) return;
    CycleSpec::Course course;
    course.start = t->number("start_c").value_or(course.start);
    course.drift = t->number("drift_K_per_h").value_or(0.0);
    course.swing = t->number("swing_K").value_or(0.0);
    course.period = t->number("period_s").value_or(course.period);
    t->finish();
    c_.temperature = course;
  }

  void read_misreadings() {
    auto m = reader_.table("misreadings");
    if (!m) return;
    c_.misread = m->number("fraction").value_or(0.0);
    if (c_.misread > 1.0) m->error("fraction", "expected 0 to 1");
    if (const auto size = m->numbers("size")) {
      if (size->size() == 2 && (*size)[0] >= 0.0 && (*size)[0] <= (*size)[1])
        c_.misread_size = {(*size)[0], (*size)[1]};
      else
        m->error("size", "expected two numbers, times the noise, the smaller one first");
    }
    m->finish();
  }

  void read_order() {
    c_.pendulum = reader_.text("order") != "unidirectional";
    const std::string direction = reader_.text("direction");
    if (!direction.empty() && c_.pendulum)
      reader_.error("direction", "is only allowed with order = \"unidirectional\"");
    c_.direction = direction == "-" ? -1.0 : 1.0;
  }

  void read_times() {
    if (c_.is("circle")) return read_circle();
    const char* feed = c_.axis.rotary ? "feed_deg_per_min" : "feed_mm_per_min";
    c_.feed = reader_.number(feed).value_or(c_.axis.rotary ? 0.1 : 0.05);
    c_.dwell = reader_.number("dwell_s").value_or(c_.dwell);
    c_.pause = reader_.number("pause_s").value_or(c_.pause);
    c_.timed = reader_.flag("times").value_or(true);
  }

  /// Reads the keys of a circle. The feed is that of the measurement, and the dwell is 0 unless
  /// `dwell_s` is stated.
  void read_circle() {
    if (const auto readings = reader_.integer("readings"))
      c_.readings = static_cast<std::uint32_t>(*readings);
    if (!c_.measurement.feed)
      reader_.error("measurement", "has no feed_mm_per_min, which a simulated circle needs");
    c_.feed = c_.measurement.feed.value_or(1.0);
    c_.dwell = reader_.number("dwell_s").value_or(0.0);
    c_.pause = reader_.number("pause_s").value_or(c_.pause);
    c_.timed = reader_.flag("times").value_or(true);
  }

  void complain(std::string message) {
    errors_.push_back(Error{std::move(message), reader_.file(), c_.line});
  }

  CycleSpec c_;
  double unit_ = 1e-3;  ///< SI value of one unit of the targets
  config::TableReader reader_;
  std::vector<Error>& errors_;
};

}  // namespace

std::vector<CycleSpec> read_cycles(config::TableReader& top, const Campaign& campaign,
                                   const std::vector<Method>& methods, std::vector<Error>& errors) {
  const auto complain = [&](std::uint64_t line, std::string message) {
    errors.push_back(Error{std::move(message), top.file(), line});
  };
  std::vector<CycleSpec> found, cycles;
  for (const config::TableReader& reader : top.tables("cycle"))
    found.push_back(CycleReader(reader, errors).read(campaign, methods));
  for (const Measurement& m : campaign.measurements) {
    const auto is_its = [&](const CycleSpec& c) { return c.measurement.id == m.id; };
    const auto of_it = std::find_if(found.begin(), found.end(), is_its);
    if (of_it == found.end()) {
      if (errors.empty())
        complain(top.line_of("measurement"),
                 "measurement \"" + m.id + "\" has no [[cycle]] that states how it is taken");
      continue;
    }
    const auto again = std::find_if(of_it + 1, found.end(), is_its);
    if (again != found.end()) complain(again->line, "measurement \"" + m.id + "\" has two cycles");
    cycles.push_back(*of_it);
  }
  return cycles;
}

}  // namespace nonio::simulation
