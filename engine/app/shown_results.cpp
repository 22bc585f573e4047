// SPDX-License-Identifier: Apache-2.0
#include "shown_results.h"

#include "batch/state/run_state.h"
#include "campaign/config/template_files.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/evaluation.h"
#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "certificates/certificate_list.h"
#include "platform/storage/files.h"
#include "platform/storage/json_numbers.h"
#include "platform/storage/packed_results.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

Expected<Shown> evaluated_now(const fs::path& folder, const Common& common, Documents documents) {
  NONIO_TRY(auto place, reading::open_workplace(folder, common.plugin_folders(),
                                                common.template_folders(), NONIO_VERSION));
  if (!common.quiet)
    for (const std::string& note : place->notes) complain(note);
  const reading::Context& context = place->context;
  const reading::Stage stage = [](const std::string&) {};
  evaluation::AnalysedCampaign analysed = evaluation::analyse(
      reading::read_campaign(folder, context, stage), id_of_campaign(folder), context, stage, {});
  std::vector<Observations> observations = analysed.read.observations;
  if (documents == Documents::left_out) analysed.documents.clear();
  const evaluation::Evaluated evaluated =
      evaluation::write_documents(std::move(analysed), nullptr, context, stage);
  std::string text = evaluation::results_json(evaluated, context);
  std::vector<std::string> notes;
  if (const std::string& language = context.site.language; language != "en")
    notes = evaluation::notes_in(language, evaluated.results, context.templates);
  return Shown{std::move(text), std::move(place->context.templates), context.site.language,
               std::move(observations), std::move(notes)};
}

Expected<Shown> of_run(const fs::path& folder, const Common& common) {
  NONIO_TRY(auto text, storage::read_file(folder / evaluation::results_name));
  std::string language = "en";
  std::vector<std::string> notes;
  if (auto record = evaluation::read_record(folder); record && !record->language.empty()) {
    language = record->language;
    notes = std::move(record->notes);
  }
  NONIO_TRY(auto templates,
            config::read_templates(common.template_folders(), {}, config::words_in(language)));
  return Shown{std::move(text), std::move(templates), language, {}, std::move(notes)};
}

Json results_of(const Shown& shown) {
  Json results = storage::parse(shown.text);
  std::vector<Json*> notes;
  const auto collect = [&](Json& of) {
    if (of.contains("notes"))
      for (Json& note : of.at("notes")) notes.push_back(&note);
  };
  for (const char* list : {"analyses", "tables"})
    if (results.contains(list))
      for (Json& one : results.at(list)) collect(one);
  collect(results);
  if (notes.size() == shown.notes.size())  // not so for records of earlier versions
    for (std::size_t i = 0; i < notes.size(); ++i) *notes[i] = shown.notes[i];
  return results;
}

bool is_out_of_force(const fs::path& results, const std::string& number) {
  const fs::path above = fs::absolute(results).lexically_normal().parent_path();
  for (const fs::path& out : {above, above.parent_path()}) {  // OUT/<id> or OUT/ab/<id>
    const std::string site = batch::site_of(out);
    if (site.empty()) continue;
    const auto numbers = certificates::out_of_force(site);
    return numbers && numbers->contains(number);
  }
  return false;
}

Finding finding_of(const Json& json) {
  Finding f{.id = json.at("id"), .attention = json.at("severity") == "attention"};
  for (const auto& [key, value] : json.at("evidence").items())
    if (value.is_string())
      f.texts.emplace_back(key, value.get<std::string>());
    else
      f.evidence.push_back(storage::number_of(key, value));
  f.advice = json.value("advice", "");
  f.measurement = json.value("measurement", "");
  return f;
}

namespace fs = std::filesystem;

Holds what_holds(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / config::manifest_name, error)) return Holds::campaign;
  if (storage::is_there(folder / evaluation::results_name).value_or(false)) return Holds::results;
  if (fs::exists(folder / "summary.json", error)) return Holds::run;
  return Holds::nothing;
}

fs::path results_at(const fs::path& folder) {
  if (what_holds(folder) != Holds::nothing) return folder;
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const fs::path above = path.parent_path();
  for (const fs::path& out : {above, above.parent_path()}) {
    const std::string id = path.filename().string();
    if (storage::own_folder(out, id) != path) continue;
    if (fs::path place = storage::results_folder(out, id); place != path) return place;
  }
  return folder;
}

std::string holds_nothing(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return "there is no folder " + folder.string();
  return folder.string() +
         " is neither a campaign (campaign.toml) nor what `nonio run` left of one (results.json)";
}

std::string id_of_campaign(const fs::path& folder) {
  std::string id;
  if (const auto text = storage::read_file(folder / config::manifest_name)) {
    const auto manifest = config::parse_without_methods(*text, config::manifest_name);
    id = manifest ? manifest->campaign.id : config::extract_id(*text);
  }
  return id.empty() ? fs::absolute(folder).lexically_normal().filename().string() : id;
}

}  // namespace nonio::app
