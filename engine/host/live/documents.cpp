// SPDX-License-Identifier: Apache-2.0
#include "host/live/documents.h"

#include <algorithm>

#include "host/evaluation/evaluation.h"
#include "host/live/difference.h"
#include "host/modelling/model_change.h"
#include "host/reading/names.h"
#include "host/storage/digest.h"
#include "host/storage/files.h"

namespace nonio::host::live {
using storage::Json;

namespace {

std::vector<std::string> model_in(const Json& request) {
  return request.at("model").get<std::vector<std::string>>();
}

}  // namespace

Expected<std::string> save(Bench& bench, const Json& request) {
  auto edits = modelling::edits_between(bench.campaign().model, model_in(request));
  for (modelling::ModelEdit& edit : edits) edit.why = request.value("why", "");
  if (edits.empty()) return fail("campaign.toml has this model already; nothing was written");
  const auto changes = modelling::change_model(bench.folder, bench.read, edits);
  if (!changes) return fail(changes.error());
  Json steps = Json::array();
  for (const modelling::Change& change : *changes)
    steps.push_back(Json::parse(modelling::history_line(change.step)));
  return storage::dump_line({{"model", bench.campaign().model},
                             {"manifest_sha256", bench.read.inputs.front().second},
                             {"steps", std::move(steps)}});
}

Expected<std::string> difference(Bench& bench, const Json& request) {
  const auto text = storage::read_small_file(bench.folder / config::manifest_name);
  if (!text) return fail(text.error());
  const std::string digest = storage::sha256(*text);
  Json out = {{"manifest_sha256", digest},
              {"changed_on_disk", digest != bench.read.inputs.front().second},
              {"diff", ""}};
  if (const auto manifest = config::parse_manifest(*text, config::manifest_name))
    out["on_disk"] = manifest->campaign.model;
  else
    out["on_disk_error"] = manifest.error().front().message;
  if (digest != bench.read.inputs.front().second) return storage::dump_line(out);
  const auto edited = modelling::edited_manifest(
      *text, modelling::edits_between(bench.campaign().model, model_in(request)));
  if (!edited) return fail(edited.error());
  out["diff"] = unified_difference(config::manifest_name, *text, *edited);
  return storage::dump_line(out);
}

Expected<std::string> document(Bench& bench, const Json& request) {
  const bool page = request.at("kind") == "page";
  const std::string output = page ? "model-html" : "pdf-report";
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
      // model-html writes a file for each model that could be fitted, in their order.
      if (!page || (k < done.results.models.size() && done.results.models[k].part == wanted))
        return artifact.bytes;
      ++k;
    }
  }
  if (!done.results.errors.empty()) return fail(done.results.errors.front());
  return fail(output + " wrote nothing of this campaign" +
              (page ? "; a page needs a model that could be fitted" : ""));
}

}  // namespace nonio::host::live
