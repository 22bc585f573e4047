// SPDX-License-Identifier: Apache-2.0
// What a certificate proves when the keys and time servers of its time have run out.
#include <gtest/gtest.h>

#include "authority.h"
#include "nonio/sign/prolong.h"
#include "nonio/sign/verify.h"
#include "time_server.h"

namespace nonio::sign_tests::long_term_test {
namespace {

using sign::Check;

/// One authority; Ada's key and the time server's run out 300 days from now.
class LongTerm : public testing::Test {
 protected:
  static constexpr sign::Time long_after = now + 2000 * day;

  Holder root = authority();
  Holder ada = issue({}, &root);
  Holder time = issue(time_server_wish(), &root);

  Holder later_time(sign::Time to) {
    Wish wish = time_server_wish();
    wish.name = "Later Time";
    wish.to = to;
    return issue(wish, &root);
  }
  sign::Verifier verifier(sign::Time at, const std::string& lists = "") const {
    sign::Verifier v;
    v.signer_roots = v.time_stamp_roots = pem(root);
    v.signers = {{"CN=Ada Bianchi,O=Laboratorio di Prova"}};
    v.now = at;
    if (!lists.empty()) v.revocation = lists;
    return v;
  }
  std::string list(sign::Time made, const Holder* revoked = nullptr, sign::Time when = 0,
                   int reason = -1) const {
    ListWish wish;
    wish.made = made;
    wish.next = made + 30 * day;
    wish.when = when;
    wish.reason = reason;
    return revocation_list(root, revoked, wish);
  }
  std::string issued(bool is_stamped = true) {
    const TimeServer server(time, now);
    const auto done = open(ada, root).sign(
        *pdf::reserve(small_pdf(), {{"x.csv", "1,2\n", "text/csv", "Source", "readings"}}, now),
        now, is_stamped ? server.stamping(pem(root)) : sign::TimeStamping{});
    EXPECT_TRUE(done) << done.error().message;
    return done->bytes;
  }
  sign::Prolonging how(sign::Time at, const std::string& lists) const {
    sign::Prolonging out;
    out.verifier = verifier(at, lists);
    out.fetch = false;
    return out;
  }
  Expected<sign::Prolonged> prolong(const std::string& bytes, sign::Time at,
                                    const std::string& lists, const Holder& by) const {
    const TimeServer server(by, at);
    sign::Prolonging wanted = how(at, lists);
    wanted.stamping = server.stamping(pem(root));
    return sign::prolong(bytes, wanted);
  }
  std::string prolonged(const std::string& bytes, sign::Time at, const std::string& lists,
                        const Holder& by) const {
    const auto done = prolong(bytes, at, lists, by);
    EXPECT_TRUE(done) << done.error().message;
    return done ? done->bytes : "";
  }
};

Check check_of(const sign::Verified& v, const std::string& id) {
  for (const Check& c : v.checks)
    if (c.id == id) return c;
  return {id, Check::State::not_checked, "no such check"};
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

TEST_F(LongTerm, KeepsWhatWasIssued) {
  const std::string before = issued();
  const std::string after = prolonged(before, now + 2 * day, list(now + day), time);
  ASSERT_TRUE(after.starts_with(before));
  const auto verified = sign::verify_pdf(after, verifier(now + 3 * day));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_EQ(verified.issued, before.size());
  EXPECT_EQ(verified.at, now);
  EXPECT_EQ(verified.existed, now + 2 * day);
  ASSERT_EQ(verified.attachments.size(), 1U);
  EXPECT_EQ(check_of(verified, "certificate.revocation").state, Check::State::holds);
}

/// Without revocation data of the time a list says nothing of a certificate that has run out: it
/// need not name it any more (RFC 5280, 3.3).
TEST_F(LongTerm, HoldsWhenTheKeysHaveRunOut) {
  const std::string before = issued();
  const std::string today = list(long_after - day);
  const auto alone = sign::verify_pdf(before, verifier(long_after, today));
  EXPECT_FALSE(alone.holds());
  EXPECT_NE(check_of(alone, "certificate.revocation").says.find("need not name it"),
            std::string::npos)
      << all_of(alone);
  // A list that was kept from that time does as well.
  const auto kept = sign::verify_pdf(before, verifier(long_after, today + list(now + day)));
  EXPECT_TRUE(kept.holds()) << all_of(kept);
  const std::string after = prolonged(before, now + 2 * day, list(now + day), time);
  for (const std::string& lists : {std::string(), today}) {
    const auto verified = sign::verify_pdf(after, verifier(long_after, lists));
    EXPECT_TRUE(verified.holds()) << all_of(verified);
    EXPECT_EQ(check_of(verified, "certificate.revocation").state, Check::State::holds);
  }
}

TEST_F(LongTerm, ATimeStampOfTheDocumentProvesTheTimeOfASignatureThatHasNone) {
  const std::string before = issued(false);
  EXPECT_FALSE(sign::verify_pdf(before, verifier(long_after)).holds());
  const std::string after = prolonged(before, now + 2 * day, list(now + day), time);
  const auto verified = sign::verify_pdf(after, verifier(long_after));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_EQ(verified.at, now + 2 * day);
  // But not when it came too late.
  const Holder later = later_time(now + 900 * day);
  EXPECT_FALSE(prolong(before, now + 400 * day, list(now + 399 * day), later));
}

TEST_F(LongTerm, RevocationDataAloneAreAnUpdateToo) {
  const std::string before = issued();
  const auto data = sign::prolong(before, how(now + 2 * day, list(now + day)));
  ASSERT_TRUE(data) << data.error().message;
  auto verified = sign::verify_pdf(data->bytes, verifier(long_after));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_EQ(verified.existed, 0);
  const auto again = sign::prolong(data->bytes, how(now + 2 * day, list(now + day)));
  EXPECT_FALSE(again) << "nothing new";
  const std::string stamped = prolonged(data->bytes, now + 3 * day, "", time);
  verified = sign::verify_pdf(stamped, verifier(long_after));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
}

/// Old lists that come into the file later prove nothing, or whoever stole a key could choose one.
TEST_F(LongTerm, ListsFromBeforeTheSignatureOnlyWhileTheyAreOfUse) {
  const std::string before = issued();
  const std::string old = list(now - 5 * day);  // until 25 days from now
  EXPECT_TRUE(prolong(before, now + 20 * day, old, time));
  const auto late = prolong(before, now + 26 * day, old, time);
  ASSERT_FALSE(late);
  EXPECT_NE(late.error().message.find("was good until"), std::string::npos) << late.error().message;
  const auto data = sign::prolong(before, how(now + 20 * day, old));
  ASSERT_TRUE(data) << data.error().message;
  EXPECT_TRUE(sign::verify_pdf(data->bytes, verifier(now + 21 * day)).holds());
  // There is no proof that the list was added while it was valid.
  const auto verified = sign::verify_pdf(data->bytes, verifier(now + 26 * day));
  EXPECT_EQ(check_of(verified, "updates.needed").state, Check::State::fails) << all_of(verified);
}

/// Whoever has the key of an authority of long ago can make lists of that time.
TEST_F(LongTerm, ListsCountOnlyIfTheyAreOlderThanTheEndOfTheirAuthority) {
  const sign::Time root_has_run_out = now + 3100 * day;
  const std::string before = issued(), good = list(now + day);
  const auto data = sign::prolong(before, how(now + 2 * day, good));
  ASSERT_TRUE(data) << data.error().message;
  EXPECT_TRUE(sign::verify_pdf(data->bytes, verifier(long_after)).holds());
  EXPECT_FALSE(sign::verify_pdf(data->bytes, verifier(root_has_run_out)).holds());
  EXPECT_FALSE(sign::verify_pdf(before, verifier(root_has_run_out, good)).holds());
  const auto verified =
      sign::verify_pdf(prolonged(before, now + 2 * day, good, time), verifier(root_has_run_out));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
}

TEST_F(LongTerm, ARevokedKeyIsNotProlonged) {
  const std::string before = issued();
  const auto done = prolong(before, now + 2 * day, list(now + day, &ada, now - day), time);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("was revoked"), std::string::npos) << done.error().message;
  // What was signed before stays good.
  const std::string after =
      prolonged(before, now + 6 * day, list(now + 5 * day, &ada, now + 4 * day), time);
  EXPECT_TRUE(sign::verify_pdf(after, verifier(long_after)).holds());
  // A signature without a time stamp of its own that the document's came after.
  EXPECT_FALSE(
      prolong(issued(false), now + 6 * day, list(now + 5 * day, &ada, now + 4 * day), time));
}

TEST_F(LongTerm, NothingIsWrittenWithoutTheStateOfAKeysRevocation) {
  const auto done = prolong(issued(), now + 2 * day, "", time);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("nothing states whether"), std::string::npos);
  const Holder other = authority("Other Root");
  ListWish wish;
  EXPECT_FALSE(prolong(issued(), now + 2 * day, revocation_list(other, nullptr, wish), time));
}

/// RFC 3161, 4: what a server stamped is lost with its key, unless a later stamp covers it.
TEST_F(LongTerm, ALaterStampProtectsAnEarlierOne) {
  const std::string before = issued();
  const Holder later = later_time(now + 2500 * day);
  const std::string once = prolonged(before, now + 2 * day, list(now + day), time);
  const std::string twice = prolonged(once, now + 200 * day, list(now + 199 * day), later);
  ASSERT_TRUE(twice.starts_with(once));
  // The first server's key is stolen, before its certificate runs out.
  constexpr int key_compromise = 1;
  const auto stolen = [&](sign::Time when) {
    return list(now + 250 * day, &time, when, key_compromise);
  };
  const sign::Time then = now + 260 * day;
  EXPECT_FALSE(sign::verify_pdf(before, verifier(then, stolen(now + 240 * day))).holds());
  EXPECT_FALSE(sign::verify_pdf(once, verifier(then, stolen(now + 240 * day))).holds());
  auto verified = sign::verify_pdf(twice, verifier(then, stolen(now + 240 * day)));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_FALSE(sign::verify_pdf(twice, verifier(then, stolen(now + 190 * day))).holds());
  // Long after the first server's certificate has run out.
  verified = sign::verify_pdf(twice, verifier(long_after, list(long_after - day)));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  // And with the later one's key lost instead.
  EXPECT_FALSE(
      sign::verify_pdf(twice, verifier(then, list(now + 250 * day, &later, now + 210 * day, 1)))
          .holds());
}

TEST_F(LongTerm, AnswersByOcspServeAsLists) {
  const std::string before = issued();
  ListWish wish;
  wish.made = now + day;
  const TimeServer server(time, now + 2 * day);
  const auto with = [&](const std::vector<std::string>& answers) {
    sign::Prolonging wanted = how(now + 2 * day, "");
    wanted.stamping = server.stamping(pem(root));
    wanted.answers = answers;
    return sign::prolong(before, wanted);
  };
  const std::string of_time = ocsp_answer(root, time, wish), of_ada = ocsp_answer(root, ada, wish);
  const auto done = with({of_time, of_ada});
  ASSERT_TRUE(done) << done.error().message;
  const auto verified = sign::verify_pdf(done->bytes, verifier(long_after));
  EXPECT_TRUE(verified.holds()) << all_of(verified);
  EXPECT_NE(check_of(verified, "certificate.revocation").says.find("OCSP"), std::string::npos);
  EXPECT_FALSE(with({of_time})) << "no proof is for Ada";
  EXPECT_FALSE(with({of_time, ocsp_answer(authority(), ada, wish)})) << "of a namesake";
  std::string damaged = of_ada;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  EXPECT_FALSE(with({of_time, damaged}));
  wish.when = now - day;
  EXPECT_FALSE(with({of_time, ocsp_answer(root, ada, wish)})) << "revoked";
  wish.when = now + day / 2;
  EXPECT_TRUE(with({of_time, ocsp_answer(root, ada, wish)})) << "revoked later";
}

TEST_F(LongTerm, OnlyOfWhatHolds) {
  std::string forged = issued();
  forged[forged.find("E = 4.5")] = 'F';
  EXPECT_FALSE(prolong(forged, now + 2 * day, list(now + day), time));
  sign::Prolonging stranger = how(now + 2 * day, list(now + day));
  stranger.verifier.signers = {{"CN=Somebody Else"}};
  EXPECT_FALSE(sign::prolong(issued(), stranger));
  stranger = how(now + 2 * day, list(now + day));
  stranger.verifier.signer_roots = "";
  EXPECT_FALSE(sign::prolong(issued(), stranger));
}

/// The document's stamp must not be older than what it covers, nor of tomorrow.
TEST_F(LongTerm, TimesFollowEachOther) {
  const std::string once = prolonged(issued(), now + 2 * day, list(now + day), time);
  const TimeServer earlier(time, now + day);
  sign::Prolonging wanted = how(now + 5 * day, list(now + 4 * day));
  wanted.stamping = earlier.stamping(pem(root));
  EXPECT_FALSE(sign::prolong(once, wanted));
  EXPECT_FALSE(sign::verify_pdf(once, verifier(now + day)).holds()) << "yet to come";
}

}  // namespace
}  // namespace nonio::sign_tests::long_term_test
