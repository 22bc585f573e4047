// SPDX-License-Identifier: Apache-2.0
#include "platform/process/watched.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>

namespace nonio::process {

namespace {

using Length = std::uint64_t;

void append_length(std::string& out, Length n) {
  char bytes[sizeof n];
  std::memcpy(bytes, &n, sizeof n);
  out.append(bytes, sizeof n);
}

Length length_at(std::string_view bytes, std::size_t at) {
  Length n = 0;
  std::memcpy(&n, bytes.data() + at, sizeof n);
  return n;
}

class Outbox {
 public:
  explicit Outbox(int channel) : channel_(channel) {}
  void put(std::string_view piece) {
    append_length(buffer_, piece.size());
    buffer_ += piece;
    if (buffer_.size() > (1U << 15)) send();
  }
  void send() {
    for (std::string_view rest = buffer_; !rest.empty();) {
      const ssize_t n = ::write(channel_, rest.data(), rest.size());
      if (n < 0 && errno != EINTR) ::_exit(1);
      if (n > 0) rest.remove_prefix(static_cast<std::size_t>(n));
    }
    buffer_.clear();
  }

 private:
  int channel_;
  std::string buffer_;
};

}  // namespace

void SignsOfLife::reading(std::string_view path) {
  const std::size_t n = std::min(path.size(), place.size() - 1);
  std::memcpy(place.data(), path.data(), n);
  place[n] = '\0';
  reads = true;
  beat();
}

Expected<Watched> Watched::start(const Task& task, double memory_MB) {
  void* shared = ::mmap(nullptr, sizeof(SignsOfLife), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return fail("no memory for a process that reads the site");
  Watched watched;
  watched.signs_.reset(new (shared) SignsOfLife());
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return fail(std::string("no channel to a process that reads the site: ") +
                std::strerror(errno));
  watched.channel_ = Handle(ends[0]);
  Handle theirs(ends[1]);
  NONIO_TRY(watched.child_, Child::start("the site", {.memory_MB = memory_MB, .silent = true}, [&] {
              watched.channel_ = Handle();
              Outbox outbox(theirs.get());
              task(*watched.signs_, [&](std::string_view piece) { outbox.put(piece); });
              outbox.send();
            }));
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return watched;
}

void Watched::Shared::operator()(SignsOfLife* signs) const { ::munmap(signs, sizeof *signs); }

std::vector<std::string> Watched::take() {
  std::array<char, 1 << 16> part;
  while (!ended_) {
    const ssize_t n = ::read(channel(), part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) break;
    if (n <= 0)
      ended_ = true;
    else
      received_.append(part.data(), static_cast<std::size_t>(n));
  }
  std::vector<std::string> pieces;
  std::size_t at = 0;
  while (received_.size() - at >= sizeof(Length)) {
    const Length size = length_at(received_, at);
    if (received_.size() - at - sizeof size < size) break;
    pieces.emplace_back(received_.substr(at + sizeof size, size));
    at += sizeof size + size;
  }
  received_.erase(0, at);
  return pieces;
}

bool Watched::is_silent(double seconds) {
  if (const std::uint64_t beats = signs_->beats; beats != beats_) {
    beats_ = beats;
    last_beat_ = Clock::now();
  }
  return std::chrono::duration<double>(Clock::now() - last_beat_).count() > seconds;
}

std::string no_answer(double seconds) {
  std::string text = std::to_string(seconds);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return "no answer within " + text + " s: the disk or share does not respond";
}

void wait_for_any(const std::vector<Watched>& children) {
  std::vector<pollfd> channels;
  for (const Watched& child : children) channels.push_back({child.channel(), POLLIN, 0});
  ::poll(channels.data(), channels.size(), 100);
}

}  // namespace nonio::process
