// SPDX-License-Identifier: Apache-2.0
#include "authority.h"

#include <gtest/gtest.h>
#include <openssl/ocsp.h>
#include <openssl/pem.h>
#include <openssl/pkcs12.h>
#include <openssl/rsa.h>
#include <openssl/x509v3.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <vector>

namespace nonio::sign_tests {

namespace {

std::shared_ptr<EVP_PKEY> make_key(const std::string& kind) {
  EVP_PKEY* key = kind == "P-256" ? EVP_EC_gen("P-256")
                  : kind == "Ed25519"
                      ? EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519")
                      : EVP_RSA_gen(static_cast<unsigned>(std::stoi(kind.substr(4))));
  return {key, &EVP_PKEY_free};
}

void extend(X509* certificate, X509* issuer, int nid, const std::string& value) {
  if (value.empty()) return;
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, nid, value.c_str());
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

Holder certify(std::shared_ptr<EVP_PKEY> key, const Wish& wish, const Holder* issuer) {
  static std::atomic<long> serial = 1000;
  Holder out{std::move(key), {X509_new(), &X509_free}};
  X509* c = out.certificate.get();
  X509_set_version(c, X509_VERSION_3);
  ASN1_INTEGER_set(X509_get_serialNumber(c), ++serial);
  ASN1_TIME_set(X509_getm_notBefore(c), wish.from);
  ASN1_TIME_set(X509_getm_notAfter(c), wish.to);
  X509_NAME* name = X509_get_subject_name(c);
  const auto add = [&](const char* field, const std::string& text) {
    X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(text.c_str()), -1, -1, 0);
  };
  add("O", "Laboratorio di Prova");
  add("CN", wish.name);
  X509* by = issuer == nullptr ? c : issuer->certificate.get();
  X509_set_issuer_name(c, X509_get_subject_name(by));
  X509_set_pubkey(c, out.key.get());
  extend(c, by, NID_basic_constraints, wish.constraints);
  extend(c, by, NID_key_usage, wish.usage);
  extend(c, by, NID_ext_key_usage, wish.extended);
  extend(c, by, NID_subject_key_identifier, "hash");
  EVP_PKEY* by_key = issuer == nullptr ? out.key.get() : issuer->key.get();
  const bool edwards = EVP_PKEY_get_base_id(by_key) == EVP_PKEY_ED25519;
  X509_sign(c, by_key, edwards ? nullptr : EVP_sha256());
  return out;
}

}  // namespace

Holder issue(const Wish& wish, const Holder* issuer) {
  return certify(make_key(wish.key), wish, issuer);
}

Holder authority(const std::string& name) {
  Wish wish;
  wish.name = name;
  wish.usage = "critical,keyCertSign,cRLSign";
  wish.extended = "";
  wish.constraints = "critical,CA:TRUE";
  wish.from = now - 3000 * day;
  wish.to = now + 3000 * day;
  return issue(wish);
}

Wish time_server_wish() {
  Wish wish;
  wish.name = "Test Time";
  wish.usage = "critical,digitalSignature";
  wish.extended = "critical,timeStamping";
  return wish;
}

Holder renamed(const Holder& holder, const Wish& wish, const Holder& issuer) {
  return certify(holder.key, wish, &issuer);
}

namespace {

template <class Write>
std::string written(const Write& write) {
  BIO* out = BIO_new(BIO_s_mem());
  write(out);
  char* data = nullptr;
  const long size = BIO_get_mem_data(out, &data);
  std::string text(data, static_cast<std::size_t>(size));
  BIO_free(out);
  return text;
}

}  // namespace

std::string pem(const Holder& holder) {
  return written([&](BIO* out) { PEM_write_bio_X509(out, holder.certificate.get()); });
}

std::string revocation_list(const Holder& issuer, const Holder* revoked, const ListWish& wish) {
  X509_CRL* list = X509_CRL_new();
  X509_CRL_set_version(list, X509_CRL_VERSION_2);
  X509_CRL_set_issuer_name(list, X509_get_subject_name(issuer.certificate.get()));
  ASN1_TIME* time = ASN1_TIME_set(nullptr, wish.made);
  X509_CRL_set1_lastUpdate(list, time);
  ASN1_TIME_set(time, wish.next);
  if (wish.next != 0) X509_CRL_set1_nextUpdate(list, time);
  if (revoked != nullptr) {
    X509_REVOKED* entry = X509_REVOKED_new();
    X509_REVOKED_set_serialNumber(entry, X509_get_serialNumber(revoked->certificate.get()));
    ASN1_TIME_set(time, wish.when);
    X509_REVOKED_set_revocationDate(entry, time);
    if (wish.reason >= 0) {
      ASN1_ENUMERATED* reason = ASN1_ENUMERATED_new();
      ASN1_ENUMERATED_set(reason, wish.reason);
      X509_REVOKED_add1_ext_i2d(entry, NID_crl_reason, reason, 0, 0);
      ASN1_ENUMERATED_free(reason);
    }
    if (wish.invalid != 0) {
      ASN1_GENERALIZEDTIME* invalid = ASN1_GENERALIZEDTIME_set(nullptr, wish.invalid);
      X509_REVOKED_add1_ext_i2d(entry, NID_invalidity_date, invalid, 0, 0);
      ASN1_GENERALIZEDTIME_free(invalid);
    }
    X509_CRL_add0_revoked(list, entry);
  }
  if (wish.is_delta) {
    ASN1_INTEGER* base = ASN1_INTEGER_new();
    ASN1_INTEGER_set(base, 1);
    X509_CRL_add1_ext_i2d(list, NID_delta_crl, base, 1, 0);
    ASN1_INTEGER_free(base);
  }
  X509_CRL_sign(list, issuer.key.get(), EVP_sha256());
  std::string text = written([&](BIO* out) { PEM_write_bio_X509_CRL(out, list); });
  ASN1_TIME_free(time);
  X509_CRL_free(list);
  return text;
}

std::string ocsp_answer(const Holder& issuer, const Holder& about, const ListWish& wish) {
  OCSP_BASICRESP* basic = OCSP_BASICRESP_new();
  OCSP_CERTID* id = OCSP_cert_to_id(EVP_sha1(), about.certificate.get(), issuer.certificate.get());
  ASN1_TIME* when = ASN1_TIME_adj(nullptr, wish.when, 0, 0);
  ASN1_TIME* made = ASN1_GENERALIZEDTIME_adj(nullptr, wish.made, 0, 0);
  ASN1_TIME* next = ASN1_GENERALIZEDTIME_adj(nullptr, wish.next, 0, 0);
  OCSP_basic_add1_status(basic, id,
                         wish.when == 0 ? V_OCSP_CERTSTATUS_GOOD : V_OCSP_CERTSTATUS_REVOKED,
                         wish.reason, when, made, wish.next == 0 ? nullptr : next);
  OCSP_basic_sign(basic, issuer.certificate.get(), issuer.key.get(), EVP_sha256(), nullptr, 0);
  OCSP_RESPONSE* response = OCSP_response_create(OCSP_RESPONSE_STATUS_SUCCESSFUL, basic);
  std::string out = written([&](BIO* to) { i2d_OCSP_RESPONSE_bio(to, response); });
  OCSP_RESPONSE_free(response);
  OCSP_BASICRESP_free(basic);
  OCSP_CERTID_free(id);
  for (ASN1_TIME* t : {when, made, next}) ASN1_TIME_free(t);
  return out;
}

Folder::Folder() {
  std::string path = (std::filesystem::temp_directory_path() / "nonio-sign-XXXXXX").string();
  path_ = ::mkdtemp(path.data());
}
Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}
std::string Folder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(file(name), std::ios::binary) << bytes;
  return file(name);
}

std::string pkcs12(const Folder& folder, const Holder& holder, const Holder& issuer) {
  STACK_OF(X509)* others = sk_X509_new_null();
  sk_X509_push(others, issuer.certificate.get());
  PKCS12* file = PKCS12_create(password, "test", holder.key.get(), holder.certificate.get(), others,
                               0, 0, 0, 0, 0);
  sk_X509_free(others);
  const std::string path = folder.file("key.p12");
  BIO* out = BIO_new_file(path.c_str(), "wb");
  i2d_PKCS12_bio(out, file);
  BIO_free(out);
  PKCS12_free(file);
  return path;
}

sign::Key open(const Holder& holder, const Holder& issuer) {
  const Folder folder;
  sign::KeyPlace place;
  place.pkcs12 = pkcs12(folder, holder, issuer);
  auto key = sign::Key::open(place, password, now);
  EXPECT_TRUE(key) << key.error().message;
  return std::move(key.value());
}

std::string small_pdf(const std::string& text, const std::string& of_page) {
  const std::string page = "BT /F1 12 Tf 50 800 Td (" + text + ") Tj ET";
  const std::vector<std::string> objects = {
      "<<\n/Type /Catalog\n/Pages 2 0 R\n/Lang (en)\n>>",
      "<<\n/Type /Pages\n/Kids [ 4 0 R ]\n/Count 1\n>>",
      "<<\n/Title (Small)\n/CreationDate (D:20261121000000Z)\n>>",
      "<<\n/Type /Page\n/Parent 2 0 R\n" + of_page +
          "/MediaBox [ 0 0 595.28 841.89 ]\n/Contents 5 0 R\n"
          "/Resources << /Font << /F1 << /Type /Font /Subtype /Type1 /BaseFont /Helvetica >> >> "
          ">>\n>>",
      "<<\n/Length " + std::to_string(page.size()) + "\n>>\nstream\r\n" + page + "\nendstream"};
  std::string out = "%PDF-1.7\n%\xB7\xBE\xAD\xAA\n", table = "0000000000 65535 f\r\n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::array<char, 32> entry{};
    std::snprintf(entry.data(), entry.size(), "%010zu 00000 n\r\n", out.size());
    table += entry.data();
    out += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::size_t at = out.size();
  return out + "xref\n0 6\n" + table +
         "trailer\n<<\n/Root 1 0 R\n/Info 3 0 R\n/Size 6\n>>\nstartxref\n" + std::to_string(at) +
         "\n%%EOF\n";
}

}  // namespace nonio::sign_tests
