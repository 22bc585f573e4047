// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "axis_job.h"
#include "consumer.h"
#include "cross_job.h"
#include "nonio/sdk/plugin.h"

namespace nonio {
namespace {

using controllers::AxisJob;
using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::signed_decimal;

enum class Layout { tnc407, itnc530, tnc640 };

struct Choices {
  Layout layout;
  bool directions;
  std::size_t max_points;
  bool listed() const { return layout == Layout::tnc640; }
};

// One row of a table before it is text. mm or deg.
struct Row {
  double position, value;
  std::optional<double> negative;
  std::vector<double> cross{};  ///< of other axes
};
using Crosses = std::vector<const CrossCurve*>;

// Columns as the table editor has them: a cell starts where its heading starts.
struct Columns {
  std::size_t position, negative, first_axis, width;
};
constexpr Columns equidistant_columns{8, 0, 20, 11};
constexpr Columns listed_columns{5, 19, 33, 14};

void put(std::string& line, std::size_t column, const std::string& text) {
  if (line.size() < column) line.resize(column, ' ');
  line += text;
}

std::string com_name(const AxisJob& job, const Choices& choices) {
  return (choices.listed() ? "AXIS_" : "AXIS-") + job.stem + ".COM";
}

std::vector<std::string> axis_columns(const Campaign& campaign, const AxisJob& job) {
  std::vector<std::string> names;
  for (const Axis& a : campaign.machine.axes) names.push_back(controllers::plain(a.name));
  if (campaign.machine.axis(job.axis) == nullptr) names.push_back(controllers::plain(job.axis));
  return names;
}

// The .COM text; it takes no comments, the words are in the file beside it.
std::string com_table(const AxisJob& job, const std::vector<Row>& rows,
                      const std::vector<std::string>& axes, const Crosses& crosses,
                      const Choices& choices) {
  const Columns& c = choices.listed() ? listed_columns : equidistant_columns;
  std::string out = "BEGIN " + com_name(job, choices);
  out += choices.listed()
             ? " MM\n"
             : "  DATUM:" + signed_decimal(rows[0].position, 4) +
                   " DISTANCE:" + signed_decimal(rows[1].position - rows[0].position, 4) + "\n";
  std::string head = "NR";
  if (choices.listed()) {
    put(head, c.position, "AXISPOS");
    put(head, c.negative, "BACKLASH");
  }
  const auto column = [&](const std::string& axis) {
    const auto at = std::find(axes.begin(), axes.end(), controllers::plain(axis));
    return c.first_axis + c.width * static_cast<std::size_t>(at - axes.begin());
  };
  for (const std::string& axis : axes) put(head, column(axis), axis);
  out += head + "\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::string line = std::to_string(i);
    put(line, c.position, signed_decimal(rows[i].position, 4));
    if (rows[i].negative) put(line, c.negative, signed_decimal(*rows[i].negative, 4));
    std::map<std::size_t, double> cells{{column(job.axis), rows[i].value}};
    for (std::size_t k = 0; k < crosses.size(); ++k)
      cells[column(crosses[k]->output)] = rows[i].cross[k];
    for (const auto& [at, value] : cells) put(line, at, signed_decimal(value, 4));
    out += line + "\n";
  }
  return choices.listed() ? out + "[END]\n" : out;
}

bool unfit_for_columns(const std::vector<std::string>& axes) {
  for (const std::string& a : axes)
    if (a.empty() || a.size() > 9 || a.find(' ') != std::string::npos) return true;
  return false;
}

/// Where the rows of a table are wanted: at the targets, and where other axes have their points.
std::vector<double> wanted(const AxisJob& job, const Crosses& crosses, const Choices& choices) {
  std::vector<double> at = job.table_curve().position;
  if (crosses.empty()) return at;
  if (!choices.listed()) return crosses.front()->position;  // these are evenly spaced
  for (const CrossCurve* cross : crosses)
    at.insert(at.end(), cross->position.begin(), cross->position.end());
  std::sort(at.begin(), at.end());
  return at;
}

Expected<std::vector<double>> positions(const AxisJob& job, const OutputInput& input,
                                        const Crosses& crosses, const Choices& choices) {
  const double step = controllers::wished_step(job, input.options);
  const auto measured = wanted(job, crosses, choices);
  if (choices.listed() && step == 0.0) {
    // Targets that the 4 decimals do not tell apart are one row.
    std::vector<double> rows;
    for (const double x : measured)
      if (rows.empty() ||
          signed_decimal(x * job.per_si(), 4) != signed_decimal(rows.back() * job.per_si(), 4))
        rows.push_back(x);
    if (rows.size() <= choices.max_points) return rows;
  }
  math::GridRule rule;
  rule.unit = 1e-4 / job.per_si();
  rule.most = choices.max_points;
  rule.step = step;
  rule.rotary = job.rotary;
  rule.axis = job.axis;
  rule.turn = job.turn.has_value();
  if (!rule.turn) rule.first = job.position_setting("first");
  // A turn has no such step; the manual says nothing more of rotary axes than 0..360.
  rule.power_of_two = choices.layout == Layout::tnc407 && !rule.turn;
  const auto grid = math::choose_grid(measured, rule);
  if (!grid) return tl::unexpected<Error>(grid.error());
  std::vector<double> out;
  for (std::size_t i = 0; i < grid->points; ++i) out.push_back(grid->position(i));
  return out;
}

std::vector<Row> rows_of(const AxisJob& job, const std::vector<double>& at, bool directions,
                         const Crosses& crosses) {
  const auto& curve = job.table_curve();
  const auto reference = job.position_setting("reference");
  const double zero =
      reference ? math::ErrorCurve::at(curve.position, curve.mean, *reference) : 0.0;
  const auto entry = [&](const std::vector<double>& values, double x) {
    return (math::ErrorCurve::at(curve.position, values, x) - zero) * job.per_si();
  };
  std::vector<Row> rows;
  for (const double x : at) {
    rows.push_back({x * job.per_si(), entry(directions ? curve.plus : curve.mean, x),
                    directions ? std::optional(entry(curve.minus, x)) : std::nullopt});
    for (const CrossCurve* cross : crosses)
      rows.back().cross.push_back(math::ErrorCurve::at(cross->position, cross->value, x) *
                                  job.per_si());
  }
  return rows;
}

std::string words(const AxisJob& job, const Choices& choices, bool directions,
                  const std::string& artifact, const std::vector<std::string>& warning) {
  std::string out;
  const auto line = [&](const std::string& text) { out += text + "\n"; };
  for (const std::string& w : warning) line(w);
  for (const std::string& w : job.about) line(w);
  line("file " + artifact + ": store it on the control as " + com_name(job, choices));
  line("sign: entries are the measured deviation (actual - nominal) with its own sign, in " +
       std::string(job.unit()));
  line(controllers::reversal_words(job, directions));
  if (job.curve.bidirectional()) {
    const double value = (directions ? job.present_backlash() : job.backlash()) * job.per_si();
    line(choices.listed()
             ? "CfgAxisComp/backLash (401802), positive where the encoder leads the table:"
             : "backlash machine parameter of the axis (MP710 or MP750), positive where the "
               "encoder leads the table:");
    line("backLash = " + signed_decimal(value, 4));
  }
  line("MP730 or the configuration must allow non-linear compensation for this axis");
  return out;
}

Expected<void> write_axis(AxisJob& job, const OutputInput& input, const Crosses& crosses,
                          const Choices& choices, OutputResult& result) {
  const bool directions = choices.directions && job.curve.bidirectional();
  if (controllers::refused(job, directions, result)) return {};
  const auto axes = axis_columns(input.campaign, job);
  if (unfit_for_columns(axes))
    return fail("axis " + job.axis +
                ": the table has columns for axis names of 1 to 9 characters without blanks");
  const auto at = positions(job, input, crosses, choices);
  if (!at) return tl::unexpected<Error>(at.error());
  const std::string stem = "heidenhain-tnc-" + job.stem;
  const auto warning = controllers::warnings(job, result);
  Artifact com{stem + ".COM",
               com_table(job, rows_of(job, *at, directions, crosses), axes, crosses, choices)};
  Artifact text{stem + ".txt", words(job, choices, directions, com.name, warning)};

  heidenhain::Machine control{controllers::plain(job.axis), job.rotary, choices.max_points,
                              job.present_backlash() * job.per_si()};
  if (job.curve.bidirectional()) {
    const auto backlash = heidenhain::backlash_entered(text.bytes);
    if (!backlash) return tl::unexpected<Error>(backlash.error());
    control.backlash = *backlash;
    if (!directions) controllers::doubt_backlash(job, result);
  }
  const auto correction = heidenhain::load(com.bytes, control);
  if (!correction)
    return fail("axis " + job.axis +
                ": the table written cannot be read back: " + correction.error().message);
  controllers::predict(job, *correction, result);
  job.loaded = *correction;
  result.artifacts.push_back(std::move(com));
  result.artifacts.push_back(std::move(text));
  return {};
}

// One line for each combination; where an axis has two tables, nothing is made active.
std::string cma_table(const std::vector<const AxisJob*>& written,
                      const std::vector<std::string>& axes, const Choices& choices) {
  Columns c = choices.listed() ? Columns{0, 5, 14, 16} : Columns{0, 0, 8, 16};
  for (const AxisJob* job : written)
    c.width = std::max(c.width, com_name(*job, choices).size() + 2);
  std::map<std::string, std::vector<std::string>> tables;
  std::size_t lines = 1;
  for (const AxisJob* job : written) {
    auto& of_axis = tables[controllers::plain(job->axis)];
    of_axis.push_back(com_name(*job, choices));
    lines = std::max(lines, of_axis.size());
  }
  std::string out = std::string("BEGIN CONFIG.CMA") + (choices.listed() ? " MM" : "") + "\n";
  std::string head = "NR";
  if (choices.listed()) put(head, c.negative, "ACTIVE");
  for (std::size_t k = 0; k < axes.size(); ++k) put(head, c.first_axis + c.width * k, axes[k]);
  out += head + "\n";
  for (std::size_t i = 0; i < lines; ++i) {
    std::string line = std::to_string(i);
    if (choices.listed() && lines == 1) put(line, c.negative, "*");
    for (std::size_t k = 0; k < axes.size(); ++k)
      if (const auto it = tables.find(axes[k]); it != tables.end())
        put(line, c.first_axis + c.width * k, it->second[std::min(i, it->second.size() - 1)]);
    out += line + "\n";
  }
  return choices.listed() ? out + "[END]\n" : out;
}

/// The columns that belong into the table of this axis, if one state of the machine alone has them.
Crosses columns_of(const std::vector<CrossJob>& sets, const AxisJob& job,
                   const OutputInput& input) {
  Crosses columns;
  std::size_t states = 0;
  for (const CrossJob& set : sets) {
    if (!controllers::together(set, job, input.campaign)) continue;
    ++states;
    for (const CrossCurve& curve : set.curves)
      if (curve.input == job.axis) columns.push_back(&curve);
  }
  return states == 1 ? columns : Crosses{};
}

/// What the control makes of the columns of other axes, read from the tables of each.
void predict_cross(const CrossJob& set, const std::vector<const AxisJob*>& written,
                   const OutputInput& input, const Choices& choices, OutputResult& result) {
  controllers::Corrections corrections;
  for (const AxisJob* job : written) {
    if (!controllers::together(set, *job, input.campaign)) continue;
    const auto com = std::find_if(
        result.artifacts.begin(), result.artifacts.end(),
        [&](const Artifact& a) { return a.name == "heidenhain-tnc-" + job->stem + ".COM"; });
    for (const CrossCurve& curve : set.curves) {
      if (job->axis != curve.input) continue;
      auto read = heidenhain::load(
          com->bytes, {controllers::plain(curve.output), false, choices.max_points, 0.0});
      if (read) corrections[{curve.input, curve.output}] = std::move(*read);
    }
    if (set.volume) corrections[{job->axis, job->axis}] = *job->loaded;
  }
  // A table that was refused takes its columns with it; its finding says why.
  for (const CrossCurve& curve : set.curves)
    if (corrections.count({curve.input, curve.output}) == 0) return;
  controllers::predict_lines(set, corrections, result);
  const char* note = set.volume ? "heidenhain.cross-volume" : "heidenhain.cross";
  if (std::none_of(result.notes.begin(), result.notes.end(),
                   [&](const Remark& r) { return r.id == note; }))
    result.notes.push_back({note});
}

void notes(const Choices& choices, OutputResult& result) {
  result.notes.push_back({"heidenhain.form-inferred"});
  if (choices.directions) result.notes.push_back({"heidenhain.negative-inferred"});
  if (!choices.listed()) result.notes.push_back({"heidenhain.cma-inferred"});
}

Expected<Choices> choices_of(const Settings& o) {
  Choices c{};
  const std::string layout = o.text("layout", "tnc640");
  c.layout = layout == "tnc407"    ? Layout::tnc407
             : layout == "itnc530" ? Layout::itnc530
                                   : Layout::tnc640;
  c.directions = o.flag("directions");
  c.max_points = static_cast<std::size_t>(o.integer("max_points", 256));
  if (c.directions && !c.listed())
    return fail("layout " + layout +
                " has no column for the negative direction: set layout = \"tnc640\" or "
                "directions = false");
  return c;
}

Expected<OutputResult> write(const OutputInput& input) {
  OutputResult result;
  const auto choices = choices_of(input.options);
  if (!choices) return tl::unexpected<Error>(choices.error());
  auto jobs = controllers::axis_jobs(input, {"step", "first", "reference", "backlash"}, result);
  if (!jobs) return tl::unexpected<Error>(jobs.error());
  // The columns of other axes are for one state of the machine, and have no direction.
  const auto sets = choices->directions ? std::vector<CrossJob>{} : controllers::cross_jobs(input);
  std::vector<const AxisJob*> written;
  for (AxisJob& job : *jobs) {
    const std::size_t files = result.artifacts.size();
    if (auto done = write_axis(job, input, columns_of(sets, job, input), *choices, result); !done)
      return tl::unexpected<Error>(done.error());
    if (result.artifacts.size() > files) written.push_back(&job);
  }
  if (written.empty()) return result;
  for (const CrossJob& set : sets) predict_cross(set, written, input, *choices, result);
  result.artifacts.push_back(
      {"heidenhain-tnc-CONFIG.CMA",
       cma_table(written, axis_columns(input.campaign, *written.front()), *choices)});
  notes(*choices, result);
  return result;
}

std::vector<Option> options() {
  std::vector<Option> list = controllers::step_options();
  list.push_back({"layout",
                  std::string("tnc640"),
                  "",
                  "Listed positions (tnc640), equidistant (itnc530), or that with a spacing of a "
                  "power of two of 0.1 um (tnc407).",
                  {"tnc640", "itnc530", "tnc407"}});
  list.push_back(
      {"directions", false, "", "The negative direction in column BACKLASH (layout tnc640)."});
  list.push_back(
      {"max_points", std::int64_t{256}, "", "Rows of one .COM table.", {}, 2.0, 10000.0});
  list.push_back(controllers::axes_option(
      "step_mm, first_mm, reference_mm (where the table is made zero; else nowhere), backlash_mm "
      "(the parameter while measured), and the same with _deg"));
  return list;
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {"heidenhain-tnc", "1.0.0",
                 "Non-linear axis error tables (.COM, .CMA) and backlash for HEIDENHAIN TNC.",
                 nonio::options()};
  output.stage = nonio::Output::Stage::table;
  output.applies = nonio::controllers::has_tables;
  output.write = nonio::write;
  registry.add(std::move(output));
}
