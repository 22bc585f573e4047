// SPDX-License-Identifier: Apache-2.0
// What a call of a plugin must do without, so that `nonio plugin check` can name what it tried.
#include <seccomp.h>
#include <sys/prctl.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "confine.h"

namespace nonio::host {

namespace {

constexpr std::array impure = {
    "open",    "openat",     "openat2",      "creat",         "truncate", "unlink",     "unlinkat",
    "rename",  "renameat",   "renameat2",    "mkdir",         "mkdirat",  "rmdir",      "link",
    "linkat",  "symlink",    "symlinkat",    "chmod",         "fchmodat", "chown",      "mknod",
    "mknodat", "chdir",      "fchdir",       "umask",         "socket",   "socketpair", "connect",
    "fork",    "vfork",      "clone",        "clone3",        "execve",   "execveat",   "kill",
    "ptrace",  "pidfd_open", "memfd_create", "io_uring_setup"};

/// Their numbers, since a handler of signals looks nothing up.
std::array<int, impure.size()> impure_numbers{};
void (*tell_impure)(const char* call) = nullptr;

void on_impure(int, siginfo_t* info, void*) {
  for (std::size_t i = 0; i < impure.size(); ++i)
    if (impure_numbers.at(i) == info->si_syscall) tell_impure(impure.at(i));
  tell_impure("a system call that is not allowed");
}

}  // namespace

std::string confine_pure(void (*told)(const char* call)) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
    return std::string("no_new_privs: ") + std::strerror(errno);
  if (::prctl(PR_GET_SECCOMP) < 0) return "this kernel has no seccomp";
  tell_impure = told;
  struct sigaction action{};
  action.sa_sigaction = on_impure;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGSYS, &action, nullptr);
  const scmp_filter_ctx filter = ::seccomp_init(SCMP_ACT_ALLOW);
  if (filter == nullptr) return "seccomp: no memory";
  for (std::size_t i = 0; i < impure.size(); ++i) {
    impure_numbers.at(i) = ::seccomp_syscall_resolve_name(impure.at(i));
    if (impure_numbers.at(i) != __NR_SCMP_ERROR)
      ::seccomp_rule_add(filter, SCMP_ACT_TRAP, impure_numbers.at(i), 0);
  }
  const int code = ::seccomp_load(filter);
  ::seccomp_release(filter);
  return code == 0 ? "" : std::string("seccomp: ") + std::strerror(-code);
}

}  // namespace nonio::host
