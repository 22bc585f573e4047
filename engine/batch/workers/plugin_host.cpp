// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/plugin_host.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iostream>

#include "batch/state/wire.h"
#include "batch/workers/computing.h"
#include "platform/process/child.h"
#include "platform/process/confine.h"
#include "platform/process/prints.h"
#include "platform/process/process_state.h"
#include "platform/storage/digest.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

using Steady = std::chrono::steady_clock;

constexpr const char* loading_process = "the process that loads plugins";
constexpr double load_seconds = 10.0, prepare_seconds = 30.0, answer_seconds = 30.0;
constexpr std::string_view preparing = "prepare ", died = "died";
constexpr int most_unexplained = 3;
constexpr std::size_t most_prints = 16 << 10;  // limit of the printed plugin output, bytes

struct Ready {
  loader::Catalogue catalogue;
  std::vector<std::string> said;
  std::string refused;  ///< reason why the process cannot continue
};

void take_input() {
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing >= 0) ::dup2(nothing, STDIN_FILENO);
}

bool is_ready(int stream) {
  pollfd one{stream, POLLIN, 0};
  constexpr int now_and_then = 50;
  return ::poll(&one, 1, now_and_then) > 0;
}

}  // namespace

std::vector<fs::path> library_folders(const fs::path& own_plugins) {
  std::vector<fs::path> folders{"/usr", "/lib", "/lib64", "/etc/ld.so.cache"};
  if (own_plugins.empty()) return folders;
  folders.push_back(own_plugins.parent_path());
  folders.push_back(own_plugins.parent_path().parent_path());
  return folders;
}

PluginHost::PluginHost(Request request) : request_(std::move(request)) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  children_before_ = process::own_children();
  for (std::string& words : process::lacking_confinement()) notes_.push_back(std::move(words));
}

PluginHost::~PluginHost() {
  end();
  process::end_children(children_before_);
}

void PluginHost::end() {
  control_ = process::Handle();
  child_.end();
  pass_on_prints();
}

Expected<loader::Catalogue> PluginHost::start() {
  constexpr int most_trials = 100;  // each attempt omits one more plugin
  // Crashes without a plugin as the cause, such as a temporary lack of memory.
  int unexplained = 0;
  for (int i = 0; i < most_trials; ++i) {
    auto loaded = load_once();
    const bool again =
        !loaded && (loaded.error().key == preparing ||
                    (loaded.error().key == died && ++unexplained < most_unexplained));
    if (!again) return loaded;
  }
  return fail("plugin after plugin brings down " + std::string(loading_process));
}

Expected<loader::Catalogue> PluginHost::load_once() {
  end();
  process::SharedStatus progress;
  if (!progress.valid()) return fail("no memory for " + std::string(loading_process));
  auto control = process::channel_pair(SOCK_SEQPACKET, loading_process);
  auto answers = process::channel_pair(SOCK_STREAM, loading_process);
  std::array<int, 2> prints{};
  if (!control || !answers || ::pipe2(prints.data(), O_CLOEXEC | O_NONBLOCK) != 0)
    return fail(std::string("no channel to ") + loading_process + ": " + std::strerror(errno));
  prints_ = process::Handle(prints[0]);
  const process::Handle printing(prints[1]);
  constexpr int yes = 1;
  ::setsockopt((*control)[0].get(), SOL_SOCKET, SO_PASSCRED, &yes, sizeof yes);
  NONIO_TRY(child_, process::Child::start(loading_process, {}, [&] {
              serve((*control)[1].get(), (*answers)[1].get(), printing.get(), progress);
            }));
  control_ = std::move((*control)[0]);
  { const process::Handle theirs = std::move((*control)[1]), also = std::move((*answers)[1]); }
  std::string hung;
  auto text = answer((*answers)[0].get(), progress, hung);
  Ready ready;
  if (text && storage::unpack(*text, ready.catalogue, ready.said, ready.refused)) {
    if (!ready.refused.empty()) return fail(ready.refused);
    for (std::string& words : ready.said) notes_.push_back(std::move(words));
    return std::move(ready.catalogue);
  }
  if (hung == "stopped") return fail("interrupted");
  const process::ChildEnd how = child_.end();
  const std::string why = !hung.empty() ? hung : how.well ? "ended the process" : how.words;
  const std::string where = progress.get();
  Error error{where.empty() ? std::string(loading_process) + " died: " + why : why};
  error.key = where.empty() ? died : preparing;
  // A first crash may be due to a lack of memory, and signal 9 comes from outside, so both are
  // tried again. A plugin that hangs is not.
  const int most_deaths = why.starts_with("signal 9 ") ? 5 : 1;
  if (!where.empty() && (!hung.empty() || ++died_at_[where] > most_deaths)) leave_out(where, why);
  return fail(error);
}

/// Waits for the message of the loading process. The time limit is that of one step, such as
/// loading one plugin. `hung` is the reason of an error.
Expected<std::string> PluginHost::answer(int stream, process::SharedStatus& progress,
                                         std::string& hung) {
  std::string last;
  auto deadline = Steady::now() + std::chrono::duration<double>(load_seconds);
  while (!is_ready(stream)) {
    pass_on_prints();
    if (request_.stopped != nullptr && request_.stopped()) hung = "stopped";
    const std::string now = progress.get();
    const double limit = now.starts_with(preparing) ? prepare_seconds : load_seconds;
    if (now != last) deadline = Steady::now() + std::chrono::duration<double>(limit);
    last = now;
    if (Steady::now() > deadline)
      hung = "no answer within " + std::to_string(static_cast<int>(limit)) + " s";
    if (!hung.empty()) return fail(hung);
  }
  // The limit is for an incomplete message, which a plugin may have sent.
  constexpr timeval patience{5, 0};
  ::setsockopt(stream, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string text;
  if (!process::read_text(stream, text)) return fail("no answer");
  return text;
}

void PluginHost::leave_out(const std::string& progress, const std::string& why) {
  if (!progress.starts_with(preparing)) {
    refused_[progress] = "did not survive loading: " + why;
    return;
  }
  const std::string output = progress.substr(preparing.size());
  unprepared_[output] = why;
  notes_.push_back("output " + output + " could not prepare: " + why);
}

Expected<process::Child> PluginHost::make_process(process::Handle stream,
                                                  const process::SharedStatus& stage) {
  constexpr int most_deaths = 5;
  for (; deaths_ <= most_deaths; ++deaths_) {
    if (!child_ || !control_)
      if (const auto again = start(); !again) return fail(again.error());
    const bool sent =
        process::send_descriptors(control_.get(), 'w', {stream.get(), stage.descriptor()});
    pollfd one{control_.get(), POLLIN, 0};
    const bool heard = sent && ::poll(&one, 1, static_cast<int>(1000 * answer_seconds)) > 0;
    auto hello = heard ? process::receive_descriptors(control_.get()) : fail("no answer");
    // The kernel states the sender, which must be a child of this process other than the loading
    // process.
    if (hello && hello->word == 'h' && hello->sender > 0 && hello->sender != child_.pid()) {
      siginfo_t info{};
      if (::waitid(P_PID, static_cast<id_t>(hello->sender), &info, WEXITED | WNOHANG | WNOWAIT) ==
          0) {
        deaths_ = 0;
        if (hello->descriptors.size() == 1)
          last_words_.push_back(
              {hello->sender, std::move(hello->descriptors.front()),
               process::SharedStatus(::fcntl(stage.descriptor(), F_DUPFD_CLOEXEC, 3))});
        return process::Child(hello->sender);
      }
    }
    end();
  }
  return fail(std::string(loading_process) + " dies again and again");
}

void PluginHost::pass_on_prints() {
  if (prints_) say(take_all(prints_.get()));
  const auto has_died = [](const LastWords& one) {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(one.pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           info.si_pid == one.pid;
  };
  for (std::size_t i = last_words_.size(); i-- > 0;) {
    const LastWords& one = last_words_[i];
    if (!has_died(one)) continue;
    const std::string text = take_all(one.reading.get());
    if (!text.empty()) say(printed_by(one.stage.valid() ? one.stage.get() : "", text));
    last_words_.erase(last_words_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void PluginHost::say(std::string_view text) {
  const std::size_t room = most_prints - std::min(printed_, most_prints);
  std::cerr << text.substr(0, room);
  printed_ += text.size();
  if (room > 0 && printed_ >= most_prints)
    std::cerr << "\nplugins print more than " << most_prints << " bytes: the rest is dropped\n";
}

std::string PluginHost::check_secrets() const {
  // The lack of confinement is reported already.
  if (!process::lacking_confinement().empty()) return {};
  for (const fs::path& secret : request_.secrets) {
    const process::Handle file(::open(secret.c_str(), O_RDONLY | O_CLOEXEC));
    if (file)
      return secret.string() + " is in a folder that plugins can read; " +
             "expected the signing key and its password elsewhere";
  }
  return {};
}

namespace {

bool is_prepared(const Output& output, const Templates& templates) {
  try {
    output.prepare(templates);
    return true;
  } catch (...) {
    return false;
  }
}

}  // namespace

loader::Plugins& PluginHost::load_all(process::SharedStatus& progress,
                                      std::vector<std::string>& said, Prints& prints) const {
  auto* plugins = new loader::Plugins;  // plugins are never unloaded
  for (const fs::path& path : plugins->files_in(request_.folders)) {
    progress.set(path.string());
    const auto known = refused_.find(path);
    plugins->load_file(path, known == refused_.end() ? "" : known->second);
    prints.pass_on("plugin " + path.filename().string());
    if (const std::string changed = process::restore_process_state(); !changed.empty())
      said.push_back("plugin " + path.filename().string() + " changed " + changed +
                     " of the process while it was loaded; put right again");
  }
  if (!plugins->conflicts().empty()) return *plugins;
  for (const Output& output : plugins->outputs()) {
    if (output.prepare == nullptr || unprepared_.contains(output.info.name)) continue;
    progress.set(std::string(preparing) + output.info.name);
    // A second attempt, because a lack of memory may be temporary.
    if (!is_prepared(output, request_.context.templates) &&
        !is_prepared(output, request_.context.templates))
      said.push_back("output " + output.info.name + " could not prepare: it threw an exception");
    prints.pass_on("output " + output.info.name);
    process::restore_process_state();
  }
  progress.set("");
  return *plugins;
}

void PluginHost::serve(int control, int catalogue, int prints, process::SharedStatus& progress) {
  take_input();
  Prints own(prints);
  if (!own.valid()) ::_exit(1);
  std::vector<int> kept{control, catalogue, progress.descriptor(), prints, own.reading()};
  std::sort(kept.begin(), kept.end());
  process::close_others(kept);
  process::forget_environment();
  // The cryptographic library reads its settings at the first digest, while files can still be
  // opened.
  storage::sha256("");
  std::vector<fs::path> readable = request_.folders;
  readable.insert(readable.end(), request_.readable.begin(), request_.readable.end());
  Ready ready;
  if (request_.confine) ready.refused = process::confine_loading(readable);
  if (request_.confine && ready.refused.empty()) ready.refused = check_secrets();
  if (ready.refused.empty()) {
    process::keep_process_state();
    request_.context.plugins = &load_all(progress, ready.said, own);
    ready.catalogue = request_.context.plugins->catalogue();
    if (request_.confine) ready.refused = process::confine_files();
  }
  if (!process::write_text(catalogue, storage::pack(ready.catalogue, ready.said, ready.refused)))
    ::_exit(0);
  ::close(catalogue);
  while (ready.refused.empty()) make_sibling(control, prints);
}

void PluginHost::make_sibling(int control, int prints) {
  auto asked = process::receive_descriptors(control);
  if (!asked) ::_exit(0);
  if (asked->descriptors.size() != 2) return;
  // The clone is a child of the main process, which waits for it. No lock can be taken at this
  // time, because this process has one thread.
  const long pid = ::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
  if (pid != 0) return;
  process::init_child();
  process::SharedStatus stage(asked->descriptors[1].release());
  const int stream = asked->descriptors[0].get();
  Prints own(prints);
  if (!stage.valid() || !own.valid() || !process::send_descriptors(control, 'h', {own.reading()}))
    ::_exit(0);
  std::vector<int> kept{stream, prints, own.reading()};
  std::sort(kept.begin(), kept.end());
  process::close_others(kept);
  process::limit_memory(request_.context.site.limits.memory_MB);
  if (const std::string why = request_.confine ? process::confine_computing() : ""; !why.empty()) {
    stage.set("confining the process: " + why);
    ::_exit(1);
  }
  evaluate_for(stream, request_.context, stage, own);
  ::_exit(0);
}

}  // namespace nonio::batch
