// SPDX-License-Identifier: Apache-2.0
// A Digital Calibration Certificate without the PDF, for users with their own certificate numbers.
#include <algorithm>

#include "dcc.h"
#include "nonio/sdk/format.h"

namespace nonio::dcc {

namespace {

constexpr const char* version = "1.0.0";

bool applies(const Campaign&) { return true; }

Expected<void> check(const Campaign& c) {
  std::string missing;
  const auto want = [&](bool there, const char* key) {
    if (!there) missing += (missing.empty() ? "" : ", ") + std::string(key);
  };
  want(!c.laboratory.name.empty(), "laboratory.name (site.toml)");
  want(dcc::is_country(c.laboratory.country),
       "laboratory.country (site.toml, two capital letters: IT)");
  want(!c.laboratory.authoriser.empty(), "laboratory.authoriser (site.toml)");
  want(!c.customer.empty(), "campaign.customer");
  want(!c.site.empty(), "campaign.site");
  want(!c.date.empty(), "campaign.date");
  want(!c.machine.model.empty(), "machine.model");
  want(!c.machine.serial.empty(), "machine.serial");
  if (missing.empty()) return {};
  return fail("a DCC needs what is missing: " + missing);
}

void add_decided(const OutputInput& in, dcc::About& about) {
  const std::string& rule = in.campaign.certificate.decision_rule;
  about.norm = rule.starts_with("ilac")    ? "ILAC-G8:09/2019"
               : rule == "iso14253-1:2013" ? "ISO 14253-1:2013"
                                           : "ISO 14253-1:2017";
  for (const Conformity& c : in.results.conformity)
    about.decided.push_back(
        {{{"", c.name + " of " + (c.measurement.empty() ? c.axis : c.measurement) + ", tolerance " +
                   short_text(printed(c.tolerance, c.quantity), 6) + " " +
                   std::string(unit_of(c.quantity).symbol)}},
         {},
         c.decision == Decision::conforms           ? "pass"
         : c.decision == Decision::does_not_conform ? "fail"
                                                    : ""});
}

Expected<OutputResult> write(const OutputInput& in) {
  if (auto complete = check(in.campaign); !complete) return fail(complete.error());
  const auto has_values = [](const auto& a) { return !a.evaluation.values.empty(); };
  const auto& analyses = in.results.analyses;
  if (std::none_of(analyses.begin(), analyses.end(), has_values))
    return fail("a DCC needs at least one result, and there is none");
  const std::string number = in.options.text("number");
  dcc::About about{number.empty() ? in.campaign.id : number,
                   {in.options.text("language", "en")},
                   in.options.text("location", "customer"),
                   "dcc",
                   version};
  add_decided(in, about);
  OutputResult result;
  result.artifacts.push_back({"dcc.xml", dcc::write(in, about), in.options.flag("sign", true)});
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {
      "dcc",
      version,
      "A Digital Calibration Certificate (DCC 3.3.0, XML) with a signature of its own.",
      {{"number", std::string(), "", "Number of the certificate (default: the campaign's id)."},
       {"language", std::string("en"), "", "Language of the texts, ISO 639-1."},
       one_of({"laboratory", "customer", "laboratoryBranch", "customerBranch", "other"},
              {"location", std::string("customer"), "", "Where it was calibrated."}),
       {"sign", true, "", "Signed with the key of [signing] in site.toml."}},
      true};
  output.applies = applies;
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::dcc
