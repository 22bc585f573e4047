// SPDX-License-Identifier: Apache-2.0
#include "platform/process/process_state.h"

#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <csignal>
#include <filesystem>
#include <locale>
#include <optional>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "platform/process/confine.h"

namespace nonio::process {

namespace {

/// Combines the rounding mode with the control bits of MXCSR (denormal numbers, exception masks),
/// without its exception flags.
unsigned processor_mode() {
  auto mode = static_cast<unsigned>(std::fegetround());
#if defined(__SSE__)
  constexpr unsigned flags = 0x3f;
  mode ^= (_mm_getcsr() & ~flags) << 16;
#endif
  return mode;
}

struct Kept {
  unsigned mode = 0;
  std::fenv_t environment{};
  std::string c_locale;
  std::locale cpp_locale;
  sigset_t signals{};
  mode_t mask = 0;
  std::string folder;
};

std::optional<Kept> kept;

mode_t mode_mask() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return mask;
}

std::string working_folder() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
}

bool same_signals(const sigset_t& a, const sigset_t& b) {
  for (int signal = 1; signal < NSIG; ++signal)
    if (sigismember(&a, signal) != sigismember(&b, signal)) return false;
  return true;
}

void say(std::string& words, const char* what) {
  words += (words.empty() ? "" : ", ") + std::string(what);
}

}  // namespace

void keep_process_state() {
  Kept now;
  now.mode = processor_mode();
  std::fegetenv(&now.environment);
  now.c_locale = std::setlocale(LC_ALL, nullptr);
  pthread_sigmask(SIG_SETMASK, nullptr, &now.signals);
  now.mask = mode_mask();
  now.folder = working_folder();
  kept = std::move(now);
}

std::string restore_process_state() {
  if (!kept) return {};
  std::string words;
  if (processor_mode() != kept->mode) {
    say(words, "the rounding mode");
    std::fesetenv(&kept->environment);
  }
  if (kept->c_locale != std::setlocale(LC_ALL, nullptr) ||
      ::uselocale(nullptr) != LC_GLOBAL_LOCALE || std::locale() != kept->cpp_locale) {
    say(words, "the locale");
    ::uselocale(LC_GLOBAL_LOCALE);
    std::locale::global(kept->cpp_locale);
    std::setlocale(LC_ALL, kept->c_locale.c_str());
  }
  sigset_t signals{};
  pthread_sigmask(SIG_SETMASK, nullptr, &signals);
  if (!same_signals(signals, kept->signals)) {
    say(words, "the signal mask");
    pthread_sigmask(SIG_SETMASK, &kept->signals, nullptr);
  }
  if (is_computing_confined()) return words;
  if (mode_mask() != kept->mask) {
    say(words, "the umask");
    ::umask(kept->mask);
  }
  if (working_folder() != kept->folder) {
    say(words, "the working directory");
    [[maybe_unused]] const int gone = ::chdir(kept->folder.c_str());
  }
  return words;
}

}  // namespace nonio::process
