// SPDX-License-Identifier: Apache-2.0
#include "revocation.h"

#include <openssl/err.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <optional>

#include "der.h"
#include "signed_data.h"
#include "verify_parts.h"

namespace nonio::sign {

namespace {

using OcspResponsePtr = std::unique_ptr<OCSP_RESPONSE, Freed<OCSP_RESPONSE_free>>;
using CertIdPtr = std::unique_ptr<OCSP_CERTID, Freed<OCSP_CERTID_free>>;

bool is_by(X509_CRL* list, X509* issuer) {
  return X509_NAME_cmp(X509_CRL_get_issuer(list), X509_get_subject_name(issuer)) == 0;
}

bool is_signed_by(X509_CRL* list, X509* issuer) {
  const bool is_his = is_by(list, issuer) && X509_CRL_verify(list, X509_get0_pubkey(issuer)) == 1;
  ERR_clear_error();
  return is_his;
}

X509_CRL* newest_list(const Trusted& known, X509* issuer) {
  X509_CRL* newest = nullptr;
  for (const RevocationPtr& l : known.lists)
    if (is_signed_by(l.get(), issuer) &&
        (newest == nullptr ||
         time_of(X509_CRL_get0_lastUpdate(newest)) < time_of(X509_CRL_get0_lastUpdate(l.get()))))
      newest = l.get();
  return newest;
}

tl::unexpected<Error> refuse_list(X509* issuer, const std::string& why) {
  return fail("the revocation list of " + quoted(subject_of(issuer)) + " " + why);
}

/// Returns an error for lists with critical extensions: delta lists and partial lists are marked
/// only by these.
Expected<void> check_whole(const X509_CRL* list, X509* issuer) {
  for (int i = 0; i < X509_CRL_get_ext_count(list); ++i)
    if (X509_EXTENSION_get_critical(X509_CRL_get_ext(list, i)) != 0)
      return refuse_list(issuer, "is not a plain and whole one: it has a critical extension");
  return {};
}

Expected<void> check_list(const X509_CRL* list, X509* issuer, Time now) {
  const Time made = time_of(X509_CRL_get0_lastUpdate(list));
  const Time next = time_of(X509_CRL_get0_nextUpdate(list));
  if (made > now + clock_tolerance)
    return refuse_list(issuer, "is of " + text_of(made) + ", yet to come");
  if (next == 0) return refuse_list(issuer, "does not state how long it is good for (nextUpdate)");
  if (next < now)
    return refuse_list(issuer, "was good until " + text_of(next) + ": expected a newer one");
  return {};
}

/// Returns the revocation date, or the invalidity date if that is earlier.
Time revoked_from(const X509_REVOKED* entry) {
  const Time when = time_of(X509_REVOKED_get0_revocationDate(entry));
  const std::unique_ptr<ASN1_GENERALIZEDTIME, Freed<ASN1_GENERALIZEDTIME_free>> invalid(
      static_cast<ASN1_GENERALIZEDTIME*>(
          X509_REVOKED_get_ext_d2i(entry, NID_invalidity_date, nullptr, nullptr)));
  const Time stated = invalid ? time_of(invalid.get()) : 0;
  return stated == 0 ? when : std::min(when, stated);
}

/// Whether a reason leaves earlier time stamps valid: unspecified, affiliationChanged, superseded,
/// cessationOfOperation (RFC 3161, 4, 1).
bool is_harmless(long code) { return code == 0 || (code >= 3 && code <= 5); }

bool leaves_stamps_good(const X509_REVOKED* entry) {
  const std::unique_ptr<ASN1_ENUMERATED, Freed<ASN1_ENUMERATED_free>> stated(
      static_cast<ASN1_ENUMERATED*>(
          X509_REVOKED_get_ext_d2i(entry, NID_crl_reason, nullptr, nullptr)));
  return stated && is_harmless(ASN1_ENUMERATED_get(stated.get()));
}

/// Entry of a revocation list or an OCSP answer for one certificate.
struct Said {
  Time made = 0, next = 0;
  Time revoked = 0;  ///< time of the revocation; 0 if not revoked
  bool leaves_stamps_good = false;
};

Expected<void> check_not_revoked(const Said& said, X509* one, const Revocation& revocation) {
  if (said.revoked == 0) return {};
  const bool good_before = revocation.of == Revocation::Of::signer || said.leaves_stamps_good;
  if (said.revoked <= revocation.at || (!good_before && said.revoked <= revocation.until))
    return fail("the certificate of " + quoted(subject_of(one)) + " was revoked on " +
                text_of(said.revoked));
  return {};
}

Said said_by(X509_CRL* list, X509* one) {
  Said said{time_of(X509_CRL_get0_lastUpdate(list)), time_of(X509_CRL_get0_nextUpdate(list))};
  X509_REVOKED* entry = nullptr;
  if (X509_CRL_get0_by_cert(list, &entry, one) == 1) {
    said.revoked = revoked_from(entry);
    said.leaves_stamps_good = leaves_stamps_good(entry);
  }
  return said;
}

/// Returns an error unless the answer is signed by the issuer or by a responder with a certificate
/// of the issuer for this purpose (RFC 6960, 4.2.2.2). A responder whose own certificate would need
/// a revocation check is not accepted, nor an answer with certificates other than the responder's.
Expected<void> check_responder(OCSP_BASICRESP* answer, X509* issuer) {
  const Borrowed candidates(sk_X509_new_null());
  sk_X509_push(candidates.get(), issuer);
  X509* responder = nullptr;
  const bool found = OCSP_resp_get0_signer(answer, &responder, candidates.get()) == 1;
  const bool sound = found && OCSP_basic_verify(answer, candidates.get(), nullptr,
                                                OCSP_NOVERIFY | OCSP_TRUSTOTHER) == 1;
  ERR_clear_error();
  if (!sound) return fail("an OCSP answer that is damaged, or whose signer is not known");
  const STACK_OF(X509)* carried = OCSP_resp_get0_certs(answer);
  for (int i = 0; i < sk_X509_num(carried); ++i)
    if (X509_cmp(sk_X509_value(carried, i), responder) != 0 || i > 0)
      return fail("an answer (OCSP) with certificates that it does not need");
  if (X509_cmp(responder, issuer) == 0) return {};
  const bool issued = X509_check_issued(issuer, responder) == X509_V_OK &&
                      X509_verify(responder, X509_get0_pubkey(issuer)) == 1;
  ERR_clear_error();
  const Time at = time_of(OCSP_resp_get0_produced_at(answer));
  if (!issued || (X509_get_extended_key_usage(responder) & XKU_OCSP_SIGN) == 0 ||
      X509_get_extension_flags(responder) & EXFLAG_CA ||
      (X509_get_extension_flags(responder) & EXFLAG_XKUSAGE) == 0)
    return fail("an answer (OCSP) of " + quoted(subject_of(responder)) +
                ", who may not answer for " + quoted(subject_of(issuer)));
  if (at < time_of(X509_get0_notBefore(responder)) || at > time_of(X509_get0_notAfter(responder)))
    return fail("an answer (OCSP) of a responder whose certificate had run out");
  if (X509_get_ext_by_NID(responder, NID_id_pkix_OCSP_noCheck, -1) < 0)
    return fail("an answer (OCSP) of a responder whose own certificate would have to be checked");
  return {};
}

/// Returns nullopt if the answer is only about other certificates, or if the status is unknown.
std::optional<Said> said_by(OCSP_BASICRESP* answer, X509* one, X509* issuer) {
  for (int i = 0; i < OCSP_resp_count(answer); ++i) {
    OCSP_SINGLERESP* single = OCSP_resp_get0(answer, i);
    const OCSP_CERTID* id = OCSP_SINGLERESP_get0_id(single);
    ASN1_OBJECT* kind = nullptr;
    OCSP_id_get0_info(nullptr, &kind, nullptr, nullptr, const_cast<OCSP_CERTID*>(id));
    const EVP_MD* digest = EVP_get_digestbyobj(kind);
    const CertIdPtr wanted(digest == nullptr ? nullptr : OCSP_cert_to_id(digest, one, issuer));
    if (!wanted || OCSP_id_cmp(wanted.get(), id) != 0) continue;
    int why = -1;
    ASN1_GENERALIZEDTIME *when = nullptr, *made = nullptr, *next = nullptr;
    const int state = OCSP_single_get0_status(single, &why, &when, &made, &next);
    Said said{time_of(made), time_of(next)};
    if (state == V_OCSP_CERTSTATUS_UNKNOWN) return std::nullopt;
    if (state == V_OCSP_CERTSTATUS_REVOKED) {
      said.revoked = time_of(when);
      said.leaves_stamps_good = is_harmless(why);
    }
    return said;
  }
  ERR_clear_error();
  return std::nullopt;
}

/// Returns nullopt unless the statement is about the certificate and its status is known.
Expected<std::optional<Said>> heard(const Statement& s, X509* one, X509* issuer) {
  if (s.answer) {
    const auto said = said_by(s.answer.get(), one, issuer);
    if (!said) return std::optional<Said>();
    if (auto sound = check_responder(s.answer.get(), issuer); !sound) return fail(sound.error());
    return said;
  }
  if (!is_by(s.list.get(), issuer)) return std::optional<Said>();
  if (!is_signed_by(s.list.get(), issuer))
    return refuse_list(issuer, "is damaged, or was not made by him");
  if (auto whole = check_whole(s.list.get(), issuer); !whole) return fail(whole.error());
  return std::optional<Said>(said_by(s.list.get(), one));
}

std::string kind_of(const Statement& s) { return s.answer ? "answer (OCSP)" : "list"; }

/// Returns why an entry cannot prove that the certificate was good at `at`, or an empty text.
std::string why_not(const Said& said, X509* one, X509* issuer, Time at, Time seen) {
  const std::string whose = " for " + quoted(subject_of(one));
  if (said.made > seen + clock_tolerance)
    return "is of " + text_of(said.made) + ", later than it was seen";
  if (said.next == 0) return "does not state how long it is good for (nextUpdate)";
  if (said.next < seen && said.made < at)
    return "was good until " + text_of(said.next) + " only, which is too early" + whose;
  if (seen > time_of(X509_get0_notAfter(issuer)))
    return "is not proved to be older than " + text_of(time_of(X509_get0_notAfter(issuer))) +
           ", when the certificate of " + quoted(subject_of(issuer)) + " ran out";
  if (said.made > time_of(X509_get0_notAfter(one)))
    return "was made when the certificate of " + quoted(subject_of(one)) +
           " had run out, and need not name it any more";
  return {};
}

}  // namespace

Expected<Statement> Statement::of_list(std::string_view der) {
  const unsigned char* at = data_of(der);
  Statement out;
  out.der = der;
  out.list.reset(d2i_X509_CRL(nullptr, &at, static_cast<long>(der.size())));
  ERR_clear_error();
  if (!out.list || !Der::only(der, Der::sequence) || der_of(out.list.get(), &i2d_X509_CRL) != der)
    return fail("no revocation list (DER)");
  return out;
}

Expected<Statement> Statement::of_answer(std::string_view der) {
  const unsigned char* at = data_of(der);
  Statement out;
  out.der = der;
  const OcspResponsePtr response(d2i_OCSP_RESPONSE(nullptr, &at, static_cast<long>(der.size())));
  if (response && Der::only(der, Der::sequence) &&
      der_of(response.get(), &i2d_OCSP_RESPONSE) == der &&
      OCSP_response_status(response.get()) == OCSP_RESPONSE_STATUS_SUCCESSFUL)
    out.answer.reset(OCSP_response_get1_basic(response.get()));
  ERR_clear_error();
  if (!out.answer || OCSP_resp_count(out.answer.get()) != 1)
    return fail("no answer by OCSP (DER) about one certificate");
  return out;
}

Expected<bool> vouches(const Statement& s, X509* one, X509* issuer, const Revocation& revocation) {
  NONIO_TRY(const auto said, heard(s, one, issuer));
  if (!said) return false;
  if (auto good = check_not_revoked(*said, one, revocation); !good) return fail(good.error());
  return why_not(*said, one, issuer, revocation.at, s.seen).empty();
}

namespace {

/// Checks the revocation of one certificate of a chain, with the next certificate as its issuer.
class Line {
 public:
  Line(X509* one, X509* issuer, const Trusted& known, const Revocation& revocation)
      : one_(one), issuer_(issuer), known_(known), revocation_(revocation) {}

  Expected<void> check() {
    if (auto done = check_given(); !done) return done;
    return check_kept();
  }
  bool is_known() const { return is_known_; }
  std::string says() const {
    return is_known_ || !says_.empty() ? says_ : "no list of " + quoted(subject_of(issuer_));
  }

 private:
  /// While the certificate is valid, only the newest list of the issuer is used, and it must be
  /// current. After the expiry, any list that was made before the expiry proves the status.
  Expected<void> check_given() {
    const bool has_run_out = time_of(X509_get0_notAfter(one_)) < revocation_.now;
    X509_CRL* newest = newest_list(known_, issuer_);
    for (const RevocationPtr& l : known_.lists) {
      X509_CRL* list = l.get();
      if (has_run_out ? !is_signed_by(list, issuer_) : list != newest) continue;
      if (!has_run_out)
        if (auto sound = check_list(list, issuer_, revocation_.now); !sound) return sound;
      if (auto whole = check_whole(list, issuer_); !whole) return whole;
      const Said said = said_by(list, one_);
      if (auto good = check_not_revoked(said, one_, revocation_); !good) return good;
      note(why_not(said, one_, issuer_, revocation_.at, revocation_.now), "list", said.made, "");
    }
    return {};
  }

  Expected<void> check_kept() {
    for (const Statement& s : known_.kept) {
      const auto said = heard(s, one_, issuer_);
      if (!said) return fail("in the file: " + said.error().message);
      if (!*said) continue;
      if (auto good = check_not_revoked(**said, one_, revocation_); !good) return good;
      const std::string why = why_not(**said, one_, issuer_, revocation_.at, s.seen);
      if (why.empty()) s.used = true;
      note(why, kind_of(s), (*said)->made, " in the file");
    }
    return {};
  }

  void note(const std::string& why, const std::string& kind, Time made, const char* where) {
    if (is_known_) return;
    is_known_ = why.empty();
    says_ = is_known_ ? quoted(subject_of(one_)) + " is not revoked by the " + kind + " of " +
                            text_of(made) + where
                      : "the " + kind + " of " + quoted(subject_of(issuer_)) + where + " " + why;
  }

  X509* one_;
  X509* issuer_;
  const Trusted& known_;
  const Revocation& revocation_;
  bool is_known_ = false;
  std::string says_;
};

}  // namespace

Expected<std::string> check_revocation(const std::vector<CertificatePtr>& chain,
                                       const Trusted& known, const Revocation& revocation,
                                       bool& looked) {
  std::string says;
  looked = false;
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    Line line(chain[i].get(), chain[i + 1].get(), known, revocation);
    if (auto good = line.check(); !good) return fail(good.error());
    if (i == 0) looked = line.is_known();
    says += (says.empty() ? "" : "; ") + line.says();
  }
  return says;
}

}  // namespace nonio::sign
