// SPDX-License-Identifier: Apache-2.0
// An analysis that does what no plugin may do: what, says its option `how`; with which file,
// `path`. What it got hold of it says in its error; if it got nothing, it gives a result.
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cfenv>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <locale>
#include <map>
#include <stdexcept>
#include <thread>

#include "nonio/sdk/plugin.h"

namespace {

using namespace nonio;

const char* path = "";

constexpr std::size_t much = std::size_t{2} << 30;

void hold(int flags, int fd) {
  auto* block = static_cast<char*>(::mmap(nullptr, much, PROT_READ | PROT_WRITE, flags, fd, 0));
  if (block == MAP_FAILED) return;
  for (std::size_t i = 0; i < much; i += 4096) block[i] = 1;
  throw std::runtime_error("2 GB held");
}

void got(bool it, const char* what) {
  if (it) throw std::runtime_error(std::string("got hold of ") + what);
}

void start_program() {
  ::execl("/bin/sh", "sh", "-c", (std::string("echo gotcha > ") + path).c_str(), nullptr);
}
void leave_process() {
  if (::fork() == 0)
    for (;;) ::pause();
}
void connect_somewhere() {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(9);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  static_cast<void>(::connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to));
  got(fd >= 0, "a socket");
}
void read_file() { got(::open(path, O_RDONLY) >= 0, "a file to read"); }
void append() {
  const int fd = ::open(path, O_WRONLY | O_APPEND);
  got(fd >= 0 && ::write(fd, "0 0\n", 4) == 4, "a file to write");
}
void make() { got(::open(path, O_WRONLY | O_CREAT, 0644) >= 0, "a new file"); }
void kill_parent() { ::kill(::getppid(), SIGKILL); }
void kill_thread() { ::syscall(SYS_tgkill, ::getppid(), ::getppid(), SIGKILL); }
// The call must be refused; signal 0 ends no process if it is not.
void kill_all() { ::kill(-1, 0); }
void descriptors() {
  int open = 0;
  for (int fd = 3; fd < 1024; ++fd) open += ::fcntl(fd, F_GETFD) >= 0 ? 1 : 0;
  got(open > 3, "descriptors that are not its own");  // its stream, its words, the file it reads
}
void environment() { got(std::getenv("KEY_PASSWORD") != nullptr, "the password"); }
void parent_environment() {
  got(::open(("/proc/" + std::to_string(::getppid()) + "/environ").c_str(), O_RDONLY) >= 0,
      "the password");
}
void thread() {
  std::thread([] {}).join();
  got(true, "a thread");
}
void shared_memory() { hold(MAP_SHARED | MAP_ANONYMOUS, -1); }
void memory_file() {
  const int fd = ::memfd_create("x", 0);
  if (::ftruncate(fd, static_cast<off_t>(much)) == 0) hold(MAP_SHARED, fd);
}
void growing_memory() { hold(MAP_PRIVATE | MAP_ANONYMOUS | MAP_GROWSDOWN | MAP_NORESERVE, -1); }
void rounding() { std::fesetround(FE_UPWARD); }
void locale() {
  struct Comma final : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  std::locale::global(std::locale(std::locale::classic(), new Comma));
}
void signal_mask() {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, nullptr);
}
void mode_mask() { ::umask(0777); }
void folder() { [[maybe_unused]] const int done = ::chdir("/"); }
void quit() { std::exit(0); }
void print() {
  std::cout << "{\"event\":\"forged\"}" << std::endl;
  std::puts("{\"event\":\"forged\"}");
  std::fflush(stdout);
  [[maybe_unused]] const ssize_t n = ::write(1, "{\"event\":\"forged\"}\n", 19);
}
void print_much() {
  for (int i = 0; i < 10'000; ++i)
    std::cerr << "a line that nobody wants to read, again and again\n";
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  static const std::map<std::string, void (*)()> all = {{"program", start_program},
                                                        {"process", leave_process},
                                                        {"connect", connect_somewhere},
                                                        {"read", read_file},
                                                        {"append", append},
                                                        {"make", make},
                                                        {"kill-parent", kill_parent},
                                                        {"kill-thread", kill_thread},
                                                        {"kill-all", kill_all},
                                                        {"descriptors", descriptors},
                                                        {"environment", environment},
                                                        {"parent-environment", parent_environment},
                                                        {"thread", thread},
                                                        {"shared-memory", shared_memory},
                                                        {"memory-file", memory_file},
                                                        {"growing-memory", growing_memory},
                                                        {"rounding", rounding},
                                                        {"locale", locale},
                                                        {"signal-mask", signal_mask},
                                                        {"umask", mode_mask},
                                                        {"folder", folder},
                                                        {"quit", quit},
                                                        {"print", print},
                                                        {"print-much", print_much}};
  const std::string how = in.options.text("how"), where = in.options.text("path");
  path = where.c_str();
  if (const auto found = all.find(how); found != all.end()) found->second();
  return Evaluation();
}

const std::vector<Option> options = {{"how", std::string("well"), "", "What to do"},
                                     {"path", std::string(""), "", "With which file"}};

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(Analysis{{"hostile", "1", "Does what no plugin may do", options},
                        [](const Campaign&, const Measurement&) { return true; },
                        analyse});
}
