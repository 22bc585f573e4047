// SPDX-License-Identifier: Apache-2.0
//
// write_model_pages FOLDER: the documents of made models, for tests with other programs.
#include <iostream>

#include "fixtures.h"
#include "model_fixture.h"

int main(int argc, char** argv) {
  using namespace nonio;
  using namespace nonio::fixtures;
  if (argc != 2) return std::cerr << "usage: write_model_pages FOLDER\n", 2;
  const std::filesystem::path folder = argv[1];
  Plugins plugins;
  for (const char* name : {"pdf-report", "model-html"})
    if (!plugins.load(NONIO_PLUGINS, name)) return 1;
  const Templates templates = read_templates(NONIO_TEMPLATES);
  const auto write = [&](const char* name, const std::vector<ModelFit>& models) {
    Case c = simple_case();
    c.results.models = models;
    for (const ModelFit& fit : models)
      c.results.analyses.push_back(
          {"model-fit",
           "",
           fit.measurements.front(),
           {.values = {{"largest_residual", fit.largest, deviation_of(fit.angular)},
                       {"redundancy", 1.0, Quantity::count}}}});
    for (const Output& output : plugins.outputs)
      for (const char* language : {"de", "en", "it"}) {
        Settings options = defaults(output.info);
        options.values["language"] = std::string(language);
        const auto result =
            output.write({c.campaign, c.observations, c.results, options, templates});
        if (!result) return std::cerr << result.error().message << '\n', false;
        const auto into = folder / name / language;
        std::filesystem::create_directories(into);
        for (const Artifact& a : result->artifacts)
          std::ofstream(into / a.name, std::ios::binary) << a.bytes;
      }
    return true;
  };
  MadeModel bare{false, false, false, false, false, 11, 1, false};
  MadeModel turn{true, true, true, false, true, 25, 3, true};
  MadeModel many{false, true, true, true, true, 2001, 50, false};
  return write("usual", {made_model()}) && write("bare", {made_model(bare)}) &&
                 write("turn", {made_model(turn)}) && write("many", {made_model(many)})
             ? 0
             : 1;
}
