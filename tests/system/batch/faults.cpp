// SPDX-License-Identifier: Apache-2.0
// Loaded before the C library (LD_PRELOAD): the N-th call of one of its functions fails, counted
// over all processes of a run. NONIO_FAULT is one of
//   FUNCTION:N:ERRNO[:TIMES]  fails with this error, TIMES times
//   FUNCTION:N:KILL           ends the main process by SIGKILL
//   rename:N:REPLAY           renames and returns ENOENT, as NFS does if an answer was lost
//   write:N:LOST              writes nothing and returns success
//   write:N:LATE              writes, and a later syncfs fails as on Linux after an error of the
//                             disk: once for each descriptor opened before, for none opened after
// NONIO_FAULT_IN = main: only calls of the main process count; = confining: only those while a
// process that evaluates confines itself. NONIO_FAULT_COUNTS = FILE receives the counts of calls.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
}

namespace {

constexpr const char* names[] = {"open",   "read",   "write",      "fsync",   "syncfs", "rename",
                                 "unlink", "mkdir",  "mmap",       "malloc",  "fork",   "flock",
                                 "stat",   "fflush", "socketpair", "opendir", "readdir"};
enum Function {
  Open,
  Read,
  Write,
  Fsync,
  Syncfs,
  Rename,
  Unlink,
  Mkdir,
  Mmap,
  Malloc,
  Fork,
  Flock,
  Stat,
  Fflush,
  Socketpair,
  Opendir,
  Readdir,
  functions
};

std::atomic<long>* counts = nullptr;  // shared by the processes
int wanted = -1;
long from = 0, times = 1;
constexpr int lost = 0x10000;              // not written, reported as written
constexpr int late = 0x20000;              // written, reported by syncfs as failed
constexpr int replay = 0x40000;            // renamed, reported as failed
std::atomic<long>* disk_failed = nullptr;  // shared by the processes
bool told[1024];                           // descriptors whose syncfs reports no error (any more)
int code = 0;                              // 0: kill
bool main_only = false, confining_only = false, confining = false;
pid_t main_pid = 0;

template <class F>
F real(const char* name) {
  return reinterpret_cast<F>(::dlsym(RTLD_NEXT, name));
}

int opened(int fd) {
  if (fd >= 0 && fd < 1024) told[fd] = disk_failed != nullptr && *disk_failed != 0;
  return fd;
}

bool hears_of_the_disk(int fd) {
  if (fd < 0 || fd >= 1024 || told[fd] || disk_failed == nullptr || *disk_failed == 0) return false;
  told[fd] = true;
  errno = EIO;
  return true;
}

bool fails(Function f) {
  if (counts == nullptr || (main_only && ::getpid() != main_pid) || (confining_only && !confining))
    return false;
  const long n = ++counts[f];
  if (f != wanted || n < from || n >= from + times) return false;
  if (code == 0) {
    ::kill(main_pid, SIGKILL);
    ::kill(::getpid(), SIGKILL);
  }
  errno = code;
  return true;
}

__attribute__((constructor)) void begin() {
  const char* const counted = std::getenv("NONIO_FAULT_COUNTS");
  const char* const text = std::getenv("NONIO_FAULT");
  if (text == nullptr && counted == nullptr) return;
  char name[32] = "", what[32] = "";
  if (text != nullptr &&
      std::sscanf(text, "%31[^:]:%ld:%31[^:]:%ld", name, &from, what, &times) < 3)
    return;
  for (int i = 0; i < functions; ++i)
    if (std::strcmp(names[i], name) == 0) wanted = i;
  code = std::strcmp(what, "KILL") == 0     ? 0
         : std::strcmp(what, "LOST") == 0   ? lost
         : std::strcmp(what, "LATE") == 0   ? late
         : std::strcmp(what, "REPLAY") == 0 ? replay
                                            : std::atoi(what);
  const char* const in = std::getenv("NONIO_FAULT_IN");
  main_only = in != nullptr && std::strcmp(in, "main") == 0;
  confining_only = in != nullptr && std::strcmp(in, "confining") == 0;
  main_pid = ::getpid();
  using Map = void* (*)(void*, size_t, int, int, int, off_t);
  void* shared =
      real<Map>("mmap")(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return;
  counts = static_cast<std::atomic<long>*>(shared);
  disk_failed = counts + functions;
}

__attribute__((destructor)) void end() {
  const char* const path = std::getenv("NONIO_FAULT_COUNTS");
  if (path == nullptr || counts == nullptr || ::getpid() != main_pid) return;
  std::atomic<long>* const counted = counts;
  counts = nullptr;
  if (std::FILE* file = std::fopen(path, "w")) {
    for (int i = 0; i < functions; ++i) std::fprintf(file, "%s %ld\n", names[i], counted[i].load());
    std::fclose(file);
  }
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  if (fails(Open)) return -1;
  return opened(real<int (*)(const char*, int, ...)>("open")(path, flags, mode));
}
int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  if (fails(Open)) return -1;
  return opened(real<int (*)(const char*, int, ...)>("open64")(path, flags, mode));
}
int openat(int at, const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  if (fails(Open)) return -1;
  return opened(real<int (*)(int, const char*, int, ...)>("openat")(at, path, flags, mode));
}
FILE* fopen(const char* path, const char* mode) {
  if (fails(Open)) return nullptr;
  return real<FILE* (*)(const char*, const char*)>("fopen")(path, mode);
}
ssize_t read(int fd, void* to, size_t n) {
  return fails(Read) ? -1 : real<ssize_t (*)(int, void*, size_t)>("read")(fd, to, n);
}
ssize_t write(int fd, const void* from_, size_t n) {
  struct stat file {};
  const bool is_file =
      real<int (*)(int, struct stat*)>("fstat")(fd, &file) == 0 && S_ISREG(file.st_mode);
  if (fails(Write) && (code < lost || is_file)) {
    if (code != late) return code == lost ? static_cast<ssize_t>(n) : -1;
    *disk_failed = 1;
  }
  return real<ssize_t (*)(int, const void*, size_t)>("write")(fd, from_, n);
}
int fsync(int fd) { return fails(Fsync) ? -1 : real<int (*)(int)>("fsync")(fd); }
int fdatasync(int fd) { return fails(Fsync) ? -1 : real<int (*)(int)>("fdatasync")(fd); }
int syncfs(int fd) noexcept {
  return fails(Syncfs) || hears_of_the_disk(fd) ? -1 : real<int (*)(int)>("syncfs")(fd);
}
int rename(const char* a, const char* b) noexcept {
  const bool fault = fails(Rename);
  if (fault && code != replay) return -1;
  const int done = real<int (*)(const char*, const char*)>("rename")(a, b);
  if (!fault || done != 0) return done;
  errno = ENOENT;
  return -1;
}
int unlink(const char* path) noexcept {
  return fails(Unlink) ? -1 : real<int (*)(const char*)>("unlink")(path);
}
int unlinkat(int at, const char* path, int flags) noexcept {
  return fails(Unlink) ? -1 : real<int (*)(int, const char*, int)>("unlinkat")(at, path, flags);
}
int remove(const char* path) noexcept {
  return fails(Unlink) ? -1 : real<int (*)(const char*)>("remove")(path);
}
int mkdir(const char* path, mode_t mode) noexcept {
  return fails(Mkdir) ? -1 : real<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}
void* mmap(void* at, size_t n, int protection, int flags, int fd, off_t offset) noexcept {
  if (fails(Mmap)) return MAP_FAILED;
  using Map = void* (*)(void*, size_t, int, int, int, off_t);
  return real<Map>("mmap")(at, n, protection, flags, fd, offset);
}
void* malloc(size_t n) noexcept { return fails(Malloc) ? nullptr : __libc_malloc(n); }
void* calloc(size_t n, size_t of) noexcept {
  return fails(Malloc) ? nullptr : __libc_calloc(n, of);
}
void* realloc(void* p, size_t n) noexcept { return fails(Malloc) ? nullptr : __libc_realloc(p, n); }
void* aligned_alloc(size_t to, size_t n) noexcept {
  return fails(Malloc) ? nullptr : __libc_memalign(to, n);
}
int posix_memalign(void** p, size_t to, size_t n) noexcept {
  if (fails(Malloc)) return ENOMEM;
  *p = __libc_memalign(to, n);
  return *p == nullptr ? ENOMEM : 0;
}
pid_t fork() noexcept { return fails(Fork) ? -1 : real<pid_t (*)()>("fork")(); }
int flock(int fd, int how) noexcept {
  return fails(Flock) ? -1 : real<int (*)(int, int)>("flock")(fd, how);
}
int stat(const char* path, struct stat* to) noexcept {
  return fails(Stat) ? -1 : real<int (*)(const char*, struct stat*)>("stat")(path, to);
}
int lstat(const char* path, struct stat* to) noexcept {
  return fails(Stat) ? -1 : real<int (*)(const char*, struct stat*)>("lstat")(path, to);
}
int fstat(int fd, struct stat* to) noexcept {
  return fails(Stat) ? -1 : real<int (*)(int, struct stat*)>("fstat")(fd, to);
}
int fflush(FILE* file) { return fails(Fflush) ? EOF : real<int (*)(FILE*)>("fflush")(file); }
int socketpair(int domain, int type, int protocol, int* ends) noexcept {
  return fails(Socketpair)
             ? -1
             : real<int (*)(int, int, int, int*)>("socketpair")(domain, type, protocol, ends);
}
int setrlimit(__rlimit_resource_t what, const struct rlimit* limit) noexcept {
  if (what == RLIMIT_NPROC) confining = true;
  return real<int (*)(__rlimit_resource_t, const struct rlimit*)>("setrlimit")(what, limit);
}
int prctl(int what, ...) noexcept {
  va_list more;
  va_start(more, what);
  unsigned long a[4];
  for (unsigned long& one : a) one = va_arg(more, unsigned long);
  va_end(more);
  using Control = int (*)(int, unsigned long, unsigned long, unsigned long, unsigned long);
  const int code = real<Control>("prctl")(what, a[0], a[1], a[2], a[3]);
  if (what == PR_SET_SECCOMP) confining = false;
  return code;
}
DIR* opendir(const char* path) {
  return fails(Opendir) ? nullptr : real<DIR* (*)(const char*)>("opendir")(path);
}
DIR* fdopendir(int fd) { return fails(Opendir) ? nullptr : real<DIR* (*)(int)>("fdopendir")(fd); }
struct dirent* readdir(DIR* folder) {
  return fails(Readdir) ? nullptr : real<struct dirent* (*)(DIR*)>("readdir")(folder);
}

}  // extern "C"
