// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/replay.h"

#include <algorithm>

#include "nonio/controllers/kit.h"
#include "nonio/math/axis_test.h"
#include "nonio/math/compensated.h"
#include "nonio/math/loaded_table.h"

namespace nonio::controllers {

namespace {

double range_of(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  return *high - *low;
}

/// Deviations with the new tables, mean over the directions of travel; nullopt if the positions of
/// the gantry's sides are needed but not stated.
std::optional<std::vector<double>> after(const ReadLine& line, const Replay& replay) {
  std::vector<double> out = line.deviation;
  for (const int way : line.ways)
    for (std::size_t i = 0; i < out.size(); ++i) {
      std::map<std::string, int> direction;
      for (const auto& [axis, sense] : line.sense) direction[axis] = sense < 0.0 ? -way : way;
      for (const auto& [axis, sense] : line.sense) {
        const auto moved = replay.moved(axis, line.at[i], direction);
        if (!moved) return std::nullopt;
        out[i] += sense * *moved / static_cast<double>(line.ways.size());
      }
    }
  return out;
}

/// Error of a gantry side at the reference point of its pitch table minus that at `x0`, m. nullopt:
/// this side was not measured for `job`.
std::optional<double> left_on_side(const ControllerInput& in, const CrossJob& job,
                                   const std::string& axis, double x0,
                                   const NumberTables& settings) {
  for (std::size_t i = 0; i < std::min(in.campaign.measurements.size(), in.observations.size());
       ++i) {
    const Measurement& m = in.campaign.measurements[i];
    if (m.kind != "axis" || control_axis(in.campaign.machine, m) != axis ||
        in.observations[i].size() == 0 ||
        std::find(job.uses.begin(), job.uses.end(), m.id) == job.uses.end())
      continue;
    const math::ErrorCurve e = math::error_curve(math::AxisTest::arrange(in.observations[i]));
    if (e.position.size() < 2) return std::nullopt;
    double reference = std::clamp(0.0, e.position.front(), e.position.back());
    if (const auto of = settings.find(axis); of != settings.end())
      if (const auto said = of->second.find("reference_mm"); said != of->second.end())
        reference = said->second / 1e3;
    const auto at = [&](double x) { return math::ErrorCurve::at(e.position, e.mean, x); };
    return at(reference) - at(x0);
  }
  return std::nullopt;
}

/// Rotation of the beam at the reference points of the pitch tables relative to the first target,
/// rad.
std::optional<double> turn_of(const ControllerInput& in, const CrossJob& job,
                              const math::Beam& beam, const NumberTables& settings) {
  const double x0 = job.lines.front().at.front().at(beam.axis);
  const auto one = left_on_side(in, job, beam.axis, x0, settings),
             other = left_on_side(in, job, beam.slave, x0, settings);
  if (!one || !other) return std::nullopt;
  return (*other - *one) / (beam.at_slave - beam.at_axis);
}

struct Predicted {
  Prediction stated;   ///< not below U
  double after = 0.0;  ///< range of the mean deviations
};

void keep_worst(std::vector<Predicted>& all, const Predicted& one) {
  const auto known = std::find_if(
      all.begin(), all.end(), [&](const Predicted& p) { return p.stated.name == one.stated.name; });
  if (known == all.end()) return all.push_back(one);
  known->stated.before = std::max(known->stated.before, one.stated.before);
  known->stated.after = std::max(known->stated.after, one.stated.after);
  known->after = std::max(known->after, one.after);
}

}  // namespace

void turn_to_reference(const ControllerInput& in, CrossJob& job, const NumberTables& settings) {
  for (const math::Beam& beam : math::beams_of(in.campaign))
    for (CrossCurve& curve : job.curves) {
      if (curve.output != beam.axis || curve.input != beam.along) continue;
      const auto turn = turn_of(in, job, beam, settings);
      if (!turn) continue;
      for (std::size_t i = 0; i < curve.value.size(); ++i)
        curve.value[i] += *turn * (curve.position[i] - curve.position.front());
      job.yaw_at_reference = beam.along.front() == 'X' ? *turn : -*turn;  // positive from +X to +Y
    }
}

bool shift_slave(const ControllerInput& in, CrossJob& job, double C0Y,
                 const NumberTables& settings) {
  for (const math::Beam& beam : math::beams_of(in.campaign)) {
    const bool carries = std::any_of(job.curves.begin(), job.curves.end(), [&](const auto& curve) {
      return curve.output == beam.axis && curve.input == beam.along;
    });
    if (!carries) continue;
    CrossCurve& along_y = job.curves.back();  // only EXY, the last curve, contains C0Y
    for (std::size_t i = 0; i < along_y.value.size(); ++i)
      along_y.value[i] += C0Y * (along_y.position[i] - along_y.position.front());
    const double turn = turn_of(in, job, beam, settings).value_or(0.0);
    job.slave_zero =
        SlaveZero{beam.axis,    beam.slave,    beam.along,
                  beam.at_axis, beam.at_slave, (beam.at_slave - beam.at_axis) * (C0Y - turn)};
    return true;
  }
  return false;
}

std::optional<double> Replay::moved(const std::string& axis, const math::Places& at,
                                    const math::MotionSigns& direction) const {
  return math::added_on_beam(
      beams, axis, at, direction,
      [&](const std::string& one, const math::Places& places, const math::MotionSigns& ways) {
        double sum = math::added(tables, one, places, ways);
        if (const auto zero = shift.find(one); zero != shift.end()) sum += zero->second;
        const auto was = backlash.find(one);
        const auto way = ways.find(one);
        for (const LoadedTable& t : tables)
          if (t.output == one && t.backlash && way != ways.end())
            sum += (*t.backlash - (was == backlash.end() ? 0.0 : was->second)) / 2.0 * way->second;
        return sum;
      });
}

Replay replay_of(const CrossJob& set, const std::vector<AxisJob>& pitch,
                 const ControllerInput& input) {
  Replay replay{.tables = {}, .beams = math::beams_of(input.campaign)};
  if (set.slave_zero) replay.shift[set.slave_zero->slave] = set.slave_zero->shift;
  for (const AxisJob& job : pitch) {
    if (!job.loaded || !together(set, job, input.campaign)) continue;
    for (const LoadedTable& t : *job.loaded) replay.tables.push_back(t);
    replay.backlash[job.axis] = job.present_backlash();
  }
  const auto& all = input.campaign.measurements;
  const bool off = std::any_of(all.begin(), all.end(), [&](const Measurement& m) {
    return m.id == set.measurement && m.compensation == "off";
  });
  for (const std::string& name : off ? std::vector<std::string>{} : set.moving()) {
    const Axis* axis = input.campaign.machine.axis(name);
    if (axis != nullptr && axis->active_table && !axis->active_table->empty())
      replay.replaces = name;
  }
  return replay;
}

void predict_lines(const CrossJob& job, const Replay& replay, OutputResult& result) {
  const bool is_raw = std::all_of(job.lines.begin(), job.lines.end(),
                                  [](const ReadLine& line) { return !line.measured.empty(); });
  if (!replay.replaces.empty() && !is_raw) {
    result.notes.push_back(
        {"table.diagonals-not-predicted", {}, {{"axis", replay.replaces}}, job.measurement});
    return;
  }
  std::vector<Predicted> all;
  for (const ReadLine& line : job.lines) {
    if (line.deviation.size() < 2) continue;
    const auto will = after(line, replay);
    if (!will) {
      result.notes.push_back({"table.sides-not-placed", {}, {}, job.measurement});
      return;
    }
    const double before = range_of(line.measured.empty() ? line.deviation : line.measured);
    keep_worst(all, {{job.measurement, line.name.substr(0, line.name.find(' ')), before,
                      math::predicted_after(before, range_of(*will), line.U), Quantity::deviation},
                     range_of(*will)});
  }
  for (auto& [p, after] : all) {
    if (!(after < p.before))
      result.findings.push_back({.id = "table.no-gain-diagonal",
                                 .attention = true,
                                 .evidence = {{"before", p.before, Quantity::deviation},
                                              {"after", after, Quantity::deviation}},
                                 .texts = {{"axis", p.name}},
                                 .measurement = job.measurement,
                                 .advice = "These tables would not make the diagonal better."});
    result.predictions.push_back(std::move(p));
  }
}

Expected<void> predict_cross(const CrossJob& job, const std::vector<Artifact>& files,
                             Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                             const std::vector<AxisJob>& pitch, const ControllerInput& input,
                             OutputResult& result) {
  const Campaign campaign = with_axes_of(input, pitch);
  auto tables = parse({files, campaign, input.options});
  const auto unread = [&](const std::string& why) {
    return fail("diagonals of " + job.measurement +
                ": the table written cannot be read back: " + why);
  };
  if (!tables) return unread(tables.error().message);
  for (const CrossCurve& curve : job.curves)
    if (std::none_of(tables->begin(), tables->end(), [&](const LoadedTable& t) {
          return t.output == curve.output &&
                 std::find(t.input.begin(), t.input.end(), curve.input) != t.input.end();
        }))
      return unread(curve.output + " by " + curve.input + " is not in it");
  Replay replay = replay_of(job, pitch, input);
  replay.tables.insert(replay.tables.end(), tables->begin(), tables->end());
  predict_lines(job, replay, result);
  note_cross(job, *tables, result);
  return {};
}

}  // namespace nonio::controllers
