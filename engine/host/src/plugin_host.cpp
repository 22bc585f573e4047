// SPDX-License-Identifier: Apache-2.0
#include "plugin_host.h"

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
#include <fstream>
#include <iostream>

#include "child.h"
#include "computing.h"
#include "confine.h"
#include "nonio/host/digest.h"
#include "process_state.h"
#include "wire.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* loading_process = "the process that loads plugins";
constexpr double load_seconds = 10.0, prepare_seconds = 30.0, answer_seconds = 30.0;
constexpr std::string_view preparing = "prepare ";
constexpr std::size_t most_prints = 16 << 10;  // bytes

/// What the process that loads plugins says when it is ready.
struct Ready {
  Catalogue catalogue;
  std::vector<std::string> said;
  std::string refused;  ///< why it cannot go on; empty: it can
};

std::vector<pid_t> children() {
  std::vector<pid_t> all;
  std::ifstream list("/proc/self/task/" + std::to_string(::gettid()) + "/children");
  for (pid_t pid; list >> pid;) all.push_back(pid);
  return all;
}

/// Never into the files of the night, nor what --json prints.
void take_prints(int prints) {
  ::dup2(prints, STDOUT_FILENO);
  ::dup2(prints, STDERR_FILENO);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing >= 0) ::dup2(nothing, STDIN_FILENO);
}

/// Why the answer will not come any more; empty if it may.
bool is_ready(int stream) {
  pollfd one{stream, POLLIN, 0};
  constexpr int now_and_then = 50;  // ms
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

PluginHost::PluginHost(Wish wish) : wish_(std::move(wish)) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  children_before_ = children();
  for (std::string& words : lacking_confinement()) notes_.push_back(std::move(words));
}

PluginHost::~PluginHost() {
  end();
  for (const pid_t pid : children()) {
    if (std::find(children_before_.begin(), children_before_.end(), pid) != children_before_.end())
      continue;
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
  }
}

void PluginHost::end() {
  control_ = Handle();
  if (pid_ > 0) {
    ::kill(-pid_, SIGKILL);
    ::kill(pid_, SIGKILL);
    ::waitpid(std::exchange(pid_, -1), nullptr, 0);
  }
  pass_on_prints();
}

Expected<Catalogue> PluginHost::start() {
  constexpr int most_trials = 100;  // each leaves something out
  for (int i = 0; i < most_trials; ++i) {
    auto loaded = load_once();
    if (loaded || loaded.error().key != preparing) return loaded;
  }
  return fail("plugin after plugin brings down " + std::string(loading_process));
}

Expected<Catalogue> PluginHost::load_once() {
  end();
  SharedWords progress;
  if (!progress.valid()) return fail("no memory for " + std::string(loading_process));
  auto control = channel_pair(SOCK_SEQPACKET, loading_process);
  auto answers = channel_pair(SOCK_STREAM, loading_process);
  std::array<int, 2> prints{};
  if (!control || !answers || ::pipe2(prints.data(), O_CLOEXEC | O_NONBLOCK) != 0)
    return fail(std::string("no channel to ") + loading_process + ": " + std::strerror(errno));
  prints_ = Handle(prints[0]);
  const Handle printing(prints[1]);
  constexpr int yes = 1;
  ::setsockopt((*control)[0].get(), SOL_SOCKET, SO_PASSCRED, &yes, sizeof yes);
  std::cout.flush();
  std::cerr.flush();
  pid_ = fork_patiently();
  if (pid_ == 0) serve((*control)[1].get(), (*answers)[1].get(), printing.get(), progress);
  if (pid_ < 0) return fail(std::string("no process to load plugins: ") + std::strerror(errno));
  ::setpgid(pid_, pid_);
  control_ = std::move((*control)[0]);
  { const Handle theirs = std::move((*control)[1]), also = std::move((*answers)[1]); }
  std::string hung;
  auto text = answer((*answers)[0].get(), progress, hung);
  Ready ready;
  if (text && wire::unpack(*text, ready.catalogue, ready.said, ready.refused)) {
    if (!ready.refused.empty()) return fail(ready.refused);
    for (std::string& words : ready.said) notes_.push_back(std::move(words));
    return std::move(ready.catalogue);
  }
  if (hung == "stopped") return fail("interrupted");
  int status = 0;
  ::kill(pid_, SIGKILL);
  ::waitpid(std::exchange(pid_, -1), &status, 0);
  const ChildEnd how = child_end(status);
  const std::string why = !hung.empty() ? hung : how.well ? "ended the process" : how.words;
  const std::string where = progress.get();
  if (where.empty()) return fail(std::string(loading_process) + " died: " + why);
  leave_out(where, why);
  Error again{why};
  again.key = preparing;
  return fail(again);
}

/// Every step has a limit of its own.
Expected<std::string> PluginHost::answer(int stream, SharedWords& progress, std::string& hung) {
  std::string last;
  auto deadline = Clock::now() + std::chrono::duration<double>(load_seconds);
  while (!is_ready(stream)) {
    pass_on_prints();
    if (wish_.stopped != nullptr && wish_.stopped()) hung = "stopped";
    const std::string now = progress.get();
    const double limit = now.starts_with(preparing) ? prepare_seconds : load_seconds;
    if (now != last) deadline = Clock::now() + std::chrono::duration<double>(limit);
    last = now;
    if (Clock::now() > deadline)
      hung = "no answer within " + std::to_string(static_cast<int>(limit)) + " s";
    if (!hung.empty()) return fail(hung);
  }
  constexpr timeval patience{5, 0};  // it is complete, or a plugin plays with it
  ::setsockopt(stream, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string text;
  if (!read_text(stream, text)) return fail("no answer");
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

Expected<pid_t> PluginHost::make_process(Handle stream, const SharedWords& stage) {
  constexpr int most_deaths = 5;
  for (; deaths_ <= most_deaths; ++deaths_) {
    if (pid_ < 0 || !control_)
      if (const auto again = start(); !again) return fail(again.error());
    const bool sent = send_descriptors(control_.get(), 'w', {stream.get(), stage.descriptor()});
    pollfd one{control_.get(), POLLIN, 0};
    const bool heard = sent && ::poll(&one, 1, static_cast<int>(1000 * answer_seconds)) > 0;
    const auto hello = heard ? receive_descriptors(control_.get()) : fail("no answer");
    // The kernel says who it is: a child of ours, and not the one that loads.
    if (hello && hello->word == 'h' && hello->sender > 0 && hello->sender != pid_) {
      siginfo_t info{};
      if (::waitid(P_PID, static_cast<id_t>(hello->sender), &info, WEXITED | WNOHANG | WNOWAIT) ==
          0)
        return hello->sender;
    }
    end();
  }
  return fail(std::string(loading_process) + " dies again and again");
}

void PluginHost::pass_on_prints() {
  std::array<char, 4096> part{};
  for (ssize_t n = 0; prints_ && (n = ::read(prints_.get(), part.data(), part.size())) > 0;) {
    if (printed_ == 0) std::cerr << "a plugin prints: ";
    const std::size_t room = most_prints - std::min(printed_, most_prints);
    std::cerr.write(part.data(), std::min<ssize_t>(n, static_cast<ssize_t>(room)));
    const bool was_full = room == 0;
    printed_ += static_cast<std::size_t>(n);
    if (!was_full && printed_ >= most_prints)
      std::cerr << "\nplugins print more than " << most_prints << " bytes: the rest is dropped\n";
  }
}

// ---- in the process that loads plugins

std::string PluginHost::check_secrets() const {
  if (!lacking_confinement().empty()) return {};  // said already
  for (const fs::path& secret : wish_.secrets) {
    const Handle file(::open(secret.c_str(), O_RDONLY | O_CLOEXEC));
    if (file)
      return secret.string() + " lies where plugins have their libraries and could read it; " +
             "wanted the signing key and its password elsewhere";
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

Plugins& PluginHost::load_all(SharedWords& progress, std::vector<std::string>& said) const {
  auto* plugins = new Plugins;  // never unloaded
  for (const fs::path& path : plugins->files_in(wish_.folders)) {
    progress.set(path.string());
    const auto known = refused_.find(path);
    plugins->load_file(path, known == refused_.end() ? "" : known->second);
    if (const std::string changed = restore_process_state(); !changed.empty())
      said.push_back("plugin " + path.filename().string() + " changed " + changed +
                     " of the process while it was loaded; put right again");
  }
  if (!plugins->conflicts().empty()) return *plugins;
  for (const Output& output : plugins->outputs()) {
    if (output.prepare == nullptr || unprepared_.contains(output.info.name)) continue;
    progress.set(std::string(preparing) + output.info.name);
    // What the system refuses now it may give in a moment.
    if (!is_prepared(output, wish_.context.templates) &&
        !is_prepared(output, wish_.context.templates))
      said.push_back("output " + output.info.name + " could not prepare: it threw an exception");
    restore_process_state();
  }
  progress.set("");
  return *plugins;
}

void PluginHost::serve(int control, int catalogue, int prints, SharedWords& progress) noexcept {
  settle_child();
  take_prints(prints);
  std::vector<int> kept{control, catalogue, progress.descriptor()};
  std::sort(kept.begin(), kept.end());
  close_others(kept);
  forget_environment();
  sha256("");  // the library behind it reads its settings now or never
  std::vector<fs::path> readable = wish_.folders;
  readable.insert(readable.end(), wish_.readable.begin(), wish_.readable.end());
  Ready ready;
  if (wish_.confine) ready.refused = confine_loading(readable);
  if (wish_.confine && ready.refused.empty()) ready.refused = check_secrets();
  if (ready.refused.empty()) {
    keep_process_state();
    wish_.context.plugins = &load_all(progress, ready.said);
    ready.catalogue = wish_.context.plugins->catalogue();
    if (wish_.confine) ready.refused = confine_files();
  }
  if (!write_text(catalogue, wire::pack(ready.catalogue, ready.said, ready.refused))) ::_exit(0);
  ::close(catalogue);
  while (ready.refused.empty()) make_sibling(control);
  ::_exit(0);
}

void PluginHost::make_sibling(int control) noexcept {
  auto asked = receive_descriptors(control);
  if (!asked) ::_exit(0);  // the main process has gone
  if (asked->descriptors.size() != 2) return;
  // As a child of the main process, which waits for it and ends it. No lock is held: this process
  // has one thread.
  const long pid = ::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
  if (pid != 0) return;
  settle_child();
  SharedWords stage(asked->descriptors[1].release());
  const int stream = asked->descriptors[0].get();
  if (!stage.valid() || !send_descriptors(control, 'h', {})) ::_exit(0);
  close_others({stream});
  limit_memory(wish_.context.site.limits.memory_MB);
  if (const std::string why = wish_.confine ? confine_computing() : ""; !why.empty()) {
    stage.set("confining the process: " + why);
    ::_exit(1);
  }
  evaluate_for(stream, wish_.context, stage);
  ::_exit(0);
}

}  // namespace nonio::host
