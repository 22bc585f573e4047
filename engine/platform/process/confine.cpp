// SPDX-License-Identifier: Apache-2.0
#include "platform/process/confine.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <set>
#include <span>
#include <string_view>

#include "platform/process/filters.h"

namespace nonio::process {
namespace fs = std::filesystem;

namespace {

// Restrictions of file access by Landlock (Documentation/userspace-api/landlock.rst).

/// The structure of Landlock ABI 6. An older kernel accepts a structure longer than its own if the
/// additional bytes are 0.
struct Ruleset {
  std::uint64_t files = 0, net = 0, scoped = 0;
};

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
  if (rule.parent_fd < 0) return;
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
  if (abi < 1) return {};
  const Ruleset all = everything(abi);
  const auto fd = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &all, sizeof all, 0));
  if (fd < 0) return why_not("Landlock");
  for (const fs::path& path : readable) allow_reading(fd, path);
  return apply(fd);
}

/// Landlock can only list what is allowed, so the folders `above` a secret are allowed entry by
/// entry.
void allow_all_but(int ruleset, const fs::path& folder, const std::set<fs::path>& above,
                   const std::set<fs::path>& secrets) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    std::error_code ignored;
    if (it->is_symlink(ignored) || secrets.contains(path)) continue;
    if (above.contains(path))
      allow_all_but(ruleset, path, above, secrets);
    else
      allow_reading(ruleset, path, LANDLOCK_ACCESS_FS_READ_FILE);
  }
}

bool computing_confined = false;

std::string forbid(std::span<const sock_filter> calls) {
  std::array<sock_filter, most_filter_steps> steps;
  const sock_fprog program{static_cast<unsigned short>(calls.size()), steps.data()};
  const auto own = static_cast<std::uint32_t>(::getpid()),
             parent = static_cast<std::uint32_t>(::getppid());
  std::transform(calls.begin(), calls.end(), steps.begin(), [&](sock_filter step) {
    if (step.k == own_process) step.k = own;
    if (step.k == parent_process) step.k = parent;
    return step;
  });
  return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0 ? ""
                                                                           : why_not("seccomp");
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
  return has_seccomp() ? forbid(loading_filter) : "";
}

std::string confine_visit() {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return why_not("no_new_privs");
  set_limit(RLIMIT_CORE, 0);
  return has_seccomp() ? forbid(visit_filter) : "";
}

std::string hide_files(const std::vector<fs::path>& files) {
  std::set<fs::path> secrets, above;
  for (const fs::path& file : files) {
    std::error_code error;
    const fs::path path = fs::canonical(file, error);
    if (error) continue;
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
  if (!has_seccomp()) return {};
  std::string why = forbid(computing_filter);
  computing_confined = why.empty();
  return why;
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

}  // namespace nonio::process
