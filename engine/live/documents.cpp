// SPDX-License-Identifier: Apache-2.0
#include "live/documents.h"

#include <algorithm>
#include <set>

#include "campaign/evaluation/evaluation.h"
#include "campaign/modelling/model_change.h"
#include "campaign/reading/names.h"
#include "live/difference.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::live {
using storage::Json;

namespace {

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

}  // namespace

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

}  // namespace nonio::live
