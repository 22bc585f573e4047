// SPDX-License-Identifier: Apache-2.0
#include "live/calculation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "campaign/evaluation/evaluation.h"
#include "campaign/modelling/model_change.h"
#include "campaign/modelling/model_fit.h"
#include "campaign/modelling/model_json.h"
#include "campaign/reading/names.h"
#include "live/columns.h"
#include "live/difference.h"
#include "nonio/reports/residuals.h"
#include "nonio/reports/wording.h"
#include "nonio/workbench/data.h"
#include "platform/process/keep_apart.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/serialise.h"

namespace nonio::live {
using modelling::PartModel;

namespace {

using storage::Json;

std::vector<std::string> model_in(const Json& request) {
  return request.at("model").get<std::vector<std::string>>();
}

/// Converts excluded rows to lines of the file. An error if a line contains other readings too,
/// because campaign.toml excludes whole lines, or if the reader states no lines.
Expected<modelling::Exclusion> exclusion_of(const Bench& bench, const Json& one) {
  modelling::Exclusion out{
      one.at("measurement").get<std::string>(), {}, one.at("why").get<std::string>()};
  const auto& all = bench.campaign().measurements;
  const auto m = std::find_if(all.begin(), all.end(),
                              [&](const Measurement& x) { return x.id == out.measurement; });
  if (m == all.end()) return fail("there is no measurement \"" + out.measurement + "\"");
  const Observations& o = bench.read.observations.at(static_cast<std::size_t>(m - all.begin()));
  const auto rows = one.at("rows").get<std::set<std::size_t>>();
  std::set<std::uint32_t> lines;
  for (const std::size_t row : rows) {
    if (row >= o.size() || row >= o.source_line.size() || o.source_line[row] == 0)
      return fail("the reader of " + m->file +
                  " does not state the line of a reading, so it cannot be excluded there");
    lines.insert(o.source_line[row]);
  }
  for (std::size_t row = 0; row < o.size(); ++row)
    if (lines.contains(o.source_line[row]) && !rows.contains(row))
      return fail("line " + std::to_string(o.source_line[row]) + " of " + m->file +
                  " holds other readings too, and campaign.toml excludes whole lines: leave them "
                  "all out, or none");
  out.lines.assign(lines.begin(), lines.end());
  return out;
}

Expected<modelling::CampaignEdit> edit_of(const Bench& bench, const Json& request) {
  modelling::CampaignEdit edit{
      .model = modelling::edits_between(bench.campaign().model, model_in(request)),
      .why = request.value("why", "")};
  for (const Json& one : request.at("exclusions")) {
    NONIO_TRY(auto exclusion, exclusion_of(bench, one));
    edit.excluded.push_back(std::move(exclusion));
  }
  for (const auto& [axis, mm] : request.at("period_mm").items())
    edit.periods.push_back({axis, mm.get<double>()});
  return edit;
}

/// Writes model, exclusions and periods of the request to campaign.toml, like the commands of
/// `nonio model`. The answer contains the model, the new digest of the file and the lines added to
/// its history. An error if nothing differs.
Expected<std::string> save(Bench& bench, const Json& request) {
  NONIO_TRY(const auto edit, edit_of(bench, request));
  if (edit.empty()) return fail("campaign.toml has this model already; nothing was written");
  NONIO_TRY(const auto changes, modelling::change_campaign(bench.folder, bench.read, edit));
  Json steps = Json::array();
  for (const modelling::Change& change : changes)
    steps.push_back(storage::parse(modelling::history_line(change.step)));
  return storage::dump_line({{"model", bench.campaign().model},
                             {"manifest_sha256", bench.read.inputs.front().second},
                             {"steps", std::move(steps)}});
}

/// Returns the changes of `save` as `diff` in the unified format, and the model in campaign.toml or
/// its first error. `diff` is empty if the file has changed since it was read.
Expected<std::string> difference(Bench& bench, const Json& request) {
  NONIO_TRY(const auto text, storage::read_small_file(bench.folder / config::manifest_name));
  const std::string digest = storage::sha256(text);
  Json out = {{"manifest_sha256", digest},
              {"changed_on_disk", digest != bench.read.inputs.front().second},
              {"diff", ""}};
  if (const auto manifest = config::parse_manifest(text, config::manifest_name,
                                                   bench.place->context.plugins->methods()))
    out["on_disk"] = manifest->campaign.model;
  else
    out["on_disk_error"] = manifest.error().front().message;
  if (digest != bench.read.inputs.front().second) return storage::dump_line(out);
  NONIO_TRY(const auto edit, edit_of(bench, request));
  NONIO_TRY(const auto edited, modelling::edited_manifest(text, edit));
  out["diff"] = unified_difference(config::manifest_name, text, edited);
  return storage::dump_line(out);
}

/// Returns the file that a run would write with the tried model: "page" of model-html for one part,
/// or "report" of pdf-report.
Expected<std::string> document(Bench& bench, const Json& request) {
  const bool page = request.at("kind") == "page";
  const Output* of_role =
      bench.place->plugins.output_of(page ? Output::Role::model_page : Output::Role::report);
  if (of_role == nullptr) return fail("no output plugin writes this document");
  const std::string& output = of_role->info.name;
  config::Manifest& manifest = *bench.read.manifest;
  manifest.campaign.model = model_in(request);
  manifest.run.outputs = std::vector<std::string>{output};
  if (page) manifest.run.analyses = std::vector<std::string>{reading::model_fit_name};
  const std::string id = manifest.campaign.id;
  const reading::Stage quiet = [](const std::string&) {};
  const evaluation::Evaluated done = evaluation::write_documents(
      evaluation::analyse(std::move(bench.read), id, bench.place->context, quiet, {}), nullptr,
      bench.place->context, quiet);
  const std::string wanted = page ? request.at("part").get<std::string>() : "";
  for (const Results::Written& written : done.results.outputs) {
    if (written.plugin != output) continue;
    std::size_t k = 0;
    for (const Artifact& artifact : written.result.artifacts) {
      // A page of models has one file per fitted model, in the same order.
      if (!page || (k < done.results.models.size() && done.results.models[k].part == wanted))
        return artifact.bytes;
      ++k;
    }
  }
  if (!done.results.errors.empty()) return fail(done.results.errors.front());
  return fail(output + " wrote nothing of this campaign" +
              (page ? "; a page needs a model that could be fitted" : ""));
}

modelling::ModelWords words_of(const Bench& bench) {
  return {bench.place->context.templates, bench.language()};
}

std::string kind_of(const PartModel& part) {
  const std::string kind = modelling::kind_of(part.part);
  return kind == "axis" && part.part.axes.front().rotary ? "rotary" : kind;
}

Json axis_json(const Axis& axis) {
  Json one = {{"name", axis.name}, {"rotary", axis.rotary}};
  if (axis.travel) {
    const Quantity q = position_of(axis.rotary);
    storage::put(one, "from", axis.travel->first, q);
    storage::put(one, "to", axis.travel->second, q);
  }
  storage::put(one, "screw_pitch", axis.screw_pitch, Quantity::length);
  return one;
}

Json machine_json(const Machine& machine) {
  Json json = {{"maker", machine.maker},         {"model", machine.model},
               {"serial", machine.serial},       {"asset", machine.asset},
               {"structure", machine.structure}, {"axes", Json::array()}};
  for (const Axis& axis : machine.axes) json["axes"].push_back(axis_json(axis));
  return json;
}

/// Returns the end points of each measured line in the volume (mm), at its lowest and highest
/// position.
Json lines_in_space(const model::Part& part) {
  struct Ends {
    std::size_t low = 0, high = 0;
    bool any = false;
  };
  std::vector<Ends> ends(part.measurements.size());
  for (std::size_t i = 0; i < part.along.size(); ++i) {
    Ends& e = ends[part.measurement[i]];
    if (!e.any) e = {i, i, true};
    if (part.along[i] < part.along[e.low]) e.low = i;
    if (part.along[i] > part.along[e.high]) e.high = i;
  }
  const auto point = [&](std::size_t row) {
    Json at = Json::array();
    for (const char* axis : {"X", "Y", "Z"}) {
      const auto* column = part.table.axis(axis);
      const double x = column == nullptr ? 0.0 : column->position[row];
      at.push_back(std::isfinite(x) ? printed(x, Quantity::length) : 0.0);
    }
    return at;
  };
  Json lines = Json::array();
  for (std::size_t k = 0; k < ends.size(); ++k)
    if (ends[k].any)
      lines.push_back({{"id", part.measurements[k]},
                       {"from", point(ends[k].low)},
                       {"to", point(ends[k].high)}});
  return {{"lines", std::move(lines)}};
}

Json card_of(const modelling::ModelWords& words, const std::string& effect) {
  Json card = Json::object();
  for (const char* what : {"title", "is", "size", "appearance", "similar", "remedy"})
    if (std::string text = words.card(effect, what); !text.empty()) card[what] = std::move(text);
  return card;
}

void put_library(const PartModel& part, const modelling::ModelWords& words, Json& list) {
  if (part.library == nullptr) return;
  const Axis& axis = part.part.axes.front();
  for (const config::Cause& cause : *part.library) {
    if (cause.rotary != axis.rotary) continue;
    const std::string name = cause.formula.name + ":" + axis.name;
    list.push_back({{"effect", name},
                    {"written", name},
                    {"part", part.part.name},
                    {"card", card_of(words, name)},
                    {"compensable", cause.compensable},
                    {"why_not", nullptr},
                    {"library", true}});
  }
}

Json catalogue_json(const Bench& bench) {
  const modelling::ModelWords words = words_of(bench);
  Json list = Json::array();
  for (const PartModel& part : bench.parts) {
    for (const model::Term& term : part.catalogue)
      list.push_back({{"effect", term.name()},
                      {"written", model::written_for(part.part, term.name())},
                      {"part", part.part.name},
                      {"card", card_of(words, term.name())},
                      {"compensable", term.effect->compensable},
                      {"why_not", nullptr}});
    for (const model::Candidate& c : part.left_out)
      list.push_back(
          {{"effect", c.term.name()},
           {"written", model::written_for(part.part, c.term.name())},
           {"part", part.part.name},
           {"card", card_of(words, c.term.name())},
           {"compensable", c.term.effect->compensable},
           {"why_not", words.unseen(c, modelling::place_of(part, bench.campaign(), c.rows))}});
    put_library(part, words, list);
  }
  return list;
}

using Kept = std::vector<std::vector<std::uint32_t>>;

Expected<Kept> exclude(Bench& bench, const Json& request) {
  const auto& measurements = bench.campaign().measurements;
  Kept kept(measurements.size());
  std::map<std::size_t, std::vector<char>> masks;
  for (const Json& one : request.value("excluded", Json::array())) {
    const auto id = one.at("measurement").get<std::string>();
    const auto row = one.at("row").get<std::size_t>();
    const auto m = std::find_if(measurements.begin(), measurements.end(),
                                [&](const Measurement& x) { return x.id == id; });
    const auto at = static_cast<std::size_t>(m - measurements.begin());
    if (m == measurements.end() || row >= bench.read.observations[at].size())
      return fail("there is no reading " + std::to_string(row) + " of measurement " + id);
    auto& mask = masks[at];
    mask.resize(bench.read.observations[at].size(), 1);
    mask[row] = 0;
  }
  for (const auto& [at, mask] : masks) {
    for (std::uint32_t row = 0; row < mask.size(); ++row)
      if (mask[row] != 0) kept[at].push_back(row);
    keep_rows(bench.read.observations[at], mask);
  }
  return kept;
}

Expected<void> try_periods(Bench& bench, const Json& request) {
  const Json periods = request.value("period_mm", Json::object());
  for (const auto& [name, mm] : periods.items()) {
    auto& axes = bench.read.manifest->campaign.machine.axes;
    const auto axis = std::find_if(axes.begin(), axes.end(),
                                   [&, &n = name](const Axis& a) { return a.name == n; });
    if (axis == axes.end() || axis->rotary)
      return fail("period_mm: the machine has no linear axis \"" + name + "\"");
    axis->screw_pitch = mm.get<double>() * 1e-3;
  }
  return {};
}

/// A part with the tried model: the part of the bench, or a copy if readings or periods differ.
struct Tried {
  std::unique_ptr<PartModel> own;
  PartModel* of_bench = nullptr;
  std::vector<std::size_t> row;  ///< row of each reading in the complete part
  const PartModel& part() const { return own ? *own : *of_bench; }
};

std::vector<std::size_t> rows_of(const PartModel& part, const PartModel& whole, const Bench& bench,
                                 const Kept& kept) {
  std::map<std::string, std::size_t> measurement;
  for (std::size_t m = 0; m < bench.campaign().measurements.size(); ++m)
    measurement[bench.campaign().measurements[m].id] = m;
  std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> place;
  for (std::size_t i = 0; i < whole.part.row.size(); ++i)
    place[{measurement[whole.part.measurements[whole.part.measurement[i]]], whole.part.row[i]}] = i;
  std::vector<std::size_t> out(part.part.row.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t m = measurement[part.part.measurements[part.part.measurement[i]]];
    const std::uint32_t row = kept[m].empty() ? part.part.row[i] : kept[m].at(part.part.row[i]);
    out[i] = place[{m, row}];
  }
  return out;
}

Expected<Tried> tried(Bench& bench, const Json& request) {
  const auto name = request.at("part").get<std::string>();
  const auto model = request.at("model").get<std::vector<std::string>>();
  PartModel* const whole = bench.part(name);
  if (whole == nullptr) return fail("there is no part \"" + name + "\"");
  Tried out;
  const bool all = request.value("excluded", Json::array()).empty();
  if (all && request.value("period_mm", Json::object()).empty()) {
    if (auto right = modelling::without_mistakes(model, bench.read); !right)
      return fail(right.error());
    modelling::set_model(*whole, model, bench.read);
    if (!bench.has_catalogue) modelling::fill_interpolated(*whole, bench.read);
    out.of_bench = whole;
  } else {
    NONIO_TRY(const auto kept, exclude(bench, request));
    if (auto done = try_periods(bench, request); !done) return fail(done.error());
    NONIO_TRY(auto parts, modelling::part_models(bench.read, model));
    const auto found = std::find_if(parts.begin(), parts.end(),
                                    [&](const PartModel& p) { return p.part.name == name; });
    if (found == parts.end()) return fail("no reading of part " + name + " is left");
    out.own = std::make_unique<PartModel>(std::move(*found));
    if (!all) out.row = rows_of(*out.own, *whole, bench, kept);
  }
  if (all) {
    out.row.resize(out.part().part.table.size());
    std::iota(out.row.begin(), out.row.end(), std::size_t{0});
  }
  return out;
}

/// The readings on the page do not depend on the model. For large parts the page draws columns of
/// pixels and needs only a sample for quantiles and tables.
workbench::Kept kept_of(const PartModel& part) {
  constexpr std::size_t sample = 5000;
  const std::vector<double> measured = part.measured();
  const bool is_drawn = measured.size() <= workbench::most_readings;
  return workbench::kept_readings(measured, is_drawn ? workbench::most_readings : sample);
}

/// Returns the data embedded by model-html, with rows counted as in the files.
Expected<std::string> page_data(const Bench& bench, const PartModel& part, const ModelFit& fit,
                                const std::vector<std::size_t>& rows) {
  const reports::Wording words(bench.place->context.templates, bench.language(), {"pictures"});
  const workbench::Drawn drawn{bench.campaign(), fit, words, reports::picture_words(fit, words)};
  workbench::Kept kept = kept_of(part);
  for (std::size_t i = 0; i < rows.size() && kept.row_in_files.empty(); ++i)
    if (rows[i] != i) kept.row_in_files = rows;
  std::string data = workbench::data_of(drawn, kept);
  if (const auto complete = words.complete(); !complete) return fail(complete.error());
  return data;
}

/// Returns null if the matrices are not prepared or are for other readings.
const model::Groundwork* groundwork_of(const Bench& bench, const Tried& tried) {
  if (tried.own) return nullptr;
  const auto found = bench.groundwork.find(tried.part().part.name);
  return found == bench.groundwork.end() ? nullptr : &found->second;
}

std::string head_of(const Bench& bench, const PartModel& part, const model::Comparison& c,
                    modelling::Extent extent) {
  const modelling::Compared both{part, c};
  return "\"compare\":" + modelling::part_json(both, bench.campaign(), words_of(bench), extent);
}

Expected<std::string> fit(Bench& bench, const Json& request, std::span<double> residual,
                          const First& first) {
  NONIO_TRY(const auto one, tried(bench, request));
  const auto page_of = [&](const model::Comparison& c) {
    std::fill(residual.begin(), residual.end(), std::nan(""));
    for (std::size_t i = 0; i < one.row.size(); ++i) residual[one.row[i]] = c.fit.residual[i];
    return page_data(bench, one.part(), modelling::fitted_value(one.part(), c), one.row);
  };
  bool is_begun = false;
  const auto begin = [&](const model::Comparison& c) {
    const auto page = page_of(c);
    if (!page || !first) return;
    first(storage::pack(head_of(bench, one.part(), c, modelling::Extent::first), *page));
    is_begun = true;
  };
  NONIO_TRY(const auto compared,
            modelling::compare_part(one.part(), groundwork_of(bench, one), begin));
  auto page = is_begun ? Expected<std::string>("") : page_of(compared);
  if (!page) return page;
  return storage::pack(head_of(bench, one.part(), compared, modelling::Extent::whole), *page);
}

/// Returns the page with the readings alone, which is shown before the first fit.
Expected<std::string> look(Bench& bench, const PartModel& part) {
  const auto data = page_data(bench, part, modelling::measured_value(part), {});
  if (!data) return data;
  return "{\"page\":" + *data + "}";
}

Json column(const std::vector<double>& values, const std::vector<std::size_t>& rows, Quantity q) {
  Json list = Json::array();
  for (const std::size_t row : rows) {
    const double shown = printed(values[row], q);
    list.push_back(std::isfinite(shown) ? Json(shown) : Json(nullptr));
  }
  return list;
}

/// Returns the contribution to the fit of each of the first 40 candidates, at the readings on the
/// page.
Json fingerprints_of(const PartModel& part, const model::Explanation& e) {
  constexpr std::size_t most = 40;
  const std::vector<std::size_t> rows = kept_of(part).rows;
  Json list = Json::array();
  for (const model::Candidate& c : e.candidates) {
    if (!modelling::is_ranked(c) || list.size() == most) continue;
    std::vector<model::Term> terms = e.comparison.fit.terms;
    terms.push_back(c.term);
    const auto with = model::fit(part.part.table, terms, e.comparison.fit.weight);
    if (!with) continue;
    Json one = {{"effect", c.term.name()},
                {"unit", unit_of(part.deviation()).symbol},
                {"says", column(with->part.back(), rows, part.deviation())}};
    list.push_back(std::move(one));
  }
  return list;
}

Expected<std::string> explain(Bench& bench, const Json& request, const First& first) {
  NONIO_TRY(const auto one, tried(bench, request));
  if (!one.own && !bench.has_catalogue) modelling::fill_catalogue(*one.of_bench, bench.read);
  NONIO_TRY(auto explained,
            modelling::explain_part(one.part(), request.value("seed", std::uint64_t{1}),
                                    groundwork_of(bench, one)));
  const modelling::Explained both{one.part(), std::move(explained)};
  first("{\"explain\":" + modelling::part_json(both, bench.campaign(), words_of(bench)) + "}");
  return "{\"fingerprints\":" + storage::dump_line(fingerprints_of(one.part(), both.explanation)) +
         ",\"what_if\":" +
         modelling::foresight_json(model::foresee(one.part().part, both.explanation)) + "}";
}

Expected<std::string> without(Bench& bench, const Json& request) {
  NONIO_TRY(const auto one, tried(bench, request));
  const auto rows = kept_of(one.part()).rows;
  const Quantity q = one.part().deviation();
  Json list = Json::array();
  for (const ModelFit::Without& w : modelling::without_each(one.part())) {
    Json item = {{"effect", w.effect}};
    storage::put(item, "rms", w.rms, q);
    storage::put(item, "cv_rms", w.cv_rms, q);
    item["residual"] = column(w.residual, rows, q);
    list.push_back(std::move(item));
  }
  Json out = {{"without", std::move(list)}};
  if (one.part().part.table.size() > 0 && !one.part().names().empty() && out["without"].empty())
    out["why_not"] = "more than 20000 readings: each fit takes seconds";
  return storage::dump_line(out);
}

}  // namespace

PartModel* Bench::part(const std::string& name) {
  const auto found = std::find_if(parts.begin(), parts.end(),
                                  [&](const PartModel& p) { return p.part.name == name; });
  return found == parts.end() ? nullptr : &*found;
}

Expected<Bench> open_bench(const BenchWish& wish) {
  process::keep_plugins_apart(wish.own_plugins);
  Bench bench{wish.folder, nullptr, {}, {}, false, {}};
  NONIO_TRY(auto place, reading::open_workplace(wish.folder, wish.plugin_folders,
                                                wish.template_folders, wish.version));
  bench.place = std::move(place);
  bench.read = reading::read_campaign(wish.folder, bench.place->context, [](const std::string&) {});
  if (!bench.read.manifest) return fail(bench.read.errors.front());
  bench.parts = modelling::bare_parts(bench.read);
  std::size_t readings = 0;
  for (PartModel& part : bench.parts) {
    modelling::set_model(part, {}, bench.read);
    readings += part.part.table.size();
  }
  // Number of readings for which the catalog takes less than 0.1 s.
  constexpr std::size_t many = 50000;
  if (readings <= many) fill_catalogue(bench);
  return bench;
}

Json fill_catalogue(Bench& bench) {
  for (PartModel& part : bench.parts) modelling::fill_catalogue(part, bench.read);
  bench.has_catalogue = true;
  return catalogue_json(bench);
}

Json described(const Bench& bench) {
  const Campaign& campaign = bench.campaign();
  Json json = {{"id", campaign.id},
               {"machine", machine_json(campaign.machine)},
               {"customer", campaign.customer},
               {"date", campaign.date},
               {"language", bench.language()},
               {"kinds", modelling::kinds_measured(bench.read)},
               {"model", campaign.model},
               {"parts", Json::array()},
               {"catalogue", bench.has_catalogue ? catalogue_json(bench) : Json(nullptr)},
               {"inputs", Json::object()},
               {"mistakes", modelling::model_mistakes(campaign.model, bench.read)},
               {"errors", Json::array()},
               {"notes", bench.place->notes}};
  for (const PartModel& part : bench.parts) {
    json["parts"].push_back({{"name", part.part.name},
                             {"kind", kind_of(part)},
                             {"measurements", part.part.measurements},
                             {"readings", part.part.table.size()}});
    if (part.part.kind == model::Part::Kind::space)
      json["parts"].back()["space"] = lines_in_space(part.part);
  }
  json["manifest_sha256"] = bench.read.inputs.front().second;
  for (const auto& [name, digest] : bench.read.inputs) {
    if (name == config::manifest_name) json["inputs"][name] = digest;
    for (const Measurement& m : campaign.measurements)
      if (name == reading::input_name(m.file)) json["inputs"][m.file] = digest;
  }
  for (const Error& e : bench.read.errors) json["errors"].push_back(storage::to_json(e));
  json["seconds"] = bench.place->context.site.limits.seconds;
  return json;
}

bool needs_files(const std::string& kind) { return kind == "save" || kind == "difference"; }

std::string trial_key(const Json& request) {
  Json key = Json::object();
  for (const char* name : {"part", "model", "excluded", "period_mm"})
    if (request.contains(name)) key[name] = request[name];
  return key.dump();
}

bool needs_residual(const Json& request) {
  const auto kind = request.value("kind", "");
  return kind == "readings" || (kind == "series" && is_of_fit(request));
}

const PartModel* without_groundwork(const Bench& bench) {
  // With fewer readings the preparation takes milliseconds, with more it would delay other
  // requests.
  constexpr std::size_t fewest = 5000, most = 200000;
  for (const PartModel& part : bench.parts)
    if (part.part.table.size() >= fewest && part.part.table.size() <= most &&
        !bench.groundwork.contains(part.part.name) &&
        std::none_of(part.terms.begin(), part.terms.end(),
                     [](const model::Term& t) { return t.effect->is_nuisance; }))
      return &part;
  return nullptr;
}

void do_groundwork(Bench& bench, const PartModel& part) {
  bench.groundwork.emplace(part.part.name, model::Groundwork(part.part, {}));
}

Expected<std::string> calculate(Bench& bench, const Json& request, std::span<double> residual,
                                bool fitted, const First& first) {
  const auto kind = request.at("kind").get<std::string>();
  if (kind == "fit") return fit(bench, request, residual, first);
  if (kind == "explain") return explain(bench, request, first);
  if (kind == "without") return without(bench, request);
  if (kind == "catalogue") return storage::dump_line(fill_catalogue(bench));
  if (kind == "save") return save(bench, request);
  if (kind == "difference") return difference(bench, request);
  if (kind == "page" || kind == "report") {
    if (auto kept = exclude(bench, request); !kept) return fail(kept.error());
    if (auto done = try_periods(bench, request); !done) return fail(done.error());
    return document(bench, request);
  }
  const PartModel* const part = bench.part(request.at("part").get<std::string>());
  if (part == nullptr) return fail("there is no such part");
  if (kind == "look") return look(bench, *part);
  if (kind == "places") return readings(*part, bench.campaign(), request, {});
  if (needs_residual(request) && !fitted)
    if (auto done = fit(bench, request, residual, {}); !done) return fail(done.error());
  if (kind == "series") return series(*part, request, residual);
  if (kind == "readings") return readings(*part, bench.campaign(), request, residual);
  return fail("there is no request \"" + kind + "\"");
}

}  // namespace nonio::live
