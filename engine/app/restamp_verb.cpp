// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/certificates/restamp.h"
#include "printable.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* restamp_name = "nonio restamp";

struct RestampWish {
  std::vector<std::string> files, answers;
  std::string site, trust, revoked, signer, time_stamp, out;
  bool no_time_stamp = false, no_fetch = false;
};

void print(const std::string& file, const host::certificates::Restamped& done,
           const Common& common) {
  if (common.json) {
    std::cout << Json{{"schema", "nonio-restamp/1"},
                      {"file", file},
                      {"written", done.written.string()},
                      {"added", done.added}}
                     .dump(-1, ' ', true, Json::error_handler_t::replace)
              << "\n";
    return;
  }
  if (common.quiet) return;
  std::cout << printable(done.written.string()) << ": written\n";
  for (const std::string& what : done.added)
    std::cout << printable(done.written.string()) << ": " << printable(what) << "\n";
}

int restamp(const RestampWish& wanted, const Common& common) {
  host::certificates::RestampOptions options;
  options.whom = {wanted.site, wanted.trust, wanted.revoked, wanted.signer};
  options.time_stamp = wanted.time_stamp;
  options.with_time_stamp = !wanted.no_time_stamp;
  options.answers = {wanted.answers.begin(), wanted.answers.end()};
  options.fetch = !wanted.no_fetch;
  if (wanted.no_time_stamp && !wanted.time_stamp.empty())
    return complain(restamp_name, "--time-stamp and --no-time-stamp exclude each other");
  const auto how = host::certificates::prolonging_of(options);
  if (!how) {
    for (const Error& e : how.error()) complain(restamp_name, text_of(e));
    return exit_usage;
  }
  int status = exit_done;
  for (const std::string& file : wanted.files) {
    const auto done = host::certificates::restamp(file, *how, wanted.out);
    if (done)
      print(file, *done, common);
    else
      status = complain(restamp_name, printable(file) + " " + printable(done.error().message),
                        exit_failed);
  }
  return status;
}

}  // namespace

Verb restamp_verb(Common& common) {
  auto wanted = std::make_shared<RestampWish>();
  using Takes = Argument::Takes;
  return {
      .name = "restamp",
      .summary = "Keep signed certificates provable when keys and time servers run out",
      .arguments = joined(
          {required(takes(Takes::file, {"FILE", &wanted->files, "Signed certificates (PDF)"})),
           existing(Takes::folder,
                    {"--site", &wanted->site,
                     "Site whose site.toml, [signing], says whom to trust and expect, the time\n"
                     "server and the revocation lists"}),
           takes(Takes::file, {"--trust", &wanted->trust,
                               "PEM file with the roots that certificates must lead to"}),
           takes(Takes::file, {"--revoked", &wanted->revoked,
                               "PEM file with revocation lists that are at hand"}),
           takes(Takes::file,
                 {"--ocsp", &wanted->answers,
                  "File with an answer by OCSP (DER) that is at hand; may be repeated"}),
           {"--signer", &wanted->signer,
            "Who should have signed: subject of the certificate, or its SHA-256"},
           {"--time-stamp", &wanted->time_stamp, "Address of the time-stamp server, http://..."},
           {"--no-time-stamp", &wanted->no_time_stamp,
            "Only put revocation data in (PAdES B-LT): who stamps later finds them"},
           {"--no-fetch", &wanted->no_fetch,
            "Ask no address that stands in a certificate; only what is at hand"},
           takes(Takes::folder,
                 {"--out", &wanted->out, "Write the files here; without it over themselves"})},
          common_arguments(common)),
      .footer =
          "Puts into each file the certificates of its signer and time servers, and what their\n"
          "authorities say of them (revocation lists, answers by OCSP), then a time stamp over\n"
          "all of it (PAdES B-LTA). What was issued stays as it is at the beginning of the file;\n"
          "`nonio verify` accepts exactly this addition and no other. Do it some days after the\n"
          "issue, and again before the certificate of the last time server runs out: a later\n"
          "stamp protects the earlier ones. The register keeps the file as it was issued.\n"
          "Lists come from --revoked and --ocsp, else from the addresses (http) in the\n"
          "certificates. Where nobody says whether a certificate was revoked, nothing is written.\n"
          "Exit status 0 only if all files were written.\n\n"
          "Example: nonio certificates site --out archive && nonio restamp --site site "
          "archive/*.pdf",
      .run = [wanted, &common] { return restamp(*wanted, common); }};
}

}  // namespace nonio::app
