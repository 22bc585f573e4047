// SPDX-License-Identifier: Apache-2.0
#include "openssl.h"

#include <openssl/core_names.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/sha.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>

namespace nonio::sign {

std::string reason() {
  const unsigned long code = ERR_peek_last_error();
  const char* words = code == 0 ? nullptr : ERR_reason_error_string(code);
  ERR_clear_error();
  return words == nullptr ? "for a reason that OpenSSL does not report" : words;
}

std::string_view bytes_of(const ASN1_STRING* text) {
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
          static_cast<std::size_t>(ASN1_STRING_length(text))};
}

std::string text_of(Time time) {
  const pdf::Calendar c = pdf::calendar(time);
  std::array<char, 64> text{};
  const int n = std::snprintf(text.data(), text.size(), "%04d-%02u-%02u %02d:%02d:%02d UTC", c.year,
                              c.month, c.day, c.hours, c.minutes, c.seconds);
  return {text.data(), static_cast<std::size_t>(n)};
}

std::string sha256(std::string_view one, std::string_view other) {
  std::array<char, SHA256_DIGEST_LENGTH> digest{};
  const std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>> context(EVP_MD_CTX_new());
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  EVP_DigestUpdate(context.get(), one.data(), one.size());
  EVP_DigestUpdate(context.get(), other.data(), other.size());
  EVP_DigestFinal_ex(context.get(), reinterpret_cast<unsigned char*>(digest.data()), nullptr);
  return {digest.data(), digest.size()};
}

std::string hex(std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  for (const char c : bytes) {
    out += digits[static_cast<unsigned char>(c) >> 4];
    out += digits[static_cast<unsigned char>(c) & 15];
  }
  return out;
}

std::string subject_of(const X509* certificate) {
  const BioPtr out(BIO_new(BIO_s_mem()));
  X509_NAME_print_ex(out.get(), X509_get_subject_name(certificate), 0,
                     XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB);
  char* data = nullptr;
  const long size = BIO_get_mem_data(out.get(), &data);
  return size <= 0 ? "" : std::string(data, static_cast<std::size_t>(size));
}

Time time_of(const ASN1_TIME* time) {
  std::tm parts{};
  if (time == nullptr || ASN1_TIME_to_tm(time, &parts) != 1) return 0;
  namespace chrono = std::chrono;
  const chrono::sys_days day =
      chrono::year(parts.tm_year + 1900) / (parts.tm_mon + 1) / parts.tm_mday;
  return chrono::sys_seconds(day).time_since_epoch().count() + parts.tm_hour * Time{3600} +
         parts.tm_min * Time{60} + parts.tm_sec;
}

Expected<std::string> algorithm_of(EVP_PKEY* key, bool old) {
  if (key == nullptr) return fail("a key that cannot be read");
  const int bits = EVP_PKEY_get_bits(key);
  switch (EVP_PKEY_get_base_id(key)) {
    case EVP_PKEY_RSA:
      if (bits >= (old ? 2048 : 3072)) return "RSA-" + std::to_string(bits);
      return fail("an RSA key of " + std::to_string(bits) + " bits: expected " +
                  (old ? "2048" : "3072") + " or more");
    case EVP_PKEY_EC: {
      std::array<char, 64> name{};
      if (EVP_PKEY_get_group_name(key, name.data(), name.size(), nullptr) == 1) {
        const std::string_view curve = name.data();
        if (curve == "prime256v1" || curve == "P-256") return std::string("P-256");
        if (curve == "secp384r1" || curve == "P-384") return std::string("P-384");
      }
      return fail(std::string("an elliptic-curve key over ") + name.data() +
                  ": expected P-256 or P-384");
    }
    default:
      break;
  }
  const char* name = EVP_PKEY_get0_type_name(key);
  return fail("a key of the kind " + std::string(name == nullptr ? "?" : name) +
              ", which cannot sign a PDF: expected RSA of 3072 bits or P-256");
}

Expected<std::vector<CertificatePtr>> certificates_of(const std::string& pem) {
  const BioPtr in(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  std::vector<CertificatePtr> out;
  ERR_clear_error();
  while (X509* certificate = PEM_read_bio_X509(in.get(), nullptr, nullptr, nullptr))
    out.emplace_back(certificate);
  const bool at_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  const std::string why = reason();
  if (!at_end) return fail("holds a certificate that cannot be read: " + why);
  if (out.empty()) return fail("holds no certificate in PEM form");
  return out;
}

}  // namespace nonio::sign
