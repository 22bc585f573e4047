// SPDX-License-Identifier: Apache-2.0
#include "survey.h"

#include <Poco/Environment.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "nonio/host/digest.h"
#include "nonio/host/files.h"
#include "twins.h"
#include "worker.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

/// Folders with a manifest, relative to the site, in order. Links are not followed: a campaign is
/// what lies in the site. Hidden folders and the output folder are left out.
Expected<std::vector<std::string>> find_campaigns(const fs::path& site, const fs::path& out,
                                                  std::vector<std::string>& notes) {
  std::vector<std::string> folders;
  std::error_code error;
  const fs::path own_output = fs::weakly_canonical(out, error);
  fs::recursive_directory_iterator it(fs::canonical(site, error),
                                      fs::directory_options::skip_permission_denied, error);
  if (error) return fail("cannot read the site " + site.string() + ": " + error.message());
  const fs::path root = fs::canonical(site);
  if (fs::exists(root / manifest_name)) folders.emplace_back(".");
  for (; it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (error) return fail("cannot read the site " + site.string() + ": " + error.message());
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    if (it->is_symlink(ignored) && it->is_directory(ignored)) {
      if (fs::exists(it->path() / manifest_name, ignored))
        notes.push_back("the campaign " + it->path().lexically_relative(root).generic_string() +
                        " is a link and is not followed: a campaign lies in the site itself");
    } else if (it->is_directory(ignored)) {
      if (name.starts_with('.') || it->path() == own_output) it.disable_recursion_pending();
    } else if (name == manifest_name && it.depth() > 0) {
      folders.push_back(it->path().parent_path().lexically_relative(root).generic_string());
    }
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

/// An id for a campaign whose manifest does not give one: its folder's name.
std::string folder_id(const std::string& folder) {
  std::string id = folder == "." ? "campaign" : fs::path(folder).filename().string();
  for (char& c : id) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (!is_campaign_id(std::string("a") + c)) c = '-';
  }
  id.insert(0, id.empty() || id.front() == '.' || !is_campaign_id(id) ? "campaign-" : "");
  return id.substr(0, 100);
}

class Look {
 public:
  explicit Look(const SurveyInput& input) : in_(input), shared_(shared_inputs(input.context)) {
    if (input.numbers)
      for (const RegisterEntry& e : *input.numbers) numbers_[e.number] = &e;
  }

  /// A first look, without reading the manifest in full: that is done where a full reading said the
  /// same before. False if it has to be read.
  bool at_first(CampaignState& state, std::string& manifest_digest) const {
    const auto text = read_file(in_.site / state.folder / manifest_name);
    if (!text) {
      name_by_folder(state);
      state.reason = "no earlier result";
      return true;
    }
    manifest_digest = sha256(*text);
    state.id = salvage_id(*text);
    const auto last = last_of(state.id);
    if (!last || !*last || (*last)->record.folder != state.folder ||
        digest_of((*last)->record, manifest_name) != manifest_digest)
      return false;
    judge(state, last, manifest_digest);
    return true;
  }

  /// With the id that a full reading gave; if it gave none, what the first look saw stays.
  void again(CampaignState& state, const std::string& id,
             const std::string& manifest_digest) const {
    read_words(state, id);
    if (state.id.empty()) name_by_folder(state);
    judge(state, last_of(state.id), manifest_digest);
  }

  /// Whether other campaigns share readings as they did when the record was written.
  void shared_again(CampaignState& state, const std::vector<CampaignState>& all) const {
    if (state.action == CampaignState::Action::todo) return;
    const auto then = twins_then_.find(state.folder);
    const Twins now = twins_of(state, all);
    if (then == twins_then_.end() ? now.empty() : then->second == now) return;
    state.action = CampaignState::Action::todo;
    state.status.clear();
    state.errors.clear();
    state.reason = now.empty() ? "no other campaign has its readings any more"
                               : "campaign " + now.front().second + " has the same readings";
  }

  /// A number that was issued and that the register does not know; empty if all is well.
  const std::string& unknown_number() const { return unknown_; }

 private:
  void note_twins(const std::string& folder, Twins twins) const {
    const std::lock_guard guard(twins_guard_);
    twins_then_[folder] = std::move(twins);
  }

  /// What `read_ids` said: the id, then the digests of the files.
  static void read_words(CampaignState& state, const std::string& words) {
    std::size_t at = std::min(words.find(' '), words.size());
    if (at > 0) state.id = words.substr(0, at);
    while (at < words.size()) {
      const std::size_t next = std::min(words.find(' ', at + 1), words.size());
      state.readings.push_back(short_digest(std::string_view(words).substr(at + 1)));
      at = next;
    }
  }

  static void name_by_folder(CampaignState& state) {
    state.id = folder_id(state.folder);
    state.named_by_folder = true;
  }

  Expected<std::optional<LastRecord>> last_of(const std::string& id) const {
    if (id.empty()) return std::nullopt;
    auto last = last_record(in_.out / id);
    if (!last || !*last) return last;
    const std::string& number = (*last)->record.certificate;
    if (in_.numbers && !number.empty() && !numbers_.contains(number)) {
      const std::lock_guard guard(unknown_guard_);
      unknown_ = number;
    }
    return last;
  }

  /// Where storing tonight's results was cut short: why the campaign was done. The files that would
  /// tell are no longer those of the night before.
  std::string staged_reason(const CampaignState& state) const {
    const auto staged = staged_record(in_.out / state.id);
    return staged && *staged && (*staged)->night == in_.night ? (*staged)->reason : "";
  }

  static std::string digest_of(const Record& record, const std::string& name) {
    for (const auto& [known, digest] : record.inputs)
      if (known == name) return digest;
    return {};
  }

  void judge(CampaignState& state, const Expected<std::optional<LastRecord>>& last,
             const std::string& manifest_digest) const {
    if (!last)
      state.reason = last.error().message;
    else if (!*last)
      state.reason = "no earlier result";
    else if (!(*last)->whole)
      state.reason = staged_reason(state);
    if (!state.reason.empty()) return;
    const Record* record = &(*last)->record;
    const bool tonight = record->night == in_.night;
    state.reason = changes(state, *record, manifest_digest);
    if (state.reason.empty() && !(*last)->whole) state.reason = "its last results are not whole";
    if (!state.reason.empty()) return;
    if (Twins then = twins_of(record->inputs); !then.empty())
      note_twins(state.folder, std::move(then));
    state.action = tonight ? CampaignState::Action::done : CampaignState::Action::unchanged;
    state.reason = tonight ? record->reason : "nothing changed";
    state.status = record->status;
    state.errors = record->errors;
  }

  std::string changes(CampaignState& state, const Record& record,
                      const std::string& manifest_digest) const {
    std::vector<std::string> why;
    if (record.retry && record.night != in_.night)
      why.push_back("it failed for a reason that may have passed");
    if (record.folder != state.folder) why.push_back("moved from " + record.folder);
    for (const auto& [name, digest] : shared_)
      if (digest_of(record, name) != digest) why.push_back(name + " changed");
    if (digest_of(record, manifest_name) != manifest_digest)
      why.push_back(std::string(manifest_name) + " changed");
    const std::string prefix = input_name("");
    for (const auto& [name, digest] : record.inputs)
      if (name.starts_with(prefix)) look_at_file(state, name.substr(prefix.size()), digest, why);
    if (in_.force && record.night != in_.night) return "--force";
    look_at_outputs(state, record, why);
    look_at_number(state, record, why);
    std::string words;
    for (const std::string& w : why) words += (words.empty() ? "" : "; ") + w;
    return words;
  }

  void look_at_file(CampaignState& state, const std::string& name, const std::string& digest,
                    std::vector<std::string>& why) const {
    const auto path = path_inside(in_.site / state.folder, name);
    const auto now = path ? sha256_of_file(*path) : fail(path.error());
    if (now) state.readings.push_back(short_digest(*now));
    std::error_code error;
    if (now.value_or(absent) == digest) return;
    if (!now && path && fs::exists(*path, error))
      why.push_back(now.error().message);
    else
      why.push_back("file " + name + (now ? " changed" : " is gone"));
  }

  /// A file of the right size that is not younger than the record was not touched since; of another
  /// one the content decides.
  void look_at_outputs(const CampaignState& state, const Record& record,
                       std::vector<std::string>& why) const {
    const fs::path folder = in_.out / state.id;
    struct stat written {};
    if (::stat((folder / record_name).c_str(), &written) != 0) return;
    for (const RecordedFile& f : record.files) {
      const fs::path path = folder / f.name;
      struct stat now {};
      if (::stat(path.c_str(), &now) != 0)
        why.push_back(f.name + " is missing from the output");
      else if (static_cast<std::uint64_t>(now.st_size) != f.size ||
               ((in_.verify_results || younger(now, written)) &&
                sha256_of_file(path).value_or(absent) != f.sha256))
        why.push_back(f.name + " was changed in the output");
    }
  }

  void look_at_number(const CampaignState& state, const Record& record,
                      std::vector<std::string>& why) const {
    if (in_.numbers && record.draft && !in_.drafts.contains(state.id))
      why.push_back("its draft was released, or the register does not know it");
    const auto number = numbers_.find(record.certificate);
    if (number == numbers_.end() || number->second->in_force()) return;
    why.push_back("its certificate " + record.certificate + " was " + number->second->state);
  }

  static bool younger(const struct stat& a, const struct stat& b) {
    return std::pair(a.st_mtim.tv_sec, a.st_mtim.tv_nsec) >
           std::pair(b.st_mtim.tv_sec, b.st_mtim.tv_nsec);
  }

  const SurveyInput& in_;
  Inputs shared_;
  std::map<std::string, const RegisterEntry*> numbers_;
  mutable std::mutex unknown_guard_;
  mutable std::string unknown_;
  mutable std::mutex twins_guard_;
  mutable std::map<std::string, Twins> twins_then_;  ///< by folder, of the records that have any
};

/// The ids that manifests give, and the digests of their files, with blanks between; each read in
/// full in a process that a parser may bring down or hold up without harm to the night; empty where
/// there is none, or where the process did not come back. Such a campaign is tried again in its
/// worker, which says what happened.
std::vector<std::string> read_ids(std::size_t count,
                                  const std::function<fs::path(std::size_t)>& manifest_of,
                                  const Limits& limits, bool (*stopped)()) {
  constexpr std::size_t most_words = 4000;  // of SharedWords: some sixty files
  static const std::vector<Measurement> no_measurements;
  std::vector<std::string> ids(count);
  const auto read = [&](std::size_t i, bool, SharedWords& words) {
    const auto text = read_file(manifest_of(i));
    const auto manifest = parse_manifest(text.value_or(""), manifest_name);
    std::string said = manifest ? manifest->campaign.id : "";
    std::set<std::string> files;
    for (const Measurement& m : manifest ? manifest->campaign.measurements : no_measurements)
      if (const auto path = path_inside(manifest_of(i).parent_path(), m.file);
          path && files.insert(m.file).second)
        if (const auto digest = sha256_of_file(*path); digest && said.size() < most_words)
          said += " " + *digest;
    words.set(said);
    return Answer::ok;
  };
  const auto limit = std::chrono::duration_cast<Worker::Clock::duration>(
      std::chrono::duration<double>(limits.seconds));
  std::vector<Worker> workers;
  for (std::size_t next = 0; (next < ids.size() || !workers.empty()) && !stopped();) {
    while (workers.size() < Poco::Environment::processorCount() && next < ids.size()) {
      auto worker = Worker::start(read, limits.memory_MB);
      if (!worker) return ids;
      workers.push_back(std::move(*worker));
      workers.back().give(next++, limit);
    }
    wait_for_answer(workers);
    for (std::size_t i = workers.size(); i-- > 0;) {
      const auto answer = workers[i].answer();
      if (!answer && !workers[i].overdue()) continue;
      const bool well = answer == Answer::ok;
      if (well) ids[workers[i].campaign()] = workers[i].stage();
      if (well && !workers[i].grown() && next < ids.size())
        workers[i].give(next++, limit);
      else
        workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  return ids;
}

/// Calls `work` for 0 to `count` - 1 on all cores, until it is stopped; its threads are joined at
/// the return, so that processes may be forked again.
void for_all(std::size_t count, bool (*stopped)(), const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex guard;
  std::exception_ptr thrown;  // out of memory
  const auto run = [&] {
    try {
      for (std::size_t i; !stopped() && (i = next.fetch_add(1)) < count;) work(i);
    } catch (...) {
      const std::lock_guard one(guard);
      thrown = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < Poco::Environment::processorCount(); ++i) helpers.emplace_back(run);
    run();
  }
  if (thrown) std::rethrow_exception(thrown);
}

/// A name taken from a folder gives way to an id that a manifest claims, and to another such name.
void give_way(std::vector<CampaignState>& states) {
  std::set<std::string> taken;
  for (const CampaignState& s : states)
    if (!s.named_by_folder) taken.insert(s.id);
  for (CampaignState& s : states) {
    if (!s.named_by_folder) continue;
    const std::string name = s.id;
    for (int n = 2; !taken.insert(s.id).second; ++n) s.id = name + "." + std::to_string(n);
  }
}

/// Different campaigns with one id: none of them may claim the output folder.
void fail_collisions(std::vector<CampaignState>& states) {
  for (std::size_t i = 0; i < states.size();) {
    std::size_t end = i + 1;
    while (end < states.size() && states[end].id == states[i].id) ++end;
    if (end - i > 1) {
      std::string folders;
      for (std::size_t k = i; k < end; ++k)
        folders += (k == i ? "" : k + 1 == end ? " and " : ", ") + states[k].folder;
      for (std::size_t k = i; k < end; ++k) {
        states[k].action = CampaignState::Action::todo;
        states[k].status = "failed";
        states[k].reason = "no result: its id is not unique";
        states[k].errors = {Error{"campaign.id \"" + states[k].id + "\" is used by " + folders +
                                      "; wanted one id for one campaign",
                                  manifest_name}};
      }
    }
    i = end;
  }
}

Error unknown_number(const std::string& number, const fs::path& out) {
  return Error{"the register of certificates does not know the number " + number + ", which " +
               out.string() +
               " says was issued: restore the register, or numbers would be used twice"};
}

}  // namespace

Expected<void> check_numbers(const fs::path& out, const std::vector<CampaignState>& campaigns,
                             const std::vector<RegisterEntry>& numbers) {
  std::set<std::string> known;
  for (const RegisterEntry& e : numbers) known.insert(e.number);
  for (const CampaignState& c : campaigns)
    if (const auto record = read_record(out / c.id);
        record && !record->certificate.empty() && !known.contains(record->certificate))
      return fail(unknown_number(record->certificate, out));
  return {};
}

Expected<std::vector<CampaignState>> survey(const SurveyInput& input) {
  auto folders = find_campaigns(input.site, input.out, input.notes);
  if (!folders) return fail(folders.error());
  std::vector<CampaignState> states(folders->size());
  const Look look(input);
  struct Unread {
    std::size_t index;
    std::string digest;
  };
  std::vector<Unread> unread;
  std::mutex unread_guard;
  for_all(states.size(), input.stopped, [&](std::size_t i) {
    states[i].folder = std::move((*folders)[i]);
    Unread one{i, {}};
    if (look.at_first(states[i], one.digest)) return;
    const std::lock_guard guard(unread_guard);
    unread.push_back(std::move(one));
  });
  const auto manifest_of = [&](std::size_t i) {
    return input.site / states[unread[i].index].folder / manifest_name;
  };
  const auto ids = read_ids(unread.size(), manifest_of, input.context.site.limits, input.stopped);
  for_all(unread.size(), input.stopped,
          [&](std::size_t i) { look.again(states[unread[i].index], ids[i], unread[i].digest); });
  if (!look.unknown_number().empty()) return fail(unknown_number(look.unknown_number(), input.out));
  give_way(states);
  std::stable_sort(states.begin(), states.end(),
                   [](const CampaignState& a, const CampaignState& b) { return a.id < b.id; });
  fail_collisions(states);
  find_twins(states);
  for (CampaignState& state : states) look.shared_again(state, states);
  return states;
}

}  // namespace nonio::host
