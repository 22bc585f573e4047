// SPDX-License-Identifier: Apache-2.0
#include "platform/process/channel.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace nonio::process {

namespace {

constexpr std::size_t most_descriptors = 4;
constexpr std::uint64_t longest_text = std::uint64_t{1} << 30;

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool read_all(int fd, char* to, std::size_t size) {
  while (size != 0) {
    const ssize_t n = ::recv(fd, to, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    to += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

struct Packet {
  char byte = 0;
  iovec part{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int) * most_descriptors) +
                                        CMSG_SPACE(sizeof(ucred))> control{};
  msghdr header{};
  Packet() {
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
  }
};

}  // namespace

Handle::~Handle() {
  if (fd_ >= 0) ::close(fd_);
}

Expected<std::array<Handle, 2>> channel_pair(int type, const std::string& to_whom) {
  int ends[2];
  if (::socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, ends) != 0)
    return fail("no channel to " + to_whom + ": " + std::strerror(errno));
  return std::array<Handle, 2>{Handle(ends[0]), Handle(ends[1])};
}

bool write_text(int stream, std::string_view bytes) {
  const std::uint64_t size = bytes.size();
  return write_all(stream, {reinterpret_cast<const char*>(&size), sizeof size}) &&
         write_all(stream, bytes);
}

bool read_text(int stream, std::string& bytes) {
  std::uint64_t size = 0;
  if (!read_all(stream, reinterpret_cast<char*>(&size), sizeof size) || size > longest_text)
    return false;
  bytes.resize(size);
  return read_all(stream, bytes.data(), size);
}

bool send_descriptors(int channel, char word, const std::vector<int>& descriptors) {
  if (descriptors.size() > most_descriptors) return false;
  Packet parcel;
  parcel.byte = word;
  const std::size_t size = descriptors.size() * sizeof(int);
  parcel.header.msg_controllen = descriptors.empty() ? 0 : CMSG_SPACE(size);
  if (!descriptors.empty()) {
    cmsghdr* head = CMSG_FIRSTHDR(&parcel.header);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(size);
    std::memcpy(CMSG_DATA(head), descriptors.data(), size);
  }
  for (;;) {
    const ssize_t n = ::sendmsg(channel, &parcel.header, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    return n == 1;
  }
}

Expected<Received> receive_descriptors(int channel) {
  Packet parcel;
  ssize_t n = 0;
  do n = ::recvmsg(channel, &parcel.header, MSG_CMSG_CLOEXEC);
  while (n < 0 && errno == EINTR);
  if (n <= 0) return fail(n == 0 ? "the other side has gone" : std::strerror(errno));
  Received received;
  received.word = parcel.byte;
  for (cmsghdr* head = CMSG_FIRSTHDR(&parcel.header); head != nullptr;
       head = CMSG_NXTHDR(&parcel.header, head)) {
    if (head->cmsg_level != SOL_SOCKET) continue;
    if (head->cmsg_type == SCM_CREDENTIALS) {
      ucred who{};
      std::memcpy(&who, CMSG_DATA(head), sizeof who);
      received.sender = who.pid;
    } else if (head->cmsg_type == SCM_RIGHTS) {
      const std::size_t count = (head->cmsg_len - CMSG_LEN(0)) / sizeof(int);
      for (std::size_t i = 0; i < count; ++i) {
        int fd = -1;
        std::memcpy(&fd, CMSG_DATA(head) + i * sizeof fd, sizeof fd);
        received.descriptors.emplace_back(fd);
      }
    }
  }
  return received;
}

}  // namespace nonio::process
