// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/axis_job.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "nonio/controllers/text.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/format.h"
#include "resolution.h"
#include "reversal_known.h"

namespace nonio::controllers {

namespace {

struct Positioning {
  bool is = false, shape = false;
};

Positioning positioning(std::string_view name) {
  Positioning p;
  p.shape = name.ends_with("_shape");
  if (p.shape) name.remove_suffix(6);
  p.is = name == "EXX" || name == "EYY" || name == "EZZ";
  return p;
}

/// Whether the axis has a positioning run, which gives a better table: one used for these step
/// diagonals, or one of the same state.
bool has_run(const ControllerInput& in, const Results::Analysed& a, const std::string& axis) {
  const auto& all = in.campaign.measurements;
  const auto of = std::find_if(all.begin(), all.end(),
                               [&](const Measurement& m) { return m.id == a.measurement; });
  const auto& uses = a.evaluation.uses;
  for (std::size_t i = 0; i < std::min(all.size(), in.observations.size()); ++i)
    if (all[i].kind == "axis" && all[i].axis == axis && in.observations[i].size() > 0 &&
        (std::find(uses.begin(), uses.end(), all[i].id) != uses.end() ||
         (of != all.end() && state_of(all[i]) == state_of(*of))))
      return true;
  return false;
}

/// Returns jobs from step diagonals (series EXX, EYY, EZZ; EXX_shape if the scale is unknown) for
/// axes without positioning runs in the same state, which would give a better table. A gantry axis
/// gets one job per side.
std::vector<AxisJob> series_jobs(const ControllerInput& in) {
  std::vector<AxisJob> jobs;
  for (const Results::Analysed& a : in.results.analyses)
    for (const Series& s : a.evaluation.series) {
      const Positioning p = positioning(s.name);
      if (!p.is || s.position.size() < 2 || has_run(in, a, s.over)) continue;
      AxisJob job;
      job.axis = s.over;
      job.measurement = a.measurement;
      job.from_diagonals = true;
      job.scale_known = !p.shape;
      job.curve.position = s.position;
      job.curve.mean = job.curve.plus = s.value;
      job.unresolved = unresolved_step(in, a.measurement, s.position, s.value);
      jobs.push_back(job);
      // Both gantry sides have the same error, because the diagonals measure the center of the
      // beam.
      const Axis* axis = in.campaign.machine.axis(s.over);
      if (axis == nullptr || axis->slave.empty()) continue;
      job.axis = axis->slave;
      jobs.push_back(std::move(job));
    }
  return jobs;
}

Expected<void> check_names(const NumberTables& settings, const ControllerInput& input) {
  std::set<std::string> known;
  for (const Axis& a : input.campaign.machine.axes) {
    known.insert(a.name);
    if (!a.slave.empty()) known.insert(a.slave);
  }
  for (const Measurement& m : input.campaign.measurements)
    if (m.kind == "axis") known.insert(control_axis(input.campaign.machine, m));
  for (const AxisJob& job : series_jobs(input)) known.insert(job.axis);
  for (const auto& [axis, of_axis] : settings)
    if (known.count(axis) == 0)
      return wrong_axes("option axes: no axis " + axis + "; there are " +
                            joined({known.begin(), known.end()}, ", "),
                        axis);
  return {};
}

struct Active {
  std::optional<std::string> table;  ///< file names; empty without a table, absent if not stated
  bool backlash = false;
};

const Measurement* measurement_of(const ControllerInput& input, const std::string& id) {
  for (const Measurement& m : input.campaign.measurements)
    if (m.id == id) return &m;
  return nullptr;
}

Active active_of(const ControllerInput& input, const std::string& axis,
                 const std::string& measurement, bool in_options) {
  const Axis* a = input.campaign.machine.axis(axis);
  const Measurement* m = measurement_of(input, measurement);
  const bool off = m != nullptr && m->compensation == "off";
  Active out;
  if (a != nullptr) out.table = a->active_table;
  if (off) out.table = std::string();
  out.backlash = off || in_options || (a != nullptr && a->active_backlash);
  return out;
}

std::vector<std::string> active_lines(const ControllerInput& input, const AxisJob& job) {
  const Active active = active_of(input, job.axis, job.measurement, true);
  std::vector<std::string> lines;
  if (active.table && active.table->empty())
    lines.emplace_back("no table of this axis was active while it was measured");
  else if (active.table)
    lines.push_back("while this axis was measured the table of " + plain(*active.table) +
                    " was active: this one replaces it and is complete");
  if (active.table)
    lines.push_back("the backlash parameter was " + with_unit(job, job.present_backlash(), 6) +
                    " while the axis was measured");
  return lines;
}

std::vector<std::string> about(const ControllerInput& input, const AxisJob& job) {
  const Machine& m = input.campaign.machine;
  std::vector<std::string> lines;
  lines.push_back("machine: " +
                  ((m.maker + m.model + m.serial).empty()
                       ? "not stated"
                       : plain(m.maker) + " " + plain(m.model) + ", serial " + plain(m.serial)));
  lines.push_back("axis " + plain(job.axis) + ", measurement " + plain(job.measurement) + ", " +
                  plain(input.campaign.date.empty() ? "no date" : input.campaign.date) +
                  ", campaign " + plain(input.campaign.id));
  lines.push_back("measured from " + with_unit(job, job.curve.position.front(), 4) + " to " +
                  with_unit(job, job.curve.position.back(), 4) + ", " +
                  std::to_string(job.curve.position.size()) + " targets");
  for (std::string& line : active_lines(input, job)) lines.push_back(std::move(line));
  return lines;
}

// Ids of drift findings with severity warning, computed here because the analyses that report drift
// are optional.
void take_drift(const math::AxisTest& test, AxisJob& job) {
  std::vector<Finding> findings;
  math::drift_findings(test, findings);
  for (const Finding& f : findings) {
    if (f.attention) job.drift.push_back(f.id);
    for (const Number& n : f.evidence)
      if (n.name == "total") job.drifted = std::max(job.drifted, std::fabs(n.value));
  }
}

std::vector<std::string> suspects_of(const math::AxisTest& test, const AxisJob& job) {
  std::vector<Finding> findings;
  math::suspect_findings(test, findings);
  std::vector<std::string> readings;
  for (const Finding& f : findings) {
    std::string text;
    for (const Number& n : f.evidence) {
      if (n.name == "target") text = with_unit(job, n.value, 4) + text;
      if (n.name == "run") text += " (" + fixed_text(n.value, 0) + ", ";
    }
    for (const auto& [name, value] : f.texts)
      if (name == "direction") text += value + ")";
    readings.push_back(std::move(text));
  }
  return readings;
}

AxisJob job_of(const ControllerInput& input, std::size_t index) {
  const Measurement& m = input.campaign.measurements[index];
  const math::AxisTest test = math::AxisTest::arrange(input.observations[index]);
  AxisJob job;
  job.axis = control_axis(input.campaign.machine, m);
  job.measurement = m.id;
  job.rotary = test.rotary;
  job.curve = math::error_curve(test);
  if (input.measured != nullptr && index < input.measured->size())
    job.measured = math::error_curve(math::AxisTest::arrange((*input.measured)[index]));
  job.reversal = math::assess_reversal(test);
  take_uncertainties(input, index, job);
  if (job.rotary) job.turn = math::closed_turn(job.curve);
  take_drift(test, job);
  job.unresolved = unresolved_step(test, job.curve);
  job.suspects = suspects_of(test, job);
  return job;
}

void say_what_was_left_out(const AxisJob& job, OutputResult& result) {
  const auto say = [&](const char* id) -> Remark& {
    return result.notes.emplace_back(remark(job, id));
  };
  if (job.curve.left_out > 0)
    say("table.left-out").evidence = {
        {"targets", static_cast<double>(job.curve.left_out), Quantity::count}};
  if (job.held) say_held(job, result);
  if (job.from_diagonals)
    say(job.scale_known ? "table.from-diagonals" : "table.from-shape")
        .texts.emplace_back("id", job.measurement);
  else if (!job.curve.bidirectional())
    say("table.one-direction").texts.emplace_back("direction", job.curve.plus.empty() ? "-" : "+");
  else if (job.reversal.kind == math::Reversal::Kind::unknown)
    say("table.reversal-unjudged");
}

// The error of an unstable axis changes, so a table cannot compensate it.
void refuse_drift(const AxisJob& job, OutputResult& result) {
  result.findings.push_back(
      {"table.refused-drift",
       true,
       {},
       {{"axis", job.axis}, {"drift", joined(job.drift, ", ")}},
       job.measurement,
       "Do not compensate yet: find the cause of the drift and measure the axis again. To have the "
       "table all the same: drifted = 1 under axes." +
           job.axis + " in the options of this control."});
}

Expected<void> name_files(std::vector<AxisJob>& jobs, OutputResult& result) {
  std::map<std::string, std::size_t> count;
  for (const AxisJob& j : jobs) ++count[j.axis];
  std::set<std::string> stems, told;
  std::map<std::size_t, std::string> numbers;
  for (AxisJob& j : jobs) {
    const std::string& owner = numbers.emplace(j.number, j.axis).first->second;
    if (j.number != 0 && owner != j.axis)
      return wrong_axes("axes " + owner + " and " + j.axis + " would both be axis number " +
                            std::to_string(j.number) + ": set number = ... under axes." + j.axis,
                        j.axis + ".number");
    if (count[j.axis] > 1) {
      j.stem += "-" + file_part(j.measurement);
      if (told.insert(j.axis).second)
        result.findings.push_back(
            {"table.two-measurements",
             false,
             {{"measurements", static_cast<double>(count[j.axis]), Quantity::count}},
             {{"axis", j.axis}},
             j.measurement,
             "Load the table of one measurement only."});
    }
    if (!stems.insert(j.stem).second)
      return fail("measurements " + j.measurement +
                  " and another one would write the same file: give them ids that differ in "
                  "letters, digits, '.' or '_'");
  }
  return {};
}

/// Gantry axes measured on parallel lines without a stated `side`, for which the tables of master
/// and slave could be exchanged.
std::set<std::string> unsided_axes(const Campaign& campaign) {
  std::set<std::string> axes;
  if (campaign.machine.structure != "gantry") return axes;
  std::map<std::string, std::map<std::string, double>> line;
  std::set<std::string> several, unsaid;
  for (const Measurement& m : campaign.measurements) {
    if (m.kind != "axis") continue;
    if (line.emplace(m.axis, m.at).first->second != m.at) several.insert(m.axis);
    if (m.side.empty()) unsaid.insert(m.axis);
  }
  std::set_intersection(several.begin(), several.end(), unsaid.begin(), unsaid.end(),
                        std::inserter(axes, axes.end()));
  return axes;
}

bool number_unsaid(const AxisJob& job, const std::vector<std::string_view>& keys) {
  return job.number == 0 && std::find(keys.begin(), keys.end(), "number:") != keys.end();
}

void refuse_number(const std::string& axis, const std::string& measurement,
                   const ControllerInput& input, OutputResult& result) {
  const std::string& asset = input.campaign.machine.asset;
  const std::string file = "machines/" + (asset.empty() ? "<asset>" : asset) + ".toml";
  result.findings.push_back({"table.axis-number",
                             true,
                             {},
                             {{"axis", axis}, {"file", file}},
                             measurement,
                             "Say its number in the control: number = ... under [axes." + axis +
                                 "] of " + file + ", or under axes." + axis +
                                 " in the options of this control."});
}

}  // namespace

bool has_tables(const Campaign& campaign) {
  return std::any_of(
      campaign.measurements.begin(), campaign.measurements.end(),
      [](const Measurement& m) { return m.kind == "axis" || m.kind == "step-diagonal"; });
}

bool lacks_number(const std::vector<std::string>& of, const ControllerInput& input,
                  const std::vector<KnownAxis>& axes, const std::string& measurement,
                  OutputResult& result) {
  std::set<std::string> unsaid;
  for (const std::string& axis : of)
    if (axis_named(axes, axis).number == 0) unsaid.insert(axis);
  for (const std::string& axis : unsaid) refuse_number(axis, measurement, input, result);
  return !unsaid.empty();
}

namespace {

/// The same line in an earlier state of the machine, which something has changed since.
const Measurement* earlier_line(const Campaign& campaign, const Measurement& m) {
  const auto is_line = [&](const Measurement& n) {
    return n.kind == m.kind && n.axis == m.axis && n.at == m.at && n.from == m.from &&
           n.to == m.to && n.side == m.side;
  };
  bool earlier = true;
  for (const Measurement& n : campaign.measurements) {
    if (n.id == m.id) earlier = false;
    if (!is_line(n)) continue;
    if (!n.adjustment.empty() && !m.adjustment.empty()
            ? n.adjustment == "before" && m.adjustment == "after"
            : earlier && !state_of(n).empty() && !state_of(m).empty() && state_of(n) != state_of(m))
      return &n;
  }
  return nullptr;
}

/// Returns the key of the measurement that contradicts what is stated of its axis, or "". A table
/// is not contradicted if it was not active in the earlier state.
std::string contradiction(const Campaign& campaign, const Measurement& m, bool none) {
  if (m.compensation == "off") return {};
  if (none && m.compensation == "on") return "compensation = \"on\"";
  const Measurement* const earlier = earlier_line(campaign, m);
  if (!none && (earlier == nullptr || earlier->compensation == "off")) return {};
  if (!m.adjustment.empty()) return m.adjustment == "after" ? "adjustment = \"after\"" : "";
  return earlier == nullptr ? "" : "state = \"" + state_of(m) + "\"";
}

}  // namespace

bool states_active(const ControllerInput& input, const std::string& axis,
                   const std::string& measurement, bool backlash_in_options, OutputResult& result) {
  const Active active = active_of(input, axis, measurement, backlash_in_options);
  const Axis* a = input.campaign.machine.axis(axis);
  if (active.table && active.backlash) {
    const Measurement* m = measurement_of(input, measurement);
    const bool none =
        active.table->empty() && (a == nullptr || a->active_backlash.value_or(0.0) == 0.0);
    const std::string stated =
        m == nullptr ? std::string() : contradiction(input.campaign, *m, none);
    if (stated.empty()) return true;
    // A table from it would replace the one that was loaded meanwhile.
    result.findings.push_back(
        {"table.active-contradicted",
         false,
         {},
         {{"axis", axis}, {"measurement", measurement}, {"stated", stated}},
         measurement,
         "If no table and no backlash value was active, state compensation = \"off\" in this "
         "[[measurement]]. Otherwise state what was active, in a campaign of its own."});
    return false;
  }
  const std::string backlash =
      a != nullptr && a->rotary ? "active_backlash_deg" : "active_backlash_mm";
  const std::string missing = active.table      ? backlash
                              : active.backlash ? "active_table"
                                                : "active_table, " + backlash;
  result.findings.push_back({"table.active-not-stated",
                             true,
                             {},
                             {{"axis", axis}, {"missing", missing}},
                             measurement,
                             "State " + missing + " in [machine.axes." + axis +
                                 "]: what was active while the axis was measured, or \"none\"."});
  return false;
}

Remark not_in_format(const std::string& output, const std::string& measurement) {
  return {"table.not-in-format", {}, {{"output", output}, {"measurements", measurement}}};
}

Remark remark(const AxisJob& job, std::string id) {
  return {std::move(id), {}, {{"axis", job.axis}, {"unit", std::string(job.unit())}}};
}

bool AxisJob::one_value_helps() const {
  if (!curve.bidirectional() || reversal.kind == math::Reversal::Kind::not_constant) return false;
  const double mean = curve.mean_reversal();
  double largest = 0.0, left = 0.0;
  for (std::size_t i = 0; i < curve.plus.size(); ++i) {
    const double B = curve.plus[i] - curve.minus[i];
    largest = std::max(largest, std::fabs(B));
    left = std::max(left, std::fabs(B - mean));
  }
  return left < largest;
}

std::optional<double> AxisJob::setting(std::string_view name) const {
  const auto it = settings.find(name);
  return it == settings.end() ? std::nullopt : std::optional(it->second);
}

std::optional<double> AxisJob::position_setting(std::string_view name) const {
  const auto value = setting(std::string(name) + (rotary ? "_deg" : "_mm"));
  return value ? std::optional(*value / per_si()) : std::nullopt;
}

Expected<std::vector<AxisJob>> axis_jobs(const ControllerInput& input,
                                         const std::vector<std::string_view>& keys,
                                         OutputResult& result) {
  NONIO_TRY(auto settings, settings_of_axes(input.options, keys));
  if (auto known = check_names(settings, input); !known)
    return tl::unexpected<Error>(known.error());
  std::vector<AxisJob> all, jobs;
  const auto& measurements = input.campaign.measurements;
  const std::set<std::string> unsided = unsided_axes(input.campaign);
  for (std::size_t i = 0; i < std::min(measurements.size(), input.observations.size()); ++i)
    if (measurements[i].kind == "axis" && input.observations[i].size() > 0 &&
        !unsided.contains(measurements[i].axis))
      all.push_back(job_of(input, i));
  for (const std::string& axis : unsided)
    result.findings.push_back({"table.gantry-sides",
                               true,
                               {},
                               {{"axis", axis}},
                               {},
                               "State the side of each line: side = \"master\" or \"slave\" "
                               "in [[measurement]], and slave in [machine.axes." +
                                   axis + "]."});
  for (AxisJob& job : series_jobs(input)) all.push_back(std::move(job));
  for (AxisJob& job : all) {
    if (job.curve.position.size() < 2) {
      result.findings.push_back(
          {"table.too-few-targets",
           true,
           {{"targets", static_cast<double>(job.curve.position.size()), Quantity::count}},
           {{"axis", job.axis}},
           job.measurement,
           "A table needs two targets, each from every direction measured."});
      continue;
    }
    job.stem = file_part(job.axis);
    if (const auto it = settings.find(job.axis); it != settings.end()) job.settings = it->second;
    if (const Measurement* m = measurement_of(input, job.measurement);
        m != nullptr && m->compensation == "off")
      job.settings[job.rotary ? "backlash_deg" : "backlash_mm"] = 0.0;
    if (const auto n = job.setting("number");
        n && std::find(keys.begin(), keys.end(), "number:") != keys.end()) {
      if (!(*n >= 1.0 && *n <= 99.0 && *n == std::floor(*n)))
        return wrong_axes(
            "option axes, axis " + job.axis + ": number must be a whole number from 1 to 99",
            job.axis + ".number");
      job.number = static_cast<std::size_t>(*n);
    }
    if (!job.drift.empty() && !job.takes_drift()) {
      refuse_drift(job, result);
      continue;
    }
    if (job.unresolved) {
      refuse_unresolved(job.axis, job.measurement, job.rotary, *job.unresolved, result);
      continue;
    }
    if (number_unsaid(job, keys)) {
      refuse_number(job.axis, job.measurement, input, result);
      continue;
    }
    if (!states_active(input, job.axis, job.measurement,
                       job.position_setting("backlash").has_value(), result))
      continue;
    job.had_table = !active_of(input, job.axis, job.measurement, true).table.value_or("").empty();
    job.about = about(input, job);
    say_what_was_left_out(job, result);
    jobs.push_back(std::move(job));
  }
  if (auto named = name_files(jobs, result); !named) return tl::unexpected<Error>(named.error());
  return jobs;
}

Option axes_option(std::string keys) {
  return {"axes", NumberTables{}, "",
          "A table for each axis, such as X.step_mm = 50; there are " + std::move(keys) + "."};
}

std::vector<Option> step_options() {
  return {
      at_least(0.0, {"step_mm", 0.0, "mm", "Distance of the points on linear axes; 0: chosen."}),
      at_least(0.0, {"step_deg", 0.0, "deg", "Distance of the points on rotary axes; 0: chosen."})};
}

double wished_step(const AxisJob& job, const Settings& options) {
  if (const auto step = job.position_setting("step")) return *step;
  return options.number(job.rotary ? "step_deg" : "step_mm") / job.per_si();
}

double reference_position(const AxisJob& job, double first, double last) {
  return job.position_setting("reference").value_or(std::clamp(0.0, first, last));
}

std::string with_unit(const AxisJob& job, double si, int decimals) {
  return decimal(si * job.per_si(), decimals) + " " + std::string(job.unit());
}

std::string deviation_words(const AxisJob& job, double si) {
  const Unit unit = unit_of(deviation_of(job.rotary));
  return decimal(si * unit.per_si, 3) + " " + std::string(unit.symbol);
}

}  // namespace nonio::controllers
