// SPDX-License-Identifier: Apache-2.0
#include "run_common.h"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "platform/process/stop.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

void print_summary(const batch::Night& night, const fs::path& out, bool json) {
  std::size_t done = 0, unchanged = 0, attention = 0, failed = 0;
  for (const batch::CampaignState& c : night.campaigns) {
    if (c.status == evaluation::Status::failed)
      ++failed;
    else if (c.action == batch::CampaignState::Action::done)
      ++done;
    else
      ++unchanged;
    if (c.status == evaluation::Status::attention) ++attention;
  }
  // Findings are counted by campaign; what somebody must decide, by line.
  if (json) {
    Json end = {{"event", "end"},         {"done", done},     {"unchanged", unchanged},
                {"attention", attention}, {"failed", failed}, {"vanished", night.vanished.size()}};
    if (night.asking) end["decisions"] = *night.asking;
    end["summary"] = (out / "summary.json").string();
    std::cout << end.dump(-1, ' ', false, Json::error_handler_t::replace) << "\n";
    return;
  }
  std::cout << done << " done, " << unchanged << " unchanged, " << failed << " failed; "
            << (night.vanished.empty() ? "" : std::to_string(night.vanished.size()) + " vanished; ")
            << attention << (attention == 1 ? " has findings" : " have findings");
  if (night.asking)
    std::cout << "; action required: " << *night.asking
              << (*night.asking == 1 ? " line" : " lines");
  std::cout << ": " << (out / "summary.txt").string() << "\n";
}

namespace {

/// Whoever ends the run, or the terminal that it was started from, leaves a night that the next run
/// goes on with. Under nohup a lost terminal is nothing to stop for. A reader of the output that
/// went away, or a limit for the size of files, is no reason to die but an error like others.
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
    std::cerr << "nonio: this runs as root, for whom nothing needs it: expected a user of its own "
                 "(the package's service runs as nonio), or --root to say that it is meant\n";
}

std::optional<int> exit_of_unfinished(const batch::Night& night) {
  if (night.end == batch::Night::End::refused) return complain(night.error);
  if (night.end == batch::Night::End::interrupted)
    return complain("interrupted; the same command goes on where it stopped", exit_interrupted);
  if (!night.error.empty()) return complain(night.error, exit_failed);
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
