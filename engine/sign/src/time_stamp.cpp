// SPDX-License-Identifier: Apache-2.0
#include "time_stamp.h"

#include <openssl/err.h>
#include <openssl/rand.h>
#include <openssl/ts.h>
#include <openssl/x509v3.h>

#include <array>

#include "der.h"
#include "http.h"
#include "verify_parts.h"

namespace nonio::sign {

namespace {

using RequestPtr = std::unique_ptr<TS_REQ, Freed<TS_REQ_free>>;
using ResponsePtr = std::unique_ptr<TS_RESP, Freed<TS_RESP_free>>;
using InfoPtr = std::unique_ptr<TS_TST_INFO, Freed<TS_TST_INFO_free>>;
using ImprintPtr = std::unique_ptr<TS_MSG_IMPRINT, Freed<TS_MSG_IMPRINT_free>>;
using IntegerPtr = std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>>;
using AlgorithmPtr = std::unique_ptr<X509_ALGOR, Freed<X509_ALGOR_free>>;

struct Request {
  std::string der, nonce;
};

Expected<Request> request_for(std::string_view imprint_wanted) {
  std::array<unsigned char, 8> random{};
  if (RAND_bytes(random.data(), random.size()) != 1) return fail("no random number: " + reason());
  // The nonce must be a positive integer whose DER has all 8 bytes.
  random[0] = static_cast<unsigned char>((random[0] & 0x3F) | 0x40);
  const IntegerPtr nonce(ASN1_INTEGER_new());
  ASN1_STRING_set(nonce.get(), random.data(), random.size());
  const AlgorithmPtr algorithm(X509_ALGOR_new());
  X509_ALGOR_set0(algorithm.get(), OBJ_nid2obj(NID_sha256), V_ASN1_NULL, nullptr);
  std::string imprinted(imprint_wanted);
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

/// Returns the token of a TimeStampResp (RFC 3161) with its bytes unchanged.
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
  if (status != 0 && status != 1)  // 0: granted, 1: granted with changes
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

Expected<std::string> ask_for_time_stamp(const TimeStamping& stamping, std::string_view imprint,
                                         Time now) {
  if (stamping.away && !stamping.away->empty())
    return fail(*stamping.away + " (asked once in this run)");
  NONIO_TRY(const auto request, request_for(imprint));
  const auto answer = ask_server(stamping.url, {.query = "application/timestamp-query",
                                                .reply = "application/timestamp-reply",
                                                .body = request.der,
                                                .longest = 60000,
                                                .seconds = stamping.seconds});
  if (!answer) {
    if (stamping.away) *stamping.away = answer.error().message;
    return fail(answer.error());
  }
  auto token = token_of(*answer);
  if (!token) return fail(stamping.url + ": " + token.error().message);
  NONIO_TRY(const auto roots, trusted({.time_stamp_roots = stamping.trust}));
  const auto stamp = check_time_stamp(*token, imprint, roots, now);
  if (!stamp) return fail(stamping.url + ": the time stamp " + stamp.error().message);
  if (stamp->nonce != request.nonce)
    return fail(stamping.url + ": the answer is not to this question");
  return token;
}

Expected<Stamp> check_time_stamp(std::string_view token, std::string_view stamped,
                                 const Trusted& known, Time now, Time until) {
  NONIO_TRY(const auto data, SignedData::parse(token, SignedData::Content::time_stamp));
  if (auto holds = data.check_signature(data.content(), {}); !holds) return fail(holds.error());
  if (auto named = data.check_certificate_named(); !named) return fail(named.error());
  const unsigned char* at = data_of(data.content());
  const InfoPtr info(d2i_TS_TST_INFO(nullptr, &at, static_cast<long>(data.content().size())));
  if (!info || TS_TST_INFO_get_version(info.get()) != 1) return fail("holds no time");
  TS_MSG_IMPRINT* imprint = TS_TST_INFO_get_msg_imprint(info.get());
  const X509_ALGOR* algorithm = TS_MSG_IMPRINT_get_algo(imprint);
  const ASN1_OBJECT* kind = nullptr;
  X509_ALGOR_get0(&kind, nullptr, nullptr, algorithm);
  if (OBJ_obj2nid(kind) != NID_sha256 || bytes_of(TS_MSG_IMPRINT_get_msg(imprint)) != stamped)
    return fail("belongs to another signature");
  Stamp stamp{time_of(TS_TST_INFO_get_time(info.get())), subject_of(data.certificate()),
              nonce_of(info.get())};
  if (stamp.time == 0) return fail("holds no time");
  if (stamp.time > now + clock_tolerance)
    return fail("is of " + text_of(stamp.time) + ", which is yet to come: here it is " +
                text_of(now) + " (a wrong clock, here or there?)");
  if (X509_check_purpose(data.certificate(), X509_PURPOSE_TIMESTAMP_SIGN, 0) != 1)
    return fail("was made by " + quoted(stamp.by) + ", whose certificate is not for time stamps");
  // A stamp remains valid after the certificate of its server has expired.
  auto chain = chain_of(data.certificate(), data.certificates(), known.time_roots, stamp.time);
  if (!chain)
    return fail("was made by " + quoted(stamp.by) +
                ", who is not trusted: " + chain.error().message);
  if (auto sound = check_issued(data.certificates(), known.time_roots); !sound)
    return fail(sound.error());
  bool looked = false;
  const auto revocation = check_revocation(
      *chain, known, {stamp.time, now, Revocation::Of::time_server, until}, looked);
  if (!revocation)
    return fail("was made by " + quoted(stamp.by) + ": " + revocation.error().message);
  stamp.chain = std::move(*chain);
  return stamp;
}

}  // namespace nonio::sign
