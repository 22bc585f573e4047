// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "campaign/config/template_files.h"
#include "history_chart.h"
#include "laboratory/assessment/assess.h"
#include "laboratory/store/place.h"
#include "laboratory/store/query.h"
#include "laboratory/store/store.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct HistoryWish {
  std::string out, machine, axis, quantity;
};

/// Leaves what is asked for.
void keep(const HistoryWish& wish, const std::string& machine, reports::SiteHistory& site) {
  if (!machine.empty())
    std::erase_if(site.machines, [&](const auto& m) { return m.id != machine; });
  for (reports::MachineHistory& m : site.machines)
    std::erase_if(m.series, [&](const reports::HistorySeries& s) {
      return (!wish.axis.empty() && s.axis != wish.axis) ||
             (!wish.quantity.empty() && s.quantity != wish.quantity);
    });
}

int history(const HistoryWish& wish, const Common& common) {
  const auto tonight = assessment::tonight_in(wish.out);
  if (!tonight) return complain(tonight.error().message);
  std::string machine;
  if (!wish.machine.empty()) {
    auto known = store::machine_named(wish.out, wish.machine);
    if (!known) return complain(known.error().message);
    machine = std::move(*known);
  }
  if (const auto known = store::known_night(wish.out);
      !known || *known != std::optional(tonight->night))
    complain(store::store_in(wish.out) + " does not contain run " + std::to_string(tonight->night) +
             " yet: what follows is older. The next `nonio run` enters it.");
  auto site = assessment::assess(wish.out, *tonight, [] {});
  if (!site) return complain(site.error().message);
  keep(wish, machine, *site);
  std::string digest;
  const auto templates = config::read_templates(common.template_folders(), digest);
  if (!templates) return complain(templates.error().message);
  if (common.json) {
    std::cout << assessment::history_json(*site, *tonight, *templates);
    return exit_done;
  }
  const std::string language =
      templates->tables.contains("words/" + tonight->language + "/site") ? tonight->language : "en";
  const reports::Wording words(*templates, language, {"site", "terminal"});
  const HistoryWords with{words, line_width(STDOUT_FILENO)};
  if (machine.empty()) {
    std::cout << machines_table(*site, with);
    return exit_done;
  }
  for (const reports::MachineHistory& m : site->machines) std::cout << machine_chart(m, with);
  return exit_done;
}

}  // namespace

int show_machine(const std::string& out, const std::string& machine, const Common& common) {
  return history({out, machine, {}, {}}, common);
}

Verb history_verb(Common& common) {
  auto wish = std::make_shared<HistoryWish>();
  return {
      .name = "history",
      .summary = "Trends, changes and forecasts of a machine over its campaigns",
      .arguments = joined(
          {required(existing(Argument::Takes::folder,
                             {"OUT", &wish->out, "Output folder of `nonio run`"})),
           {"MACHINE", &wish->machine,
            "Its asset, or maker and serial with a space between them; without it all machines"},
           {"--axis", &wish->axis, "As the control names it: X, or X1 and X2 of a gantry"},
           {"--quantity", &wish->quantity, "scale, B_mean, ln_s, A, R, ... as in results.json"}},
          common_arguments(common)),
      .footer =
          "One line per campaign, in the language of the site: o = as found, x = as left, + = "
          "check, . = not comparable, with U "
          "(k = 2) as in its report and, in brackets, the U of the comparison (scatter of the "
          "readings only, without the contributions that all campaigns with one instrument share). "
          "! = tolerance limit, * = event, ~ = change, with U and adjusted p-value. Smaller "
          "changes cannot be detected; the detection limit is given below each chart. A, E and R "
          "are shown without a fitted line. The scatter (ln_s) is shown as the standard deviation "
          "of a reading with its interval (k = 2), its changes as factors.\n\n--json writes schema "
          "nonio-history/1 (docs/history.md).",
      .examples = {"nonio machine history out S-0042 --axis X --quantity B_mean"},
      .run = [wish, &common] { return history(*wish, common); }};
}

}  // namespace nonio::app
