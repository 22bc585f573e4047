// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "platform/storage/json_values.h"
#include "plugin_check/plugin_check.h"
#include "plugin_check/plugin_new.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct CheckOptions {
  plugin_check::PluginCheckRequest request;
  std::string subject;
  std::vector<std::string> cases;
};

class CheckReport {
 public:
  CheckReport(const CheckOptions& options, const Common& common)
      : options_(options), common_(common) {}

  void operator()(const plugin_check::PluginCheck& c) {
    ++counts_[static_cast<std::size_t>(c.state)];
    const bool bad = c.state == plugin_check::PluginCheck::State::failed ||
                     c.state == plugin_check::PluginCheck::State::crashed;
    if (bad) again_ = repeat(c);
    if (common_.json) {
      Json one = {{"file", c.file},
                  {"plugin", c.plugin},
                  {"check", c.name},
                  {"state", plugin_check::to_text(c.state)},
                  {"says", c.says}};
      if (bad) one["again"] = again_;
      checks_.push_back(std::move(one));
      return;
    }
    if (common_.quiet && !bad) return;
    if (const std::string head = c.file + (c.plugin.empty() ? "" : ", " + c.plugin); head != head_)
      std::cout << (head_ = head) << "\n";
    std::string name = c.name;
    name.resize(std::max<std::size_t>(name.size(), 13), ' ');
    std::cout << "  " << plugin_check::to_text(c.state) << "  " << name << c.says << std::endl;
    if (bad) std::cout << "           again: " << again_ << "\n";
  }

  int end() const {
    const std::size_t passed = counts_[0], failed = counts_[1], crashed = counts_[2];
    if (common_.json)
      print_json(Json{{"schema", "nonio-plugin-check/1"},
                      {"seed", options_.request.seed},
                      {"seeds", options_.request.seeds},
                      {"checks", checks_},
                      {"passed", passed},
                      {"failed", failed},
                      {"crashed", crashed},
                      {"skipped", counts_[3]}});
    else
      std::cout << passed << " passed, " << failed << " failed, " << crashed << " crashed, "
                << counts_[3] << " skipped; seed " << options_.request.seed << ", seeds "
                << options_.request.seeds << "\n";
    if (passed + failed + crashed + counts_[3] == 0) {
      return complain("no plugin here has the check " + options_.request.only);
    }
    return failed + crashed == 0 ? exit_done : exit_failed;
  }

 private:
  std::string repeat(const plugin_check::PluginCheck& c) const {
    std::string words = "nonio plugin check " + c.file;
    if (!c.plugin.empty()) words += " --plugin " + c.plugin.substr(c.plugin.find(' ') + 1);
    words += " --only " + c.name + " --seed " + std::to_string(c.seed) + " --seeds 1";
    if (fs::is_directory(options_.subject) &&
        fs::is_directory(fs::path(options_.subject) / "cases"))
      words += " --cases " + (fs::path(options_.subject) / "cases").string();
    for (const std::string& folder : options_.cases) words += " --cases " + folder;
    return words;
  }

  const CheckOptions& options_;
  const Common& common_;
  std::size_t counts_[4] = {};
  std::string head_, again_;
  Json checks_ = Json::array();
};

int check_plugin(CheckOptions& options, const Common& common) {
  plugin_check::PluginCheckRequest& request = options.request;
  request.subject = options.subject;
  request.own_plugins = Common::own_plugins();
  request.template_folders = common.template_folders();
  request.version = NONIO_VERSION;
  request.cases.assign(options.cases.begin(), options.cases.end());
  CheckReport report(options, common);
  const auto done = plugin_check::check_plugins(request, std::ref(report));
  return done ? report.end() : complain(done.error().message);
}

struct SkeletonOptions {
  std::string kind, name, out;
};

int make_plugin(const SkeletonOptions& options, const Common& common) {
  const fs::path folder = options.out.empty() ? options.name : options.out;
  const fs::path skeletons = common.template_folders().front().parent_path() / "plugin";
  const auto files =
      plugin_check::new_plugin(skeletons, options.kind, options.name, fs::absolute(folder));
  if (!files) return complain(files.error().message);
  if (common.json)
    print_json(Json{{"folder", fs::absolute(folder).string()}, {"files", *files}});
  else if (!common.quiet)
    std::cout << "Written: " << folder.string() << "\n\n"
              << "    cmake -S " << folder.string() << " -B " << folder.string() << "/build\n"
              << "    cmake --build " << folder.string() << "/build\n"
              << "    ctest --test-dir " << folder.string() << "/build --output-on-failure\n";
  return exit_done;
}

std::string all_checks() {
  std::string words = "Checks:\n";
  for (auto [name, law] : plugin_check::plugin_check_names()) {
    name.resize(std::max<std::size_t>(name.size(), 13), ' ');
    words += "  " + name + law + "\n";
  }
  return words + "\nExit status: 0 none failed or crashed; 1 some did; 2 usage.";
}

Verb new_plugin_verb(Common& common) {
  auto options = std::make_shared<SkeletonOptions>();
  return {.name = "new",
          .summary = "Writes a plugin folder that builds, has tests, and works",
          .arguments = joined(
              {required(offering({"method", "reader", "analysis", "effect", "output", "controller"},
                                 {"KIND", &options->kind,
                                  "method, reader, analysis, effect, output or controller"})),
               required({"NAME", &options->name, "Small letters, digits and '-'"}),
               takes(Argument::Takes::folder,
                     {"--out", &options->out, "The folder; it must not exist (default: NAME)"})},
              common_arguments(common)),
          .examples = {"nonio plugin new controller my-control"},
          .run = [options, &common] { return make_plugin(*options, common); }};
}

Verb check_plugin_verb(Common& common) {
  auto options = std::make_shared<CheckOptions>();
  using Takes = Argument::Takes;
  return {.name = "check",
          .summary = "Runs the conformance checks for a plugin type, each in a process with limits",
          .arguments = joined(
              {required(existing(Takes::path, {"FILE|FOLDER", &options->subject,
                                               "A plugin; or a folder: every .so below it, and "
                                               "cases/*/campaign.toml as samples"})),
               {"--seed", &options->request.seed, "Seed of the generated samples (default: 1)"},
               {"--seeds", &options->request.seeds, "Number of seeds, in steps of 1 (default: 3)"},
               {"--plugin", &options->request.plugin,
                "Only the plugin of this name, of a file that has several"},
               {"--only", &options->request.only, "Only this check of the list below"},
               existing(Takes::folder,
                        {"--cases", &options->cases, "A folder with campaigns as further samples"}),
               within(1.0, 3600.0,
                      {"--seconds", &options->request.seconds,
                       "Processor time limit of one check (default: 20)"}),
               templates_argument(common)},
              common_arguments(common)),
          .footer = all_checks(),
          .examples = {"nonio plugin check build"},
          .run = [options, &common] { return check_plugin(*options, common); }};
}

}  // namespace

Verb plugin_verb(Common& common) {
  return {.name = "plugin",
          .summary = "Plugins: what is loaded, and your own",
          .verbs = {plugin_list_verb(common), new_plugin_verb(common), check_plugin_verb(common)}};
}

}  // namespace nonio::app
