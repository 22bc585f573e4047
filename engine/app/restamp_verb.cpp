// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "certificates/restamp.h"
#include "platform/storage/json_values.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;

namespace {

struct RestampWish {
  std::vector<std::string> files, answers, signers;
  std::string site, signer_roots, time_stamp_roots, trust, revoked, time_stamp, out;
  bool no_time_stamp = false, no_fetch = false;
};

void print(const std::string& file, const certificates::Restamped& done, const Common& common) {
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
  certificates::RestampOptions options;
  options.whom = {wanted.site,  wanted.signer_roots, wanted.time_stamp_roots,
                  wanted.trust, wanted.revoked,      wanted.signers};
  options.time_stamp = wanted.time_stamp;
  options.with_time_stamp = !wanted.no_time_stamp;
  options.answers = {wanted.answers.begin(), wanted.answers.end()};
  options.fetch = !wanted.no_fetch;
  if (wanted.no_time_stamp && !wanted.time_stamp.empty())
    return complain("--time-stamp and --no-time-stamp exclude each other");
  const auto how = certificates::prolonging_of(options);
  if (!how) {
    for (const Error& e : how.error()) complain(text_of(e));
    return exit_usage;
  }
  const auto rows = certificates::register_rows(wanted.site);
  int status = exit_done;
  for (const std::string& file : wanted.files) {
    const auto done = certificates::restamp(file, *how, rows, wanted.out);
    if (done)
      print(file, *done, common);
    else
      status = complain(printable(file) + " " + printable(done.error().message), exit_failed);
  }
  return status;
}

}  // namespace

Verb extend_verb(Common& common) {
  auto wanted = std::make_shared<RestampWish>();
  using Takes = Argument::Takes;
  return {
      .name = "extend",
      .summary = "Keeps signed certificates verifiable after keys and time servers expire",
      .arguments = joined(
          {required(takes(Takes::file, {"FILE", &wanted->files, "Signed certificates (PDF)"})),
           existing(Takes::folder, {"--site", &wanted->site,
                                    "Site whose site.toml, [signing], names trusted roots, "
                                    "expected signer, time server and revocation lists"}),
           takes(Takes::file, {"--signer-roots", &wanted->signer_roots,
                               "PEM file with the trusted root certificates of signers"}),
           takes(Takes::file, {"--time-stamp-roots", &wanted->time_stamp_roots,
                               "PEM file with the trusted root certificates of time servers"}),
           takes(Takes::file,
                 {"--trust", &wanted->trust, "PEM file with one root certificate for both"}),
           takes(Takes::file, {"--revoked", &wanted->revoked, "PEM file with revocation lists"}),
           takes(Takes::file,
                 {"--ocsp", &wanted->answers, "File with an OCSP response (DER); may be repeated"}),
           {"--signer", &wanted->signers,
            "Expected signer: subject of the certificate, or its SHA-256; may be repeated"},
           {"--time-stamp", &wanted->time_stamp, "Address of the time-stamp server, http://..."},
           {"--no-time-stamp", &wanted->no_time_stamp,
            "Add only revocation data (PAdES B-LT), for a later time stamp"},
           {"--no-fetch", &wanted->no_fetch,
            "Do not contact addresses in certificates; use only the given data"},
           takes(Takes::folder, {"--out", &wanted->out,
                                 "Folder for the files (default: overwrite the given files)"})},
          common_arguments(common)),
      .footer =
          "Adds to each file the certificates of its signer and time servers with their revocation "
          "data (revocation lists, OCSP responses), then a time stamp over the whole file (PAdES "
          "B-LTA). The issued bytes stay unchanged at the beginning of the file; `nonio "
          "certificate verify` "
          "accepts this addition and no other. Extend it some days after the issue, and again "
          "before "
          "the certificate of the last time server expires: a later stamp protects the earlier "
          "ones. The register keeps the file as it was issued. Revocation data come from --revoked "
          "and --ocsp, otherwise from the addresses (http) in the certificates. If the status of a "
          "certificate cannot be determined, nothing is written. Exit status 0 only if all files "
          "were written.",
      .examples = {"nonio certificate extend --site site archive/S-0001.pdf archive/S-0002.pdf"},
      .run = [wanted, &common] { return restamp(*wanted, common); }};
}

}  // namespace nonio::app
