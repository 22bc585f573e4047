// SPDX-License-Identifier: Apache-2.0
// Does harm before anything in it is called: what, says its name, test_on_load_WHAT.so.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cfenv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "nonio/sdk/plugin.h"

namespace {

/// In the child in which a verb tries plugins first: that has one more filter.
bool is_tried() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("Seccomp_filters:")) return line.back() != '1';
  return false;
}

int harm();

std::string_view what() {
  Dl_info here{};
  if (::dladdr(reinterpret_cast<const void*>(&harm), &here) == 0) std::abort();
  const std::string_view path = here.dli_fname, before = "test_on_load_";
  const std::size_t begin = path.rfind(before) + before.size();
  return path.substr(begin, path.rfind('.') - begin);
}

int harm() {
  const std::string_view how = what();
  if (how == "quits") std::exit(0);
  if (how == "hangs")
    for (;;) ::pause();
  if (how == "kills") ::kill(::getppid(), SIGKILL);
  // The kernel takes the lower half.
  if (how == "kills-by-half")
    ::syscall(SYS_tgkill, (1L << 32) | ::getppid(), (1L << 32) | ::getppid(), SIGKILL);
  if (how == "kills-visited" && !is_tried()) ::kill(::getppid(), SIGKILL);
  if (how == "types-visited" && !is_tried()) ::ioctl(0, (1UL << 32) | TIOCSTI, "x");
  if (how == "leaves-visited" && !is_tried()) {
    if (::fork() == 0 && ::setsid() > 0)
      for (;;) ::pause();
    std::puts("it left a process");
    std::fflush(stdout);
  }
  if (how == "prints") std::puts("{\"event\":\"forged\"}"), std::fflush(stdout);
  if (how == "rounds") std::fesetround(FE_UPWARD);
  if (how == "reads" && ::open(std::getenv("NONIO_TEST_KEY"), O_RDONLY) >= 0)
    std::puts("it has the key"), std::fflush(stdout);
  if (how == "starts") ::execl("/bin/sh", "sh", "-c", "kill -9 $PPID", nullptr);
  return 0;
}

const int done = harm();

}  // namespace

NONIO_PLUGIN(registry) {
  (void)done;
  if (what() != "prepares-twice") return;
  nonio::Output output;
  output.info = {"second-thoughts", "1", "has no memory the first time", {}};
  output.applies = [](const nonio::Campaign&) { return false; };
  output.write = [](const nonio::OutputInput&) -> nonio::Expected<nonio::OutputResult> {
    return nonio::OutputResult{};
  };
  output.prepare = [](const nonio::Templates&) {
    static bool again = false;
    if (!std::exchange(again, true)) throw std::bad_alloc();
  };
  registry.add(output);
}
