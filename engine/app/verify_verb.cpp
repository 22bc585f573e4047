// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <sstream>

#include "certificates/trust.h"
#include "certificates/verify.h"
#include "nonio/sdk/format.h"
#include "platform/process/apart.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using certificates::Verdict;
using storage::Json;

namespace {

struct VerifyWish {
  std::vector<std::string> files, signers;
  std::string site, signer_roots, time_stamp_roots, trust, revoked;
  bool verbose = false;
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
  const Verdict verdict = certificates::verdict_of(v);
  return {{"schema", "nonio-verify/1"},
          {"file", file},
          {"holds", v.holds()},
          {"verdict", certificates::id_of(verdict)},
          {"not_made", certificates::not_made(v)},
          {"signer", v.subject},
          {"checks", std::move(checks)}};
}

std::vector<std::string> check_names(const std::vector<std::string>& checks) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> names{
      {{".time", "time stamp"},
       {".revocation", "revocation"},
       {"register.state", "register"},
       {"content.printed", "printed pages"},
       {"content.templates", "templates"},
       {"content.words", "words"}}};
  std::vector<std::string> out;
  for (const std::string& id : checks) {
    std::string name = id;
    for (const auto& [end, says] : names)
      if (id.ends_with(end)) name = says;
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

int exit_of(const std::vector<Verdict>& verdicts) {
  constexpr std::array<std::pair<Verdict, int>, 8> statuses{{{Verdict::altered, exit_failed},
                                                             {Verdict::untrusted, 4},
                                                             {Verdict::not_in_force, 5},
                                                             {Verdict::other_words, 8},
                                                             {Verdict::no_certificate, 6},
                                                             {Verdict::no_file, 7},
                                                             {Verdict::incomplete, 3},
                                                             {Verdict::valid, exit_done}}};
  for (const auto& [verdict, status] : statuses)
    if (std::find(verdicts.begin(), verdicts.end(), verdict) != verdicts.end()) return status;
  return exit_failed;
}

/// Verdicts and checks in the words of the page on certificates.
class CheckWords {
 public:
  explicit CheckWords(const config::TerminalWords& say) : say_(say) {}

  std::string verdict(const sign::Verified& v) const {
    const Verdict verdict = certificates::verdict_of(v);
    std::string out = text("verify.verdict_", certificates::id_of(verdict));
    if (verdict != Verdict::incomplete) return out;
    std::vector<std::string> names;
    for (const std::string& id : certificates::not_made(v))
      if (std::find(names.begin(), names.end(), name(id)) == names.end()) names.push_back(name(id));
    return out + ": " + storage::listed(names);
  }
  std::string signer(const std::string& subject) const {
    Finding of;
    of.texts = {{"signer", subject}};
    return filled(text("verify.", "signer"), of, say_.language());
  }
  std::string check(const sign::Check& c) const {
    const bool fails = c.state == sign::Check::State::fails;
    const std::string meaning = fails ? first("failing.", c.id) : "";
    return name(c.id) + ": " + text("verify.is_", to_text(c.state)) +
           (meaning.empty() ? "" : ". " + meaning);
  }

 private:
  std::string text(const char* group, std::string id) const {
    std::replace_if(
        id.begin(), id.end(), [](char c) { return c == '.' || c == '-' || c == ' '; }, '_');
    return words(say_.templates(), say_.language(), group + id);
  }
  /// A DCC in a PDF has the checks of a DCC in its own file.
  std::string first(const char* group, const std::string& id) const {
    if (id == "dcc") return text(group, "dcc_none");
    if (!id.starts_with("dcc.")) return text(group, id);
    for (const char* kind : {"dcc.", "xml.", "certificate.", "signer."})
      if (std::string found = text(group, kind + id.substr(4)); !found.empty()) return found;
    return {};
  }
  std::string name(const std::string& id) const {
    const std::string found = first("check.", id);
    return (id.starts_with("dcc.") ? "DCC: " : "") + (found.empty() ? id : found);
  }

  const config::TerminalWords& say_;
};

void print(std::ostream& out, const std::string& file, const sign::Verified& v, bool quiet,
           bool verbose, const CheckWords& say) {
  out << printable(file) << ": " << say.verdict(v);
  if (!quiet && !v.subject.empty()) out << ". " << say.signer(printable(v.subject));
  out << "\n";
  for (const sign::Check& c : v.checks)
    if (!quiet && (verbose || c.state == sign::Check::State::fails))
      out << wrapped(say.check(c), 2, sentence_width(STDOUT_FILENO), 2);
}

/// The verdict is printed first, so that no text of the file can precede or imitate it. `quiet`
/// omits the checks, `verbose` includes those that passed.
void print(std::ostream& out, const std::string& file, const sign::Verified& v, bool quiet,
           bool verbose) {
  const std::string name = printable(file);
  const Verdict verdict = certificates::verdict_of(v);
  const auto not_made = check_names(certificates::not_made(v));
  std::string line = name + ": ";
  if (verdict == Verdict::incomplete)
    line += "VALID (" + std::to_string(not_made.size()) +
            (not_made.size() == 1 ? " check" : " checks") +
            " not made: " + storage::listed(not_made) + ")";
  else
    line += certificates::text_of(verdict);
  if (!quiet && !v.subject.empty()) line += "; signed by \"" + printable(v.subject) + "\"";
  out << wrapped(line, 0, sentence_width(STDOUT_FILENO), 2);
  if (quiet) return;
  for (const sign::Check& c : v.checks)
    if (verbose || c.state == sign::Check::State::fails)
      out << wrapped(std::string(c.id) + " " + to_text(c.state) + ": " + printable(c.says), 2,
                     sentence_width(STDOUT_FILENO), 2);
}

int verify(const VerifyWish& wanted, const Common& common) {
  const auto verifier =
      certificates::verifier_of({wanted.site, wanted.signer_roots, wanted.time_stamp_roots,
                                 wanted.trust, wanted.revoked, wanted.signers});
  if (!verifier) {
    for (const Error& e : verifier.error()) complain(text_of(e));
    return exit_usage;
  }
  // The register is read before the process is confined, because a confined process cannot connect
  // to a server.
  const auto rows = certificates::register_rows(wanted.site);
  const SiteWords words(common, wanted.site.empty() ? "en" : language_at(wanted.site),
                        "workbench-site");
  process::step_aside();  // an untrusted file is read in a confined process, like plugin code
  std::unique_ptr<reading::Workplace> place;
  std::ostringstream early;  // output is delayed, because loading plugins may restart this process
  const auto open = [&]() -> Expected<const reading::Context*> {
    if (place) return &place->context;
    auto opened = certificates::open_to_verify(common.plugin_folders(), common.template_folders(),
                                               wanted.site, NONIO_VERSION);
    std::cout << early.str();
    if (!opened) return fail(opened.error());
    place = std::move(*opened);
    return &place->context;
  };
  std::vector<Verdict> verdicts;
  for (const std::string& file : wanted.files) {
    const auto v = certificates::verify_file(file, *verifier, open, rows);
    if (!v) return complain(v.error().message);
    verdicts.push_back(certificates::verdict_of(*v));
    std::ostream& out = place ? std::cout : early;
    if (common.json)
      out << to_json(file, *v).dump(-1, ' ', true, Json::error_handler_t::replace) << "\n";
    else if (words.get().language() == "en")
      print(out, file, *v, common.quiet, wanted.verbose);
    else
      print(out, file, *v, common.quiet, wanted.verbose, CheckWords(words.get()));
  }
  if (!place) std::cout << early.str();
  return exit_of(verdicts);
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
           existing(Takes::folder,
                    {"--site", &wanted->site,
                     "Site whose site.toml, [signing], names trusted roots and the expected "
                     "signer, and whose register lists the numbers in force"}),
           takes(
               Takes::file,
               {"--signer-roots", &wanted->signer_roots,
                "PEM file with the trusted root certificates of signers (no others are trusted)"}),
           takes(Takes::file, {"--time-stamp-roots", &wanted->time_stamp_roots,
                               "PEM file with the trusted root certificates of time servers"}),
           takes(Takes::file,
                 {"--trust", &wanted->trust,
                  "PEM file with one root certificate, trusted for signers and time servers"}),
           takes(Takes::file, {"--revoked", &wanted->revoked, "PEM file with revocation lists"}),
           {"--signer", &wanted->signers,
            "Expected signer: subject of the certificate, or its SHA-256; may be repeated"},
           {.name = "--verbose",
            .target = &wanted->verbose,
            .help = "One line per check, not only for those that fail",
            .brief = "-v"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Prints the verdict with the signer, and one line for each check that fails. Without "
          "roots and --signer (or --site) a "
          "signature proves nothing: the verdict is that you do not trust the signer. No network "
          "is needed.\n\nExit status: 0 valid; 1 altered or damaged; 2 usage, configuration, or a "
          "register that cannot be read; 3 valid, but not every check was made; 4 signer not "
          "trusted by you; 5 not in force; 6 not a certificate; 7 no such file; 8 texts differ "
          "from the "
          "installed templates. Of several files the most severe: 1, 4, 5, 8, 6, 7, 3, 0.",
      .examples = {"nonio certificate verify --site site out/c1/certificate.pdf"},
      .run = [wanted, &common] { return verify(*wanted, common); }};
}

}  // namespace nonio::app
