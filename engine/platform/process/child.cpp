// SPDX-License-Identifier: Apache-2.0
#include "platform/process/child.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <thread>

namespace nonio::process {

ChildEnd child_end(int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {true, {}};
  if (WIFEXITED(status)) return {false, "exit status " + std::to_string(WEXITSTATUS(status))};
  const int number = WTERMSIG(status);
  if (number == SIGSYS)
    return {false,
            "tried what no plugin may do (start a program or a process, open a connection, signal "
            "another process, memory beyond the limit): ended by the kernel"};
  return {false, "signal " + std::to_string(number) + " (" + ::strsignal(number) + ")"};
}

namespace {

using Clock = std::chrono::steady_clock;

void keep_silent() {
  const int nothing = ::open("/dev/null", O_RDWR);
  if (nothing < 0) return;
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
#ifndef NONIO_SANITIZED
  ::dup2(nothing, STDERR_FILENO);
#endif
  if (nothing > STDERR_FILENO) ::close(nothing);
}

pid_t fork_patiently() {
  constexpr int most = 20;
  for (int i = 0;; ++i) {
    const pid_t pid = ::fork();
    if (pid >= 0 || i == most || (errno != EAGAIN && errno != ENOMEM)) return pid;
    ::usleep(100'000);
  }
}

[[noreturn]] void work_and_end(const Child::Settings& settings, const std::function<void()>& work,
                               pid_t parent) noexcept {
  init_child();
  if (::getppid() != parent) ::_exit(2);
  if (settings.silent) keep_silent();
  if (settings.memory_MB > 0.0) limit_memory(settings.memory_MB);
  try {
    work();
  } catch (...) {
    ::_exit(3);
  }
  ::_exit(0);
}

std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (const std::string& text : texts) all.push_back(const_cast<char*>(text.c_str()));
  all.push_back(nullptr);
  return all;
}

[[noreturn]] void become(const Child::Program& program) {
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const auto from = [&](int descriptor) { return descriptor < 0 ? nothing : descriptor; };
  ::dup2(from(program.input), STDIN_FILENO);
  ::dup2(from(program.output), STDOUT_FILENO);
  ::dup2(from(program.errors), STDERR_FILENO);
  ::execve(program.command.front().c_str(), pointers_to(program.command).data(),
           pointers_to(program.environment).data());
  constexpr int cannot_run = 127;
  ::_exit(cannot_run);
}

}  // namespace

Child::Child(pid_t pid) : pid_(pid) { ::setpgid(pid_, pid_); }

Expected<Child> Child::start(const std::string& purpose, const Settings& settings,
                             const std::function<void()>& work) {
  std::cout.flush();
  std::cerr.flush();
  std::fflush(stdout);
  const pid_t parent = ::getpid();
  const pid_t pid = fork_patiently();
  if (pid == 0) work_and_end(settings, work, parent);
  if (pid < 0) return fail("no process for " + purpose + ": " + std::strerror(errno));
  return Child(pid);
}

Expected<Child> Child::start(const Program& program) {
  const std::string& path = program.command.front();
  if (::access(path.c_str(), X_OK) != 0) return fail(std::string(std::strerror(errno)));
  return start(path, {}, [&] { become(program); });
}

bool Child::has_ended() const {
  siginfo_t info{};
  return pid_ > 0 &&
         (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
          info.si_pid == pid_);
}

ChildEnd Child::end() {
  if (pid_ < 0) return {true, {}};
  const pid_t child = std::exchange(pid_, -1);
  ::kill(-child, SIGKILL);
  ::kill(child, SIGKILL);
  const auto patience = Clock::now() + std::chrono::seconds(2);
  int status = 0;
  pid_t gone = 0;
  while ((gone = ::waitpid(child, &status, WNOHANG)) == 0 && Clock::now() < patience)
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  return gone > 0 ? child_end(status) : ChildEnd{false, "does not respond (waiting in the kernel)"};
}

ChildEnd Child::wait(double seconds) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  auto pause = std::chrono::microseconds(100);
  int status = 0;
  while (::waitpid(pid_, &status, WNOHANG) == 0) {
    if (Clock::now() > deadline) {
      end();
      return {false, "no answer within " + std::to_string(static_cast<int>(seconds)) + " s", true};
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::microseconds(5000));
  }
  pid_ = -1;
  return child_end(status);
}

std::vector<pid_t> own_children() {
  std::vector<pid_t> all;
  std::ifstream list("/proc/self/task/" + std::to_string(::gettid()) + "/children");
  for (pid_t pid; list >> pid;) all.push_back(pid);
  return all;
}

void end_children(const std::vector<pid_t>& kept) {
  const auto patience = Clock::now() + std::chrono::seconds(2);
  for (bool any = true; any && Clock::now() < patience;) {
    any = false;
    for (const pid_t pid : own_children()) {
      if (std::find(kept.begin(), kept.end(), pid) != kept.end()) continue;
      any = true;
      ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, WNOHANG);
    }
    if (any) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

void init_child() {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::signal(SIGINT, SIG_DFL);
  ::signal(SIGTERM, SIG_DFL);
  struct sigaction hang_up {};
  ::sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) ::signal(SIGHUP, SIG_DFL);  // SIGHUP stays ignored under nohup
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
}

std::vector<std::string> present_environment() {
  std::vector<std::string> all;
  for (char** one = environ; one != nullptr && *one != nullptr; ++one) all.emplace_back(*one);
  return all;
}

std::size_t memory_held() {
  const auto info = ::mallinfo2();
  return info.arena + info.hblkhd;
}

void keep_freed_memory(int reserve_MiB) {
  constexpr int mebibyte = 1 << 20;
  ::mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
  ::mallopt(M_TRIM_THRESHOLD, 64 * mebibyte);
  ::mallopt(M_TOP_PAD, reserve_MiB * mebibyte);
}

void use_large_pages() {
  constexpr std::size_t large_page = 2 << 20;
  constexpr int reserve_MiB = 32;
  keep_freed_memory(reserve_MiB);
  const auto end = [] { return static_cast<char*>(::sbrk(0)); };
  char* const before = end();
  // Extends the heap by the reserve; volatile, or the compiler removes both calls.
  void* volatile extended = std::malloc(std::size_t{1} << 20);
  std::free(extended);
  const std::size_t into = reinterpret_cast<std::uintptr_t>(before) % large_page;
  char* const start = before + (into == 0 ? 0 : large_page - into);
  if (start < end()) ::madvise(start, static_cast<std::size_t>(end() - start), MADV_HUGEPAGE);
}

bool has_grown(std::size_t at_start) {
  constexpr std::size_t allowed = 64 << 20;
  return memory_held() > at_start + allowed;
}

void limit_memory(double megabytes) {
#ifndef NONIO_SANITIZED
  const auto bytes = static_cast<rlim_t>(megabytes * 1e6);
  const rlimit limit{bytes, bytes};
  ::setrlimit(RLIMIT_DATA, &limit);
#else
  (void)megabytes;
#endif
}

}  // namespace nonio::process
