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

/// Returns the folders of libraries that plugins need in addition to their own folders.
/// `own_plugins`: plugin folder of the program, next to which its libraries are.
std::vector<std::filesystem::path> library_folders(const std::filesystem::path& own_plugins);

/// Controls the only process that loads plugins; it is confined before it loads them. It starts the
/// processes that evaluate as children of the main process, which contains no plugin code. A plugin
/// that crashes the process while it is loaded or prepared is tried again once (up to five times
/// after signal 9), then left out; one that hangs is left out after its time limit.
class PluginHost {
 public:
  struct Request {
    std::vector<std::filesystem::path> folders;  ///< folders that contain plugins
    /// Further folders that plugins may read, since they contain their libraries.
    std::vector<std::filesystem::path> readable;
    /// Files that plugins must not read: the signing key and its password.
    std::vector<std::filesystem::path> secrets;
    reading::Context& context;  ///< settings of the run; `plugins` is set in the loading process
                                ///< only
    bool (*stopped)();          ///< whether a stop is requested; may be null
    bool confine = true;
  };
  explicit PluginHost(Request request);
  PluginHost(const PluginHost&) = delete;
  PluginHost& operator=(const PluginHost&) = delete;
  /// Ends the process and all processes that plugins have left running.
  ~PluginHost();

  /// Loads the plugins and returns their catalogue; an error if nothing can be loaded.
  Expected<loader::Catalogue> start();
  /// Notes on plugins that failed, and on confinement that the kernel does not support.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Starts a process that evaluates campaigns for the owner of the other end of `stream`, and
  /// reports in `stage` what it is about to call. Starts the loading process again if that has
  /// died.
  Expected<process::Child> make_process(process::Handle stream, const process::SharedStatus& stage);
  /// Prints what plugins have printed, up to a limit for all plugins together.
  void pass_on_prints();

 private:
  Expected<loader::Catalogue> load_once();
  void serve(int control, int catalogue, int prints, process::SharedStatus& progress);
  loader::Plugins& load_all(process::SharedStatus& progress, std::vector<std::string>& said,
                            Prints& prints) const;
  /// Prints `text`, up to a limit for all plugins together.
  void say(std::string_view text);
  void make_sibling(int control, int prints);
  std::string check_secrets() const;
  Expected<std::string> answer(int stream, process::SharedStatus& progress, std::string& hung);
  void leave_out(const std::string& progress, const std::string& why);
  void end();

  Request request_;
  std::vector<std::string> notes_;
  std::map<std::filesystem::path, std::string> refused_;  ///< plugins that are not loaded, and why
  std::map<std::string, std::string> unprepared_;         ///< outputs that are not prepared, and
                                                          ///< why
  std::map<std::string, int> died_at_;                    ///< number of times that the process
                                                          ///< died, by the stage reported before
  std::vector<pid_t> children_before_;
  process::Child child_;
  process::Handle control_, prints_;
  /// Output of an evaluating process that was not printed before it died.
  struct LastWords {
    pid_t pid;
    process::Handle reading;
    process::SharedStatus stage;
  };
  std::vector<LastWords> last_words_;
  std::size_t printed_ = 0;
  int deaths_ = 0;  ///< failed attempts since an evaluating process was started last
};

}  // namespace nonio::batch
