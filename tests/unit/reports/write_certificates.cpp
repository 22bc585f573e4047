// SPDX-License-Identifier: Apache-2.0
//
// write_certificates FOLDER: one in each language and one in two, and one of six axes with long
// names, unsigned, for tests/external/pages.
#include <iostream>

#include "certificate_case.h"

namespace {

using namespace nonio;
using namespace nonio::fixtures;

/// Six axes with limits, a test before and after an adjustment, and names that are as long as they
/// get.
Case many(const Plugins& plugins) {
  Case c = whole_case(plugins);
  c.results = {};
  const std::string name =
      "Vereinigte Werkzeugmaschinenfabriken Oberlausitz-Niederschlesien "
      "Aktiengesellschaft & Co. Kommanditgesellschaft";
  c.campaign.customer = name;
  c.campaign.customer_address =
      "Straße der Zusammenarbeit zwischen Hochschule und Handwerk 117, Gebäude 12, 02826 Görlitz";
  c.campaign.machine.maker = name;
  c.campaign.machine.model = "Fahrständer-Bohr- und Fräswerk mit zwei Drehtischen FBW 12000 / 4-6";
  c.campaign.machine.serial = "0417-2019-000000000000001234567890-B";
  c.campaign.laboratory.name = name;
  for (const char* axis : {"Y", "Z", "W"}) c.add(axis, {.length = 1.2, .seed = 11});
  for (const char* axis : {"B", "C"})
    c.add(axis, {.rotary = true, .length = 6.2, .targets = 13, .seed = 12});
  c.campaign.environment.drift_angle = 2e-6;
  for (Axis& a : c.campaign.machine.axes) a.expansion = 11.5e-6;
  Measurement after = c.campaign.measurements[0];
  c.campaign.measurements[0].id = "X as found";
  c.campaign.measurements[0].adjustment = "before";
  after.id = "X as left", after.adjustment = "after";
  c.campaign.measurements.push_back(after);
  c.observations[0].measurement = "X as found";
  c.observations.push_back(observe("X as left", "X", {.slope = 1, .wave = 1, .reversal = -0.5}));
  c.analyse(plugins);
  for (const Measurement& m : c.campaign.measurements) {
    const Axis* axis = c.campaign.machine.axis(m.axis);
    for (const char* result : {"A", "B"})
      c.results.conformity.push_back({m.id, m.axis, "iso230-2", result,
                                      axis->rotary ? 80e-6 : 14e-6, deviation_of(axis->rotary),
                                      Decision::conforms, ""});
  }
  return c;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::cerr << "usage: write_certificates FOLDER\n", 2;
  Plugins plugins;
  for (const char* name : {"iso230-2", "vdi-dgq-3441", "certificate"})
    if (!plugins.load(NONIO_PLUGINS, name)) return 1;
  const Templates templates = read_templates(NONIO_TEMPLATES);
  const Settings none;
  Issue issue{"2026-0012",  "2026-11-21", "2026-0003",
              "2026-10-01", {{"x.csv"}},  std::string(64, 'a')};
  issue.why = "R";
  Case c = whole_case(plugins);
  decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
  decide(c, "iso230-2", "B", 50e-6, Decision::conforms);
  const std::vector<std::vector<std::string>> all = {{"de"}, {"en"}, {"es"},
                                                     {"it"}, {"zh"}, {"it", "en"}};
  const auto write = [&](Case& of, const std::vector<std::string>& languages, std::string name) {
    of.campaign.certificate.languages = languages;
    const auto result = plugins.outputs.front().write(
        {of.campaign, of.observations, of.results, none, templates, &issue});
    if (!result) return std::cerr << result.error().message << '\n', false;
    for (const std::string& language : languages) name += "-" + language;
    for (const auto& [artifact, end] :
         {std::pair(&result->artifacts[0], ".pdf"), std::pair(&result->artifacts[1], ".xml")})
      std::ofstream(std::filesystem::path(argv[1]) / (name + end), std::ios::binary)
          << artifact->bytes;
    return true;
  };
  Case six = many(plugins);
  for (const auto& languages : all)
    if (!write(c, languages, "certificate")) return 1;
  return write(six, {"de"}, "six") && write(six, {"de", "en"}, "six") ? 0 : 1;
}
