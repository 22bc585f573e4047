// SPDX-License-Identifier: Apache-2.0
// Loaded before the C library (LD_PRELOAD): calls on paths that end as NONIO_FAULTS says fail, or
// never return. NONIO_FAULTS is "CALL:END:ERRNO", "CALL:END:hang" or "CALL:END:slow" (5 ms),
// several with a space between; CALL is open or stat. NONIO_FAULTS_AFTER = PATH: only
// once there is such a file.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

bool ends_with(const char* text, const char* end, std::size_t size) {
  const std::size_t length = std::strlen(text);
  return length >= size && std::strncmp(text + length - size, end, size) == 0;
}

/// errno of the fault, or 0.
int fault(const char* call, const char* path) {
  const char* rule = std::getenv("NONIO_FAULTS");
  const char* const after = std::getenv("NONIO_FAULTS_AFTER");
  if (after != nullptr && ::access(after, F_OK) != 0) return 0;
  while (rule != nullptr && *rule != '\0') {
    const char* const end = std::strchr(rule, ':');
    const char* const what = end == nullptr ? nullptr : std::strchr(end + 1, ':');
    if (what == nullptr) return 0;
    if (std::strncmp(rule, call, static_cast<std::size_t>(end - rule)) == 0 &&
        ends_with(path, end + 1, static_cast<std::size_t>(what - end - 1))) {
      while (std::strncmp(what + 1, "hang", 4) == 0) ::pause();
      if (std::strncmp(what + 1, "slow", 4) == 0) return ::usleep(5000);
      return std::atoi(what + 1);
    }
    rule = std::strchr(what, ' ');
    if (rule != nullptr) ++rule;
  }
  return 0;
}

template <class Call, class... Arguments>
int pass_on(const char* name, const char* kind, const char* path, Arguments... arguments) {
  if (const int code = fault(kind, path); code != 0) {
    errno = code;
    return -1;
  }
  return reinterpret_cast<Call>(::dlsym(RTLD_NEXT, name))(arguments...);
}

/// The whole path of a name in an open folder, by which C++'s walks open what is in it.
const char* below(int folder, const char* path, char* to, std::size_t size) {
  char link[64];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
  const ssize_t length = path[0] == '/' ? -1 : ::readlink(link, to, size - 1);
  if (length < 0 || static_cast<std::size_t>(length) + std::strlen(path) + 2 > size) return path;
  std::snprintf(to + length, size - static_cast<std::size_t>(length), "/%s", path);
  return to;
}

using Open = int (*)(const char*, int, mode_t);
using OpenAt = int (*)(int, const char*, int, mode_t);
using Stat = int (*)(const char*, struct stat*);
using StatAt = int (*)(int, const char*, struct stat*, int);

mode_t mode_of(int flags, va_list list) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(list, mode_t) : 0;
}

}  // namespace

#define NONIO_OPEN(name)                                          \
  extern "C" int name(const char* path, int flags, ...) {         \
    va_list list;                                                 \
    va_start(list, flags);                                        \
    const mode_t mode = mode_of(flags, list);                     \
    va_end(list);                                                 \
    return pass_on<Open>(#name, "open", path, path, flags, mode); \
  }
#define NONIO_OPEN_AT(name)                                                                       \
  extern "C" int name(int folder, const char* path, int flags, ...) {                             \
    va_list list;                                                                                 \
    va_start(list, flags);                                                                        \
    const mode_t mode = mode_of(flags, list);                                                     \
    va_end(list);                                                                                 \
    char whole[8192];                                                                             \
    return pass_on<OpenAt>(#name, "open", below(folder, path, whole, sizeof whole), folder, path, \
                           flags, mode);                                                          \
  }
#define NONIO_STAT(name)                                     \
  extern "C" int name(const char* path, struct stat* info) { \
    return pass_on<Stat>(#name, "stat", path, path, info);   \
  }

// The C library's own calls of open pass these by.
#define NONIO_OPENER(type, name, ...)                                          \
  extern "C" type* name(const char* path __VA_OPT__(, const char* mode)) {     \
    if (const int code = fault("open", path); code != 0) {                     \
      errno = code;                                                            \
      return nullptr;                                                          \
    }                                                                          \
    return reinterpret_cast<type* (*)(const char* __VA_OPT__(, const char*))>( \
        ::dlsym(RTLD_NEXT, #name))(path __VA_OPT__(, mode));                   \
  }

NONIO_OPENER(DIR, opendir)
NONIO_OPENER(FILE, fopen, mode)
NONIO_OPENER(FILE, fopen64, mode)
NONIO_OPEN(open)
NONIO_OPEN(open64)
NONIO_OPEN_AT(openat)
NONIO_OPEN_AT(openat64)
#undef stat64
#undef lstat64
NONIO_STAT(stat)
NONIO_STAT(lstat)
extern "C" int stat64(const char* path, struct stat64* info) {
  return pass_on<int (*)(const char*, struct stat64*)>("stat64", "stat", path, path, info);
}
extern "C" int lstat64(const char* path, struct stat64* info) {
  return pass_on<int (*)(const char*, struct stat64*)>("lstat64", "stat", path, path, info);
}
