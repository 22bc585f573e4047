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

/// Folders of the libraries that plugins need, in addition to their own folders; `own_plugins`: next to the
/// program.
std::vector<std::filesystem::path> library_folders(const std::filesystem::path& own_plugins);

/// The one process that loads plugins, confined before it does. It makes the processes that
/// evaluate, as children of the main process, which has no plugin code. What a plugin brings down
/// while it is loaded or prepared is left out the next time; one that hangs costs its limit once.
class PluginHost {
 public:
  struct Request {
    std::vector<std::filesystem::path> folders;  ///< of plugins
    /// Further folders that contain libraries of plugins.
    std::vector<std::filesystem::path> readable;
    /// Files that plugins must not read: the signing key and its password.
    std::vector<std::filesystem::path> secrets;
    reading::Context& context;  ///< its `plugins` are set in the process that loads them
    bool (*stopped)();          ///< may be null
    bool confine = true;
  };
  explicit PluginHost(Request request);
  PluginHost(const PluginHost&) = delete;
  PluginHost& operator=(const PluginHost&) = delete;
  /// Ends it, and whatever plugins have left running.
  ~PluginHost();

  /// What was loaded; an error if nothing can be.
  Expected<loader::Catalogue> start();
  /// What went wrong, and what the kernel lacks.
  const std::vector<std::string>& notes() const { return notes_; }

  /// A process that evaluates campaigns for whoever has the other end of `stream`, and states in
  /// `stage` what it is about to call. Made anew if the process that loads has died.
  Expected<process::Child> make_process(process::Handle stream, const process::SharedStatus& stage);
  /// Passes on what plugins have printed, up to a limit.
  void pass_on_prints();

 private:
  Expected<loader::Catalogue> load_once();
  void serve(int control, int catalogue, int prints, process::SharedStatus& progress);
  loader::Plugins& load_all(process::SharedStatus& progress, std::vector<std::string>& said,
                            Prints& prints) const;
  /// With a limit for all plugins together.
  void say(std::string_view text);
  void make_sibling(int control, int prints);
  std::string check_secrets() const;
  Expected<std::string> answer(int stream, process::SharedStatus& progress, std::string& hung);
  void leave_out(const std::string& progress, const std::string& why);
  void end();

  Request request_;
  std::vector<std::string> notes_;
  std::map<std::filesystem::path, std::string> refused_;  ///< and why
  std::map<std::string, std::string> unprepared_;         ///< outputs, and why
  std::map<std::string, int> died_at_;                    ///< how often it died where
  std::vector<pid_t> children_before_;
  process::Child child_;
  process::Handle control_, prints_;
  /// What a process that evaluates has printed and not passed on when it died.
  struct LastWords {
    pid_t pid;
    process::Handle reading;
    process::SharedStatus stage;
  };
  std::vector<LastWords> last_words_;
  std::size_t printed_ = 0;
  int deaths_ = 0;  ///< since a process was made
};

}  // namespace nonio::batch
