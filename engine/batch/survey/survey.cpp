// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/survey.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "batch/state/wire.h"
#include "batch/survey/earlier_results.h"
#include "batch/survey/site_walk.h"
#include "batch/survey/twins.h"
#include "campaign/config/manifest.h"
#include "campaign/evaluation/record.h"
#include "platform/process/watched.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::storage {
NONIO_MEMBERS(batch::CampaignState, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
}  // namespace nonio::storage

namespace nonio::batch {

namespace fs = std::filesystem;

namespace {

/// Decides whether a campaign is evaluated by comparing its files with its last record. Runs in a
/// child process of the survey.
class ChangeDetector {
 public:
  ChangeDetector(const SurveyInput& input, process::SignsOfLife& signs);

  /// `known` contains the folder, and the id if the manifest states none. `rough` omits the parsing
  /// of the manifest, which has crashed the process before.
  CampaignState at(const CampaignState& known, bool rough);
  /// Returns an issued number that the register lacks; empty if there is none.
  const std::string& unknown_number() const { return unknown_; }

 private:
  using Last = Expected<std::optional<evaluation::LastRecord>>;

  /// Returns the id in the manifest and stores the digests of the files of readings in `state`.
  /// Empty if the manifest is invalid, or without parsing if `rough`.
  std::string read_whole(CampaignState& state, const std::string& manifest, bool rough);
  Last last_of(const std::string& id);
  std::string staged_reason(const CampaignState& state) const;
  void judge(CampaignState& state, const Last& last, const std::string& manifest_digest);
  std::string changes(CampaignState& state, const evaluation::Record& record,
                      const std::string& manifest_digest);
  /// Adds a reason to `why` if the digest of the file is not `digest`. Returns the first 64 bits of
  /// the present digest, or std::nullopt if the file cannot be read.
  std::optional<std::uint64_t> look_at_file(const CampaignState& state, const std::string& name,
                                            const std::string& digest,
                                            std::vector<std::string>& why);
  void look_at_outputs(const CampaignState& state, const evaluation::Record& record,
                       std::vector<std::string>& why);
  void look_at_number(const CampaignState& state, const evaluation::Record& record,
                      std::vector<std::string>& why) const;
  Expected<std::string> digest_with_signs(const std::filesystem::path& path);

  const SurveyInput& in_;
  process::SignsOfLife& signs_;
  reading::Inputs shared_;
  std::map<std::string, const certificates::RegisterEntry*> numbers_;
  std::string unknown_;
};
namespace fs = std::filesystem;

std::string digest_in(const evaluation::Record& record, const std::string& name) {
  for (const auto& [known, digest] : record.inputs)
    if (known == name) return digest;
  return {};
}

bool is_younger(const storage::Written& a, const storage::Written& b) {
  return std::pair(a.seconds, a.nanoseconds) > std::pair(b.seconds, b.nanoseconds);
}

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

/// Large enough that starting a process is cheap compared with its work, small enough that a crash
/// costs little.
constexpr std::size_t campaigns_in_batch = 2000;
/// Number of campaigns without a response after which the waiting time is one second.
constexpr std::size_t most_patience = 8;

Error unknown_number(const std::string& number, const std::filesystem::path& out) {
  return Error{"the register of certificates does not know the number " + number + ", which " +
               out.string() +
               " states was issued: restore the register, or numbers would be used twice"};
}

struct Batch {
  std::vector<std::uint32_t> campaigns{};
  bool rough = false;
  std::size_t received = 0;
};

class Pool {
 public:
  Pool(const SurveyInput& input, std::vector<CampaignState>& states)
      : in_(input), states_(states) {}

  Expected<void> run(std::span<const std::uint32_t> which) {
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    // Several batches per core let all cores end at about the same time.
    const std::size_t size =
        std::clamp(which.size() / (4 * cores), std::size_t{1}, campaigns_in_batch);
    while ((!which.empty() || !todo_.empty() || !children_.empty()) && !in_.stopped()) {
      while ((!which.empty() || !todo_.empty()) && children_.size() < cores) {
        if (todo_.empty()) {
          const auto next = which.first(std::min(size, which.size()));
          todo_.push_back({{next.begin(), next.end()}});
          which = which.subspan(next.size());
        }
        if (auto started = start(); !started) return started;
      }
      process::wait_for_any(children_);
      for (std::size_t i = children_.size(); i-- > 0;) serve(i);
    }
    if (!unknown_.empty()) return fail(unknown_number(unknown_, in_.out));
    return {};
  }

 private:
  Expected<void> start() {
    Batch batch = std::move(todo_.back());
    todo_.pop_back();
    auto child = process::Watched::start(
        [&](process::SignsOfLife& signs, const process::Watched::Send& send) {
          ChangeDetector look(in_, signs);
          for (std::size_t i = 0; i < batch.campaigns.size(); ++i) {
            signs.index = i;
            const CampaignState state = look.at(states_[batch.campaigns[i]], batch.rough);
            send(storage::pack(state, look.unknown_number()));
          }
        },
        in_.context.site.limits.memory_MB);
    if (!child) return fail(child.error());
    children_.push_back(std::move(*child));
    batches_.push_back(std::move(batch));
    return {};
  }

  void serve(std::size_t i) {
    process::Watched& child = children_[i];
    Batch& batch = batches_[i];
    for (const std::string& piece : child.take())
      if (batch.received < batch.campaigns.size()) {
        std::string unknown;
        storage::unpack(piece, states_[batch.campaigns[batch.received++]], unknown);
        if (!unknown.empty()) unknown_ = std::move(unknown);
      }
    const double seconds = in_.context.site.limits.disk_seconds;
    const double patience = hung_ < most_patience ? seconds : std::min(seconds, 1.0);
    const bool silent = !child.ended() && child.is_silent(patience);
    if (!child.ended() && !silent) return;
    if (batch.received < batch.campaigns.size()) cut_short(child, batch, silent, patience);
    children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
    batches_.erase(batches_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  /// A campaign whose files do not respond fails. After a crash, the campaign is tried alone, at
  /// most twice, and then fails. Another process continues with the rest of the batch.
  void cut_short(process::Watched& child, const Batch& batch, bool silent, double patience) {
    const std::size_t at =
        std::clamp<std::size_t>(child.signs().index, batch.received, batch.campaigns.size() - 1);
    const std::string place = storage::path_text(child.signs().reads_from());
    const bool hangs = silent && child.signs().reads;
    const process::ChildEnd end = child.end();
    const std::uint32_t campaign = batch.campaigns[at];
    Batch rest{{}, batch.rough};
    for (std::size_t i = batch.received; i < batch.campaigns.size(); ++i)
      if (i != at) rest.campaigns.push_back(batch.campaigns[i]);
    if (!rest.campaigns.empty()) todo_.push_back(std::move(rest));
    const int tried = ++trials_[campaign];
    if (hangs) ++hung_;
    if (hangs)
      fail_at(campaign, {process::no_answer(patience), place});
    else if (tried <= 2)
      todo_.push_back({{campaign}, tried == 2 || silent});
    else
      fail_at(campaign, {"the process that looked at it ended: " + end.words, place});
  }

  void fail_at(std::uint32_t campaign, Error why) {
    CampaignState& state = states_[campaign];
    state.named_by_folder = true;
    state.status = evaluation::Status::failed;
    state.reason = "not evaluated";
    state.errors = {std::move(why)};
  }

  const SurveyInput& in_;
  std::vector<CampaignState>& states_;
  std::vector<Batch> todo_;
  std::vector<process::Watched> children_;
  std::vector<Batch> batches_;
  std::map<std::uint32_t, int> trials_;
  std::size_t hung_ = 0;
  std::string unknown_;
};

/// Sets the states with the indices `which` on all cores, in child processes, so that a disk that
/// hangs or a crash does no harm. An error if no process can be started or the register lacks a
/// number.
Expected<void> look_at_all(const SurveyInput& input, std::span<const std::uint32_t> which,
                           std::vector<CampaignState>& states) {
  return Pool(input, states).run(which);
}

std::string folder_id(const std::string& folder) {
  std::string id = folder == "." ? "campaign" : fs::path(folder).filename().string();
  for (char& c : id) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (!config::is_campaign_id(std::string("a") + c)) c = '-';
  }
  id.insert(0, id.empty() || id.front() == '.' || !config::is_campaign_id(id) ? "campaign-" : "");
  return id.substr(0, 100);
}

/// Sets the id of campaigns whose manifest states none: the id of earlier results of the folder,
/// otherwise a unique id made from the name of the folder.
void name_by_folder(std::vector<CampaignState>& states, const std::vector<EarlierResult>& earlier,
                    const ClaimedIds& claimed) {
  std::map<std::string_view, std::string_view> known;
  std::set<std::string> taken;
  for (const EarlierResult& e : earlier) {
    // A result that did not fail has the id of a valid manifest, which has precedence.
    const auto [at, is_new] = known.emplace(e.folder, e.id);
    if (!is_new && !e.failed) at->second = e.id;
    taken.insert(e.id);
  }
  for (CampaignState& s : states) {
    if (!s.named_by_folder) continue;
    if (const auto at = known.find(storage::path_text(s.folder)); at != known.end()) {
      s.id = at->second;
      known.erase(at);
      continue;
    }
    const std::string name = folder_id(s.folder);
    std::string id = name;
    for (int n = 2; claimed.contains(id) || !taken.insert(id).second; ++n)
      id = name + "." + std::to_string(n);
    s.id = id;
  }
}

/// Campaigns with equal ids fail, because their results would share a folder. A message names at
/// most four of their folders.
void fail_collisions(std::vector<CampaignState>& states) {
  constexpr std::size_t most_named = 4;
  for (std::size_t i = 0; i < states.size();) {
    std::size_t end = i + 1;
    while (end < states.size() && states[end].id == states[i].id) ++end;
    if (end - i > 1) {
      std::string folders;
      const std::size_t named = std::min(end, i + most_named);
      for (std::size_t k = i; k < named; ++k)
        folders += (k == i         ? ""
                    : k + 1 == end ? " and "
                                   : ", ") +
                   storage::path_text(states[k].folder);
      if (named < end) folders += " and " + std::to_string(end - named) + " more folders";
      for (std::size_t k = i; k < end; ++k) {
        states[k].action = CampaignState::Action::todo;
        states[k].status = evaluation::Status::failed;
        states[k].reason = "no result: its id is not unique";
        states[k].errors = {Error{"campaign.id \"" + states[k].id + "\" is used by " + folders +
                                      "; expected one id for one campaign",
                                  config::manifest_name}};
      }
    }
    i = end;
  }
}

CampaignState failed_folder(const SiteWalk::Unlisted& unlisted) {
  CampaignState state;
  state.folder = unlisted.folder;
  state.named_by_folder = true;
  state.is_campaign = false;
  state.status = evaluation::Status::failed;
  state.reason = "the folder cannot be listed";
  state.errors = {Error{"the folder " + storage::path_text(unlisted.folder) +
                        " cannot be listed, so its content is not known: " + unlisted.why}};
  return state;
}

void compare_twins(CampaignState& state, const std::vector<CampaignState>& all) {
  const reading::Twins before = state.twins_before;
  state.twins_before = {};
  if (state.action == CampaignState::Action::todo) return;
  const reading::Twins now = twins_of(state, all);
  if (now == before) return;
  state.action = CampaignState::Action::todo;
  state.status = evaluation::Status::none;
  state.errors = {};
  state.reason = now.empty() ? "no other campaign has its readings any more"
                             : "campaign " + now.front().second + " has the same readings";
}

}  // namespace

Expected<void> check_numbers(const fs::path& out, const std::vector<CampaignState>& campaigns,
                             const std::vector<certificates::RegisterEntry>& numbers) {
  std::set<std::string> known;
  for (const certificates::RegisterEntry& e : numbers) known.insert(e.number);
  for (const CampaignState& c : campaigns)
    if (const auto record = evaluation::read_record(storage::results_folder(out, c.id));
        record && !record->certificate.empty() && !known.contains(record->certificate))
      return fail(unknown_number(record->certificate, out));
  return {};
}

Expected<Surveyed> survey(const SurveyInput& input) {
  Surveyed all;
  std::vector<CampaignState>& states = all.campaigns;
  auto walk =
      walk_site(input.site, input.out, input.context.site.limits.disk_seconds, input.stopped);
  if (!walk) return fail(walk.error());
  for (std::string& note : walk->notes) input.notes.push_back(std::move(note));
  states.reserve(walk->campaigns.size() + walk->unlisted.size());
  for (const std::string& folder : walk->campaigns) {
    states.emplace_back();
    states.back().folder = folder;
  }
  walk->campaigns = std::vector<std::string>();
  {
    std::vector<std::uint32_t> each(states.size());
    std::iota(each.begin(), each.end(), std::uint32_t{0});
    if (auto looked = look_at_all(input, each, states); !looked) return fail(looked.error());
  }
  if (input.stopped()) return all;
  const std::size_t walked = states.size();
  for (const SiteWalk::Unlisted& u : walk->unlisted) states.push_back(failed_folder(u));
  {
    const ClaimedIds claimed(states);
    NONIO_TRY(const auto earlier, unclaimed_results(input.out, claimed));
    name_by_folder(states, earlier, claimed);
    std::vector<std::uint32_t> which;
    for (std::size_t i = 0; i < states.size(); ++i)
      if (states[i].named_by_folder && states[i].status == evaluation::Status::none)
        which.push_back(static_cast<std::uint32_t>(i));
    if (auto looked = look_at_all(input, which, states); !looked) return fail(looked.error());
    all.vanished = vanished_of(earlier, states, walked, walk->unlisted, input.out, input.notes);
  }
  set_in_order(states);
  return all;
}

void set_in_order(std::vector<CampaignState>& campaigns) {
  std::sort(campaigns.begin(), campaigns.end(), [](const CampaignState& a, const CampaignState& b) {
    const auto by_id = a.id <=> b.id;
    return by_id == 0 ? a.folder < b.folder : by_id < 0;
  });
  fail_collisions(campaigns);
  find_twins(campaigns);
  for (CampaignState& state : campaigns) compare_twins(state, campaigns);
}

}  // namespace nonio::batch
