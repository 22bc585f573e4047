// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "nonio/host/certificate_list.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
using host::RegisterEntry;

namespace {

struct CertificateWish {
  std::string site, out, withdraw, why;
};

Json to_json(const RegisterEntry& e) {
  Json json = {
      {"number", e.number}, {"state", e.state}, {"campaign", e.campaign}, {"date", e.date}};
  if (!e.replaces.empty()) json["replaces"] = e.replaces;
  if (!e.replaced_by.empty()) json["replaced_by"] = e.replaced_by;
  if (!e.reason.empty()) json["reason"] = e.reason;
  return json;
}

void print(const RegisterEntry& e) {
  std::cout << e.number << "  " << e.state;
  if (!e.replaced_by.empty())
    std::cout << (e.state == "amended" ? " by " : ", replaced by ") << e.replaced_by;
  std::cout << "  " << e.campaign << "  " << e.date << (e.reason.empty() ? "" : "  " + e.reason)
            << "\n";
}

int refuse(const Error& error) {
  std::cerr << "nonio certificates: " << (error.file.empty() ? "" : error.file + ": ")
            << error.message << "\n";
  return exit_usage;
}

int certificates(const CertificateWish& wanted, const Common& common) {
  if (wanted.withdraw.empty() != wanted.why.empty())
    return refuse(Error{"--withdraw NUMBER and --why TEXT go together"});
  const auto numbering = host::numbering_of(wanted.site);
  if (!numbering) return refuse(numbering.error());
  if (!wanted.withdraw.empty()) {
    const auto done = host::withdraw(wanted.site, *numbering, wanted.withdraw, wanted.why);
    if (!done) return refuse(done.error());
  }
  const auto entries = host::Register::entries(wanted.site, *numbering);
  if (!entries) return refuse(entries.error());
  if (!wanted.out.empty())
    if (auto written = host::export_certificates(wanted.site, *numbering, wanted.out); !written)
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
            "This number is not in force any more; the next run issues the campaign's\n"
            "certificate anew, under a new number that names this one"},
           {"--why", &wanted->why, "Why it is withdrawn: stays in the register"}},
          common_arguments(common)),
      .footer =
          "A line for each number that was ever drawn: number, state, campaign, date, reason.\n"
          "  issued     in force\n"
          "  amended    replaced by another number, because the data changed\n"
          "  withdrawn  taken back, with the reason\n"
          "  drawn      not issued, with the reason; the next run uses it for the same campaign\n"
          "Nothing is ever deleted, and the same data are never issued twice: if a certificate is\n"
          "lost, --out gives it back. Keep the register (certificates.sqlite in the site) with "
          "your\n"
          "backups: without it numbers would be used twice, and a run refuses.\n\n"
          "Example: nonio certificates site --withdraw 2026-0012 --why \"wrong serial number\"",
      .run = [wanted, &common] { return certificates(*wanted, common); }};
}

}  // namespace nonio::app
