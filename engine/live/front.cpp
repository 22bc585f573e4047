// SPDX-License-Identifier: Apache-2.0
#include "live/front.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "live/guard.h"

namespace nonio::live {

Expected<Front> Front::open(std::uint16_t port) {
  const auto failed = [&](const char* what) {
    return fail("127.0.0.1:" + std::to_string(port) + ": " + what + ": " + std::strerror(errno));
  };
  process::Handle socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) return failed("socket");
  const int yes = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  if (::bind(socket.get(), plain, sizeof address) != 0) return failed("bind");
  if (::listen(socket.get(), SOMAXCONN) != 0) return failed("listen");
  socklen_t size = sizeof address;
  if (::getsockname(socket.get(), plain, &size) != 0) return failed("getsockname");
  return Front(std::move(socket), ntohs(address.sin_port));
}

void Front::accept_all() {
  while (true) {
    process::Handle visitor(
        ::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!visitor) return;
    // The one who has waited longest has least to say.
    if (waiting_.size() == most_waiting) waiting_.erase(waiting_.begin());
    waiting_[++last_] = {std::move(visitor), Clock::now(), 0};
  }
}

int Front::look_at(int socket) const {
  constexpr std::size_t room = most_head + 4096;
  std::array<char, room> bytes;
  const ssize_t n = ::recv(socket, bytes.data(), bytes.size(), MSG_PEEK);
  if (n < 0) return errno == EAGAIN || errno == EINTR ? 0 : -1;
  if (n == 0) return -1;
  const std::string_view seen(bytes.data(), static_cast<std::size_t>(n));
  const std::size_t end = std::min(seen.find("\r\n\r\n"), seen.find("\n\n"));
  if (end != std::string_view::npos) return head_status(seen.substr(0, end));
  return seen.size() >= room ? 431 : 0;
}

void Front::serve(const std::function<void(process::Handle, int)>& take,
                  const std::function<bool()>& is_over) {
  constexpr int tick = 100, soon = 2;
  while (!is_over()) {
    std::vector<pollfd> all{{socket_.get(), POLLIN, 0}};
    for (const auto& [number, visitor] : waiting_) all.push_back({visitor.socket.get(), POLLIN, 0});
    // A socket whose head has begun is always readable: looked at again a little later.
    if (::poll(all.data(), all.size(), tick) > 0 && all.front().revents == 0) ::usleep(soon * 1000);
    accept_all();
    std::vector<std::pair<std::uint64_t, int>> ready;
    for (const auto& [number, visitor] : waiting_) {
      const int state = look_at(visitor.socket.get());
      if (state != 0)
        ready.emplace_back(number, state);
      else if (Clock::now() - visitor.since > head_patience)
        ready.emplace_back(number, 408);
    }
    for (const auto& [number, state] : ready) {
      process::Handle socket = std::move(waiting_.at(number).socket);
      waiting_.erase(number);
      if (state > 0) take(std::move(socket), state == 200 ? 0 : state);
    }
  }
}

}  // namespace nonio::live
