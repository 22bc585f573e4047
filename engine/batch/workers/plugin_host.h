// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "batch/workers/worker.h"
#include "campaign/evaluation/evaluate.h"
#include "platform/process/channel.h"
#include "platform/process/prints.h"

namespace nonio::batch {

/// Returns the folders with libraries that plugins need. The libraries of the program are stored
/// next to its plugin folder `own_plugins`.
std::vector<std::filesystem::path> library_folders(const std::filesystem::path& own_plugins);

/// Controls the only process that loads plugins, after its confinement. It starts the evaluating
/// processes as children of the main process, which contains no plugin code. A plugin that ends the
/// process is loaded once more (after signal 9 five times) and then omitted; a plugin that hangs is
/// omitted at once.
class PluginHost {
 public:
  struct Request {
    std::vector<std::filesystem::path> folders;
    /// Folders with libraries of plugins.
    std::vector<std::filesystem::path> readable;
    std::vector<std::filesystem::path> secrets;
    reading::Context& context;  ///< `plugins` is set in the loading process only
    bool (*stopped)();          ///< whether a stop is requested; may be null
    bool confine = true;
  };
  explicit PluginHost(Request request);
  PluginHost(const PluginHost&) = delete;
  PluginHost& operator=(const PluginHost&) = delete;
  /// Ends the process and all processes that plugins have left.
  ~PluginHost();

  /// Loads the plugins. An error if the process cannot be started or confined.
  Expected<loader::Catalogue> start();
  /// Notes on plugins that failed and on confinement that the kernel does not support.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Starts a process that evaluates campaigns for the other end of `stream` and reports each step
  /// in `stage`. Restarts the loading process if it has ended.
  Expected<process::Child> make_process(process::Handle stream, const process::SharedStatus& stage);
  /// Prints the output of plugins, up to a limit for all plugins.
  void pass_on_prints();

 private:
  Expected<loader::Catalogue> load_once();
  void serve(int control, int catalogue, int prints, process::SharedStatus& progress);
  loader::Plugins& load_all(process::SharedStatus& progress, std::vector<std::string>& said,
                            Prints& prints) const;
  void say(std::string_view text);
  void make_sibling(int control, int prints);
  std::string check_secrets() const;
  Expected<std::string> answer(int stream, process::SharedStatus& progress, std::string& hung);
  void leave_out(const std::string& progress, const std::string& why);
  void end();

  Request request_;
  std::vector<std::string> notes_;
  std::map<std::filesystem::path, std::string> refused_;  ///< reason by omitted plugin
  std::map<std::string, std::string> unprepared_;         ///< reason by output that is not prepared
  std::map<std::string, int> died_at_;
  std::vector<pid_t> children_before_;
  process::Child child_;
  process::Handle control_, prints_;
  /// Output of an evaluating process that must be printed if the process has ended.
  struct LastWords {
    pid_t pid;
    process::Handle reading;
    process::SharedStatus stage;
  };
  std::vector<LastWords> last_words_;
  std::size_t printed_ = 0;
  int deaths_ = 0;
};

}  // namespace nonio::batch
