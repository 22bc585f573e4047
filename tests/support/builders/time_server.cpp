// SPDX-License-Identifier: Apache-2.0
#include "time_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/ts.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace nonio::sign_tests {

TimeServer::TimeServer(Holder holder, sign::Time time, Mood mood)
    : holder_(std::move(holder)), time_(time), mood_(mood) {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0)
    throw std::runtime_error("a port for the time server");
  ::listen(socket_, 8);
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { serve(); });
}

TimeServer::~TimeServer() {
  ends_ = true;
  thread_.join();
  ::close(socket_);
}

sign::TimeStamping TimeServer::stamping(const std::string& trust) const {
  sign::TimeStamping out;
  out.url = "http://127.0.0.1:" + std::to_string(port_) + "/tsa";
  out.seconds = mood_ == Mood::silent ? 1 : 10;
  out.trust = trust;
  return out;
}

void TimeServer::serve() {
  while (!ends_) {
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, 20) != 1) continue;
    const int client = ::accept(socket_, nullptr, nullptr);
    std::string request;
    std::array<char, 4096> part{};
    std::size_t wanted = std::string::npos;
    while (request.size() < wanted) {
      const ssize_t n = ::read(client, part.data(), part.size());
      if (n <= 0) break;
      request.append(part.data(), static_cast<std::size_t>(n));
      const auto head = request.find("\r\n\r\n");
      if (head == std::string::npos) continue;
      const auto length = request.find("Content-Length: ");
      wanted = head + 4 + std::stoul(request.substr(length + 16));
    }
    if (mood_ == Mood::silent) {
      while (!ends_) ::usleep(5000);
    } else {
      const std::string body = answer_to(request.substr(request.find("\r\n\r\n") + 4));
      const std::string reply =
          "HTTP/1.0 200 OK\r\nContent-Type: application/timestamp-reply\r\nContent-Length: " +
          std::to_string(body.size()) + "\r\n\r\n" + body;
      [[maybe_unused]] const ssize_t n = ::write(client, reply.data(), reply.size());
    }
    ::close(client);
  }
}

std::string TimeServer::answer_to(const std::string& query) const {
  if (mood_ == Mood::nonsense) return "I do not know what time it is";
  TS_RESP_CTX* context = TS_RESP_CTX_new();
  TS_RESP_CTX_set_signer_cert(context, holder_.certificate.get());
  TS_RESP_CTX_set_signer_key(context, holder_.key.get());
  TS_RESP_CTX_set_signer_digest(context, EVP_sha256());
  TS_RESP_CTX_set_ess_cert_id_digest(context, EVP_sha256());
  ASN1_OBJECT* policy = OBJ_txt2obj("1.2.3.4.1", 1);
  TS_RESP_CTX_set_def_policy(context, policy);
  ASN1_OBJECT_free(policy);
  if (mood_ != Mood::refuses) TS_RESP_CTX_add_md(context, EVP_sha256());
  TS_RESP_CTX_set_serial_cb(
      context,
      [](TS_RESP_CTX*, void*) {
        ASN1_INTEGER* serial = ASN1_INTEGER_new();
        ASN1_INTEGER_set(serial, 77);
        return serial;
      },
      nullptr);
  TS_RESP_CTX_set_time_cb(
      context,
      [](TS_RESP_CTX*, void* time, long* seconds, long* microseconds) {
        *seconds = *static_cast<const sign::Time*>(time);
        *microseconds = 0;
        return 1;
      },
      const_cast<sign::Time*>(&time_));
  const auto* at = reinterpret_cast<const unsigned char*>(query.data());
  TS_REQ* request = d2i_TS_REQ(nullptr, &at, static_cast<long>(query.size()));
  if (mood_ == Mood::other_nonce) {
    ASN1_INTEGER* nonce = ASN1_INTEGER_new();
    ASN1_INTEGER_set(nonce, 4711);
    TS_REQ_set_nonce(request, nonce);
    ASN1_INTEGER_free(nonce);
  }
  if (mood_ == Mood::other_imprint) {
    std::string other(32, 'x');
    TS_MSG_IMPRINT_set_msg(TS_REQ_get_msg_imprint(request),
                           reinterpret_cast<unsigned char*>(other.data()), 32);
  }
  unsigned char* encoded = nullptr;
  BIO* in = BIO_new(BIO_s_mem());
  i2d_TS_REQ_bio(in, request);
  TS_RESP* response = TS_RESP_create_response(context, in);
  const int size = i2d_TS_RESP(response, &encoded);
  std::string bytes(reinterpret_cast<char*>(encoded), static_cast<std::size_t>(size));
  OPENSSL_free(encoded);
  BIO_free(in);
  TS_RESP_free(response);
  TS_REQ_free(request);
  TS_RESP_CTX_free(context);
  return bytes;
}

}  // namespace nonio::sign_tests
