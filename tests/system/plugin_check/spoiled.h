// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

#include "nonio/sdk/plugin.h"

/// What the spoiled plugins share. Each library exists once and is copied under many names:
/// "reader--deviation-x1000.so" has the fault "deviation-x1000", "reader--none.so" has none.
namespace spoiled {

inline void here() {}

inline const std::string& fault() {
  static const std::string name = [] {
    Dl_info info{};
    ::dladdr(reinterpret_cast<const void*>(&here), &info);
    const std::string stem = std::filesystem::path(info.dli_fname).stem().string();
    const std::size_t at = stem.find("--");
    return at == stem.npos ? stem : stem.substr(at + 2);
  }();
  return name;
}

inline bool has(std::string_view name) { return fault() == name; }

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double inf = std::numeric_limits<double>::infinity();

[[noreturn]] inline void crash() {
  volatile int* nowhere = nullptr;
  *nowhere = 1;
  std::abort();
}

inline void hang() {
  volatile bool on = true;
  while (on) on = true;
}

/// What no plugin may do or depend on: 1 where it shows.
inline double impurity() {
  if (has("by-the-clock")) {
    const std::time_t now = std::time(nullptr);
    return static_cast<double>(now % 1000003);
  }
  if (has("by-the-date")) {
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    ::localtime_r(&now, &local);
    return local.tm_mday;
  }
  if (has("by-home")) {
    const char* home = std::getenv("HOME");
    return home == nullptr ? 0.0 : static_cast<double>(std::string_view(home).size()) + home[1];
  }
  if (has("by-folder")) return static_cast<double>(std::filesystem::current_path().string().size());
  if (has("writes-a-file")) std::ofstream("/dev/null") << "a";
  if (has("reads-a-file")) {
    std::string line;
    std::ifstream("/proc/self/status") >> line;
  }
  if (has("opens-a-socket"))
    if (const int line = ::socket(AF_UNIX, SOCK_STREAM, 0); line >= 0) ::close(line);
  if (has("makes-a-process")) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    if (child > 0) ::waitpid(child, nullptr, 0);
  }
  if (has("runs-a-program")) [[maybe_unused]]
    const int code = std::system("true");
  return 0.0;
}

inline double counted() {
  static int calls = 0;
  return has("counts-calls") ? ++calls : 0;
}

/// Mistakes in what a plugin says of itself.
inline nonio::Info info(const char* name) {
  nonio::Info i{name, "1", "Wrong on purpose", {}};
  const auto option = [&](nonio::Option o) { i.options.push_back(std::move(o)); };
  if (has("capitals")) i.name = "Spoiled";
  if (has("two-words")) i.name = "spoiled plugin";
  if (has("no-version")) i.version = "";
  if (has("version-in-words")) i.version = "one";
  if (has("no-summary")) i.summary = "";
  if (has("summary-of-two-lines")) i.summary = "Wrong\non purpose";
  if (has("option-twice"))
    option({"size", 1.0, "", "A size."}), option({"size", 2.0, "", "Again."});
  if (has("option-with-a-blank")) option({"a size", 1.0, "", "A size."});
  if (has("no-help")) option({"size", 1.0, "", ""});
  if (has("default-out-of-range")) option({"size", 5.0, "", "A size.", {}, 0.0, 1.0});
  if (has("unit-of-another")) option({"size_mm", 5.0, "um", "A size."});
  if (has("default-no-choice")) option({"kind", std::string("c"), "", "A kind.", {"a", "b"}});
  if (has("choice-twice")) option({"kind", std::string("a"), "", "A kind.", {"a", "a"}});
  if (has("range-turned")) option({"size", 5.0, "", "A size.", {}, 9.0, 1.0});
  if (has("default-no-number")) option({"size", nan, "", "A size."});
  return i;
}

inline void at_registration() {
  if (has("throws-at-start")) throw std::runtime_error("wrong on purpose");
  if (has("crashes-at-start")) crash();
  if (has("slow-at-start")) {
    const std::clock_t begin = std::clock();
    while (std::clock() - begin < 2 * CLOCKS_PER_SEC) {
    }
  }
}

}  // namespace spoiled
