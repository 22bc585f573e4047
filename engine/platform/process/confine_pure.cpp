// SPDX-License-Identifier: Apache-2.0
// Traps forbidden system calls of plugin functions, so that `nonio plugin check` can report their
// names.
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <vector>

#include "platform/process/confine.h"

namespace nonio::process {

namespace {

struct Call {
  const char* name;
  int number;
};

constexpr std::array impure = {
#ifdef SYS_open
    Call{"open", SYS_open},
#endif
    Call{"openat", SYS_openat},
    Call{"openat2", SYS_openat2},
#ifdef SYS_creat
    Call{"creat", SYS_creat},
#endif
    Call{"truncate", SYS_truncate},
#ifdef SYS_unlink
    Call{"unlink", SYS_unlink},
#endif
    Call{"unlinkat", SYS_unlinkat},
#ifdef SYS_rename
    Call{"rename", SYS_rename},
#endif
#ifdef SYS_renameat
    Call{"renameat", SYS_renameat},
#endif
    Call{"renameat2", SYS_renameat2},
#ifdef SYS_mkdir
    Call{"mkdir", SYS_mkdir},
#endif
    Call{"mkdirat", SYS_mkdirat},
#ifdef SYS_rmdir
    Call{"rmdir", SYS_rmdir},
#endif
#ifdef SYS_link
    Call{"link", SYS_link},
#endif
    Call{"linkat", SYS_linkat},
#ifdef SYS_symlink
    Call{"symlink", SYS_symlink},
#endif
    Call{"symlinkat", SYS_symlinkat},
#ifdef SYS_chmod
    Call{"chmod", SYS_chmod},
#endif
    Call{"fchmodat", SYS_fchmodat},
#ifdef SYS_chown
    Call{"chown", SYS_chown},
#endif
#ifdef SYS_mknod
    Call{"mknod", SYS_mknod},
#endif
    Call{"mknodat", SYS_mknodat},
    Call{"chdir", SYS_chdir},
    Call{"fchdir", SYS_fchdir},
    Call{"umask", SYS_umask},
    Call{"socket", SYS_socket},
    Call{"socketpair", SYS_socketpair},
    Call{"connect", SYS_connect},
#ifdef SYS_fork
    Call{"fork", SYS_fork},
#endif
#ifdef SYS_vfork
    Call{"vfork", SYS_vfork},
#endif
    Call{"clone", SYS_clone},
    Call{"clone3", SYS_clone3},
    Call{"execve", SYS_execve},
    Call{"execveat", SYS_execveat},
    Call{"kill", SYS_kill},
    Call{"ptrace", SYS_ptrace},
    Call{"pidfd_open", SYS_pidfd_open},
    Call{"memfd_create", SYS_memfd_create},
    Call{"io_uring_setup", SYS_io_uring_setup}};

void (*tell_impure)(const char* call) = nullptr;

void on_impure(int, siginfo_t* info, void*) {
  for (const Call& call : impure)
    if (call.number == info->si_syscall) tell_impure(call.name);
  tell_impure("a system call that is not allowed");
}

std::vector<sock_filter> trap_impure() {
  std::vector<sock_filter> steps{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
  for (const Call& call : impure) {
    steps.push_back(
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call.number), 0, 1));
    steps.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  }
  steps.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  return steps;
}

}  // namespace

/// Protects against mistakes, not against malicious code: other system calls remain possible.
std::string confine_pure(void (*told)(const char* call)) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
    return std::string("no_new_privs: ") + std::strerror(errno);
  if (::prctl(PR_GET_SECCOMP) < 0) return "this kernel has no seccomp";
  tell_impure = told;
  struct sigaction action {};
  action.sa_sigaction = on_impure;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGSYS, &action, nullptr);
  auto steps = trap_impure();
  const sock_fprog program{static_cast<unsigned short>(steps.size()), steps.data()};
  if (::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    return std::string("seccomp: ") + std::strerror(errno);
  return "";
}

}  // namespace nonio::process
