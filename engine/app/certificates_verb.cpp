// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <iostream>
#include <memory>

#include "certificates/certificate_list.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using certificates::RegisterEntry;
using storage::Json;

namespace {

struct CertificateWish {
  std::string site, out, withdraw, why, by;
  bool audit = false;
};

Json to_json(const RegisterEntry& e) {
  Json json = {
      {"number", e.number}, {"state", e.state}, {"campaign", e.campaign}, {"date", e.date}};
  if (!e.replaces.empty()) json["replaces"] = e.replaces;
  if (!e.replaced_by.empty()) json["replaced_by"] = e.replaced_by;
  if (!e.reason.empty()) json["reason"] = e.reason;
  const auto add = [&](const char* key, const std::string& text) {
    if (!text.empty()) json[key] = text;
  };
  add("released_by", e.released_by);
  add("released_account", e.released_account);
  add("released_user", e.released_user);
  add("withdrawn_by", e.withdrawn_by);
  add("withdrawn_account", e.withdrawn_account);
  if (!e.signer.empty()) json["signer"] = {{"subject", e.signer}, {"sha256", e.signer_sha256}};
  return json;
}

/// Examples: "  approved by B. Sample (user sample, account lab@room-3)", "  withdrawn by B. Sample
/// (name not authenticated, account lab@room-3)".
std::string person_text(const config::TerminalWords& say, const char* what, const std::string& by,
                        const std::string& account, const std::string& user = {}) {
  if (by.empty() && account.empty()) return {};
  std::string in = by.empty()     ? ""
                   : user.empty() ? say("certificate.not-authenticated")
                                  : say("certificate.user", {{"user", user}});
  if (!account.empty())
    in += (in.empty() ? "" : ", ") + say("certificate.account", {{"account", account}});
  return "  " + say(what, {{"person", by.empty() ? in : by + " (" + in + ")"}});
}

void print(const RegisterEntry& e, const config::TerminalWords& say) {
  std::string line = e.number + "  " + say.of("certificate.state", e.state);
  if (!e.replaced_by.empty())
    line += ", " + say("certificate.replaced-by", {{"number", e.replaced_by}});
  line +=
      "  " + e.campaign + "  " + e.date + (e.reason.empty() ? "" : "  " + e.reason) +
      person_text(say, "certificate.approved", e.released_by, e.released_account, e.released_user) +
      person_text(say, "certificate.withdrawn", e.withdrawn_by, e.withdrawn_account);
  std::cout << wrapped(line, 0, sentence_width(STDOUT_FILENO), 4);
}

int refuse(const Error& error) { return complain(text_of(error)); }

int audit(const CertificateWish& wanted, const config::Numbering& numbering, const Common& common) {
  const auto found = certificates::audit(wanted.site, numbering);
  if (!found) return refuse(found.error());
  const certificates::Audit& a = *found;
  if (common.json) {
    print_json(Json{{"schema", "nonio-audit/1"},
                    {"sound", a.wrong.empty()},
                    {"register", a.id},
                    {"entries", a.entries},
                    {"certificates", a.certificates},
                    {"files", a.files},
                    {"last_at", a.last_at},
                    {"last_sha256", a.last_sha256},
                    {"wrong", a.wrong}});
  } else {
    const SiteWords words(common, language_at(wanted.site));
    const config::TerminalWords& say = words.get();
    const std::size_t width = sentence_width(STDOUT_FILENO);
    for (const std::string& what : a.wrong) std::cout << say("error") << ": " << what << "\n";
    std::cout << wrapped(
                     say(a.wrong.empty() ? "audit.unchanged" : "audit.changed") + ": " +
                         say("audit.register", {{"id", a.id},
                                                {"entries", std::to_string(a.entries)},
                                                {"certificates", std::to_string(a.certificates)},
                                                {"files", std::to_string(a.files)}}),
                     0, width, 2)
              << wrapped(say("audit.last", {{"at", a.last_at}, {"sha256", a.last_sha256}}), 0,
                         width, 2);
  }
  return a.wrong.empty() ? exit_done : exit_failed;
}

int certificates(const CertificateWish& wanted, const Common& common) {
  if (wanted.withdraw.empty() && !wanted.why.empty())
    return refuse(Error{"--why: expected the number of the certificate to withdraw"});
  const auto numbering = certificates::numbering_of(wanted.site);
  if (!numbering) return refuse(numbering.error());
  if (wanted.audit) return audit(wanted, *numbering, common);
  if (!wanted.withdraw.empty()) {
    const auto done =
        certificates::withdraw(wanted.site, *numbering, wanted.withdraw, wanted.why, wanted.by);
    if (!done) return refuse(done.error());
  }
  const auto entries = certificates::certificates_of(wanted.site, *numbering);
  if (!entries) return refuse(entries.error());
  if (!wanted.out.empty())
    if (auto written = certificates::export_certificates(wanted.site, *numbering, wanted.out);
        !written)
      return refuse(written.error());
  if (common.json) {
    Json all = Json::array();
    for (const RegisterEntry& e : *entries) all.push_back(to_json(e));
    print_json(Json{{"schema", "nonio-certificates/1"}, {"certificates", std::move(all)}});
  } else {
    const SiteWords words(common, language_at(wanted.site));
    for (const RegisterEntry& e : *entries) print(e, words.get());
    if (entries->empty() && !common.quiet) std::cout << words.get()("certificate.none") << "\n";
  }
  return exit_done;
}

}  // namespace

std::vector<Verb> register_verbs(Common& common) {
  auto wanted = std::make_shared<CertificateWish>();
  using Takes = Argument::Takes;
  const Argument site = required(existing(Takes::folder, {"SITE", &wanted->site, "The site"}));
  const Argument why{"--why", &wanted->why, "Reason of the withdrawal, kept in the register"};
  const Argument by{"--by", &wanted->by, "Name of the person, kept in the register"};
  const auto former = [](Argument a) {
    a.hidden = true;
    return a;
  };
  const auto run = [wanted, &common] { return certificates(*wanted, common); };
  Verb list{
      .name = "list",
      .summary = "Shows the certificate register of a site: numbers, states, files",
      .arguments = joined(
          {site,
           takes(Takes::folder, {"--out", &wanted->out,
                                 "Write the issued files of all numbers into this folder: "
                                 "NUMBER.pdf and NUMBER-dcc.xml. It restores a lost certificate"}),
           former({"--withdraw", &wanted->withdraw, ""}), former(why), former(by),
           former({"--audit", &wanted->audit, ""})},
          common_arguments(common)),
      .footer =
          "Prints one line per number: number, state, campaign, date, reason, who approved or "
          "withdrew it. The name is the stated name; the account is that of the operating system "
          "(user@host). Neither authenticates the person.\n  issued     in force\n  amended    "
          "replaced by another number, because the data changed\n  withdrawn  no longer in force, "
          "with the reason\n  reserved   not issued, with the reason; the next run uses it for the "
          "same campaign\nEntries are never deleted, and the same data are never issued twice. "
          "Include the register (certificates.sqlite in the site) in your backups: without it, "
          "numbers would be used twice, so the nightly run stops.",
      .examples = {"nonio certificate list site"},
      .run = run};
  Verb withdraw{
      .name = "withdraw",
      .summary = "Withdraws a certificate",
      .arguments = joined(
          {site,
           required({"NUMBER", &wanted->withdraw, "Number of the certificate, such as 2026-0012"}),
           required(why), by},
          common_arguments(common)),
      .footer =
          "The next nightly run makes a draft of a new certificate, which states this "
          "number and the reason.",
      .examples = {"nonio certificate withdraw site 2026-0012 --why \"wrong serial "
                   "number\" --by \"B. Sample\""},
      .run = run};
  Verb audit{.name = "audit",
             .summary = "Checks that nothing in the register was changed or removed",
             .arguments = joined({site}, common_arguments(common)),
             .footer =
                 "Checks the chain of digests, every file, and the digests in signed certificates. "
                 "It cannot detect that the last entries were removed: note the last entry that it "
                 "prints. Exit status 1 if a check fails.",
             .examples = {"nonio certificate audit site"},
             .run = [wanted, run] {
               wanted->audit = true;
               return run();
             }};
  return {std::move(list), std::move(withdraw), std::move(audit)};
}

}  // namespace nonio::app
