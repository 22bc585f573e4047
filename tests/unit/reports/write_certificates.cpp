// SPDX-License-Identifier: Apache-2.0
//
// write_certificates FOLDER: one in each language and one in two, unsigned, for tests/real/pages.
#include <iostream>

#include "certificate_case.h"

int main(int argc, char** argv) {
  using namespace nonio;
  using namespace nonio::fixtures;
  if (argc != 2) return std::cerr << "usage: write_certificates FOLDER\n", 2;
  Plugins plugins;
  for (const char* name : {"iso230-2", "vdi-dgq-3441", "certificate"})
    if (!plugins.load(std::string(NONIO_PLUGINS) + "/" + name + ".so")) return 1;
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
  for (const auto& languages : all) {
    c.campaign.certificate.languages = languages;
    const auto result = plugins.outputs.front().write(
        {c.campaign, c.observations, c.results, none, templates, nullptr, &issue});
    if (!result) return std::cerr << result.error().message << '\n', 1;
    std::string name = "certificate";
    for (const std::string& language : languages) name += "-" + language;
    std::ofstream(std::filesystem::path(argv[1]) / (name + ".pdf"), std::ios::binary)
        << result->artifacts.front().bytes;
  }
  return 0;
}
