// SPDX-License-Identifier: Apache-2.0
#include "plan_sheet.h"

#include <filesystem>
#include <iostream>

#include "campaign/config/template_files.h"
#include "campaign/planning/plan.h"
#include "campaign_verb.h"
#include "platform/storage/files.h"
#include "verbs.h"

namespace nonio::app {

std::vector<Argument> sheet_arguments(SheetWish& wish, Common& common) {
  return {
      takes(Argument::Takes::file,
            {"--pdf", &wish.file, "The same as a PDF to take to the machine"}),
      one_of({"de", "en", "it"},
             {"--language", &wish.language, "Language of the text and of the PDF"}),
      within(0, 100,
             {"--stops", &wish.stops, "So many plans with all their stops in the PDF (default 1)"}),
      templates_argument(common)};
}

Machine rectangle(double x, double y) {
  Machine machine;
  machine.axes = {Axis{.name = "X", .travel = std::pair(0.0, x)},
                  Axis{.name = "Y", .travel = std::pair(0.0, y)}};
  return machine;
}

int write_sheet(const SheetWish& wish, const Machine& machine, const PointTable& rows,
                std::map<std::string, std::string> options, const Common& common) {
  namespace fs = std::filesystem;
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict);
  const auto templates = config::read_templates(common.template_folders());
  if (!templates) return complain(text_of(templates.error()));
  options["language"] = wish.language;
  options["stops"] = std::to_string(wish.stops);
  const Output* sheet = plugins.output_of(Output::Role::sheet_of_stops);
  if (sheet == nullptr) return complain("no output plugin writes a sheet of stops");
  auto files =
      planning::write_programs(plugins, sheet->info.name, machine, rows, options, *templates);
  if (!files) {
    for (const Error& e : files.error()) complain(text_of(e));
    return exit_usage;
  }
  const fs::path to = fs::absolute(wish.file);
  for (Artifact& a : *files) a.name = to.filename().string();
  if (auto done = storage::publish(to.parent_path(), *files); !done)
    return complain(done.error().message, exit_failed);
  if (!common.quiet) std::cerr << wish.file << "\n";
  return exit_done;
}

}  // namespace nonio::app
