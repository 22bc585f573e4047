// SPDX-License-Identifier: Apache-2.0
#include "batch/release/release.h"

#include <algorithm>

#include "batch/close/history_update.h"
#include "batch/state/output_lock.h"
#include "batch/survey/twins.h"
#include "batch/workers/runner.h"
#include "batch/workers/set_up.h"
#include "campaign/config/site_files.h"
#include "campaign/evaluation/record.h"
#include "certificates/certificate_list.h"
#include "certificates/journal.h"
#include "certificates/register_place.h"
#include "certificates/users.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr const char* author = "author";
constexpr const char* authoriser = "authoriser";

std::string plain_name(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool blank = c == ' ' || c == '\t';
    if (blank && (out.empty() || out.back() == ' ')) continue;
    out += blank ? ' ' : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

std::vector<std::string> persons_in(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    if (std::string name = plain_name(text.substr(at, end - at)); !name.empty())
      out.push_back(std::move(name));
    at = end + 1;
  }
  return out;
}

bool is_one_line(const std::string& text) {
  return std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
}

std::string mistake_in(const ReleaseRequest& request) {
  if (const std::string mistake = certificates::mistake_in_name(request.by); !mistake.empty())
    return "--by: " + mistake;
  for (const auto& [finding, reason] : request.reasons)
    if (!has_content(reason) || !is_one_line(reason))
      return "the reason for " + finding +
             " is empty or has a control character; expected one line of text";
  return {};
}

Expected<std::map<std::string, std::string>> reasons_for(const certificates::WaitingDraft& draft,
                                                         const ReleaseRequest& request) {
  std::map<std::string, std::string> reasons;
  std::string known;
  for (const evaluation::KnownFinding& f : draft.findings) {
    known += (known.empty() ? "" : ", ") + certificates::finding_key(f);
  }
  for (const auto& [name, text] : request.reasons) {
    const std::string given = name + "=" + text;
    bool found = false;
    for (const evaluation::KnownFinding& f : draft.findings)
      for (const std::string& key : {f.id, certificates::finding_key(f)})
        if (given.starts_with(key + "=")) {
          const std::string reason = given.substr(key.size() + 1);
          if (key == f.id)
            reasons.try_emplace(certificates::finding_key(f), reason);
          else
            reasons[key] = reason;
          found = true;
        }
    if (!found)
      return fail("the draft has no finding " + name + "; it has " +
                  (known.empty() ? "none" : known));
  }
  return reasons;
}

class Releaser {
 public:
  Releaser(ReleaseRequest request, const RunOptions& base, const RunEvents& events)
      : request_(std::move(request)), options_(base), events_(events) {}

  Released run() {
    if (auto well = open_campaign(); !well) return refuse(well.error().message);
    out_.by = request_.by;
    if (auto well = open_draft(); !well) return refuse(well.error().message);
    if (auto well = take_output(); !well) return refuse(well.error().message);
    const certificates::WaitingDraft& draft = *out_.draft;
    auto reasons = reasons_for(draft, request_);
    if (!reasons) return refuse(reasons.error().message);
    const certificates::Approval approval{.by = request_.by,
                                          .role = role_,
                                          .at = certificates::utc_now(),
                                          .reasons = std::move(*reasons),
                                          .user = request_.user};
    for (const evaluation::KnownFinding& f : draft.findings) {
      const auto has = [&](const certificates::Approval& a) {
        return a.reasons.contains(certificates::finding_key(f));
      };
      if (f.attention && !has(approval) && !(draft.author && has(*draft.author)))
        out_.without_reason.push_back(certificates::finding_key(f));
    }
    if (!out_.without_reason.empty()) {
      out_.state = Released::State::lacking;
      return std::move(out_);
    }
    if (role_ == author) return approve(approval);
    return issue(approval);
  }

 private:
  Released refuse(std::string why) {
    out_.state = Released::State::refused;
    out_.why = std::move(why);
    return std::move(out_);
  }

  /// Checks password and role of the account `--user` and sets the name of the person from
  /// users.toml.
  Expected<void> identify() {
    if (request_.user.empty()) return no_user_is_named();
    if (!request_.by.empty()) return fail("--by and --user: expected one of them");
    NONIO_TRY(const auto users, certificates::read_users(options_.site));
    const auto user = certificates::user_with(users, request_.user);
    const bool fits =
        certificates::fits_password(request_.password, user ? user->password : std::string());
    request_.password.clear();
    if (!fits)
      return fail("--user " + request_.user + ": not a user of users.toml, or another password");
    if (user->role < certificates::Role::approve)
      return fail("--user " + request_.user + ": the role " + certificates::to_text(user->role) +
                  " of users.toml does not allow to approve");
    request_.by = user->name;
    return {};
  }

  /// Returns an error if `--by` names a user with a password, who must use `--user`.
  Expected<void> no_user_is_named() const {
    if (!certificates::has_users(options_.site)) return {};
    NONIO_TRY(const auto users, certificates::read_users(options_.site));
    for (const certificates::User& user : users)
      if (!user.password.empty() &&
          certificates::likeness_of(user.name) == certificates::likeness_of(request_.by))
        return fail("--by " + request_.by +
                    ": this user of users.toml has a password; expected --user " + user.account);
    return {};
  }

  Expected<void> open_campaign() {
    options_.site = config::site_of(request_.campaign);
    if (auto well = identify(); !well) return well;
    if (const std::string mistake = mistake_in(request_); !mistake.empty()) return fail(mistake);
    auto text = storage::read_file(request_.campaign / config::manifest_name);
    if (!text) return fail(text.error().message + ": it is not the folder of a campaign");
    const auto manifest = config::parse_without_methods(*text, config::manifest_name);
    if (!manifest) {
      const Error& e = manifest.error().front();
      return fail(e.file + ":" + std::to_string(e.line) + ": " + e.message);
    }
    id_ = manifest->campaign.id;
    const auto numbering = certificates::numbering_of(options_.site);
    if (!numbering) return fail("site.toml: " + numbering.error().message);
    numbering_ = *numbering;
    role_ = !request_.role.empty() ? request_.role : numbering_.two_persons ? author : authoriser;
    return role_ == authoriser ? may_authorise() : Expected<void>{};
  }

  Expected<void> may_authorise() const {
    std::string digest;
    const auto site = config::read_site(options_.site, digest);
    if (!site) return fail("site.toml: " + site.error().front().message);
    const auto persons = persons_in(site->laboratory.authoriser);
    if (persons.empty() ||
        std::find(persons.begin(), persons.end(), plain_name(request_.by)) != persons.end())
      return {};
    return fail("--by \"" + request_.by +
                "\" is not an authoriser of this laboratory: site.toml, "
                "laboratory.authoriser, names " +
                site->laboratory.authoriser);
  }

  Expected<void> open_draft() {
    const std::string none = "nothing of campaign " + id_ +
                             " waits for approval; a draft is made by `nonio run SITE --out OUT`";
    NONIO_TRY(const auto place, certificates::register_place(options_.site, numbering_));
    NONIO_TRY(const auto there, certificates::has_register(place, numbering_.patience));
    if (!there) return fail(none);
    NONIO_TRY(auto opened, certificates::Register::open(options_.site, numbering_));
    if (auto sound = opened.check_journal(true); !sound) return fail(sound.error());
    NONIO_TRY(auto draft, opened.draft(id_));
    NONIO_TRY(auto last, opened.last_number(id_));
    if (last) last_number_ = last->number;
    if (!draft) return fail(last ? none_but(opened, *last) : none);
    out_.draft = std::move(draft);
    seen_ = *out_.draft;
    std::error_code error;
    const fs::path folder = fs::canonical(request_.campaign, error)
                                .lexically_relative(fs::canonical(options_.site, error));
    if (folder.generic_string() != out_.draft->folder)
      return fail("the draft of " + id_ + " was made from the folder " + out_.draft->folder +
                  ", not from " + folder.generic_string());
    const auto& by_author = out_.draft->author;
    if (numbering_.two_persons && role_ == authoriser) {
      if (!by_author)
        return fail(
            "two_persons = true in site.toml: the author has to approve it first "
            "(nonio certificate approve CAMPAIGN --by NAME --as author)");
      if (certificates::likeness_of(by_author->by) == certificates::likeness_of(request_.by))
        return fail("two_persons = true in site.toml: " + by_author->by +
                    " is the author; expected another person as authoriser");
      // A name does not prove identity: two persons need two passwords or two accounts.
      const bool two_users = !by_author->user.empty() && !request_.user.empty();
      if (by_author->user.empty() != request_.user.empty())
        return fail(
            "two_persons = true in site.toml: one of the two stated a password, the other only a "
            "name; expected --user of both, or of none");
      if (!two_users && !certificates::is_own_account_certain())
        return fail(
            "two_persons = true in site.toml: this process has user numbers of its own (a user "
            "namespace), so that accounts are no proof; expected --user of both");
      // Only the login is compared, because the name of a host can be changed easily.
      const auto login = [](const std::string& account) {
        return account.substr(0, account.find('@'));
      };
      if (two_users ? by_author->user == request_.user
                    : login(by_author->account) == login(certificates::own_account()))
        return fail("two_persons = true in site.toml: the author approved it under this account, " +
                    (two_users ? by_author->user : by_author->account) +
                    "; the authoriser needs an account of their own");
    }
    return {};
  }

  std::string none_but(certificates::Register& opened,
                       const certificates::RegisterEntry& last) const {
    const auto first = opened.approval_of(last.number).value_or(std::nullopt);
    return "no draft of campaign " + id_ + " waits for approval; " + last.number + " of " +
           last.date + " is its last certificate" +
           (first ? ", approved by " + first->by + " at " + first->at : "") +
           "; if its files are missing, the next run writes them";
  }

  /// Checks that the draft file is that of the register, locks the output folder, and reads from
  /// the record the run and the other campaigns with the same readings.
  Expected<void> take_output() {
    if (!request_.out.empty()) out_.draft->out = fs::absolute(request_.out).string();
    options_.out = out_.draft->out;
    if (const std::string why = why_stale(*out_.draft); !why.empty()) return fail(why);
    NONIO_TRY(auto taken, OutputLock::take(options_.out));
    lock_.emplace(std::move(taken));
    const fs::path results = storage::results_folder(options_.out, id_);
    auto record = evaluation::read_record(results);
    if (!record) return fail("no result of a run in " + results.string());
    run_.number = record->run;
    twins_ = twins_of(record->inputs);
    return {};
  }

  Released approve(const certificates::Approval& approval) {
    auto opened = certificates::Register::open(options_.site, numbering_);
    if (!opened) return refuse(opened.error().message);
    if (auto done = opened->approve(seen_, approval); !done) return fail_with(done.error().message);
    out_.state = Released::State::approved;
    return std::move(out_);
  }

  Released issue(const certificates::Approval& approval) {
    auto place = set_up(options_);
    if (!place) return refuse(place.error().message);
    out_.notes = (*place)->notes;
    if (!(*place)->signer) return refuse("site.toml does not contain a key; expected [signing]");
    if (!(*place)->no_key.empty()) return refuse((*place)->no_key);
    const certificates::Releasing releasing{seen_, approval, twins_};
    ReleaseDesk desk{&*(*place)->signer, &releasing, {}, &*(*place)->host};
    // The next run adds campaigns that the store does not contain yet.
    if (auto bases = assessment::history_bases(options_.out, {id_}); bases)
      for (assessment::HistoryBasis& b : *bases) desk.histories.emplace(id_, std::move(b));
    CampaignState campaign;
    campaign.id = id_;
    campaign.folder = out_.draft->folder;
    campaign.reason = "approved by " + request_.by;
    std::vector<CampaignState> campaigns{campaign};
    HistoryUpdate history(options_, (*place)->context);
    if (const auto begun = history.begin(); !begun) return fail_with(begun.error().message);
    if (!do_campaigns(options_, events_, (*place)->context, run_, desk, campaigns))
      return fail_with("interrupted");
    // If the store cannot be updated now, the next run updates it.
    [[maybe_unused]] const auto entered =
        history.end({id_}, read_records(options_, (*place)->context));
    auto opened = certificates::Register::open(options_.site, numbering_);
    if (!opened) return fail_with(opened.error().message);
    auto last = opened->last_number(id_);
    if (!last || !*last || (*last)->number == last_number_)
      return fail_with(campaigns.front().errors.empty() ? "nothing was issued"
                                                        : campaigns.front().errors.front().message);
    // Another person may have approved the draft first.
    const auto first = opened->approval_of((*last)->number);
    if (!first) return fail_with(first.error().message);
    if (!*first || (*first)->by != approval.by || (*first)->at != approval.at ||
        (*first)->reasons != approval.reasons)
      return fail_with(campaigns.front().errors.empty()
                           ? (*last)->number + " was issued first by another person"
                           : campaigns.front().errors.front().message);
    out_.entry = std::move(**last);
    out_.state = Released::State::issued;
    if (const auto files = opened->files(out_.entry.number))
      for (const evaluation::IssuedFile& f : *files)
        out_.files.push_back(storage::own_folder(options_.out, id_) / f.name);
    if (!campaigns.front().errors.empty()) out_.why = campaigns.front().errors.front().message;
    return std::move(out_);
  }

  Released fail_with(std::string why) {
    out_.state = Released::State::failed;
    out_.why = std::move(why);
    return std::move(out_);
  }

  ReleaseRequest request_;
  RunOptions options_;
  const RunEvents& events_;
  config::Numbering numbering_;
  RunState run_;
  std::optional<OutputLock> lock_;
  std::string id_, role_, last_number_;
  certificates::WaitingDraft seen_;
  reading::Twins twins_;
  Released out_;
};

}  // namespace

fs::path file_of(const certificates::WaitingDraft& draft) {
  return storage::results_folder(draft.out, draft.campaign) / draft.file;
}

std::string why_stale(const certificates::WaitingDraft& draft) {
  const fs::path file = file_of(draft);
  const auto now = storage::sha256_of_file(file);
  if (now && *now == draft.sha256) return {};
  return "the draft " + file.string() +
         (now ? " has changed since the last run" : " is not there") +
         ": run `nonio run` again (or name its output folder with --out, if that was moved)";
}

Released release(const ReleaseRequest& request, const RunOptions& base, const RunEvents& events) {
  return Releaser(request, base, events).run();
}

Expected<std::vector<certificates::WaitingDraft>> waiting_drafts(const fs::path& folder) {
  const fs::path site = config::site_of(folder);
  NONIO_TRY(const auto numbering, certificates::numbering_of(site));
  auto drafts = certificates::Register::drafts(site, numbering);
  std::error_code error;
  if (!drafts || !fs::exists(folder / config::manifest_name, error)) return drafts;
  const std::string own =
      fs::canonical(folder, error).lexically_relative(fs::canonical(site, error)).generic_string();
  std::erase_if(*drafts, [&](const certificates::WaitingDraft& d) { return d.folder != own; });
  return drafts;
}

}  // namespace nonio::batch
