// SPDX-License-Identifier: Apache-2.0
#include "confine.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <set>
#include <string_view>

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

// ---- files: Landlock (Documentation/userspace-api/landlock.rst)

/// As of ABI 6; a kernel takes a longer structure than it knows if the rest is 0.
struct Ruleset {
  std::uint64_t files = 0, net = 0, scoped = 0;
};

/// Of which later headers than Debian 12's have the names.
constexpr std::uint64_t truncate_right = 1ULL << 14, device_right = 1ULL << 15;
constexpr std::uint64_t bind_and_connect = 3, abstract_sockets_and_signals = 3;

int landlock_abi() {
  static const auto abi = static_cast<int>(
      ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION));
  return abi;
}

Ruleset everything(int abi) {
  Ruleset all;
  all.files = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;
  if (abi >= 2) all.files |= LANDLOCK_ACCESS_FS_REFER;
  if (abi >= 3) all.files |= truncate_right;
  if (abi >= 5) all.files |= device_right;
  if (abi >= 4) all.net = bind_and_connect;
  if (abi >= 6) all.scoped = abstract_sockets_and_signals;
  return all;
}

std::string why_not(const char* what) { return std::string(what) + ": " + std::strerror(errno); }

void allow_reading(int ruleset, const fs::path& path,
                   std::uint64_t rights = LANDLOCK_ACCESS_FS_READ_FILE |
                                          LANDLOCK_ACCESS_FS_READ_DIR) {
  landlock_path_beneath_attr rule{};
  rule.parent_fd = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (rule.parent_fd < 0) return;  // what is not there need not be read
  std::error_code error;
  rule.allowed_access = rights;
  if (!fs::is_directory(path, error)) rule.allowed_access &= LANDLOCK_ACCESS_FS_READ_FILE;
  ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  ::close(rule.parent_fd);
}

std::string apply(int ruleset) {
  const long done = ::syscall(SYS_landlock_restrict_self, ruleset, 0);
  const std::string why = done != 0 ? why_not("Landlock") : "";
  ::close(ruleset);
  return why;
}

std::string restrict_files(const std::vector<fs::path>& readable) {
  const int abi = landlock_abi();
  if (abi < 1) return {};  // said by lacking_confinement
  const Ruleset all = everything(abi);
  const auto fd = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &all, sizeof all, 0));
  if (fd < 0) return why_not("Landlock");
  for (const fs::path& path : readable) allow_reading(fd, path);
  return apply(fd);
}

/// Everything below a folder but the secrets: Landlock says what is allowed, not what is not.
void allow_all_but(int ruleset, const fs::path& folder, const std::set<fs::path>& above,
                   const std::set<fs::path>& secrets) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    std::error_code ignored;
    // What a link leads to is allowed where it lies.
    if (it->is_symlink(ignored) || secrets.contains(path)) continue;
    if (above.contains(path))
      allow_all_but(ruleset, path, above, secrets);
    else
      allow_reading(ruleset, path, LANDLOCK_ACCESS_FS_READ_FILE);
  }
}

// ---- system calls: seccomp

struct Release {
  void operator()(void* filter) const { ::seccomp_release(filter); }
};
using Filter = std::unique_ptr<void, Release>;

/// Nothing of this belongs into a computation: whoever tries is ended, with its name.
constexpr std::string_view hostile[] = {"execve",
                                        "execveat",
                                        "fork",
                                        "vfork",
                                        "socket",
                                        "socketpair",
                                        "connect",
                                        "bind",
                                        "listen",
                                        "accept",
                                        "accept4",
                                        "ptrace",
                                        "process_vm_readv",
                                        "process_vm_writev",
                                        "kill",
                                        "tkill",
                                        "pidfd_open",
                                        "pidfd_send_signal",
                                        "pidfd_getfd",
                                        "rt_sigqueueinfo",
                                        "rt_tgsigqueueinfo",
                                        "memfd_create",
                                        "memfd_secret",
                                        "shmget",
                                        "shmat",
                                        "shmctl",
                                        "msgget",
                                        "msgsnd",
                                        "msgrcv",
                                        "semget",
                                        "semop",
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
                                        "capset",
                                        "personality",
                                        "quotactl",
                                        "open_by_handle_at",
                                        "name_to_handle_at",
                                        "fanotify_init",
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
                                        "ioprio_set",
                                        "syslog",
                                        "acct"};

/// What a computation does, and how it looks at files that it may not open.
constexpr std::string_view computing[] = {"read",
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

void add(const Filter& filter, std::uint32_t action, std::string_view call) {
  const int number = ::seccomp_syscall_resolve_name(std::string(call).c_str());
  if (number != __NR_SCMP_ERROR) ::seccomp_rule_add(filter.get(), action, number, 0);
}

template <class... Compare>
void add_if(const Filter& filter, std::uint32_t action, const char* call, Compare... compare) {
  const int number = ::seccomp_syscall_resolve_name(call);
  if (number != __NR_SCMP_ERROR)
    ::seccomp_rule_add(filter.get(), action, number, sizeof...(compare), compare...);
}

std::string load(const Filter& filter) {
  const int code = ::seccomp_load(filter.get());
  return code == 0 ? "" : std::string("seccomp: ") + std::strerror(-code);
}

scmp_arg_cmp masked(unsigned argument, scmp_datum_t mask, scmp_datum_t value) {
  return {argument, SCMP_CMP_MASKED_EQ, mask, value};
}

/// Memory that no limit counts: shared without a file, or growing like a stack.
void forbid_uncounted_memory(const Filter& filter, std::uint32_t action) {
  constexpr unsigned flags = 3;  // argument of mmap
  add_if(filter, action, "mmap",
         masked(flags, MAP_SHARED | MAP_ANONYMOUS, MAP_SHARED | MAP_ANONYMOUS));
  add_if(filter, action, "mmap", masked(flags, MAP_GROWSDOWN, MAP_GROWSDOWN));
}

/// For the process that loads plugins and makes the others: everything but what is hostile. A
/// process may be made as its sibling only, which is how `PluginHost` does it.
std::string forbid_hostile() {
  const Filter filter(::seccomp_init(SCMP_ACT_ALLOW));
  if (!filter) return "seccomp: no memory";
  for (const std::string_view call : hostile) add(filter, SCMP_ACT_KILL_PROCESS, call);
  add(filter, SCMP_ACT_ERRNO(ENOSYS), "clone3");  // whose arguments a filter does not see
  add_if(filter, SCMP_ACT_KILL_PROCESS, "clone", masked(0, CLONE_THREAD | CLONE_PARENT, 0));
  add_if(filter, SCMP_ACT_ERRNO(EAGAIN), "clone", masked(0, CLONE_THREAD, CLONE_THREAD));
  for (const pid_t spared : {::getppid(), 1})
    add_if(filter, SCMP_ACT_KILL_PROCESS, "tgkill",
           scmp_arg_cmp{0, SCMP_CMP_EQ, static_cast<scmp_datum_t>(spared), 0});
  // signals by way of a descriptor
  for (const scmp_datum_t command : {F_SETOWN, F_SETSIG, 15 /* F_SETOWN_EX */})
    add_if(filter, SCMP_ACT_KILL_PROCESS, "fcntl", scmp_arg_cmp{1, SCMP_CMP_EQ, command, 0});
  add_if(filter, SCMP_ACT_ERRNO(EPERM), "prlimit64", scmp_arg_cmp{0, SCMP_CMP_NE, 0, 0});
  add_if(filter, SCMP_ACT_KILL_PROCESS, "ioctl",
         scmp_arg_cmp{1, SCMP_CMP_EQ, 0x5412 /* TIOCSTI */, 0});
  forbid_uncounted_memory(filter, SCMP_ACT_KILL_PROCESS);
  return load(filter);
}

std::string forbid_talking() {
  const Filter filter(::seccomp_init(SCMP_ACT_ALLOW));
  if (!filter) return "seccomp: no memory";
  for (const char* call : {"execve",
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
                           "bpf",
                           "keyctl",
                           "add_key",
                           "request_key",
                           "mount",
                           "unshare",
                           "setns",
                           "io_uring_setup",
                           "userfaultfd",
                           "perf_event_open"})
    add(filter, SCMP_ACT_KILL_PROCESS, call);
  return load(filter);
}

bool computing_confined = false;

std::string allow_computing() {
  const Filter filter(::seccomp_init(SCMP_ACT_ERRNO(EPERM)));
  if (!filter) return "seccomp: no memory";
  for (const std::string_view call : computing) add(filter, SCMP_ACT_ALLOW, call);
  constexpr unsigned flags = 3;
  add_if(filter, SCMP_ACT_ALLOW, "mmap", masked(flags, MAP_GROWSDOWN, 0));
  add_if(filter, SCMP_ACT_ALLOW, "prlimit64", scmp_arg_cmp{0, SCMP_CMP_EQ, 0, 0},
         scmp_arg_cmp{2, SCMP_CMP_EQ, 0, 0});
  // abort() and raise(), to nobody else
  add_if(filter, SCMP_ACT_ALLOW, "tgkill",
         scmp_arg_cmp{0, SCMP_CMP_EQ, static_cast<scmp_datum_t>(::getpid()), 0});
  add(filter, SCMP_ACT_ERRNO(EAGAIN), "clone");
  add(filter, SCMP_ACT_ERRNO(ENOSYS), "clone3");
  add_if(filter, SCMP_ACT_KILL_PROCESS, "tgkill",
         scmp_arg_cmp{0, SCMP_CMP_NE, static_cast<scmp_datum_t>(::getpid()), 0});
  for (const char* call : {"chdir", "fchdir", "umask"}) add(filter, SCMP_ACT_KILL_PROCESS, call);
  const std::string why = load(filter);
  computing_confined = why.empty();
  return why;
}

bool has_seccomp() { return ::prctl(PR_GET_SECCOMP) >= 0; }

void drop_capabilities() {
  ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  for (unsigned long cap = 0; ::prctl(PR_CAPBSET_DROP, cap, 0, 0, 0) == 0; ++cap)
    ;
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  const std::array<__user_cap_data_struct, 2> none{};
  ::syscall(SYS_capset, &head, none.data());
}

void set_limit(__rlimit_resource what, rlim_t most) {
  const rlimit limit{most, most};
  ::setrlimit(what, &limit);
}

}  // namespace

std::vector<std::string> lacking_confinement() {
  std::vector<std::string> lacking;
  const int abi = landlock_abi();
  if (abi < 1)
    lacking.emplace_back(
        "this kernel has no Landlock: a plugin can read and write the files that this user can, "
        "the signing key among them");
  if (!has_seccomp())
    lacking.emplace_back(
        "this kernel has no seccomp: a plugin can start programs, open connections and signal "
        "other processes of this user");
  return lacking;
}

std::string confine_loading(const std::vector<fs::path>& readable) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return why_not("no_new_privs");
  drop_capabilities();
  set_limit(RLIMIT_CORE, 0);
  if (const std::string why = restrict_files(readable); !why.empty()) return why;
  return has_seccomp() ? forbid_hostile() : "";
}

std::string confine_visit() {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return why_not("no_new_privs");
  set_limit(RLIMIT_CORE, 0);
  return has_seccomp() ? forbid_talking() : "";
}

std::string hide_files(const std::vector<fs::path>& files) {
  std::set<fs::path> secrets, above;
  for (const fs::path& file : files) {
    std::error_code error;
    const fs::path path = fs::canonical(file, error);
    if (error) continue;  // there is none to hide
    secrets.insert(path);
    for (fs::path p = path.parent_path(); above.insert(p).second;) p = p.parent_path();
  }
  if (secrets.empty() || landlock_abi() < 1) return {};
  const Ruleset reading{LANDLOCK_ACCESS_FS_READ_FILE, 0, 0};
  const auto fd =
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &reading, sizeof reading, 0));
  if (fd < 0) return why_not("Landlock");
  allow_all_but(fd, "/", above, secrets);
  return apply(fd);
}

std::string confine_files() { return restrict_files({}); }

std::string confine_computing() {
  constexpr rlim_t descriptors = 64;
  set_limit(RLIMIT_NPROC, 0);
  set_limit(RLIMIT_FSIZE, 0);
  set_limit(RLIMIT_NOFILE, descriptors);
  return has_seccomp() ? allow_computing() : "";
}

bool is_computing_confined() { return computing_confined; }

void close_others(const std::vector<int>& kept) {
  unsigned first = 3;
  for (const int fd : kept) {
    const auto keep = static_cast<unsigned>(fd);
    if (keep > first) ::close_range(first, keep - 1, 0);
    first = std::max(first, keep + 1);
  }
  ::close_range(first, ~0U, 0);
}

void forget_environment() {
  constexpr std::string_view kept[] = {
      "LC_",      "LANG",  "TZ=",     "NONIO_TEST_", "NONIO_PLUGIN_PATH=",
      "PATH=",    "HOME=", "TMPDIR=", "TERM=",       "NO_COLOR=",
      "COLUMNS=", "ASAN_", "UBSAN_",  "TSAN_",       "LSAN_"};
  for (char** one = environ; one != nullptr && *one != nullptr; ++one) {
    const std::string_view entry = *one;
    const bool keep = std::any_of(std::begin(kept), std::end(kept),
                                  [&](std::string_view k) { return entry.starts_with(k); });
    if (!keep) ::explicit_bzero(*one, entry.size());
  }
}

}  // namespace nonio::host
