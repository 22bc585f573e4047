// SPDX-License-Identifier: Apache-2.0
// Generates the filters of filters.h as C++ source at build time. At run time, a failed allocation
// makes libseccomp loop, free memory twice or silently omit rules (version 2.5.4; 397 failed
// allocations: 56, 25 and 134 cases).
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "platform/process/filters.h"

namespace {

using nonio::process::own_process, nonio::process::parent_process;

/// System calls that no process with plugins needs; a process that makes one is killed.
const char* const hostile[] = {"execve",
                               "execveat",
                               "socket",
                               "connect",
                               "bind",
                               "listen",
                               "accept",
                               "accept4",
                               "ptrace",
                               "process_vm_readv",
                               "process_vm_writev",
                               "pidfd_open",
                               "pidfd_send_signal",
                               "pidfd_getfd",
                               "rt_sigqueueinfo",
                               "rt_tgsigqueueinfo",
                               "memfd_secret",
                               "shmget",
                               "shmat",
                               "msgget",
                               "msgsnd",
                               "semget",
                               "mq_open",
                               "bpf",
                               "keyctl",
                               "add_key",
                               "request_key",
                               "perf_event_open",
                               "userfaultfd",
                               "io_uring_setup",
                               "mount",
                               "umount2",
                               "move_mount",
                               "open_tree",
                               "fsopen",
                               "pivot_root",
                               "chroot",
                               "unshare",
                               "setns",
                               "reboot",
                               "kexec_load",
                               "init_module",
                               "finit_module",
                               "delete_module",
                               "swapon",
                               "swapoff",
                               "sethostname",
                               "setdomainname",
                               "settimeofday",
                               "clock_settime",
                               "clock_adjtime",
                               "adjtimex",
                               "setuid",
                               "setgid",
                               "setreuid",
                               "setregid",
                               "setresuid",
                               "setresgid",
                               "setgroups",
                               "personality",
                               "quotactl",
                               "open_by_handle_at",
                               "fanotify_init",
                               "syslog",
                               "acct"};

/// System calls that a command needs to create processes and files; forbidden in the processes that
/// load plugins or evaluate.
const char* const of_verbs[] = {"fork",
                                "vfork",
                                "socketpair",
                                "kill",
                                "tkill",
                                "memfd_create",
                                "shmctl",
                                "msgrcv",
                                "semop",
                                "capset",
                                "name_to_handle_at",
                                "chmod",
                                "fchmod",
                                "fchmodat",
                                "chown",
                                "fchown",
                                "lchown",
                                "fchownat",
                                "utimensat",
                                "setxattr",
                                "lsetxattr",
                                "fsetxattr",
                                "removexattr",
                                "lremovexattr",
                                "fremovexattr",
                                "setpriority",
                                "sched_setaffinity",
                                "sched_setscheduler",
                                "sched_setparam",
                                "sched_setattr",
                                "ioprio_set"};

/// System calls of a computation, including those that query files without opening them.
const char* const computing[] = {"read",
                                 "readv",
                                 "pread64",
                                 "write",
                                 "writev",
                                 "close",
                                 "fstat",
                                 "newfstatat",
                                 "stat",
                                 "lstat",
                                 "statx",
                                 "lseek",
                                 "munmap",
                                 "mremap",
                                 "madvise",
                                 "brk",
                                 "mprotect",
                                 "mincore",
                                 "futex",
                                 "sendto",
                                 "sendmsg",
                                 "recvfrom",
                                 "recvmsg",
                                 "poll",
                                 "ppoll",
                                 "rt_sigaction",
                                 "rt_sigprocmask",
                                 "rt_sigreturn",
                                 "sigaltstack",
                                 "getpid",
                                 "gettid",
                                 "getppid",
                                 "getuid",
                                 "geteuid",
                                 "getgid",
                                 "getegid",
                                 "getpgrp",
                                 "getrandom",
                                 "clock_gettime",
                                 "clock_getres",
                                 "clock_nanosleep",
                                 "nanosleep",
                                 "gettimeofday",
                                 "time",
                                 "sched_yield",
                                 "sched_getaffinity",
                                 "getcpu",
                                 "getrusage",
                                 "times",
                                 "sysinfo",
                                 "uname",
                                 "exit",
                                 "exit_group",
                                 "restart_syscall",
                                 "set_robust_list",
                                 "rseq",
                                 "getcwd",
                                 "readlink",
                                 "readlinkat",
                                 "access",
                                 "faccessat",
                                 "faccessat2",
                                 "open",
                                 "openat",
                                 "getdents64",
                                 "fcntl",
                                 "dup",
                                 "dup2",
                                 "dup3",
                                 "getrlimit",
                                 "membarrier",
                                 "fadvise64"};

[[noreturn]] void give_up(const char* what, int code) {
  std::fprintf(stderr, "make_filters: %s: error %d\n", what, code);
  std::exit(1);
}

class Filter {
 public:
  explicit Filter(std::uint32_t otherwise) : filter_(::seccomp_init(otherwise)) {
    if (filter_ == nullptr) give_up("no memory", 0);
  }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;
  ~Filter() { ::seccomp_release(filter_); }

  template <class... Compare>
  void add(std::uint32_t action, const char* call, Compare... wanted) {
    const int number = ::seccomp_syscall_resolve_name(call);
    if (number == __NR_SCMP_ERROR) give_up(call, number);
    const int code =
        ::seccomp_rule_add(filter_, action, number, sizeof...(wanted), scmp_arg_cmp(wanted)...);
    if (code != 0) give_up(call, code);
  }

  void print(const char* name) const {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) give_up("pipe", 0);
    if (const int code = ::seccomp_export_bpf(filter_, ends[1]); code != 0) give_up(name, code);
    std::array<sock_filter, nonio::process::most_filter_steps> steps{};
    const ssize_t size = ::read(ends[0], steps.data(), sizeof steps);
    if (size <= 0 || size == sizeof steps) give_up(name, static_cast<int>(size));
    std::printf("const sock_filter %s_steps[] = {\n", name);
    for (std::size_t i = 0; i < static_cast<std::size_t>(size) / sizeof steps[0]; ++i)
      std::printf("    {%#x, %u, %u, %#xU},\n", steps[i].code, steps[i].jt, steps[i].jf,
                  steps[i].k);
    std::printf("};\nconst std::span<const sock_filter> %s_filter(%s_steps);\n\n", name, name);
    ::close(ends[0]);
    ::close(ends[1]);
  }

 private:
  scmp_filter_ctx filter_;
};

scmp_arg_cmp masked(unsigned argument, scmp_datum_t mask, scmp_datum_t value) {
  return {argument, SCMP_CMP_MASKED_EQ, mask, value};
}
scmp_arg_cmp is(unsigned argument, scmp_datum_t value) { return {argument, SCMP_CMP_EQ, value, 0}; }
scmp_arg_cmp is_not(unsigned argument, scmp_datum_t value) {
  return {argument, SCMP_CMP_NE, value, 0};
}

/// Compares the lower 32 bits, because the kernel ignores the upper half of an int argument.
scmp_arg_cmp is_int(unsigned argument, std::uint32_t value) {
  return masked(argument, 0xFFFFFFFF, value);
}

void forbid_hostile(Filter& filter) {
  for (const char* call : hostile) filter.add(SCMP_ACT_KILL_PROCESS, call);
  for (const std::uint32_t spared : {parent_process, 1U})
    filter.add(SCMP_ACT_KILL_PROCESS, "tgkill", is_int(0, spared));
  // These commands request signals from a descriptor, or insert input into a terminal.
  for (const std::uint32_t command : {F_SETOWN, F_SETSIG, 15 /* F_SETOWN_EX */})
    filter.add(SCMP_ACT_KILL_PROCESS, "fcntl", is_int(1, command));
  for (const std::uint32_t command : {0x5412 /* TIOCSTI */, 0x541C /* TIOCLINUX */})
    filter.add(SCMP_ACT_KILL_PROCESS, "ioctl", is_int(1, command));
}

/// Filter of the process that loads plugins and creates the others. It may create a process only as
/// its sibling (CLONE_PARENT), as `PluginHost` does.
void print_loading() {
  Filter filter(SCMP_ACT_ALLOW);
  forbid_hostile(filter);
  for (const char* call : of_verbs) filter.add(SCMP_ACT_KILL_PROCESS, call);
  filter.add(SCMP_ACT_ERRNO(ENOSYS), "clone3");
  filter.add(SCMP_ACT_KILL_PROCESS, "clone", masked(0, CLONE_THREAD | CLONE_PARENT, 0));
  filter.add(SCMP_ACT_ERRNO(EAGAIN), "clone", masked(0, CLONE_THREAD, CLONE_THREAD));
  filter.add(SCMP_ACT_ERRNO(EPERM), "prlimit64", is_not(0, 0));
  // Memory to which no limit applies: shared without a file, or growing like a stack.
  constexpr unsigned flags = 3;
  constexpr scmp_datum_t shared = MAP_SHARED | MAP_ANONYMOUS;
  filter.add(SCMP_ACT_KILL_PROCESS, "mmap", masked(flags, shared, shared));
  filter.add(SCMP_ACT_KILL_PROCESS, "mmap", masked(flags, MAP_GROWSDOWN, MAP_GROWSDOWN));
  filter.print("loading");
}

/// Filter of a command, which may signal its own children, but not its parent, process 1 or all
/// processes.
void print_visit() {
  Filter filter(SCMP_ACT_ALLOW);
  forbid_hostile(filter);
  for (const std::uint32_t spared : {parent_process, 1U, 0U, 0xFFFFFFFFU})
    filter.add(SCMP_ACT_KILL_PROCESS, "kill", is_int(0, spared));
  for (const std::uint32_t spared : {parent_process, 1U})
    filter.add(SCMP_ACT_KILL_PROCESS, "tkill", is_int(0, spared));
  filter.print("visit");
}

/// Filter of a process that evaluates, installed in addition to `print_loading`. It permits only
/// the listed calls.
void print_computing() {
  Filter filter(SCMP_ACT_ERRNO(EPERM));
  for (const char* call : computing) filter.add(SCMP_ACT_ALLOW, call);
  constexpr unsigned flags = 3;
  filter.add(SCMP_ACT_ALLOW, "mmap", masked(flags, MAP_GROWSDOWN, 0));
  filter.add(SCMP_ACT_ALLOW, "prlimit64", is(0, 0), is(2, 0));
  // abort() and raise() need tgkill.
  filter.add(SCMP_ACT_ALLOW, "tgkill", is(0, own_process));
  filter.add(SCMP_ACT_KILL_PROCESS, "tgkill", is_not(0, own_process));
  filter.add(SCMP_ACT_ERRNO(EAGAIN), "clone");
  filter.add(SCMP_ACT_ERRNO(ENOSYS), "clone3");
  for (const char* call : {"chdir", "fchdir", "umask"}) filter.add(SCMP_ACT_KILL_PROCESS, call);
  filter.print("computing");
}

}  // namespace

int main() {
  std::puts(
      "// Written by make_filters.\n#include \"platform/process/filters.h\"\n\nnamespace "
      "nonio::process {\n");
  print_loading();
  print_visit();
  print_computing();
  std::puts("}  // namespace nonio::process");
  return std::fflush(stdout) == 0 ? 0 : 1;
}
