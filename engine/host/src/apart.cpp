// SPDX-License-Identifier: Apache-2.0
#include "apart.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "child.h"
#include "confine.h"
#include "nonio/host/apart.h"
#include "process_state.h"

namespace nonio::host {

namespace {

enum class Place { anywhere, wanted_apart, apart };
Place where_run = Place::anywhere;
bool is_muted = false;
std::vector<std::filesystem::path>& hidden() {
  static std::vector<std::filesystem::path> files;
  return files;
}

void flush_output() {
  std::cout.flush();
  std::fflush(stdout);
}

/// What the shell would do with a program that ended so.
[[noreturn]] void end_as(pid_t child, const std::vector<pid_t>& children_before) {
  ::signal(SIGINT, SIG_IGN);  // the child gets it too, and says how it ends
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR)
    ;
  end_children(children_before);  // what plugins have left running
  if (WIFEXITED(status)) ::_exit(WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGINT) ::_exit(130);
  std::cerr << "nonio: a plugin brought the process down in which it ran: "
            << child_end(status).words << "\n";
  ::_exit(2);
}

}  // namespace

void keep_plugins_apart() {
  if (where_run == Place::anywhere) where_run = Place::wanted_apart;
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
  const pid_t child = ::fork();
  if (child > 0) end_as(child, children_before);
  if (child < 0) {
    std::cerr << "nonio: no process for the plugins: " << std::strerror(errno) << "\n";
    ::_exit(2);
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(2);
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

}  // namespace nonio::host
