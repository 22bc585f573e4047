// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "batch/release/release.h"
#include "platform/storage/json_values.h"
#include "progress.h"
#include "questions.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using batch::Released;
using certificates::WaitingDraft;
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct ReleaseVerbWish {
  std::string folder, by, user, role, out;
  std::vector<std::string> reasons;
  bool list = false;
};

std::string reason_of(const WaitingDraft& draft, const evaluation::KnownFinding& finding) {
  if (!draft.author) return {};
  const auto given = draft.author->reasons.find(certificates::finding_key(finding));
  return given == draft.author->reasons.end() ? "" : given->second;
}

Json draft_json(const WaitingDraft& draft, bool waits = true) {
  Json json = {{"campaign", draft.campaign},
               {"folder", draft.folder},
               {"file", batch::file_of(draft).string()}};
  if (!draft.replaces.empty()) json["replaces"] = draft.replaces;
  if (const std::string why = waits ? batch::why_stale(draft) : ""; !why.empty())
    json["stale"] = why;
  if (draft.author) json["author"] = {{"name", draft.author->by}, {"at", draft.author->at}};
  Json findings = Json::array();
  for (const evaluation::KnownFinding& f : draft.findings) {
    Json one = {{"id", f.id},
                {"measurement", f.measurement},
                {"severity", f.attention ? "attention" : "info"},
                {"title", f.title}};
    if (!f.said.empty()) one["said"] = f.said;
    if (const std::string reason = reason_of(draft, f); !reason.empty()) one["reason"] = reason;
    findings.push_back(std::move(one));
  }
  json["findings"] = std::move(findings);
  return json;
}

void print(std::ostream& out, const WaitingDraft& draft, const config::TerminalWords& say) {
  out << draft.campaign << "  " << batch::file_of(draft).string();
  if (!draft.replaces.empty()) out << "  " << say("replaces", {{"number", draft.replaces}});
  if (draft.author)
    out << "  "
        << say("certificate.approved", {{"person", draft.author->by + " " + draft.author->at}});
  out << "\n";
  if (!batch::why_stale(draft).empty()) out << "  " << say("approve.stale") << "\n";
  for (const evaluation::KnownFinding& f : draft.findings) {
    out << "  " << padded(say.of("severity", f.attention ? "attention" : "info"), 11)
        << certificates::finding_key(f) << "  " << f.heading();
    if (const std::string reason = reason_of(draft, f); !reason.empty())
      out << "  (" << reason << ")";
    out << "\n";
  }
}

std::string dumped(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

int list_drafts(const ReleaseVerbWish& wish, const Common& common) {
  const auto drafts = batch::waiting_drafts(wish.folder);
  if (!drafts) return complain(text_of(drafts.error()));
  if (common.json) {
    Json all = Json::array();
    for (const WaitingDraft& d : *drafts) all.push_back(draft_json(d));
    std::cout << dumped({{"schema", "nonio-drafts/1"}, {"drafts", std::move(all)}}) << "\n";
    return exit_done;
  }
  const SiteWords words(common, language_at(wish.folder));
  for (const WaitingDraft& d : *drafts) print(std::cout, d, words.get());
  if (drafts->empty() && !common.quiet) std::cout << words.get()("approve.none") << "\n";
  return exit_done;
}

Json released_json(const Released& done) {
  constexpr const char* states[] = {"refused", "lacking", "approved", "failed", "issued"};
  Json json = {{"schema", "nonio-release/1"}, {"state", states[static_cast<int>(done.state)]}};
  if (done.draft) json["draft"] = draft_json(*done.draft, done.state != Released::State::issued);
  if (!done.without_reason.empty()) json["without_reason"] = done.without_reason;
  if (!done.why.empty()) json["why"] = done.why;
  if (done.state == Released::State::issued) {
    json["number"] = done.entry.number;
    json["date"] = done.entry.date;
    json["files"] = Json::array();
    for (const fs::path& f : done.files) json["files"].push_back(f.string());
  }
  return json;
}

int tell(const Released& done, const ReleaseVerbWish& wish, const Common& common) {
  using State = Released::State;
  const SiteWords words(common, language_at(wish.folder));
  const config::TerminalWords& say = words.get();
  if (common.json) std::cout << dumped(released_json(done)) << "\n";
  for (const std::string& note : done.notes)
    if (!common.quiet) complain(note);
  switch (done.state) {
    case State::refused:
      return complain(done.why);
    case State::lacking:
      if (!common.json) print(std::cerr, *done.draft, say);
      for (const std::string& key : done.without_reason)
        complain(say("approve.needs-reason", {{"finding", key}}));
      complain(say("approve.repeat", {{"finding", done.without_reason.front()}}));
      return exit_failed;
    case State::approved:
      if (!common.json)
        std::cout << say("approve.signed-off", {{"campaign", done.draft->campaign},
                                                {"by", done.by},
                                                {"folder", wish.folder}})
                  << "\n";
      return exit_done;
    case State::failed:
      return complain(done.why + " (nothing was issued by this command)", exit_failed);
    case State::issued:
      break;
  }
  if (!common.json) {
    std::cout << say("approve.issued", {{"number", done.entry.number},
                                        {"campaign", done.draft->campaign},
                                        {"by", done.by}})
              << "\n";
    for (const fs::path& f : done.files) std::cout << "  " << f.string() << "\n";
  }
  if (!done.why.empty())
    complain(done.why + " (issued; the next run writes its files)", exit_failed);
  return done.why.empty() ? exit_done : exit_failed;
}

int release(const ReleaseVerbWish& wish, const Common& common) {
  if (wish.list) return list_drafts(wish, common);
  if (wish.by.empty() && wish.user.empty())
    return complain("state who approves it: --by NAME or --user ACCOUNT; --list lists the drafts");
  batch::ReleaseRequest wanted{wish.folder, wish.by, wish.role, {}, wish.out, wish.user};
  for (const std::string& given : wish.reasons) {
    const std::size_t equals = given.find('=');
    if (equals == std::string::npos || equals == 0)
      return complain("--reason wants FINDING=TEXT, found \"" + given + "\"");
    wanted.reasons.emplace(given.substr(0, equals), given.substr(equals + 1));
  }
  if (!wish.user.empty()) {
    auto password = read_password(wish.user);
    if (!password) return complain(text_of(password.error()));
    wanted.password = *std::move(password);
  }
  batch::RunOptions base;
  base.jobs = 1;
  base.plugin_folders = common.plugin_folders();
  base.own_plugins = Common::own_plugins();
  base.template_folders = common.template_folders();
  base.version = NONIO_VERSION;
  Progress progress(common, true, false);
  return tell(batch::release(wanted, base, progress.events()), wish, common);
}

}  // namespace

Verb approve_verb(Common& common) {
  auto wanted = std::make_shared<ReleaseVerbWish>();
  using Takes = Argument::Takes;
  return {
      .name = "approve",
      .summary = "Issues a certificate from the draft of a nightly run",
      .arguments = joined(
          {required(existing(Takes::folder, {"CAMPAIGN", &wanted->folder,
                                             "Folder of the campaign; with --list also a site"})),
           {"--by", &wanted->by,
            "Name of the person who approves it, printed on the certificate. It is a statement, "
            "not an authentication; the register also keeps the account (user@host)"},
           {"--user", &wanted->user,
            "Instead of --by: account of SITE/users.toml with the role approve; its name is "
            "printed. "
            "Its password is read from the terminal, or from a line of standard input; the "
            "register "
            "keeps the account, and two of them are two persons"},
           one_of(
               {"author", "authoriser"},
               {"--as", &wanted->role,
                "author: signs off the draft; an authoriser then approves it. Default: author if "
                "the site requires two persons, otherwise authoriser"}),
           {"--reason", &wanted->reasons,
            "FINDING=TEXT: reason why the certificate may be issued in spite of this finding. "
            "FINDING as printed by --list, or its id for all measurements"},
           {"--list", &wanted->list,
            "List the drafts that wait for approval, with their findings; approve nothing"},
           takes(Takes::folder,
                 {"--out", &wanted->out, "Output folder of the nightly run, if it was moved"}),
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "The nightly run makes a draft: OUT/CAMPAIGN/certificate-draft.pdf, marked on every "
          "page, without number and signature. Read the draft, check the findings, and approve it. "
          "The certificate then gets a number, is signed, and is entered into the register of the "
          "site with your name, the time and the reasons. If data, plugins or templates have "
          "changed since the draft was made, repeat the nightly run first. Exit status 1 if a "
          "reason is missing.",
      .examples = {"nonio certificate approve site/c1 --by \"B. Sample\" --reason \"X: "
                   "drift=agreed with the customer\""},
      .run = [wanted, &common] { return release(*wanted, common); }};
}

}  // namespace nonio::app
