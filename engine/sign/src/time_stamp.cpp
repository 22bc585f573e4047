// SPDX-License-Identifier: Apache-2.0
#include "time_stamp.h"

#include <openssl/err.h>
#include <openssl/http.h>
#include <openssl/rand.h>
#include <openssl/ts.h>
#include <openssl/x509v3.h>

#include <array>

#include "der.h"
#include "verify_parts.h"

namespace nonio::sign {

namespace {

using RequestPtr = std::unique_ptr<TS_REQ, Freed<TS_REQ_free>>;
using ResponsePtr = std::unique_ptr<TS_RESP, Freed<TS_RESP_free>>;
using InfoPtr = std::unique_ptr<TS_TST_INFO, Freed<TS_TST_INFO_free>>;
using ImprintPtr = std::unique_ptr<TS_MSG_IMPRINT, Freed<TS_MSG_IMPRINT_free>>;
using IntegerPtr = std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>>;
using AlgorithmPtr = std::unique_ptr<X509_ALGOR, Freed<X509_ALGOR_free>>;

struct OpensslText {
  char* text = nullptr;
  OpensslText() = default;
  OpensslText(const OpensslText&) = delete;
  OpensslText& operator=(const OpensslText&) = delete;
  ~OpensslText() { OPENSSL_free(text); }
};

struct Request {
  std::string der, nonce;
};

Expected<Request> request_for(std::string_view signature) {
  std::array<unsigned char, 8> random{};
  if (RAND_bytes(random.data(), random.size()) != 1) return fail("no random number: " + reason());
  random[0] = static_cast<unsigned char>((random[0] & 0x3F) | 0x40);  // positive, full length
  const IntegerPtr nonce(ASN1_INTEGER_new());
  ASN1_STRING_set(nonce.get(), random.data(), random.size());
  const AlgorithmPtr algorithm(X509_ALGOR_new());
  X509_ALGOR_set0(algorithm.get(), OBJ_nid2obj(NID_sha256), V_ASN1_NULL, nullptr);
  std::string imprinted = sha256(signature);
  const ImprintPtr imprint(TS_MSG_IMPRINT_new());
  const RequestPtr request(TS_REQ_new());
  if (TS_MSG_IMPRINT_set_algo(imprint.get(), algorithm.get()) != 1 ||
      TS_MSG_IMPRINT_set_msg(imprint.get(), reinterpret_cast<unsigned char*>(imprinted.data()),
                             static_cast<int>(imprinted.size())) != 1 ||
      TS_REQ_set_version(request.get(), 1) != 1 ||
      TS_REQ_set_msg_imprint(request.get(), imprint.get()) != 1 ||
      TS_REQ_set_nonce(request.get(), nonce.get()) != 1 ||
      TS_REQ_set_cert_req(request.get(), 1) != 1)
    return fail("no request: " + reason());
  return Request{der_of(request.get(), &i2d_TS_REQ),
                 {reinterpret_cast<const char*>(random.data()), random.size()}};
}

/// The answer's bytes.
Expected<std::string> post(const TimeStamping& stamping, const std::string& request) {
  OpensslText host, port, path, query;
  int secure = 0;
  if (OSSL_HTTP_parse_url(stamping.url.c_str(), &secure, nullptr, &host.text, &port.text, nullptr,
                          &path.text, &query.text, nullptr) != 1 ||
      secure != 0) {
    ERR_clear_error();
    return fail(stamping.url + " is no address of the form http://host/path");
  }
  std::string full_path = path.text;
  if (query.text != nullptr && *query.text != '\0') full_path += std::string("?") + query.text;
  const BioPtr body(BIO_new_mem_buf(request.data(), static_cast<int>(request.size())));
  constexpr std::size_t longest = 60000;
  const BioPtr answer(OSSL_HTTP_transfer(
      nullptr, host.text, port.text, full_path.c_str(), 0, nullptr, nullptr, nullptr, nullptr,
      nullptr, nullptr, 0, nullptr, "application/timestamp-query", body.get(),
      "application/timestamp-reply", 1, longest, stamping.seconds, 0));
  if (!answer) return fail(stamping.url + " does not answer: " + reason());
  std::string bytes;
  std::array<char, 4096> part{};
  for (int n; (n = BIO_read(answer.get(), part.data(), part.size())) > 0;)
    bytes.append(part.data(), static_cast<std::size_t>(n));
  return bytes;
}

/// TimeStampResp ::= SEQUENCE { status, token }: the token as it stands there.
Expected<std::string> token_of(const std::string& answer) {
  ERR_clear_error();
  const unsigned char* at = data_of(answer);
  const ResponsePtr response(d2i_TS_RESP(nullptr, &at, static_cast<long>(answer.size())));
  if (!response) {
    ERR_clear_error();
    return fail("the answer is no time stamp");
  }
  const long status =
      ASN1_INTEGER_get(TS_STATUS_INFO_get0_status(TS_RESP_get_status_info(response.get())));
  if (status != 0 && status != 1)  // granted, granted with changes
    return fail("the server refuses, status " + std::to_string(status));
  const auto outer = Der::only(answer, Der::sequence);
  std::string_view rest = outer ? outer->content : std::string_view{};
  Der::take(rest, Der::sequence);
  const auto token = Der::only(rest, Der::sequence);
  if (!token) return fail("the answer holds no time stamp");
  return std::string(token->whole);
}

std::string nonce_of(const TS_TST_INFO* info) {
  const ASN1_INTEGER* nonce = TS_TST_INFO_get_nonce(info);
  return nonce == nullptr ? "" : std::string(bytes_of(nonce));
}

}  // namespace

Expected<std::string> ask_for_time_stamp(const TimeStamping& stamping, std::string_view signature,
                                         Time now) {
  const auto request = request_for(signature);
  if (!request) return fail(request.error());
  const auto answer = post(stamping, request->der);
  if (!answer) return fail(answer.error());
  auto token = token_of(*answer);
  if (!token) return fail(stamping.url + ": " + token.error().message);
  const auto roots = trusted(stamping.trust, {});
  if (!roots) return fail(roots.error());
  const auto stamp = check_time_stamp(*token, signature, *roots, now);
  if (!stamp) return fail(stamping.url + ": the time stamp " + stamp.error().message);
  if (stamp->nonce != request->nonce)
    return fail(stamping.url + ": the answer is not to this question");
  return token;
}

Expected<Stamp> check_time_stamp(std::string_view token, std::string_view signature,
                                 const Trusted& known, Time now) {
  const auto data = SignedData::parse(token, SignedData::Content::time_stamp);
  if (!data) return fail(data.error());
  if (auto holds = data->check_signature(data->content(), {}); !holds) return fail(holds.error());
  if (auto named = data->check_certificate_named(); !named) return fail(named.error());
  const unsigned char* at = data_of(data->content());
  const InfoPtr info(d2i_TS_TST_INFO(nullptr, &at, static_cast<long>(data->content().size())));
  if (!info || TS_TST_INFO_get_version(info.get()) != 1) return fail("holds no time");
  TS_MSG_IMPRINT* imprint = TS_TST_INFO_get_msg_imprint(info.get());
  const X509_ALGOR* algorithm = TS_MSG_IMPRINT_get_algo(imprint);
  const ASN1_OBJECT* kind = nullptr;
  X509_ALGOR_get0(&kind, nullptr, nullptr, algorithm);
  if (OBJ_obj2nid(kind) != NID_sha256 ||
      bytes_of(TS_MSG_IMPRINT_get_msg(imprint)) != sha256(signature))
    return fail("belongs to another signature");
  Stamp stamp{time_of(TS_TST_INFO_get_time(info.get())), subject_of(data->certificate()),
              nonce_of(info.get())};
  if (stamp.time == 0) return fail("holds no time");
  if (stamp.time > now + clock_tolerance)
    return fail("is of " + text_of(stamp.time) + ", which is yet to come: here it is " +
                text_of(now) + " (a wrong clock, here or there?)");
  if (X509_check_purpose(data->certificate(), X509_PURPOSE_TIMESTAMP_SIGN, 0) != 1)
    return fail("was made by " + quoted(stamp.by) + ", whose certificate is not for time stamps");
  // At the time of the stamp: that the server's certificate has run out since does not make it
  // less true that it was given.
  const auto chain = chain_of(data->certificate(), data->certificates(), known, stamp.time);
  if (!chain)
    return fail("was made by " + quoted(stamp.by) +
                ", who is not trusted: " + chain.error().message);
  if (auto sound = check_issued(data->certificates(), known); !sound) return fail(sound.error());
  bool looked = false;
  const auto revocation =
      check_revocation(*chain, known, {stamp.time, now, Revocation::Of::time_server}, looked);
  if (!revocation)
    return fail("was made by " + quoted(stamp.by) + ": " + revocation.error().message);
  return stamp;
}

}  // namespace nonio::sign
