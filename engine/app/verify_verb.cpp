// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/certificates/verify.h"
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
void print(const std::string& file, const sign::Verified& v, bool quiet) {
  const std::string name = printable(file);
  std::cout << name << ": " << host::certificates::verdict_of(v) << "\n";
  if (quiet) return;
  for (const sign::Check& c : v.checks)
    std::cout << name << ": " << c.id << " " << to_text(c.state) << ": " << printable(c.says)
              << "\n";
}

int verify(const VerifyWish& wanted, const Common& common) {
  const auto verifier =
      host::certificates::verifier_of({wanted.site, wanted.trust, wanted.revoked, wanted.signer});
  if (!verifier) {
    for (const Error& e : verifier.error()) complain("nonio verify", text_of(e));
    return exit_usage;
  }
  const auto place = host::certificates::open_to_verify(
      common.plugin_folders(), common.template_folders(), wanted.site, NONIO_VERSION);
  if (!place) return complain("nonio verify", place.error().message);
  bool all = true;
  for (const std::string& file : wanted.files) {
    const sign::Verified v =
        host::certificates::verify_file(file, *verifier, (*place)->context, wanted.site);
    all = all && v.holds();
    if (common.json)
      std::cout << to_json(file, v).dump(-1, ' ', true, Json::error_handler_t::replace) << "\n";
    else
      print(file, v, common.quiet);
  }
  return all ? exit_done : exit_failed;
}

}  // namespace

Verb verify_verb(Common& common) {
  auto wanted = std::make_shared<VerifyWish>();
  using Takes = Argument::Takes;
  return {
      .name = "verify",
      .summary =
          "Whether signed certificates are what their signer signed, and their numbers right",
      .arguments = joined(
          {required(
               takes(Takes::file, {"FILE", &wanted->files, "Certificates (PDF) and DCC (XML)"})),
           existing(Takes::folder,
                    {"--site", &wanted->site,
                     "Site whose site.toml, [signing], says whom to trust and expect, and whose\n"
                     "register says which numbers are in force"}),
           takes(Takes::file,
                 {"--trust", &wanted->trust,
                  "PEM file with the roots that certificates must lead to (nobody else is "
                  "trusted)"}),
           takes(Takes::file, {"--revoked", &wanted->revoked, "PEM file with revocation lists"}),
           {"--signer", &wanted->signer,
            "Who should have signed: subject of the certificate, or its SHA-256"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "The verdict, then one line for each check; exit status 0 only if all hold. Without "
          "--trust and --signer "
          "(or\n"
          "--site) a signature proves nothing, and the answer is no. Needs no network.\n\n"
          "Example: nonio verify --site site out/c1/certificate.pdf",
      .run = [wanted, &common] { return verify(*wanted, common); }};
}

}  // namespace nonio::app
