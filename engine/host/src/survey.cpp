// SPDX-License-Identifier: Apache-2.0
#include "survey.h"

#include <Poco/Environment.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "nonio/host/digest.h"
#include "nonio/host/files.h"

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
  explicit Look(const SurveyInput& input) : in_(input), shared_(shared_inputs(input.context)) {}

  CampaignState at(const std::string& folder) const {
    CampaignState state;
    state.folder = folder;
    const auto text = read_file(in_.site / folder / manifest_name);
    if (!text) {
      state.id = folder_id(folder);
      state.reason = "no earlier result";
      state.named_by_folder = true;
      return state;
    }
    const std::string digest = sha256(*text);
    state.id = salvage_id(*text);
    std::optional<Record> record = record_of(state.id);
    if (!record || record->folder != folder || digest_of(*record, manifest_name) != digest) {
      // The quick look is only believed where a full one said the same before.
      if (const auto manifest = parse_manifest(*text, manifest_name); manifest)
        state.id = manifest->campaign.id;
      state.named_by_folder = state.id.empty();
      if (state.id.empty()) state.id = folder_id(folder);
      record = record_of(state.id);
    }
    judge(state, record, digest);
    return state;
  }

 private:
  std::optional<Record> record_of(const std::string& id) const {
    if (id.empty()) return std::nullopt;
    auto record = read_record(in_.out / id);
    return record ? std::optional(std::move(*record)) : std::nullopt;
  }

  static std::string digest_of(const Record& record, const std::string& name) {
    for (const auto& [known, digest] : record.inputs)
      if (known == name) return digest;
    return {};
  }

  void judge(CampaignState& state, const std::optional<Record>& record,
             const std::string& manifest_digest) const {
    if (!record) {
      state.reason = "no earlier result";
      return;
    }
    const bool tonight = record->night == in_.night;
    state.reason = in_.force && !tonight ? "--force" : changes(state, *record, manifest_digest);
    if (!state.reason.empty()) return;
    state.action = tonight ? CampaignState::Action::done : CampaignState::Action::unchanged;
    state.reason = tonight ? record->reason : "nothing changed";
    state.status = record->status;
    state.errors = record->errors;
  }

  std::string changes(const CampaignState& state, const Record& record,
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
    for (const std::string& name : record.files) {
      std::error_code error;
      if (!fs::exists(in_.out / state.id / name, error))
        why.push_back(name + " is missing from the output");
    }
    std::string words;
    for (const std::string& w : why) words += (words.empty() ? "" : "; ") + w;
    return words;
  }

  void look_at_file(const CampaignState& state, const std::string& name, const std::string& digest,
                    std::vector<std::string>& why) const {
    const auto path = path_inside(in_.site / state.folder, name);
    const auto now = path ? sha256_of_file(*path) : fail(path.error());
    if (now.value_or(absent) != digest)
      why.push_back("file " + name + (now ? " changed" : " is gone"));
  }

  const SurveyInput& in_;
  Inputs shared_;
};

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

}  // namespace

Expected<std::vector<CampaignState>> survey(const SurveyInput& input) {
  const auto folders = find_campaigns(input.site, input.out, input.notes);
  if (!folders) return fail(folders.error());
  std::vector<CampaignState> states(folders->size());
  const Look look(input);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next.fetch_add(1)) < folders->size();)
      states[i] = look.at((*folders)[i]);
  };
  {
    // Joined before any campaign is forked.
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < Poco::Environment::processorCount(); ++i) helpers.emplace_back(work);
    work();
  }
  give_way(states);
  std::stable_sort(states.begin(), states.end(),
                   [](const CampaignState& a, const CampaignState& b) { return a.id < b.id; });
  fail_collisions(states);
  return states;
}

}  // namespace nonio::host
