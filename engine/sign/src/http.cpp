// SPDX-License-Identifier: Apache-2.0
#include "http.h"

#include <netdb.h>
#include <openssl/err.h>
#include <openssl/http.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include "openssl.h"

namespace nonio::sign {

namespace {

struct OpensslText {
  char* text = nullptr;
  OpensslText() = default;
  OpensslText(const OpensslText&) = delete;
  OpensslText& operator=(const OpensslText&) = delete;
  ~OpensslText() { OPENSSL_free(text); }
};

struct AddressesFreed {
  void operator()(addrinfo* all) const { ::freeaddrinfo(all); }
};

/// Reports a refused connection at once, unlike OpenSSL, which retries until the time limit.
Expected<int> connect_to(const char* host, const char* port, int seconds) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int trouble = ::getaddrinfo(host, port, &wanted, &found); trouble != 0)
    return fail(std::string("its name is not known: ") + ::gai_strerror(trouble));
  const std::unique_ptr<addrinfo, AddressesFreed> all(found);
  std::string why = "it has no address";
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    const int s = ::socket(one->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (s < 0) continue;
    int trouble = ::connect(s, one->ai_addr, one->ai_addrlen) == 0 ? 0 : errno;
    pollfd done{s, POLLOUT, 0};
    if (trouble == EINPROGRESS) {
      socklen_t size = sizeof trouble;
      if (::poll(&done, 1, seconds * 1000) != 1)
        trouble = ETIMEDOUT;
      else if (::getsockopt(s, SOL_SOCKET, SO_ERROR, &trouble, &size) != 0)
        trouble = errno;
    }
    if (trouble == 0) return s;
    ::close(s);
    why = std::strerror(trouble);
  }
  return fail(why);
}

/// Returns null if the environment configures a proxy, through which OpenSSL then connects.
Expected<BioPtr> connection_to(const OpensslText& host, const OpensslText& port, int seconds) {
  if (OSSL_HTTP_adapt_proxy(nullptr, nullptr, host.text, 0) != nullptr) return BioPtr();
  NONIO_TRY(const auto connected, connect_to(host.text, port.text, seconds));
  return BioPtr(BIO_new_socket(connected, BIO_CLOSE));
}

}  // namespace

Expected<std::string> ask_server(const std::string& url, const Question& question) {
  ERR_clear_error();
  OpensslText host, port, path, query;
  int secure = 0;
  if (OSSL_HTTP_parse_url(url.c_str(), &secure, nullptr, &host.text, &port.text, nullptr,
                          &path.text, &query.text, nullptr) != 1 ||
      secure != 0) {
    ERR_clear_error();
    return fail(url + " is no address of the form http://host/path");
  }
  const auto connection = connection_to(host, port, question.seconds);
  if (!connection) return fail(url + " does not answer: " + connection.error().message);
  std::string full_path = path.text;
  if (query.text != nullptr && *query.text != '\0') full_path += std::string("?") + query.text;
  const BioPtr body(
      question.query == nullptr
          ? nullptr
          : BIO_new_mem_buf(question.body.data(), static_cast<int>(question.body.size())));
  const BioPtr answer(OSSL_HTTP_transfer(nullptr, host.text, port.text, full_path.c_str(), 0,
                                         nullptr, nullptr, connection->get(), connection->get(),
                                         nullptr, nullptr, 0, nullptr, question.query, body.get(),
                                         question.reply, 1, question.longest, question.seconds, 0));
  if (!answer) return fail(url + " does not answer: " + reason());
  std::string bytes;
  std::array<char, 4096> part{};
  for (int n; (n = BIO_read(answer.get(), part.data(), part.size())) > 0;)
    bytes.append(part.data(), static_cast<std::size_t>(n));
  return bytes;
}

}  // namespace nonio::sign
