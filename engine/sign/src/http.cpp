// SPDX-License-Identifier: Apache-2.0
#include "http.h"

#include <openssl/err.h>
#include <openssl/http.h>

#include <array>

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
  std::string full_path = path.text;
  if (query.text != nullptr && *query.text != '\0') full_path += std::string("?") + query.text;
  const BioPtr body(
      question.query == nullptr
          ? nullptr
          : BIO_new_mem_buf(question.body.data(), static_cast<int>(question.body.size())));
  const BioPtr answer(OSSL_HTTP_transfer(nullptr, host.text, port.text, full_path.c_str(), 0,
                                         nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, 0,
                                         nullptr, question.query, body.get(), question.reply, 1,
                                         question.longest, question.seconds, 0));
  if (!answer) return fail(url + " does not answer: " + reason());
  std::string bytes;
  std::array<char, 4096> part{};
  for (int n; (n = BIO_read(answer.get(), part.data(), part.size())) > 0;)
    bytes.append(part.data(), static_cast<std::size_t>(n));
  return bytes;
}

}  // namespace nonio::sign
