// SPDX-License-Identifier: Apache-2.0
#include "signer.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <iostream>
#include <utility>

#include "child.h"
#include "guarded.h"
#include "nonio/host/files.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

/// One request and its answer go over a stream of their own, whose end the signer is sent.
class Conversation {
 public:
  explicit Conversation(int fd) : fd_(fd) {}
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;
  ~Conversation() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }

  bool write(std::string_view bytes) const {
    const std::uint64_t size = bytes.size();
    return write_all({reinterpret_cast<const char*>(&size), sizeof size}) && write_all(bytes);
  }
  /// False if the other side has gone, or says more than anybody has to say.
  bool read(std::string& bytes) const {
    std::uint64_t size = 0;
    if (!read_all(reinterpret_cast<char*>(&size), sizeof size) || size > longest) return false;
    bytes.resize(size);
    return read_all(bytes.data(), size);
  }

 private:
  static constexpr std::uint64_t longest = std::uint64_t{1} << 30;

  bool write_all(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }
  bool read_all(char* to, std::size_t size) const {
    while (size != 0) {
      const ssize_t n = ::recv(fd_, to, size, 0);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      to += n;
      size -= static_cast<std::size_t>(n);
    }
    return true;
  }

  int fd_;
};

struct DescriptorMessage {
  char byte = 0;
  iovec part{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr header{};
  DescriptorMessage() {
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
  }
};

bool send_descriptor(int channel, int fd) {
  DescriptorMessage message;
  cmsghdr* head = CMSG_FIRSTHDR(&message.header);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof fd);
  std::memcpy(CMSG_DATA(head), &fd, sizeof fd);
  return ::sendmsg(channel, &message.header, MSG_NOSIGNAL) == 1;
}

/// -1 if nobody is left who could ask.
int receive_descriptor(int channel) {
  for (;;) {
    DescriptorMessage message;
    const ssize_t n = ::recvmsg(channel, &message.header, MSG_CMSG_CLOEXEC);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return -1;
    const cmsghdr* head = CMSG_FIRSTHDR(&message.header);
    if (head == nullptr || head->cmsg_type != SCM_RIGHTS) continue;
    int fd = -1;
    std::memcpy(&fd, CMSG_DATA(head), sizeof fd);
    return fd;
  }
}

Expected<std::string> password_of(const Signing& signing, const fs::path& site) {
  if (!signing.password_env.empty()) {
    const char* value = std::getenv(signing.password_env.c_str());
    if (value == nullptr)
      return fail("the environment has no " + signing.password_env +
                  " (password_env in [signing] of site.toml)");
    return std::string(value);
  }
  fs::path path = site / signing.password_file;
  if (!signing.password_credential.empty()) {
    const char* folder = std::getenv("CREDENTIALS_DIRECTORY");
    if (folder == nullptr)
      return fail(
          "systemd gave no credentials (password_credential in [signing] of site.toml; "
          "LoadCredential= in the unit)");
    path = fs::path(folder) / signing.password_credential;
  }
  auto text = read_file(path);
  if (!text) return fail("the key's password: " + text.error().message);
  while (text->ends_with('\n') || text->ends_with('\r')) text->pop_back();
  return text;
}

/// Relative to the site; empty stays empty.
std::string in_site(const fs::path& site, const std::string& path) {
  return path.empty() ? path : (site / path).string();
}

Expected<sign::Key> open_key(const Signing& s, const fs::path& site) {
  auto password = password_of(s, site);
  if (!password) return fail(password.error());
  auto key =
      sign::Key::open({in_site(site, s.pkcs12), s.pkcs11, s.module, in_site(site, s.certificates)},
                      *password, std::time(nullptr));
  std::string& secret = *password;
  explicit_bzero(secret.data(), secret.size());  // a plain fill of what ends is left out
  return key;
}

Expected<sign::TimeStamping> stamping_of(const Signing& s, const fs::path& site) {
  sign::TimeStamping stamping;
  if (s.time_stamp.empty()) return stamping;
  auto roots = read_file(in_site(site, s.trust));
  if (!roots) return fail(roots.error());
  stamping.url = s.time_stamp;
  stamping.required = s.time_stamp_required;
  stamping.seconds = s.time_stamp_seconds;
  stamping.trust = std::move(*roots);
  return stamping;
}

/// Waits for whoever asks: one that hangs is ended by the main process, and its stream with it.
/// An empty request asks who signs. The answer: "" or what went wrong; what there is to say of a
/// missing time stamp; the bytes.
void answer(const Conversation& stream, const Expected<sign::Key>& key,
            const Expected<sign::TimeStamping>& stamping) {
  std::string request;
  if (!stream.read(request)) return;
  const auto reply = [&](const std::string& why, const sign::Signed& done) {
    [[maybe_unused]] const bool heard =
        stream.write(why) && stream.write(done.no_time_stamp) && stream.write(done.bytes);
  };
  if (!key) return reply(key.error().message, {});
  if (!stamping) return reply(stamping.error().message, {});
  if (request.empty()) {
    const sign::Identity& who = key->identity();
    return reply("", {std::to_string(who.not_after) + " " + who.subject});
  }
  const auto done = guarded("the signature", [&] {
    return key->sign(std::move(request), std::time(nullptr), *stamping);
  });
  done ? reply("", *done) : reply(done.error().message, {});
}

/// `while_waiting`: called now and then until the answer begins; may be empty.
Expected<sign::Signed> ask(int channel, std::string_view bytes,
                           const std::function<void()>& while_waiting = {}) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(std::string("no channel to the process that signs: ") + std::strerror(errno));
  const Conversation own(ends[0]);
  bool asked = false;
  {
    const Conversation theirs(ends[1]);
    asked = send_descriptor(channel, theirs.get());
  }
  asked = asked && own.write(bytes);
  pollfd answered{own.get(), POLLIN, 0};
  while (asked && while_waiting && ::poll(&answered, 1, 100) <= 0) while_waiting();
  std::string why;
  sign::Signed done;
  if (!asked || !own.read(why) || !own.read(done.no_time_stamp) || !own.read(done.bytes))
    return fail("the process that signs died");
  if (!why.empty()) return fail(why);
  return done;
}

}  // namespace

Signer::Signer(const Signing& signing, fs::path site) : signing_(signing), site_(std::move(site)) {}

Signer::~Signer() {
  if (to_ >= 0) ::close(to_);
  if (from_ >= 0) ::close(from_);
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

Expected<void> Signer::fork_process() {
  std::cout.flush();
  std::cerr.flush();
  pid_ = ::fork();
  if (pid_ == 0) serve();
  if (pid_ > 0) return {};
  return fail(std::string("no process that signs: ") + std::strerror(errno));
}

void Signer::serve() const noexcept {
  settle_child();
  ::prctl(PR_SET_DUMPABLE, 0);  // nobody may look into its memory
  ::close(to_);
  constexpr int most_deaths = 5;
  const auto key = guarded("the signing key", [&]() -> Expected<sign::Key> {
    if (deaths_ > most_deaths) return fail("the process that opens it dies again and again");
    return open_key(signing_, site_);
  });
  const auto stamping = stamping_of(signing_, site_);
  for (int fd; (fd = receive_descriptor(from_)) >= 0;) answer(Conversation(fd), key, stamping);
  ::_exit(0);
}

Expected<sign::Identity> Signer::start() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(std::string("no channel to the process that signs: ") + std::strerror(errno));
  to_ = ends[0];
  from_ = ends[1];
  if (auto made = fork_process(); !made) return fail(made.error());
  const auto hello = ask(to_, {}, [this] { revive(); });
  if (!hello) return fail(hello.error());
  sign::Identity who;
  const std::size_t blank = hello->bytes.find(' ');
  who.not_after = std::atoll(hello->bytes.c_str());
  who.subject = hello->bytes.substr(blank + 1);
  return who;
}

void Signer::revive() {
  if (pid_ > 0 && ::waitpid(pid_, nullptr, WNOHANG) == 0) return;
  pid_ = -1;
  ++deaths_;
  // Not now: then a later call tries again.
  [[maybe_unused]] const auto made = fork_process();
}

void Signer::leave_to_worker() const {
  ::close(from_);
  if (!signing_.password_env.empty()) ::unsetenv(signing_.password_env.c_str());
}

Expected<sign::Signed> Signer::sign(const std::string& bytes) const { return ask(to_, bytes); }

}  // namespace nonio::host
