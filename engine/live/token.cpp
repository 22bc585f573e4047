// SPDX-License-Identifier: Apache-2.0
#include "live/token.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "platform/process/channel.h"

namespace nonio::live {

namespace {

constexpr std::size_t digits = 32;

Expected<std::string> read_token(const std::string& file, int fd) {
  struct stat s {};
  if (::fstat(fd, &s) != 0) return fail(file + ": " + std::strerror(errno));
  if (!S_ISREG(s.st_mode) || s.st_uid != ::geteuid() || (s.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return fail(file + ": expected a file of this user that no other user can read (chmod 600)");
  std::array<char, digits + 2> bytes{};
  const ssize_t n = ::read(fd, bytes.data(), bytes.size());
  std::string token(bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  if (token.ends_with('\n')) token.pop_back();
  if (token.size() != digits || token.find_first_not_of("0123456789abcdef") != std::string::npos)
    return fail(file +
                ": expected a token of 32 hexadecimal digits (delete the file for a new one)");
  return token;
}

}  // namespace

Expected<std::string> new_token() {
  std::array<unsigned char, digits / 2> bits{};
  if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
    return fail(std::string("no random numbers: ") + std::strerror(errno));
  std::string token;
  for (const unsigned char byte : bits) {
    constexpr const char* hex = "0123456789abcdef";
    token += hex[byte >> 4];
    token += hex[byte & 15];
  }
  return token;
}

Expected<std::string> token_in(const std::string& file) {
  const process::Handle old(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (old) return read_token(file, old.get());
  if (errno != ENOENT) return fail(file + ": " + std::strerror(errno));
  auto token = new_token();
  if (!token) return token;
  const process::Handle made(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  const std::string line = *token + "\n";
  if (!made || ::write(made.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    return fail(file + ": " + std::strerror(errno));
  return token;
}

}  // namespace nonio::live
