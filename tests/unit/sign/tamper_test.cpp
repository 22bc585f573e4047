// SPDX-License-Identifier: Apache-2.0
// What an attacker may do to a signed file: every byte flipped once, and the tricks that at least
// one of pdfsig, openssl and qpdf was seen to accept.
#include <gtest/gtest.h>
#include <openssl/cms.h>
#include <openssl/x509.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "authority.h"
#include "nonio/sign/prolong.h"
#include "nonio/sign/verify.h"
#include "time_server.h"

namespace nonio::sign_tests::tamper_test {
namespace {

using sign::Check;

struct Scene {
  Holder root = authority();
  Holder ada = issue({}, &root);
  TimeServer server{issue(time_server_wish(), &root)};
  sign::Verifier verifier;
  std::string plain, stamped;

  Scene() {
    verifier.signer_roots = verifier.time_stamp_roots = pem(root);
    verifier.signers = {{"CN=Ada Bianchi,O=Laboratorio di Prova"}};
    verifier.now = now;
    plain = make(open(ada, root), {});
    stamped = make(open(ada, root), server.stamping(pem(root)));
  }
  std::string make(const sign::Key& key, const sign::TimeStamping& stamping) const {
    const auto reserved =
        pdf::reserve(small_pdf(), {{"x.csv", "1,2\n", "text/csv", "Source", "readings"}}, now,
                     stamping.url.empty() ? 1500 : 4500);
    const auto done = key.sign(*reserved, now, stamping);
    EXPECT_TRUE(done) << done.error().message;
    return done ? done->bytes : "";
  }
  bool holds(const std::string& bytes) const { return sign::verify_pdf(bytes, verifier).holds(); }
  /// Which check says no first.
  std::string fails(const std::string& bytes) const {
    for (const Check& c : sign::verify_pdf(bytes, verifier).checks)
      if (c.state == Check::State::fails && !c.says.empty()) return c.id;
    return "none";
  }
};

const Scene& scene() {
  static const Scene made;
  return made;
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Each byte in one other way of the 255. From `from` on; of a long row of zeros every 97th.
void flip_every_byte(const std::string& good, std::size_t from = 0) {
  constexpr unsigned seed = 20261123;
  std::cout << "seed " << seed << '\n';
  std::mt19937 rng(seed);
  std::uniform_int_distribution<int> other(1, 255);
  const Scene& s = scene();
  ASSERT_TRUE(s.holds(good));
  std::string bytes = good;
  std::size_t accepted = 0;
  for (std::size_t i = from; i < good.size(); ++i) {
    if (from != 0 && i % 97 != 0 && good.compare(i, 64, std::string(64, '0')) == 0) continue;
    const int mask = other(rng);
    bytes[i] = static_cast<char>(bytes[i] ^ mask);
    if (s.fails(bytes) == "none" && ++accepted <= 20)
      ADD_FAILURE() << "byte " << i << " ^ " << mask << " is accepted";
    bytes[i] = good[i];
  }
  EXPECT_EQ(accepted, 0U);
}

std::string prolonged() {
  const Scene& s = scene();
  sign::Prolonging how;
  how.verifier = s.verifier;
  how.verifier.revocation = revocation_list(s.root, nullptr, 0);
  how.stamping = s.server.stamping(pem(s.root));
  how.fetch = false;
  const auto done = sign::prolong(s.plain, how);
  EXPECT_TRUE(done) << done.error().message;
  return done ? done->bytes : "";
}

TEST(Tamper, EveryByteFlippedOfAProlongedFile) {
  flip_every_byte(prolonged(), scene().plain.size());
}

/// A file that is cut short holds only where an update ends: that is an earlier file.
TEST(Tamper, AProlongedFileCutShort) {
  const Scene& s = scene();
  const std::string good = prolonged();
  for (std::size_t n = s.plain.size(); n < good.size(); n += n < s.plain.size() + 3000 ? 1 : 37)
    EXPECT_EQ(s.holds(good.substr(0, n)), n == s.plain.size()) << n;
}

TEST(Tamper, EveryByteFlipped) { flip_every_byte(scene().plain); }
TEST(Tamper, EveryByteFlippedWithATimeStamp) { flip_every_byte(scene().stamped); }

/// Every byte of the signature itself in every way: what is not signed has one form.
TEST(Tamper, EveryValueOfEveryByteOfTheSignature) {
  const Scene& s = scene();
  const std::size_t gap = s.stamped.find("/Contents <30") + 11;
  std::size_t end = s.stamped.find('>', gap);
  while (s.stamped.compare(end - 8, 8, "00000000") == 0) end -= 2;
  std::mt19937 random(20261121);
  std::string bytes = s.stamped;
  constexpr std::string_view digits = "0123456789abcdef";
  for (std::size_t i = gap; i < end; ++i) {
    const char was = bytes[i];
    const char other = digits[random() % 16];
    if (other == was) continue;
    bytes[i] = other;
    EXPECT_NE(s.fails(bytes), "none") << "digit " << i - gap << " as " << other << " in "
                                      << s.stamped.substr(i - 60, 80) << " at 60";
    bytes[i] = was;
  }
}

TEST(Tamper, BytesBehindTheSignedOnesAreRefused) {
  const Scene& s = scene();
  EXPECT_EQ(s.fails(s.plain + "% a comment\n"), "signature.range");
  EXPECT_EQ(s.fails(s.plain + "\n"), "signature.range");
  EXPECT_EQ(s.fails(s.plain + s.plain), "signature.range");
  const std::size_t table = s.plain.rfind("startxref\n") + 10;
  const std::string old = s.plain.substr(table, s.plain.find('\n', table) - table);
  std::string update = s.plain + "5 0 obj\n<<\n/Length 2\n>>\nstream\nBT\nendstream\nendobj\n";
  const std::size_t at = update.size();
  char offset[16];
  std::snprintf(offset, sizeof offset, "%010zu", s.plain.size());
  update += "xref\n5 1\n" + std::string(offset) +
            " 00000 n\r\ntrailer\n<<\n/Root 1 0 R\n/Size 10\n/Prev " + old + "\n>>\nstartxref\n" +
            std::to_string(at) + "\n%%EOF\n";
  EXPECT_EQ(s.fails(update), "file.updates");
  // And the signed range made longer.
  const std::size_t range = update.find("/ByteRange [0 ") + 36;
  std::snprintf(offset, sizeof offset, "%010zu",
                std::stoul(update.substr(range, 10)) + update.size() - s.plain.size());
  update.replace(range, 10, offset);
  EXPECT_EQ(s.fails(update), "signature.range");
}

TEST(Tamper, WhatIsPutIntoThePadding) {
  const Scene& s = scene();
  const std::size_t end = s.plain.find('>', s.plain.find("/Contents <30"));
  std::string bytes = s.plain;
  bytes.replace(end - 4, 4, "beef");
  EXPECT_EQ(s.fails(bytes), "signature.padding");
  bytes = s.plain;
  bytes.replace(end - 20, 20, ">/Extra (smuggled) <");
  EXPECT_NE(s.fails(bytes), "none");
  // Fewer zeros, with the offsets corrected by hand, are still inside what is signed.
  bytes = s.plain;
  bytes.erase(end - 2, 2);
  EXPECT_EQ(s.fails(bytes), "signature.range");
}

TEST(Tamper, TheFieldIsHidden) {
  const Scene& s = scene();
  EXPECT_EQ(s.fails(with(s.plain, "/AcroForm", "/AcroFarm")), "signature.content");
  EXPECT_EQ(s.fails(with(s.plain, "/ETSI.CAdES", "/ETSI.CAdeS")), "signature.content");
}

TEST(Tamper, TheCertificateIsAnother) {
  const Scene& s = scene();
  Wish eve;
  eve.name = "Eve";
  // Another person with a certificate of the same authority: only the expected signer shows it.
  EXPECT_EQ(s.fails(s.make(open(issue(eve, &s.root), s.root), {})), "signer.expected");
  // A namesake by himself.
  const Holder namesake = issue({});
  EXPECT_EQ(s.fails(s.make(open(namesake, namesake), {})), "certificate.chain");
  // The same key under another certificate, put in place of the signer's.
  const Holder other = renamed(s.ada, eve, s.root);
  const std::string forged = s.make(open(other, s.root), {});
  EXPECT_EQ(s.fails(forged), "signer.expected");
}

std::string hex_of(const std::string& bytes) {
  std::string out;
  for (const unsigned char c : bytes) {
    std::array<char, 3> two{};
    std::snprintf(two.data(), two.size(), "%02x", c);
    out += two.data();
  }
  return out;
}

template <class T>
std::string der(T* object, int (*encode)(const T*, unsigned char**)) {
  unsigned char* made = nullptr;
  const int size = encode(object, &made);
  std::string out(reinterpret_cast<const char*>(made), static_cast<std::size_t>(size));
  OPENSSL_free(made);
  return out;
}

/// A certificate of the same key, issuer, serial number and size for another name: ECDSA signatures
/// differ in length, so it is signed until it fits.
Holder twin_of_ada(const Scene& s) {
  Wish eva;
  eva.name = "Eva Bianchi";
  const Holder twin = renamed(s.ada, eva, s.root);
  X509* c = twin.certificate.get();
  X509_set_serialNumber(c, X509_get_serialNumber(s.ada.certificate.get()));
  const std::size_t wanted = der(s.ada.certificate.get(), &i2d_X509).size();
  for (int trial = 0; trial < 1000; ++trial) {
    X509_sign(c, s.root.key.get(), EVP_sha256());
    if (der(c, &i2d_X509).size() == wanted) break;
  }
  return twin;
}

TEST(Tamper, TheCertificateInsideTheSignatureIsSwapped) {
  const Scene& s = scene();
  const std::string ada = hex_of(der(s.ada.certificate.get(), &i2d_X509));
  const std::string eva = hex_of(der(twin_of_ada(s).certificate.get(), &i2d_X509));
  ASSERT_EQ(ada.size(), eva.size());
  EXPECT_EQ(s.fails(with(s.plain, ada, eva)), "signature.certificate");
}

/// What openssl cms -verify accepts: a signer named by the key alone fits every certificate of it.
TEST(Tamper, ASignerNamedByTheKeyAlone) {
  const Scene& s = scene();
  const std::size_t gap = s.plain.find("/Contents <30") + 10, end = s.plain.find('>', gap) + 1;
  const std::string content = s.plain.substr(0, gap) + s.plain.substr(end);
  for (const unsigned extra : {0U, unsigned{CMS_CADES}}) {
    const unsigned flags = CMS_BINARY | CMS_DETACHED;
    BIO* in = BIO_new_mem_buf(content.data(), static_cast<int>(content.size()));
    CMS_ContentInfo* cms = CMS_sign(nullptr, nullptr, nullptr, nullptr, flags | CMS_PARTIAL);
    CMS_add1_signer(cms, s.ada.certificate.get(), s.ada.key.get(), EVP_sha256(),
                    flags | CMS_USE_KEYID | CMS_NOSMIMECAP | extra);
    EXPECT_EQ(CMS_final(cms, in, nullptr, flags), 1);
    std::string digits = hex_of(der(cms, &i2d_CMS_ContentInfo));
    CMS_ContentInfo_free(cms);
    BIO_free(in);
    ASSERT_LE(digits.size(), end - gap - 2);
    digits.resize(end - gap - 2, '0');
    EXPECT_EQ(s.fails(with(s.plain, s.plain.substr(gap + 1, end - gap - 2), digits)),
              "signature.form");
  }
}

/// The signer's own key may sign what says another time than the document; readers of PDF show it.
TEST(Tamper, ASignedAttributeMoreIsRefused) {
  const Scene& s = scene();
  const std::size_t gap = s.plain.find("/Contents <30") + 10, end = s.plain.find('>', gap) + 1;
  const std::string content = s.plain.substr(0, gap) + s.plain.substr(end);
  const unsigned flags = CMS_BINARY | CMS_DETACHED | CMS_NOSMIMECAP | CMS_CADES;
  BIO* in = BIO_new_mem_buf(content.data(), static_cast<int>(content.size()));
  CMS_ContentInfo* cms = CMS_sign(nullptr, nullptr, nullptr, nullptr, flags | CMS_PARTIAL);
  CMS_add1_signer(cms, s.ada.certificate.get(), s.ada.key.get(), EVP_sha256(), flags);
  EXPECT_EQ(CMS_final(cms, in, nullptr, flags), 1);  // with a time of signing
  std::string digits = hex_of(der(cms, &i2d_CMS_ContentInfo));
  CMS_ContentInfo_free(cms);
  BIO_free(in);
  ASSERT_LE(digits.size(), end - gap - 2);
  digits.resize(end - gap - 2, '0');
  const std::string forged = with(s.plain, s.plain.substr(gap + 1, end - gap - 2), digits);
  EXPECT_EQ(s.fails(forged), "signature.form");
  for (const Check& c : sign::verify_pdf(forged, s.verifier).checks)
    if (c.id == "signature.form") EXPECT_NE(c.says.find("signed attributes"), std::string::npos);
}

TEST(Tamper, AnExpiredCertificate) {
  const Scene& s = scene();
  sign::Verifier later = s.verifier;
  later.now = now + 400 * day;
  EXPECT_FALSE(sign::verify_pdf(s.plain, later).holds());
  EXPECT_TRUE(sign::verify_pdf(s.stamped, later).holds());
}

/// Observed: OpenSSL accepts the tag of a SET that is not marked as constructed, and corrects it
/// before it checks the signature, so that a different file passed (2026-11-21).
TEST(Tamper, AnAttributeThatIsNoConstructedSetIsRefused) {
  const Scene& s = scene();
  constexpr const char* digest_attribute = "06092a864886f70d01090431";
  EXPECT_EQ(s.fails(with(s.plain, digest_attribute, "06092a864886f70d01090411")), "signature.form");
}

/// Not a search for anything: whatever a file holds, the answer is no, and there is one.
TEST(Tamper, RandomDamageIsAlwaysRefused) {
  const Scene& s = scene();
  const unsigned seed = std::random_device{}();
  const char* wanted = std::getenv("NONIO_MUTANTS");
  const long trials = wanted == nullptr ? 2000 : std::atol(wanted);
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (long trial = 0; trial < trials; ++trial) {
    std::string bytes = s.stamped;
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      const std::size_t at = random() % bytes.size();
      const std::size_t size = std::min<std::size_t>(random() % 40, bytes.size() - at);
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes.erase(at, size);
          break;
        case 2:
          bytes.insert(at, bytes.substr(random() % bytes.size(), size));
          break;
        default:
          bytes.replace(at, size, std::string(size, '9'));
      }
    }
    if (bytes == s.stamped) continue;
    ASSERT_NE(s.fails(bytes), "none");
    [[maybe_unused]] const auto pages = pdf::page_contents(bytes);
  }
}

}  // namespace
}  // namespace nonio::sign_tests::tamper_test
