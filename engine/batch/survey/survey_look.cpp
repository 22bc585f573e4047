// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/survey_look.h"

#include <sys/stat.h>

#include <set>
#include <utility>

#include "batch/survey/twins.h"
#include "campaign/config/manifest.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

std::string digest_in(const evaluation::Record& record, const std::string& name) {
  for (const auto& [known, digest] : record.inputs)
    if (known == name) return digest;
  return {};
}

bool is_younger(const storage::Written& a, const storage::Written& b) {
  return std::pair(a.seconds, a.nanoseconds) > std::pair(b.seconds, b.nanoseconds);
}

}  // namespace

ChangeDetector::ChangeDetector(const SurveyInput& input, process::SignsOfLife& signs)
    : in_(input), signs_(signs), shared_(reading::shared_inputs(input.context)) {
  if (input.numbers)
    for (const certificates::RegisterEntry& e : *input.numbers) numbers_[e.number] = &e;
}

CampaignState ChangeDetector::at(const CampaignState& known, bool rough) {
  CampaignState state;
  state.folder = known.folder;
  state.id = known.id;
  state.named_by_folder = known.named_by_folder;
  signs_.reading((fs::path(known.folder) / config::manifest_name).string());
  const auto text = storage::read_small_file(in_.site / known.folder / config::manifest_name);
  if (!text) {
    state.named_by_folder = true;
    state.reason = "no earlier result";
    return state;
  }
  const std::string digest = storage::sha256(*text);
  // The manifest is parsed only if it differs from that of the last results.
  if (state.id.empty()) state.id = config::extract_id(*text);
  Last last = last_of(state.id);
  const bool as_before = last && *last &&
                         (*last)->record.folder == storage::path_text(known.folder) &&
                         digest_in((*last)->record, config::manifest_name) == digest;
  if (!as_before) {
    std::string id = read_whole(state, *text, rough);
    if (!known.named_by_folder) {
      if (!id.empty() && id != state.id) {
        state.id = id;
        last = last_of(state.id);
      }
      state.named_by_folder = state.id.empty();
    }
  }
  judge(state, last, digest);
  return state;
}

std::string ChangeDetector::read_whole(CampaignState& state, const std::string& manifest,
                                       bool rough) {
  if (rough) return {};
  signs_.reads = false;
  const auto parsed = config::parse_without_methods(manifest, config::manifest_name);
  signs_.reads = true;
  signs_.beat();
  if (!parsed) return {};
  state.warnings = parsed->warnings;
  std::set<std::string> files;
  std::vector<std::uint64_t> readings;
  for (const Measurement& m : parsed->campaign.measurements) {
    if (!files.insert(m.file).second) continue;
    signs_.reading((fs::path(state.folder) / m.file).string());
    const auto path = storage::path_inside(in_.site / state.folder, m.file);
    const auto digest = path ? digest_with_signs(*path) : fail(path.error());
    if (digest) readings.push_back(storage::short_digest(*digest));
  }
  state.readings = readings;
  return parsed->campaign.id;
}

ChangeDetector::Last ChangeDetector::last_of(const std::string& id) {
  if (id.empty()) return std::nullopt;
  auto last = evaluation::last_record(storage::results_folder(in_.out, id));
  if (!last || !*last) return last;
  const std::string& number = (*last)->record.certificate;
  if (in_.numbers && !number.empty() && !numbers_.contains(number)) unknown_ = number;
  return last;
}

/// Returns the reason of an evaluation of this run whose results were not stored completely, so
/// that the output files are not those of the previous run; otherwise empty.
std::string ChangeDetector::staged_reason(const CampaignState& state) const {
  const auto staged = evaluation::staged_record(storage::own_folder(in_.out, state.id));
  return staged && *staged && (*staged)->run == in_.run ? (*staged)->reason : "";
}

void ChangeDetector::judge(CampaignState& state, const Last& last,
                           const std::string& manifest_digest) {
  if (!last)
    state.reason = last.error().message;
  else if (!*last)
    state.reason = "no earlier result";
  else if (!(*last)->whole)
    state.reason = staged_reason(state);
  if (!state.reason.empty()) return;
  const evaluation::Record& record = (*last)->record;
  const bool last_run = record.run == in_.run;
  state.reason = changes(state, record, manifest_digest);
  if (state.reason.empty() && !(*last)->whole) state.reason = "its last results are not whole";
  if (!state.reason.empty()) return;
  state.twins_before = twins_of(record.inputs);
  state.shows_history = record.history.has_value();
  if (record.history) state.history = record.history->sha256;
  state.action = last_run ? CampaignState::Action::done : CampaignState::Action::unchanged;
  state.reason = last_run ? record.reason : "nothing changed";
  state.status = record.status;
  state.errors = record.errors;
}

std::string ChangeDetector::changes(CampaignState& state, const evaluation::Record& record,
                                    const std::string& manifest_digest) {
  std::vector<std::string> why;
  if (record.retry && record.run != in_.run)
    why.push_back("it failed for a reason that may have passed");
  if (record.folder != storage::path_text(state.folder))
    why.push_back("moved from " + record.folder);
  for (const auto& [name, digest] : shared_)
    if (digest_in(record, name) != digest) why.push_back(name + " changed");
  if (digest_in(record, config::manifest_name) != manifest_digest)
    why.push_back(std::string(config::manifest_name) + " changed");
  const std::string prefix = reading::input_name("");
  for (const auto& [name, digest] : record.inputs)
    if (name.starts_with(config::machine_prefix) &&
        config::machine_digest(in_.context.machines, name) != digest)
      why.push_back("the record of the machine (" + name.substr(config::machine_prefix.size()) +
                    ") changed");
  std::vector<std::uint64_t> readings = state.readings;
  for (const auto& [name, digest] : record.inputs)
    if (name.starts_with(prefix))
      if (const auto now = look_at_file(state, name.substr(prefix.size()), digest, why))
        readings.push_back(*now);
  state.readings = readings;
  if (in_.force && record.run != in_.run) return "--force";
  look_at_outputs(state, record, why);
  look_at_number(state, record, why);
  std::string words;
  for (const std::string& w : why) words += (words.empty() ? "" : "; ") + w;
  return words;
}

Expected<std::string> ChangeDetector::digest_with_signs(const fs::path& path) {
  return storage::sha256_of_file(path, [this] { signs_.beat(); });
}

std::optional<std::uint64_t> ChangeDetector::look_at_file(const CampaignState& state,
                                                          const std::string& name,
                                                          const std::string& digest,
                                                          std::vector<std::string>& why) {
  signs_.reading((fs::path(state.folder) / name).string());
  const auto path = storage::path_inside(in_.site / state.folder, name);
  const auto now = path ? digest_with_signs(*path) : fail(path.error());
  std::error_code error;
  if (now.value_or(config::absent) != digest)
    why.push_back(!now && path && fs::exists(*path, error)
                      ? now.error().message
                      : "file " + name + (now ? " changed" : " no longer exists"));
  return now ? std::optional(storage::short_digest(*now)) : std::nullopt;
}

/// Adds missing and modified output files to `why`. Of files with the recorded size, only those
/// that are newer than the record are compared by digest, or all if `verify_results` is set.
void ChangeDetector::look_at_outputs(const CampaignState& state, const evaluation::Record& record,
                                     std::vector<std::string>& why) {
  const fs::path folder = storage::results_folder(in_.out, state.id);
  signs_.reading(folder.string());
  const auto written = storage::record_written_at(folder);
  if (!written || !*written) return;
  for (const evaluation::RecordedFile& f : record.files) {
    const fs::path path = folder / f.name;
    const auto now = storage::written_at(path);
    if (!now || !*now)
      why.push_back(f.name + " is missing from the output");
    else if ((*now)->size != f.size ||
             ((in_.verify_results || is_younger(**now, **written)) &&
              digest_with_signs(path).value_or(config::absent) != f.sha256))
      why.push_back(f.name + " was changed in the output");
  }
}

void ChangeDetector::look_at_number(const CampaignState& state, const evaluation::Record& record,
                                    std::vector<std::string>& why) const {
  if (in_.numbers && record.draft && !in_.drafts.contains(state.id))
    why.push_back("its draft was released, or the register does not know it");
  const bool amends = std::any_of(record.findings.begin(), record.findings.end(),
                                  [](const auto& f) { return f.id == "certificate.amendment"; });
  if (in_.numbers && amends && std::none_of(numbers_.begin(), numbers_.end(), [&](const auto& n) {
        return n.second->campaign == state.id && n.second->in_force();
      }))
    why.push_back("the certificate that it replaces was withdrawn");
  const auto number = numbers_.find(record.certificate);
  if (number == numbers_.end() || number->second->in_force()) return;
  why.push_back("its certificate " + record.certificate + " was " + number->second->state);
}

}  // namespace nonio::batch
