// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "host/certificates/verify.h"
#include "host/process/apart.h"
#include "printable.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;

namespace {

struct VerifyWish {
  std::vector<std::string> files;
  std::string site, trust, revoked, signer;
};

const char* to_text(sign::Check::State state) {
  switch (state) {
    case sign::Check::State::holds:
      return "holds";
    case sign::Check::State::fails:
      return "fails";
    case sign::Check::State::not_checked:
      break;
  }
  return "not checked";
}

Json to_json(const std::string& file, const sign::Verified& v) {
  Json checks = Json::array();
  for (const sign::Check& c : v.checks)
    checks.push_back({{"id", c.id}, {"state", to_text(c.state)}, {"says", c.says}});
  return {{"schema", "nonio-verify/1"}, {"file", file},
          {"holds", v.holds()},         {"verdict", host::certificates::verdict_of(v)},
          {"signer", v.subject},        {"checks", std::move(checks)}};
}

/// The verdict first: nothing that a file says comes before it, and nothing can look like it.
void print(std::ostream& out, const std::string& file, const sign::Verified& v, bool quiet) {
  const std::string name = printable(file);
  out << name << ": " << host::certificates::verdict_of(v) << "\n";
  if (quiet) return;
  for (const sign::Check& c : v.checks)
    out << name << ": " << c.id << " " << to_text(c.state) << ": " << printable(c.says) << "\n";
}

int verify(const VerifyWish& wanted, const Common& common) {
  const auto verifier =
      host::certificates::verifier_of({wanted.site, wanted.trust, wanted.revoked, wanted.signer});
  if (!verifier) {
    for (const Error& e : verifier.error()) complain("nonio verify", text_of(e));
    return exit_usage;
  }
  host::process::step_aside();  // a stranger's file is read confined, as the plugins' code is run
  std::unique_ptr<host::reading::Workplace> place;
  std::ostringstream early;  // loading plugins may begin this process anew: said when that is over
  const auto open = [&]() -> Expected<const host::reading::Context*> {
    if (place) return &place->context;
    auto opened = host::certificates::open_to_verify(
        common.plugin_folders(), common.template_folders(), wanted.site, NONIO_VERSION);
    std::cout << early.str();
    if (!opened) return fail(opened.error());
    place = std::move(*opened);
    return &place->context;
  };
  bool all = true;
  for (const std::string& file : wanted.files) {
    const auto v = host::certificates::verify_file(file, *verifier, open, wanted.site);
    if (!v) return complain("nonio verify", v.error().message);
    all = all && v->holds();
    std::ostream& out = place ? std::cout : early;
    if (common.json)
      out << to_json(file, *v).dump(-1, ' ', true, Json::error_handler_t::replace) << "\n";
    else
      print(out, file, *v, common.quiet);
  }
  if (!place) std::cout << early.str();
  return all ? exit_done : exit_failed;
}

}  // namespace

Verb verify_verb(Common& common) {
  auto wanted = std::make_shared<VerifyWish>();
  using Takes = Argument::Takes;
  return {
      .name = "verify",
      .summary = "Checks the signature of certificates and recalculates their values",
      .arguments = joined(
          {required(
               takes(Takes::file, {"FILE", &wanted->files, "Certificates (PDF) and DCC (XML)"})),
           existing(Takes::folder, {"--site", &wanted->site,
                                    "Site whose site.toml, [signing], names trusted roots and the "
                                    "expected signer, and\n"
                                    "whose register lists the numbers in force"}),
           takes(Takes::file,
                 {"--trust", &wanted->trust,
                  "PEM file with the trusted root certificates (no others are trusted)"}),
           takes(Takes::file, {"--revoked", &wanted->revoked, "PEM file with revocation lists"}),
           {"--signer", &wanted->signer,
            "Expected signer: subject of the certificate, or its SHA-256"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Prints the verdict, then one line per check; exit status 0 only if all hold. "
          "Without --trust\n"
          "and --signer (or --site) a signature proves nothing, and the verdict is negative. "
          "No network\n"
          "is needed.\n\n"
          "Example: nonio verify --site site out/c1/certificate.pdf",
      .run = [wanted, &common] { return verify(*wanted, common); }};
}

}  // namespace nonio::app
