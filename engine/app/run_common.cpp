// SPDX-License-Identifier: Apache-2.0
#include "run_common.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "nonio/sdk/format.h"
#include "platform/process/stop.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "text_layout.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

/// Returns the result that is out of tolerance or indeterminate with U, for example " 4.8 ± 1.0
/// um". Empty for lines of other kinds.
std::string judged_value(const Json& line, const std::string& language) {
  const std::string kind = line.value("kind", ""), unit = line.value("unit", "");
  if ((kind != "out" && kind != "undecided") || !line.contains("value")) return {};
  const double value = line.at("value").get<double>();
  const auto rounded = rounded_result(value, 2.0 * line.value("u", 0.0));
  const std::string shown = rounded ? rounded->value + " ± " + rounded->U : short_text(value);
  return " " + localised(shown, language) + (unit.empty() ? "" : " " + unit);
}

/// Prints one line per campaign or machine that requires action, except failed campaigns, which are
/// printed before. Returns the number of campaigns and machines, including those without a line.
std::size_t print_actions(const std::string& actions, const fs::path& out,
                          const config::TerminalWords& words) {
  constexpr std::size_t most_campaigns = 20;
  const Json lines = storage::parse_or_discard(actions);
  if (!lines.is_array()) return 0;
  struct Campaign {
    std::string id, says;
    std::vector<std::string> of{};
    std::size_t more = 0;
  };
  std::vector<Campaign> campaigns;
  for (const Json& line : lines) {
    const std::string kind = line.value("kind", ""), campaign = line.value("campaign", ""),
                      id = campaign.empty() ? line.value("machine", "") : campaign;
    if (line.value("state", "") != "new" || id.empty() || kind == "failed" || kind == "information")
      continue;
    const std::string axis = line.value("axis", ""), quantity = line.value("quantity", ""),
                      of = axis + (axis.empty() || quantity.empty() ? "" : " ") + quantity +
                           judged_value(line, words.language()),
                      says = line.value("says", "");
    auto same = std::find_if(campaigns.begin(), campaigns.end(),
                             [&](const Campaign& one) { return one.id == id; });
    if (same == campaigns.end()) same = campaigns.insert(same, {id, says});
    if (same->says != says) ++same->more;
    if (same->says == says && !of.empty()) same->of.push_back(of);
  }
  for (std::size_t i = 0; i < std::min(campaigns.size(), most_campaigns); ++i) {
    const Campaign& c = campaigns[i];
    std::cout << wrapped(
        words("status.attention") + "  " + c.id +
            (c.of.empty() ? "" : " (" + storage::listed(c.of) + ")") + ": " + c.says +
            (c.more == 0 ? "" : " " + words("run.more", {{"count", std::to_string(c.more)}})),
        0, sentence_width(STDOUT_FILENO), 4);
  }
  if (campaigns.size() > most_campaigns)
    std::cout << words("run.more-actions",
                       {{"count", std::to_string(campaigns.size() - most_campaigns)},
                        {"out", out.string()}})
              << "\n";
  return campaigns.size();
}

}  // namespace

void print_summary(const batch::RunResult& run, const fs::path& out,
                   const config::TerminalWords& words, bool json) {
  std::size_t done = 0, unchanged = 0, attention = 0, failed = 0;
  for (const batch::CampaignState& c : run.campaigns) {
    if (c.status == evaluation::Status::failed)
      ++failed;
    else if (c.action == batch::CampaignState::Action::done)
      ++done;
    else
      ++unchanged;
    if (c.status == evaluation::Status::attention) ++attention;
  }
  if (json) {
    Json end = {{"event", "end"},         {"done", done},     {"unchanged", unchanged},
                {"attention", attention}, {"failed", failed}, {"vanished", run.vanished.size()}};
    if (run.asking) end["decisions"] = *run.asking;
    end["summary"] = (out / "summary.json").string();
    print_json(end, -1);
    return;
  }
  const std::size_t acting = run.asking ? print_actions(run.actions, out, words) : 0;
  const auto count = [](std::size_t n) { return std::to_string(n); };
  std::cout << words("counts", {{"done", count(done)},
                                {"unchanged", count(unchanged)},
                                {"failed", count(failed)}})
            << "; "
            << (run.vanished.empty()
                    ? ""
                    : words("vanished", {{"count", count(run.vanished.size())}}) + "; ")
            << (run.asking ? words.counted("attention", acting) + "; " : "")
            << (out / "summary.txt").string() << "\n";
}

namespace {

/// SIGINT, SIGTERM and SIGHUP interrupt the run, which the next run continues; under nohup SIGHUP
/// stays ignored. A closed output pipe and a limit of the file size cause an error instead of a
/// signal.
void catch_signals() {
  struct sigaction stop {};
  stop.sa_handler = [](int) { process::request_stop(); };
  sigaction(SIGINT, &stop, nullptr);
  sigaction(SIGTERM, &stop, nullptr);
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &stop, nullptr);
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, nullptr);
  sigaction(SIGXFSZ, &ignore, nullptr);
}

}  // namespace

void prepare_run(batch::RunOptions& options, const std::string& site, const std::string& out,
                 const Common& common) {
  options.site = site;
  options.out = fs::absolute(out);
  options.plugin_folders = common.plugin_folders();
  options.own_plugins = Common::own_plugins();
  options.template_folders = common.template_folders();
  options.version = NONIO_VERSION;
  options.as_root = options.as_root || std::getenv("NONIO_ALLOW_ROOT") != nullptr;
  catch_signals();
  if (::geteuid() == 0 && !options.as_root && !common.quiet)
    std::cerr << "nonio: warning: running as root is not needed. Use a dedicated user (the service "
                 "uses nonio), or pass --root.\n";
}

std::optional<int> exit_of_unfinished(const batch::RunResult& run) {
  if (run.end == batch::RunResult::End::refused) return complain(run.error);
  if (run.end == batch::RunResult::End::interrupted)
    return complain("interrupted; the same command goes on where it stopped", exit_interrupted);
  if (!run.error.empty()) return complain(run.error, exit_failed);
  return std::nullopt;
}

Argument jobs_argument(batch::RunOptions& options) {
  return within(1, 1024,
                {"--jobs", &options.jobs, "Campaigns at a time (default: one for each core)"});
}
Argument root_argument(batch::RunOptions& options) {
  return {"--root", &options.as_root,
          "Permit root, even with plugins that other users can change; or set NONIO_ALLOW_ROOT"};
}

}  // namespace nonio::app
