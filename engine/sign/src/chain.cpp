// SPDX-License-Identifier: Apache-2.0
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <ctime>

#include "signed_data.h"
#include "verify_parts.h"

namespace nonio::sign {

namespace {

using StorePtr = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContextPtr = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;

Expected<std::vector<RevocationPtr>> lists_of(const std::string& pem) {
  std::vector<RevocationPtr> out;
  const BioPtr in(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  while (X509_CRL* list = PEM_read_bio_X509_CRL(in.get(), nullptr, nullptr, nullptr))
    out.emplace_back(list);
  const bool at_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  ERR_clear_error();
  if (out.empty() || !at_end) return fail("holds no revocation list in PEM form");
  return out;
}

}  // namespace

Expected<Trusted> trusted(const Verifier& verifier) {
  Trusted out;
  ERR_clear_error();
  const auto take = [](const std::string& pem, const char* whose,
                       std::vector<CertificatePtr>& to) -> Expected<void> {
    if (pem.empty()) return {};
    auto roots = certificates_of(pem);
    if (!roots)
      return fail("the file with the roots of " + std::string(whose) + " " + roots.error().message);
    to = std::move(*roots);
    return {};
  };
  if (auto done = take(verifier.signer_roots, "signers", out.signer_roots); !done)
    return fail(done.error());
  if (auto done = take(verifier.time_stamp_roots, "time servers", out.time_roots); !done)
    return fail(done.error());
  if (verifier.revocation) {
    auto lists = lists_of(*verifier.revocation);
    if (!lists) return fail("the revocation file " + lists.error().message);
    out.lists = std::move(*lists);
  }
  return out;
}

Expected<void> check_verifier(const Verifier& verifier) {
  if (auto known = trusted(verifier); !known) return fail(known.error());
  return {};
}

Expected<std::size_t> number_of_roots(const std::string& pem) {
  NONIO_TRY(const auto roots, certificates_of(pem));
  return roots.size();
}

Expected<std::vector<CertificatePtr>> chain_of(X509* certificate,
                                               const std::vector<CertificatePtr>& all,
                                               const std::vector<CertificatePtr>& roots, Time at) {
  ERR_clear_error();
  const StorePtr store(X509_STORE_new());
  for (const CertificatePtr& root : roots) X509_STORE_add_cert(store.get(), root.get());
  const Borrowed others(sk_X509_new_null());
  for (const CertificatePtr& c : all) sk_X509_push(others.get(), c.get());
  const StoreContextPtr context(X509_STORE_CTX_new());
  if (X509_STORE_CTX_init(context.get(), store.get(), certificate, others.get()) != 1)
    return fail("cannot be checked: " + reason());
  X509_VERIFY_PARAM* wanted = X509_STORE_CTX_get0_param(context.get());
  X509_VERIFY_PARAM_set_time(wanted, static_cast<std::time_t>(at));
  X509_VERIFY_PARAM_set_auth_level(wanted, 2);  // 112 bits of security, for example RSA-2048
  if (X509_verify_cert(context.get()) != 1) {
    const int code = X509_STORE_CTX_get_error(context.get());
    const X509* where = X509_STORE_CTX_get_current_cert(context.get());
    ERR_clear_error();
    return fail(std::string(X509_verify_cert_error_string(code)) +
                (where == nullptr ? "" : ", at " + quoted(subject_of(where))));
  }
  std::vector<CertificatePtr> out;
  const STACK_OF(X509)* chain = X509_STORE_CTX_get0_chain(context.get());
  for (int i = 0; i < sk_X509_num(chain); ++i) {
    X509_up_ref(sk_X509_value(chain, i));
    out.emplace_back(sk_X509_value(chain, i));
  }
  return out;
}

Expected<void> check_issued(const std::vector<CertificatePtr>& certificates,
                            const std::vector<CertificatePtr>& roots) {
  const auto issued = [](const CertificatePtr& one, const CertificatePtr& by) {
    return X509_check_issued(by.get(), one.get()) == X509_V_OK &&
           X509_get0_pubkey(by.get()) != nullptr &&
           X509_verify(one.get(), X509_get0_pubkey(by.get())) == 1;
  };
  for (const CertificatePtr& one : certificates) {
    const auto by = [&](const CertificatePtr& c) { return issued(one, c); };
    const bool fits = std::any_of(certificates.begin(), certificates.end(), by) ||
                      std::any_of(roots.begin(), roots.end(), by);
    ERR_clear_error();
    if (!fits)
      return fail("the certificate of " + quoted(subject_of(one.get())) +
                  " is damaged, or its issuer is not known");
  }
  return {};
}

Expected<void> check_only(const std::vector<CertificatePtr>& certificates,
                          const std::vector<CertificatePtr>& chain) {
  for (std::size_t i = 0; i < certificates.size(); ++i) {
    const auto same = [&](const CertificatePtr& c) {
      return X509_cmp(c.get(), certificates[i].get()) == 0;
    };
    const auto after = certificates.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    if (std::none_of(chain.begin(), chain.end(), same) ||
        std::any_of(after, certificates.end(), same))
      return fail("the certificate of " + quoted(subject_of(certificates[i].get())) +
                  " is also present, or present twice, and leads to no trusted certificate");
  }
  return {};
}

std::vector<CertificatePtr> way_up(X509* certificate, std::vector<CertificatePtr> others) {
  std::vector<CertificatePtr> way;
  for (X509* one = certificate; !others.empty(); one = way.back().get()) {
    const auto issuer = std::find_if(others.begin(), others.end(), [&](const CertificatePtr& c) {
      return X509_check_issued(c.get(), one) == X509_V_OK;
    });
    if (issuer == others.end()) break;
    way.push_back(std::move(*issuer));
    others.erase(issuer);
  }
  return way;
}

}  // namespace nonio::sign
