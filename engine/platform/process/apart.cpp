// SPDX-License-Identifier: Apache-2.0
#include "platform/process/apart.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "platform/process/child.h"
#include "platform/process/confine.h"
#include "platform/process/keep_apart.h"
#include "platform/process/process_state.h"
#include "platform/process/shared_status.h"

namespace nonio::process {

namespace {

enum class Place { anywhere, wanted_apart, apart };
Place where_run = Place::anywhere;
bool is_muted = false;
std::vector<std::filesystem::path>& hidden() {
  static std::vector<std::filesystem::path> files;
  return files;
}

constexpr unsigned load_seconds = 10;

std::filesystem::path& own_folder() {
  static std::filesystem::path folder;
  return folder;
}

/// Shared memory in which the child states that it is loading an untried plugin.
SharedStatus& loading_untried() {
  static SharedStatus words;
  return words;
}

bool try_all = false;  // set after a child ended while it loaded an untried plugin

int end_of(pid_t child, const std::vector<pid_t>& children_before) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR)
    ;
  end_children(children_before);
  return status;
}

/// Exits with 130 after SIGINT, and with 2 and a message after another signal.
[[noreturn]] void end_as(int status) {
  if (WIFEXITED(status)) ::_exit(WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGINT) ::_exit(130);
  std::cerr << "nonio: a plugin brought the process down in which it ran: "
            << child_end(status).words << "\n";
  ::_exit(2);
}

}  // namespace

void flush_output() {
  std::cout.flush();
  std::fflush(stdout);
}

void keep_plugins_apart(std::filesystem::path own_plugins) {
  if (where_run == Place::anywhere) where_run = Place::wanted_apart;
  std::error_code error;
  own_folder() = std::filesystem::canonical(own_plugins, error);
}

bool must_be_tried(const std::filesystem::path& plugin) {
  return where_run != Place::apart || try_all || !loading_untried().valid() ||
         plugin.parent_path() != own_folder();
}

LoadingUntried::LoadingUntried() {
  if (where_run != Place::apart || try_all || !loading_untried().valid()) return;
  loading_untried().set("loading");
  ::alarm(load_seconds);
}

LoadingUntried::~LoadingUntried() {
  if (where_run != Place::apart || try_all || !loading_untried().valid()) return;
  ::alarm(0);
  loading_untried().set("");
}

void hide_from_plugins(std::vector<std::filesystem::path> secrets) {
  hidden() = std::move(secrets);
}

void step_aside() {
  if (where_run != Place::wanted_apart) return;
  where_run = Place::apart;
  flush_output();
  std::cerr.flush();
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const std::vector<pid_t> children_before = own_children();
  const pid_t parent = ::getpid();
  const bool can_tell = loading_untried().valid();
  pid_t child = ::fork();
  while (child > 0) {
    ::signal(SIGINT, SIG_IGN);  // the child receives SIGINT too
    const int status = end_of(child, children_before);
    if (try_all || !can_tell || loading_untried().get().empty()) end_as(status);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) end_as(status);
    try_all = true;
    ::signal(SIGINT, SIG_DFL);
    child = ::fork();
  }
  if (child < 0) {
    std::cerr << "nonio: no process for the plugins: " << std::strerror(errno) << "\n";
    ::_exit(2);
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(2);
  use_large_pages();
  forget_environment();
  std::string why = confine_visit();
  if (why.empty()) why = hide_files(hidden());
  if (!why.empty()) {
    std::cerr << "nonio: the plugins cannot be confined: " << why << "\n";
    ::_exit(2);
  }
  keep_process_state();
}

bool is_apart() { return where_run == Place::apart; }

Muted::Muted() {
  if (where_run != Place::apart || is_muted) return;
  flush_output();
  output_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (output_ < 0) return;
  is_muted = true;
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
}

Muted::~Muted() {
  if (output_ < 0) return;
  flush_output();
  ::dup2(output_, STDOUT_FILENO);
  ::close(output_);
  is_muted = false;
}

}  // namespace nonio::process
