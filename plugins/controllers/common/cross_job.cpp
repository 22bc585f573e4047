// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/cross_job.h"

#include <algorithm>
#include <cmath>

#include "nonio/controllers/kit.h"
#include "nonio/controllers/size.h"
#include "nonio/math/loaded_table.h"

namespace nonio::controllers {

namespace {

/// Straightness and what of squareness belongs to it: error of `output` over `input` is the series
/// plus `sign` times the value times the way. C0Y turns +Y towards -X, B0Z turns +Z towards +X, A0Z
/// turns +Z towards -Y (ISO 230-1).
struct Part {
  const char *series, *squareness;
  double sign;
};
constexpr std::array<Part, 6> parts{{{"EYX", nullptr, 0.0},
                                     {"EZX", nullptr, 0.0},
                                     {"EXY", "C0Y", -1.0},
                                     {"EZY", nullptr, 0.0},
                                     {"EXZ", "B0Z", 1.0},
                                     {"EYZ", "A0Z", -1.0}}};

const Series* series_of(const Evaluation& e, std::string_view name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

const Value* value_of(const Evaluation& e, std::string_view name) {
  for (const Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}

double range(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  return *high - *low;
}

/// The curve of one part towards `output`; nothing where a number of it is not known.
std::optional<CrossCurve> curve_of(const Evaluation& e, const Part& part,
                                   const std::string& output) {
  const Series* s = series_of(e, part.series);
  const Value* square = part.squareness == nullptr ? nullptr : value_of(e, part.squareness);
  if (s == nullptr || s->position.size() < 2 || (part.squareness != nullptr && square == nullptr))
    return std::nullopt;
  CrossCurve curve{s->over, output, s->position, s->value};
  for (std::size_t i = 0; square != nullptr && i < curve.value.size(); ++i)
    curve.value[i] += part.sign * square->value * (s->position[i] - s->position.front());
  return curve;
}

void make_zero(CrossCurve& curve, const NumberTables& settings) {
  curve.reference = std::clamp(0.0, curve.position.front(), curve.position.back());
  if (const auto axis = settings.find(curve.input); axis != settings.end())
    if (const auto said = axis->second.find("reference_mm"); said != axis->second.end()) {
      curve.reference = said->second / 1e3;
      curve.told = true;
    }
  const double zero = math::ErrorCurve::at(curve.position, curve.value, curve.reference);
  for (double& v : curve.value) v -= zero;
}

TableSize size_of_curve(const CrossCurve& curve) {
  TableSize size;
  size.take(curve.position, curve.value);
  return size;
}

/// Settings of option `axes`; one that is malformed is said where the axes themselves are read.
NumberTables known_settings(const ControllerInput& in) {
  return settings_of_axes(in.options).value_or(NumberTables{});
}

/// Both diagonals as read, at the stops of the curves.
std::optional<CrossJob> of_diagonals(const Results::Analysed& a) {
  const Evaluation& e = a.evaluation;
  const Series *f = series_of(e, "EYX"), *g = series_of(e, "EXY");
  const auto *D1 = e.points.column("D1"), *D2 = e.points.column("D2");
  if (f == nullptr || g == nullptr || D1 == nullptr || D2 == nullptr) return std::nullopt;
  const auto along_x = curve_of(e, parts[0], g->over), along_y = curve_of(e, parts[2], f->over);
  if (!along_x || !along_y) return std::nullopt;
  CrossJob job{a.measurement, e.uses, {*along_x, *along_y}, {}};
  const auto &x = f->position, &y = g->position;
  const double Lx = x.back() - x.front(), Ly = y.back() - y.front(), L = std::hypot(Lx, Ly);
  for (const bool rising : {true, false}) {
    ReadLine line{rising ? "D1" : "D2",
                  {{f->over, Lx / L}, {g->over, (rising ? Ly : -Ly) / L}},
                  {},
                  (rising ? D1 : D2)->values};
    for (std::size_t i = 0; i < x.size(); ++i)
      line.at.push_back({{f->over, x[i]}, {g->over, y[rising ? i : y.size() - 1 - i]}});
    job.lines.push_back(std::move(line));
  }
  return job;
}

/// The body diagonals as read where all axes have moved as far: what a mirror that stands askew
/// adds to single moves is not in these.
std::vector<ReadLine> body_diagonals(const Measurement& m, const Observations& o) {
  constexpr double same_part = 1e-6;
  std::vector<ReadLine> lines;
  for (const Observations::Line& of : o.lines) {
    ReadLine line{of.name.substr(std::min(m.id.size() + 1, of.name.size())), {}, {{}}, {0.0}};
    for (std::size_t k = 0; k < o.axes.size(); ++k) {
      const auto from = m.from.find(o.axes[k].axis), to = m.to.find(o.axes[k].axis);
      if (k > 2 || from == m.from.end() || to == m.to.end()) return {};
      line.sense[from->first] = of.sense[k];
      const auto [low, high] = std::minmax(from->second, to->second);
      line.at.front()[from->first] = of.sense[k] > 0.0 ? low : high;
    }
    lines.push_back(std::move(line));
  }
  for (std::size_t i = 0; i < o.size(); ++i) {
    ReadLine& line = lines[o.line.empty() ? 0 : o.line[i]];
    std::map<std::string, double> at;
    std::vector<double> gone;
    for (const auto& axis : o.axes) {
      at[axis.axis] = axis.position[i];
      gone.push_back((axis.position[i] - line.at.front()[axis.axis]) /
                     (m.to.at(axis.axis) - m.from.at(axis.axis)));
    }
    const auto [least, most] = std::minmax_element(
        gone.begin(), gone.end(), [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    if (std::fabs(*most) - std::fabs(*least) > same_part) continue;
    line.at.push_back(std::move(at));
    line.deviation.push_back(o.deviation[i]);
  }
  return lines;
}

std::optional<CrossJob> of_volume(const ControllerInput& in, const Results::Analysed& a,
                                  std::size_t index) {
  const Evaluation& e = a.evaluation;
  const Observations& o = in.observations[index];
  if (o.axes.size() != 3) return std::nullopt;
  CrossJob job{a.measurement, e.uses, {}, {}, true};
  for (const Part& part : parts)
    if (auto curve = curve_of(e, part, o.axes[static_cast<std::size_t>(part.series[1] - 'X')].axis))
      job.curves.push_back(std::move(*curve));
  if (job.curves.empty()) return std::nullopt;
  job.lines = body_diagonals(in.campaign.measurements[index], o);
  return job;
}

}  // namespace

std::vector<std::string> CrossJob::moving() const {
  std::vector<std::string> names;
  for (const CrossCurve& c : curves) names.insert(names.end(), {c.input, c.output});
  return names;
}

std::string CrossJob::axes() const {
  std::vector<std::string> names;
  for (const CrossCurve& c : curves)
    for (const std::string& name : {c.input, c.output})
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  std::sort(names.begin(), names.end());
  std::string out;
  for (const std::string& name : names) out += name;
  return out;
}

std::vector<CrossJob> cross_jobs(const ControllerInput& in) {
  std::vector<CrossJob> jobs;
  const auto settings = known_settings(in);
  const auto& measurements = in.campaign.measurements;
  for (const Results::Analysed& a : in.results.analyses) {
    const auto of = std::find_if(measurements.begin(), measurements.end(),
                                 [&](const Measurement& m) { return m.id == a.measurement; });
    const auto index = static_cast<std::size_t>(of - measurements.begin());
    const bool volume =
        of != measurements.end() && of->kind == "step-diagonal" && index < in.observations.size();
    if (auto job = volume ? of_volume(in, a, index) : of_diagonals(a)) {
      for (CrossCurve& curve : job->curves) make_zero(curve, settings);
      jobs.push_back(std::move(*job));
    }
  }
  return jobs;
}

bool oversized(const CrossJob& job, const ControllerInput& in, OutputResult& result) {
  const auto settings = known_settings(in);
  bool beyond = false;
  for (const CrossCurve& curve : job.curves) {
    const auto axis = settings.find(curve.output);
    if (axis == settings.end()) continue;
    const TableSize size = size_of_curve(curve);
    const auto hold = [&](const char* key, Quantity q, double found, double at) {
      const auto said = axis->second.find(key);
      if (said == axis->second.end()) return;
      const double limit = said->second / unit_of(q).per_si;
      if (found <= limit * (1.0 + 1e-9)) return;
      beyond = true;
      result.findings.push_back(
          {"table.refused-cross",
           true,
           {{"found", found, q}, {"limit", limit, q}, {"at", at, Quantity::length}},
           {{"axis", curve.output}, {"input", curve.input}, {"key", key}},
           job.measurement,
           "The machine's maker allows no more (" + std::string(key) +
               "): the axis must be mended or adjusted before a table can take the rest."});
    };
    hold("largest_um", Quantity::deviation, size.largest, size.largest_at);
    hold("slope_um_per_m", Quantity::deviation_per_length, size.slope, size.slope_from);
  }
  return beyond;
}

std::string cross_words(const CrossCurve& curve) {
  const TableSize size = size_of_curve(curve);
  return plain(curve.output) + " over " + plain(curve.input) + ": zero at " +
         decimal(curve.reference * 1e3, 4) + " mm of " + plain(curve.input) +
         (curve.told ? "" : ", taken as reference point") + "; largest entry " +
         decimal(size.largest * 1e6, 3) + " um at " + decimal(size.largest_at * 1e3, 4) +
         " mm, steepest " + decimal(size.slope * 1e6, 3) + " um/m";
}

void note_cross(const CrossJob& job, OutputResult& result) {
  for (const CrossCurve& curve : job.curves) {
    const TableSize size = size_of_curve(curve);
    result.notes.push_back({curve.told ? "table.cross-zero-at" : "table.cross-zero-taken",
                            {{"reference", curve.reference, Quantity::length},
                             {"largest", size.largest, Quantity::deviation},
                             {"slope", size.slope, Quantity::deviation_per_length}},
                            {{"axis", curve.output}, {"input", curve.input}}});
  }
}

bool together(const CrossJob& set, const AxisJob& job, const Campaign& campaign) {
  if (set.measurement == job.measurement) return true;
  bool names_one = false;
  for (const std::string& id : set.uses) {
    if (id == job.measurement) return true;
    for (const Measurement& m : campaign.measurements)
      names_one = names_one || (m.id == id && m.kind == "axis" && m.axis == job.axis);
  }
  return !set.volume && !names_one;  // step diagonals use runs of their own occasion only
}

Expected<void> fits(const CrossJob& job, const Settings& options) {
  const auto most = static_cast<std::size_t>(options.integer("max_points", 1000000));
  for (const CrossCurve& curve : job.curves)
    if (curve.position.size() > most)
      return fail("diagonals of " + job.measurement + ": " + std::to_string(curve.position.size()) +
                  " points, the control takes " + std::to_string(most) + " (max_points)");
  return {};
}

void predict_lines(const CrossJob& job, const std::vector<LoadedTable>& tables,
                   OutputResult& result) {
  const auto after = [&](const ReadLine& line) {
    std::map<std::string, int> direction;
    for (const auto& [axis, sense] : line.sense) direction[axis] = sense < 0.0 ? -1 : 1;
    std::vector<double> out;
    for (std::size_t i = 0; i < line.deviation.size(); ++i) {
      double v = line.deviation[i];
      for (const auto& [axis, sense] : line.sense)
        v += sense * math::added(tables, axis, line.at[i], direction);
      out.push_back(v);
    }
    return range(out);
  };
  std::vector<Prediction> all;  // several runs of a line: the worst of them
  for (const ReadLine& line : job.lines) {
    if (line.deviation.size() < 2) continue;  // nothing of it was read at whole steps
    const std::string name = line.name.substr(0, line.name.find(' '));
    const Prediction one{job.measurement, name, range(line.deviation), after(line),
                         Quantity::deviation};
    const auto known =
        std::find_if(all.begin(), all.end(), [&](const Prediction& p) { return p.name == name; });
    if (known == all.end()) {
      all.push_back(one);
    } else {
      known->before = std::max(known->before, one.before);
      known->after = std::max(known->after, one.after);
    }
  }
  for (Prediction& p : all) {
    if (!(p.after < p.before))
      result.findings.push_back({.id = "table.no-gain",
                                 .attention = true,
                                 .evidence = {{"before", p.before, Quantity::deviation},
                                              {"after", p.after, Quantity::deviation}},
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
  if (job.volume)
    for (const AxisJob& of : pitch)
      if (of.loaded && together(job, of, input.campaign))
        tables->insert(tables->end(), of.loaded->begin(), of.loaded->end());
  predict_lines(job, *tables, result);
  note_cross(job, result);
  return {};
}

}  // namespace nonio::controllers
