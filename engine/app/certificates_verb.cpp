// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/certificates/certificate_list.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
using host::certificates::RegisterEntry;

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
  add("withdrawn_by", e.withdrawn_by);
  add("withdrawn_account", e.withdrawn_account);
  return json;
}

/// "  released by B. Sample (account lab@room-3)": the name as it was said, the account as the
/// operating system knows it.
std::string person_text(const char* what, const std::string& by, const std::string& account) {
  if (by.empty() && account.empty()) return {};
  return std::string("  ") + what + (by.empty() ? "" : " by " + by) +
         (account.empty() ? "" : " (account " + account + ")");
}

void print(const RegisterEntry& e) {
  std::cout << e.number << "  " << e.state;
  if (!e.replaced_by.empty())
    std::cout << (e.state == "amended" ? " by " : ", replaced by ") << e.replaced_by;
  std::cout << "  " << e.campaign << "  " << e.date << (e.reason.empty() ? "" : "  " + e.reason)
            << person_text("released", e.released_by, e.released_account)
            << person_text("withdrawn", e.withdrawn_by, e.withdrawn_account) << "\n";
}

int refuse(const Error& error) {
  std::cerr << "nonio certificates: " << (error.file.empty() ? "" : error.file + ": ")
            << error.message << "\n";
  return exit_usage;
}

int audit(const CertificateWish& wanted, const host::config::Numbering& numbering,
          const Common& common) {
  const auto found = host::certificates::audit(wanted.site, numbering);
  if (!found) return refuse(found.error());
  const host::certificates::Audit& a = *found;
  if (common.json) {
    std::cout
        << Json{{"schema", "nonio-audit/1"}, {"sound", a.wrong.empty()},       {"register", a.id},
                {"entries", a.entries},      {"certificates", a.certificates}, {"files", a.files},
                {"last_at", a.last_at},      {"last_sha256", a.last_sha256},   {"wrong", a.wrong}}
               .dump(1, ' ', false, Json::error_handler_t::replace)
        << "\n";
  } else {
    for (const std::string& what : a.wrong) std::cout << "WRONG: " << what << "\n";
    std::cout << "register " << a.id << ": " << a.entries << " entries, " << a.certificates
              << " certificates, " << a.files << " files\n"
              << "last entry " << a.last_at << ", SHA-256 " << a.last_sha256 << "\n"
              << (a.wrong.empty()
                      ? "nothing was changed, nothing was taken out before the last entry"
                      : "this is not the register as it was written")
              << "\n";
  }
  return a.wrong.empty() ? exit_done : exit_failed;
}

int certificates(const CertificateWish& wanted, const Common& common) {
  if (wanted.withdraw.empty() != wanted.why.empty())
    return refuse(Error{"--withdraw NUMBER and --why TEXT go together"});
  const auto numbering = host::certificates::numbering_of(wanted.site);
  if (!numbering) return refuse(numbering.error());
  if (wanted.audit) return audit(wanted, *numbering, common);
  if (!wanted.withdraw.empty()) {
    const auto done = host::certificates::withdraw(wanted.site, *numbering, wanted.withdraw,
                                                   wanted.why, wanted.by);
    if (!done) return refuse(done.error());
  }
  const auto entries = host::certificates::certificates_of(wanted.site, *numbering);
  if (!entries) return refuse(entries.error());
  if (!wanted.out.empty())
    if (auto written = host::certificates::export_certificates(wanted.site, *numbering, wanted.out);
        !written)
      return refuse(written.error());
  if (common.json) {
    Json all = Json::array();
    for (const RegisterEntry& e : *entries) all.push_back(to_json(e));
    std::cout << Json{{"schema", "nonio-certificates/1"}, {"certificates", std::move(all)}}.dump(
                     1, ' ', false, Json::error_handler_t::replace)
              << "\n";
  } else {
    for (const RegisterEntry& e : *entries) print(e);
    if (entries->empty() && !common.quiet) std::cout << "no number was drawn yet\n";
  }
  return exit_done;
}

}  // namespace

Verb certificates_verb(Common& common) {
  auto wanted = std::make_shared<CertificateWish>();
  using Takes = Argument::Takes;
  return {
      .name = "certificates",
      .summary = "The site's register of certificates: numbers, what became of them, files",
      .arguments = joined(
          {required(existing(Takes::folder, {"SITE", &wanted->site, "Site whose register it is"})),
           takes(Takes::folder,
                 {"--out", &wanted->out,
                  "Write the files of all issued numbers into this folder, as they were issued:\n"
                  "NUMBER.pdf and NUMBER-dcc.xml"}),
           {"--withdraw", &wanted->withdraw,
            "This number is not in force any more; the next run makes a draft of the campaign's\n"
            "certificate, which gets a new number and names this one and the reason"},
           {"--why", &wanted->why, "Why it is withdrawn: stays in the register"},
           {"--by", &wanted->by, "Who withdraws it: stays in the register"},
           {"--audit", &wanted->audit,
            "Prove that nothing was changed in the register and nothing taken out: the chain of\n"
            "digests, every file, and what signed certificates say of it. Status 1 if not"}},
          common_arguments(common)),
      .footer =
          "A line for each number that was ever drawn: number, state, campaign, date, reason, who\n"
          "released or withdrew it. The name is what that person stated, the account is the "
          "operating\n"
          "system's (user@host): a record, not a proof of the person.\n"
          "  issued     in force\n"
          "  amended    replaced by another number, because the data changed\n"
          "  withdrawn  taken back, with the reason\n"
          "  drawn      not issued, with the reason; the next run uses it for the same campaign\n"
          "Nothing is ever deleted, and the same data are never issued twice: if a certificate is\n"
          "lost, --out gives it back. What is cut off at the end of a register shows only in what "
          "is\n"
          "outside of it: note the last entry that --audit prints. Keep the register "
          "(certificates.sqlite in the site) with "
          "your\n"
          "backups: without it numbers would be used twice, and a run refuses.\n\n"
          "Example: nonio certificates site --withdraw 2026-0012 --why \"wrong serial number\"",
      .run = [wanted, &common] { return certificates(*wanted, common); }};
}

}  // namespace nonio::app
