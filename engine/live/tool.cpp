// SPDX-License-Identifier: Apache-2.0
#include "live/tool.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>

#include "live/bench.h"
#include "platform/process/child.h"
#include "platform/storage/serialise.h"

namespace nonio::live {

namespace {

/// First member of a message: true for a line, false for the end.
constexpr bool is_line = true;
constexpr std::size_t most_input = 4096, most_printed = 64 << 20, most_errors = 1 << 16;

bool take_from(int fd, std::string& into) {
  std::array<char, 1 << 16> bytes;
  const ssize_t n = ::read(fd, bytes.data(), bytes.size());
  if (n < 0 && errno == EINTR) return true;
  if (n <= 0) return false;
  into.append(bytes.data(), static_cast<std::size_t>(n));
  return true;
}

int exit_status_of(const process::Child& child) {
  int status = 0;
  while (::waitpid(child.pid(), &status, 0) < 0 && errno == EINTR)
    ;
  constexpr int by_signal = 255;
  return WIFEXITED(status) ? WEXITSTATUS(status) : by_signal;
}

/// Sends the complete lines from `sent` on and advances `sent`.
void tell_lines(const std::string& text, std::size_t& sent, int channel) {
  for (std::size_t end; (end = text.find('\n', sent)) != std::string::npos; sent = end + 1) {
    process::write_text(channel, storage::pack(is_line, text.substr(sent, end - sent)));
  }
}

}  // namespace

void run_tool(const std::string& program, const std::vector<std::string>& arguments,
              const std::string& input, double seconds, process::Handle channel) {
  int out[2], errors[2];
  if (::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(errors, O_CLOEXEC) != 0) ::_exit(1);
  process::Child::Program own{{program}, process::present_environment(), -1, out[1], errors[1]};
  int in[2] = {-1, -1};
  if (const std::string line = input + "\n"; !input.empty()) {
    // The write cannot block, because a pipe holds at least 4096 bytes.
    if (line.size() > most_input || ::pipe2(in, O_CLOEXEC) != 0 ||
        ::write(in[1], line.data(), line.size()) != static_cast<ssize_t>(line.size()))
      ::_exit(1);
    ::close(in[1]);
    own.input = in[0];
  }
  own.command.insert(own.command.end(), arguments.begin(), arguments.end());
  auto child = process::Child::start(own);
  if (!child) ::_exit(1);
  ::close(out[1]);
  ::close(errors[1]);
  // Each line of a run is an event; the output of other commands is sent as one answer.
  const bool tells = !arguments.empty() && arguments.front() == "run";
  std::string printed, said;
  std::size_t sent_printed = 0, sent = 0;
  std::array<pollfd, 3> all{
      {{out[0], POLLIN, 0}, {errors[0], POLLIN, 0}, {channel.get(), POLLIN, 0}}};
  using Clock = std::chrono::steady_clock;
  // SIGTERM is sent first, so that finished work is kept.
  constexpr std::chrono::seconds patience(10);
  auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(seconds));
  bool overdue = false;
  constexpr int tick_ms = 1000;
  while (all[0].fd >= 0 || all[1].fd >= 0) {
    const int ready = ::poll(all.data(), all.size(), tick_ms);
    if (Clock::now() > deadline) {
      ::kill(child->pid(), SIGTERM);
      if (overdue) break;
      overdue = true;
      deadline = Clock::now() + patience;
    }
    if (ready <= 0) continue;
    std::string word;
    const bool asked = all[2].revents == POLLIN && process::read_text(channel.get(), word);
    if (asked) ::kill(child->pid(), SIGTERM);
    if ((all[2].revents != 0 && !asked) || printed.size() > most_printed) {
      child->end();
      ::_exit(1);
    }
    if (all[0].revents != 0 && !take_from(out[0], printed)) all[0].fd = -1;
    if (all[1].revents != 0 && !take_from(errors[0], said)) all[1].fd = -1;
    if (tells) tell_lines(printed, sent_printed, channel.get());
    tell_lines(said, sent, channel.get());
  }
  const int status = overdue ? -1 : exit_status_of(*child);
  if (overdue) {
    child->end();
    said += "no answer within " + std::to_string(static_cast<int>(seconds)) +
            " s (site.toml, [limits] seconds)\n";
  }
  said.erase(0, said.size() - std::min(said.size(), most_errors));
  process::write_text(channel.get(), storage::pack(!is_line, status, printed, said));
  ::_exit(0);
}

void run_partner(const std::string& program, const std::vector<std::string>& arguments,
                 process::Handle channel) {
  std::vector<char*> all{const_cast<char*>(program.c_str())};
  for (const std::string& one : arguments) all.push_back(const_cast<char*>(one.c_str()));
  all.push_back(nullptr);
  if (::dup2(channel.get(), STDIN_FILENO) < 0 || ::dup2(channel.get(), STDOUT_FILENO) < 0)
    ::_exit(1);
  ::execv(program.c_str(), all.data());
  ::_exit(1);
}

std::optional<std::string> ask_partner(const process::Handle& channel, const std::string& line,
                                       double seconds) {
  const std::string sent = line + "\n";
  if (::send(channel.get(), sent.data(), sent.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(sent.size()))
    return std::nullopt;
  constexpr double ms = 1000.0;
  for (std::string got; got.size() < most_printed;) {
    pollfd one{channel.get(), POLLIN, 0};
    if (::poll(&one, 1, static_cast<int>(seconds * ms)) <= 0 || !take_from(channel.get(), got))
      return std::nullopt;
    if (got.ends_with('\n')) return got;
  }
  return std::nullopt;
}

void stop_tool(const process::Handle& channel) {
  [[maybe_unused]] const bool sent = process::write_text(channel.get(), "stop");
}

ToolEnd hear_tool(const process::Handle& channel,
                  const std::function<void(const std::string&)>& line) {
  ToolEnd end;
  for (std::string bytes; process::read_text(channel.get(), bytes);) {
    bool is_one_line = false;
    if (std::string text; storage::unpack(bytes, is_one_line, text)) {
      line(text);
      continue;
    }
    storage::unpack(bytes, is_one_line, end.status, end.out, end.errors);
    break;
  }
  return end;
}

namespace {

/// Path that executes this program even if its file was replaced after the start.
constexpr const char* own_program = "/proc/self/exe";

/// Returns false if the server has ended.
bool launch(const BenchWish& common, const storage::Json& what, int to_server) {
  auto ends = process::channel_pair(SOCK_STREAM, "a process of its own");
  if (!ends) return process::send_descriptors(to_server, '-', {});
  auto child = process::Child::start("a request", {}, [&] {
    ::signal(SIGCHLD, SIG_DFL);
    ::close(to_server);
    (*ends)[0] = process::Handle();
    if (what.contains("partner"))
      run_partner(own_program, what["partner"].get<std::vector<std::string>>(),
                  std::move((*ends)[1]));
    if (what.contains("arguments"))
      run_tool(own_program, what["arguments"].get<std::vector<std::string>>(),
               what.value("input", ""), what.value("seconds", 0.0), std::move((*ends)[1]));
    BenchWish wish = common;
    wish.folder = what.at("campaign").get<std::string>();
    run_bench(wish, std::move((*ends)[1]));
  });
  if (!child) return process::send_descriptors(to_server, '-', {});
  child->release();
  return process::send_descriptors(to_server, '+', {(*ends)[0].get()});
}

void serve_launches(const BenchWish& common, int server) {
  ::signal(SIGINT, SIG_IGN);   // the server ends this process
  ::signal(SIGCHLD, SIG_IGN);  // ended children are removed by the kernel
  for (std::string what; process::read_text(server, what);)
    if (!launch(common, storage::parse(what), server)) break;
}

}  // namespace

Expected<Launcher> Launcher::start(const BenchWish& common) {
  NONIO_TRY(auto ends, process::channel_pair(SOCK_STREAM, "the process that starts others"));
  NONIO_TRY(auto child, process::Child::start("what starts others", {}, [&] {
              ends[0] = process::Handle();
              serve_launches(common, ends[1].get());
            }));
  child.release();
  return Launcher(std::move(ends[0]));
}

Expected<process::Handle> Launcher::open(const std::filesystem::path& campaign) {
  return ask({{"campaign", campaign.string()}});
}

Expected<process::Handle> Launcher::run(const std::vector<std::string>& arguments, double seconds,
                                        const std::string& input) {
  return ask({{"arguments", arguments}, {"seconds", seconds}, {"input", input}});
}

Expected<process::Handle> Launcher::partner(const std::vector<std::string>& arguments) {
  return ask({{"partner", arguments}});
}

Expected<process::Handle> Launcher::ask(const storage::Json& what) {
  const std::lock_guard lock(*mutex_);
  if (!process::write_text(channel_.get(), storage::dump_line(what)))
    return fail("the process that starts others has ended; start nonio serve again");
  auto answer = process::receive_descriptors(channel_.get());
  if (!answer) return fail("the process that starts others has ended; start nonio serve again");
  if (answer->word != '+' || answer->descriptors.size() != 1)
    return fail("no process could be started");
  return std::move(answer->descriptors.front());
}

}  // namespace nonio::live
