// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "authority.h"
#include "nonio/sign/verify.h"
#include "time_server.h"

namespace nonio::sign_tests::sign_test {
namespace {

using sign::Check;

const Holder& root() {
  static const Holder made = authority();
  return made;
}

sign::Verifier trusting(const std::string& signer = "CN=Ada Bianchi,O=Laboratorio di Prova") {
  sign::Verifier v;
  v.signer_roots = v.time_stamp_roots = pem(root());
  if (!signer.empty()) v.signers = {{signer}};
  v.now = now;
  return v;
}

const std::vector<pdf::Attachment> files = {
    {"x.csv", "run,direction\n1,+\n", "text/csv", "Source", "readings"},
    {"data/città.csv", std::string(100000, '7'), "text/csv", "Source", "readings"},
    {"results.json", "{}", "application/json", "Data", "results"}};

std::string signed_by(const Holder& holder, const sign::TimeStamping& stamping = {},
                      std::size_t room = pdf::usual_room) {
  auto reserved = pdf::reserve(small_pdf(), files, now, room);
  EXPECT_TRUE(reserved) << reserved.error().message;
  auto done = open(holder, root()).sign(*reserved, now, stamping);
  EXPECT_TRUE(done) << done.error().message;
  return done ? done->bytes : "";
}

Check::State state_of(const sign::Verified& v, const std::string& id) {
  for (const Check& c : v.checks)
    if (c.id == id) return c.state;
  ADD_FAILURE() << "no check " << id;
  return Check::State::not_checked;
}

std::string all_of(const sign::Verified& v) {
  std::string text;
  for (const Check& c : v.checks)
    text += c.id +
            (c.state == Check::State::holds   ? " holds: "
             : c.state == Check::State::fails ? " FAILS: "
                                              : " not checked: ") +
            c.says + "\n";
  return text;
}

class EachKey : public testing::TestWithParam<const char*> {};

TEST_P(EachKey, SignsAPdfThatVerifies) {
  Wish wish;
  wish.key = GetParam();
  const auto verified = sign::verify_pdf(signed_by(issue(wish, &root())), trusting());
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  ASSERT_EQ(verified.attachments.size(), files.size());
  EXPECT_EQ(verified.attachments[0].name, "data/città.csv");
  EXPECT_EQ(verified.attachments[0].bytes, files[1].bytes);
  EXPECT_EQ(verified.attachments[1].name, "results.json");
  EXPECT_EQ(verified.attachments[2].relation, "Source");
  EXPECT_EQ(verified.at, now);
}
INSTANTIATE_TEST_SUITE_P(Sign, EachKey, testing::Values("P-256", "RSA-3072"));

TEST(Sign, TheSameInputAndRsaGiveTheSameBytes) {
  Wish wish;
  wish.key = "RSA-3072";
  const Holder ada = issue(wish, &root());
  EXPECT_EQ(signed_by(ada), signed_by(ada));
}

TEST(Sign, WithoutAnExpectedSignerOrTrustedRootsTheSignatureDoesNotHold) {
  const std::string bytes = signed_by(issue({}, &root()));
  auto verifier = trusting("");
  auto verified = sign::verify_pdf(bytes, verifier);
  EXPECT_EQ(state_of(verified, "signer.expected"), Check::State::not_checked);
  EXPECT_FALSE(verified.holds());
  verifier = trusting();
  verifier.signer_roots = "";
  verified = sign::verify_pdf(bytes, verifier);
  EXPECT_EQ(state_of(verified, "certificate.chain"), Check::State::not_checked);
  EXPECT_FALSE(verified.holds());
}

TEST(Sign, TheSignerMayBeGivenAsFingerprint) {
  const Holder ada = issue({}, &root());
  auto reserved = pdf::reserve(small_pdf(), {}, now);
  const auto key = open(ada, root());
  const std::string bytes = key.sign(*reserved, now)->bytes;
  EXPECT_TRUE(sign::verify_pdf(bytes, trusting(key.identity().sha256)).holds());
  EXPECT_FALSE(sign::verify_pdf(bytes, trusting(std::string(64, '0'))).holds());
}

TEST(Sign, RefusesKeysThatCannotSign) {
  const auto why = [&](const Wish& wish) {
    const Folder folder;
    sign::KeyPlace place;
    place.pkcs12 = pkcs12(folder, issue(wish, &root()), root());
    const auto key = sign::Key::open(place, password, now);
    return key ? "" : key.error().message;
  };
  Wish wish;
  wish.key = "Ed25519";
  EXPECT_NE(why(wish).find("ED25519"), std::string::npos) << why(wish);
  wish.key = "RSA-2048";
  EXPECT_NE(why(wish).find("3072"), std::string::npos) << why(wish);
  wish = {};
  wish.to = now - day;
  EXPECT_NE(why(wish).find("ran out"), std::string::npos) << why(wish);
  wish = {};
  wish.from = now + day;
  EXPECT_NE(why(wish).find("not valid before"), std::string::npos) << why(wish);
  wish = {};
  wish.usage = "critical,keyEncipherment";
  EXPECT_NE(why(wish).find("key usage"), std::string::npos) << why(wish);
  wish = {};
  wish.extended = "serverAuth";
  EXPECT_NE(why(wish).find("documents"), std::string::npos) << why(wish);
}

TEST(Sign, AWrongPasswordIsSaidAndNotShown) {
  const Folder folder;
  sign::KeyPlace place;
  place.pkcs12 = pkcs12(folder, issue({}, &root()), root());
  const auto key = sign::Key::open(place, "hunter2", now);
  ASSERT_FALSE(key);
  EXPECT_NE(key.error().message.find("wrong password"), std::string::npos);
  EXPECT_EQ(key.error().message.find("hunter2"), std::string::npos);
  place.pkcs12 = folder.write("nothing.p12", "nothing");
  EXPECT_NE(sign::Key::open(place, password, now).error().message.find("PKCS#12"),
            std::string::npos);
  place.pkcs12 = folder.file("absent.p12");
  EXPECT_NE(sign::Key::open(place, password, now).error().message.find("cannot read"),
            std::string::npos);
}

TEST(Sign, SignsOnlyWhatIsReservedAndOnlyOnce) {
  const auto key = open(issue({}, &root()), root());
  EXPECT_FALSE(key.sign(small_pdf(), now));
  EXPECT_FALSE(key.sign("hello", now));
  const auto once = key.sign(*pdf::reserve(small_pdf(), {}, now), now);
  ASSERT_TRUE(once);
  const auto twice = key.sign(once->bytes, now);
  ASSERT_FALSE(twice);
  EXPECT_NE(twice.error().message.find("signed already"), std::string::npos);
  EXPECT_FALSE(pdf::reserve(once->bytes, {}, now));
}

TEST(Sign, ASignatureThatDoesNotFitIsAnError) {
  const auto key = open(issue({}, &root()), root());
  const TimeServer server(issue(time_server_wish(), &root()));
  const auto done =
      key.sign(*pdf::reserve(small_pdf(), {}, now, 1000), now, server.stamping(pem(root())));
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("does not fit"), std::string::npos) << done.error().message;
}

TEST(TimeStamp, ProvesTheTime) {
  const TimeServer server(issue(time_server_wish(), &root()), now - 5 * day);
  const std::string bytes = signed_by(issue({}, &root()), server.stamping(pem(root())));
  auto verifier = trusting();
  auto verified = sign::verify_pdf(bytes, verifier);
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_EQ(verified.at, now - 5 * day);
  // Long after the certificates ran out.
  verifier.now = now + 2000 * day;
  EXPECT_TRUE(sign::verify_pdf(bytes, verifier).holds());
}

TEST(TimeStamp, WithoutOneAnExpiredCertificateProvesNothing) {
  auto verifier = trusting();
  verifier.now = now + 2000 * day;
  const auto verified = sign::verify_pdf(signed_by(issue({}, &root())), verifier);
  EXPECT_EQ(state_of(verified, "certificate.chain"), Check::State::fails) << all_of(verified);
}

TEST(TimeStamp, NoAnswerFailsOrIsSaidAsConfigured) {
  using Mood = TimeServer::Mood;
  const auto key = open(issue({}, &root()), root());
  const std::string reserved = *pdf::reserve(small_pdf(), {}, now);
  for (const Mood mood :
       {Mood::silent, Mood::refuses, Mood::other_imprint, Mood::other_nonce, Mood::nonsense}) {
    const TimeServer server(issue(time_server_wish(), &root()), now, mood);
    auto stamping = server.stamping(pem(root()));
    EXPECT_FALSE(key.sign(reserved, now, stamping)) << static_cast<int>(mood);
    stamping.required = false;
    const auto without = key.sign(reserved, now, stamping);
    ASSERT_TRUE(without) << without.error().message;
    EXPECT_FALSE(without->no_time_stamp.empty());
    EXPECT_TRUE(sign::verify_pdf(without->bytes, trusting()).holds());
  }
}

TEST(TimeStamp, IsTakenOnlyFromAServerThatIsTrustedAndCertifiedForTime) {
  const auto key = open(issue({}, &root()), root());
  const std::string reserved = *pdf::reserve(small_pdf(), {}, now);
  Wish not_for_time = time_server_wish();
  not_for_time.extended = "emailProtection";
  const Holder stranger = authority("Stranger");
  const TimeServer one(issue(time_server_wish(), &stranger));
  EXPECT_FALSE(key.sign(reserved, now, one.stamping(pem(root()))));
  const TimeServer other(issue(not_for_time, &root()));
  EXPECT_FALSE(key.sign(reserved, now, other.stamping(pem(root()))));
}

TEST(Revocation, CountsFromItsDateOn) {
  const Holder ada = issue({}, &root());
  const TimeServer server(issue(time_server_wish(), &root()), now - 5 * day);
  const std::string bytes = signed_by(ada, server.stamping(pem(root())));
  auto verifier = trusting();
  verifier.revocation = revocation_list(root(), &ada, now - 3 * day);
  EXPECT_TRUE(sign::verify_pdf(bytes, verifier).holds());
  verifier.revocation = revocation_list(root(), &ada, now - 8 * day);
  EXPECT_EQ(state_of(sign::verify_pdf(bytes, verifier), "certificate.revocation"),
            Check::State::fails);
  verifier.revocation = revocation_list(root(), nullptr, 0);
  EXPECT_EQ(state_of(sign::verify_pdf(bytes, verifier), "certificate.revocation"),
            Check::State::holds);
  // A list that says nothing of this signer is no check of him.
  verifier.revocation = revocation_list(authority("Other"), nullptr, 0);
  EXPECT_FALSE(sign::verify_pdf(bytes, verifier).holds());
}

TEST(Revocation, OnlyByAListThatIsOfUseNow) {
  const Holder ada = issue({}, &root());
  const std::string bytes = signed_by(ada);
  const auto state = [&](const ListWish& wish, const Holder* revoked = nullptr) {
    auto verifier = trusting();
    verifier.revocation = revocation_list(root(), revoked, wish);
    return state_of(sign::verify_pdf(bytes, verifier), "certificate.revocation");
  };
  EXPECT_EQ(state({}), Check::State::holds);
  ListWish stale;
  stale.made = now - 40 * day;
  stale.next = now - day;
  EXPECT_EQ(state(stale), Check::State::fails);
  ListWish endless;
  endless.next = 0;
  EXPECT_EQ(state(endless), Check::State::fails);
  ListWish early;
  early.made = now + day;
  EXPECT_EQ(state(early), Check::State::fails);
  ListWish delta;
  delta.is_delta = true;
  EXPECT_EQ(state(delta), Check::State::fails);
  // The key was lost before anybody noticed.
  ListWish lost;
  lost.when = now + day;
  EXPECT_EQ(state(lost, &ada), Check::State::holds);
  lost.invalid = now - day;
  EXPECT_EQ(state(lost, &ada), Check::State::fails);
}

TEST(Revocation, TheNewestOfSeveralListsCounts) {
  const Holder ada = issue({}, &root());
  const std::string bytes = signed_by(ada);
  ListWish older;
  older.made = now - 20 * day;
  older.next = now + day;
  ListWish newer;
  newer.when = now - day;
  const std::string old_list = revocation_list(root(), nullptr, older),
                    new_list = revocation_list(root(), &ada, newer);
  for (const std::string& lists : {old_list + new_list, new_list + old_list}) {
    auto verifier = trusting();
    verifier.revocation = lists;
    EXPECT_EQ(state_of(sign::verify_pdf(bytes, verifier), "certificate.revocation"),
              Check::State::fails);
  }
}

/// RFC 3161, 4: after which reasons the stamps that a server gave before stay good.
TEST(Revocation, OfATimeServer) {
  const Holder time = issue(time_server_wish(), &root());
  const TimeServer server(time, now - 5 * day);
  const std::string bytes = signed_by(issue({}, &root()), server.stamping(pem(root())));
  const std::string dcc =
      open(issue({}, &root()), root())
          .sign("<?xml version=\"1.0\"?><r></r>", now, server.stamping(pem(root())))
          ->bytes;
  const auto holds = [&](sign::Time when, int reason) {
    auto verifier = trusting();
    ListWish wish;
    wish.when = when;
    wish.reason = reason;
    verifier.revocation = revocation_list(root(), &time, wish);
    const bool pdf = sign::verify_pdf(bytes, verifier).holds();
    EXPECT_EQ(sign::verify_xml(dcc, verifier).holds(), pdf) << reason;
    return pdf;
  };
  EXPECT_FALSE(holds(now - 3 * day, -1));
  EXPECT_FALSE(holds(now - 3 * day, 1)) << "its key was compromised";
  EXPECT_FALSE(holds(now - 3 * day, 2)) << "its authority was compromised";
  for (const int reason : {0, 3, 4, 5}) {
    EXPECT_TRUE(holds(now - 3 * day, reason)) << reason;
    EXPECT_FALSE(holds(now - 8 * day, reason)) << reason;
  }
}

TEST(TimeStamp, ATimeInTheFutureIsRefused) {
  const TimeServer server(issue(time_server_wish(), &root()), now + 7200);
  const auto key = open(issue({}, &root()), root());
  const std::string reserved = *pdf::reserve(small_pdf(), {}, now);
  EXPECT_FALSE(key.sign(reserved, now, server.stamping(pem(root())))) << "signed with it";
  const auto later = key.sign(reserved, now + 7200, server.stamping(pem(root())));
  ASSERT_TRUE(later) << later.error().message;
  auto verifier = trusting();
  EXPECT_EQ(state_of(sign::verify_pdf(later->bytes, verifier), "signature.time"),
            Check::State::fails);
  verifier.now = now + 7200 - 30;  // clocks differ a little
  EXPECT_TRUE(sign::verify_pdf(later->bytes, verifier).holds());
}

/// What a stranger sends is not read: the first line that says no is that of the signature, and
/// nothing is looked at behind it.
TEST(Verify, ReadsNothingWithoutATrustedSignature) {
  const std::string good = signed_by(issue({}, &root()));
  auto verifier = trusting("CN=Somebody Else");
  const auto verified = sign::verify_pdf(good, verifier);
  EXPECT_FALSE(verified.holds());
  EXPECT_TRUE(verified.attachments.empty());
  EXPECT_EQ(state_of(verified, "file.structure"), Check::State::not_checked);
  EXPECT_EQ(state_of(verified, "attachments"), Check::State::not_checked);
}

constexpr const char* document =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<r xmlns=\"urn:x\"><v "
    "u=\"\\micro\\metre\">4.5</v></r>\n";

TEST_P(EachKey, SignsXmlThatVerifies) {
  Wish wish;
  wish.key = GetParam();
  const auto done = open(issue(wish, &root()), root()).sign(document, now);
  ASSERT_TRUE(done) << done.error().message;
  auto verified = sign::verify_xml(done->bytes, trusting());
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  std::string changed = done->bytes;
  changed.replace(changed.find("4.5"), 3, "4.6");
  verified = sign::verify_xml(changed, trusting());
  EXPECT_EQ(state_of(verified, "xml.content"), Check::State::fails);
}

TEST(Xml, WithATimeStampOutlivesItsCertificate) {
  const TimeServer server(issue(time_server_wish(), &root()), now - 5 * day);
  const auto key = open(issue({}, &root()), root());
  const auto done = key.sign(document, now, server.stamping(pem(root())));
  ASSERT_TRUE(done) << done.error().message;
  auto verifier = trusting();
  auto verified = sign::verify_xml(done->bytes, verifier);
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_EQ(state_of(verified, "xml.time"), Check::State::holds);
  EXPECT_EQ(verified.at, now - 5 * day);
  verifier.now = now + 2000 * day;
  EXPECT_TRUE(sign::verify_xml(done->bytes, verifier).holds());
  EXPECT_FALSE(sign::verify_xml(key.sign(document, now)->bytes, verifier).holds());
  // The stamp of another document.
  const auto other = key.sign(std::string(document), now, server.stamping(pem(root())));
  const auto stamp = [](const std::string& xml) {
    const auto from = xml.find("<xades:EncapsulatedTimeStamp>"), to = xml.find("</xades:Enc");
    return std::pair(from, to - from);
  };
  std::string moved = done->bytes;
  const auto [from, size] = stamp(moved);
  const auto [other_from, other_size] = stamp(other->bytes);
  moved.replace(from, size, other->bytes.substr(other_from, other_size));
  ASSERT_NE(moved, done->bytes);
  EXPECT_EQ(state_of(sign::verify_xml(moved, trusting()), "xml.time"), Check::State::fails);
}

TEST(Xml, IsWrittenInItsCanonicalForm) {
  const auto key = open(issue({}, &root()), root());
  const std::string tidy =
      key.sign("<?xml version=\"1.0\"?><r><a></a>\n<b x=\"1\" y=\"2\"></b></r>", now)->bytes;
  const std::string loose =
      key.sign("<?xml version='1.0'?>\n<r ><a/>\n<b y='2'  x='1'/></r>\n", now)->bytes;
  const auto content = [](const std::string& xml) { return xml.substr(0, xml.find("<Signature")); };
  EXPECT_EQ(content(tidy), content(loose));
  EXPECT_TRUE(sign::verify_xml(loose, trusting()).holds());
  EXPECT_TRUE(sign::same_document(loose, "<?xml version=\"1.0\"?><r><a/>\n<b x='1' y='2'/></r>"));
  EXPECT_FALSE(sign::same_document(loose, "<?xml version=\"1.0\"?><r><a/>\n<b x='1' y='3'/></r>"));
  for (const char* with : {"<r><!-- x --></r>", "<r><?x y?></r>", "<r><![CDATA[x]]></r>",
                           "<!-- x --><r></r>", "<!DOCTYPE r><r></r>"})
    EXPECT_FALSE(key.sign(std::string("<?xml version=\"1.0\"?>") + with, now)) << with;
}

TEST(Xml, OnlyOfTheWholeDocumentAndWithoutTricks) {
  const auto key = open(issue({}, &root()), root());
  const std::string good = key.sign(document, now)->bytes;
  const auto fails = [&](std::string bytes) {
    return !sign::verify_xml(bytes, trusting()).holds();
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    EXPECT_NE(bytes.find(from), std::string::npos) << from;
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  EXPECT_FALSE(fails(good));
  EXPECT_TRUE(fails(document));
  EXPECT_TRUE(fails(with("URI=\"\"", "URI=\"#x\"")));
  EXPECT_TRUE(fails(with("<r xmlns", "<!DOCTYPE r [<!ENTITY a \"b\">]><r xmlns")));
  EXPECT_TRUE(fails(with("</r>", "<w/></r>")));
  EXPECT_TRUE(fails(with("<v u", " <v u")));
  EXPECT_TRUE(
      fails("<?xml version=\"1.0\"?><evil>" + good.substr(good.find('\n') + 1) + "</evil>"));
  EXPECT_TRUE(fails(good.substr(0, good.size() / 2)));
  EXPECT_FALSE(key.sign(good, now)) << "signed twice";
  EXPECT_FALSE(sign::verify_xml(good, trusting(), "other certificate").holds());
}

}  // namespace
}  // namespace nonio::sign_tests::sign_test
