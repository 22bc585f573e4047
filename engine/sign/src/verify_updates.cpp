// SPDX-License-Identifier: Apache-2.0
#include "verify_updates.h"

#include <algorithm>
#include <set>

#include "der.h"
#include "verify_parts.h"

namespace nonio::sign {

namespace {

/// Computes digests of several beginnings of a file in one pass over the file.
class FileDigest {
 public:
  explicit FileDigest(std::string_view bytes) : bytes_(bytes), context_(EVP_MD_CTX_new()) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }

  /// Returns the SHA-256 of the first `to` bytes of the file followed by `after`. `to` must not
  /// decrease from call to call.
  std::string of(std::size_t to, std::string_view after) {
    const std::string_view more = bytes_.substr(done_, to - done_);
    EVP_DigestUpdate(context_.get(), more.data(), more.size());
    done_ = to;
    const Context copy(EVP_MD_CTX_new());
    EVP_MD_CTX_copy_ex(copy.get(), context_.get());
    EVP_DigestUpdate(copy.get(), after.data(), after.size());
    std::string out(32, '\0');
    EVP_DigestFinal_ex(copy.get(), reinterpret_cast<unsigned char*>(out.data()), nullptr);
    return out;
  }

 private:
  using Context = std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>>;
  std::string_view bytes_;
  Context context_;
  std::size_t done_ = 0;
};

Expected<void> take_store(const pdf::Store& store, Added& added) {
  const auto take = [&](Expected<Statement> statement) -> Expected<void> {
    if (!statement) return fail(statement.error());
    added.statements.push_back(std::move(*statement));
    added.covered.push_back(added.stamps.size());
    return {};
  };
  for (const std::string& der : store.answers)
    if (auto done = take(Statement::of_answer(der)); !done) return done;
  for (const std::string& der : store.lists)
    if (auto done = take(Statement::of_list(der)); !done) return done;
  added.certificates.insert(added.certificates.end(), store.certificates.begin(),
                            store.certificates.end());
  return {};
}

}  // namespace

Expected<std::string> der_in(std::string_view digits) {
  if (digits.find_first_not_of("0123456789abcdef") != std::string_view::npos)
    return fail("holds something else than digits and small letters a to f");
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  std::string contents;
  contents.reserve(digits.size() / 2);
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    contents += static_cast<char>(digit(digits[i]) * 16 + digit(digits[i + 1]));
  std::string_view rest = contents;
  const auto der = Der::take(rest);
  if (!der) return fail("holds no signature");
  if (rest.find_first_not_of('\0') != std::string_view::npos)
    return fail("contains data after the signature");
  return std::string(der->whole);
}

Expected<Added> read_updates(std::string_view bytes, const std::vector<std::size_t>& ends,
                             pdf::Updater& updater) {
  Added added;
  FileDigest digest(bytes);
  for (std::size_t i = 1; i < ends.size(); ++i) {
    NONIO_TRY(const auto update, updater.read(bytes, ends[i]));
    if (auto done = take_store(update.store, added); !done)
      return fail("an update holds " + done.error().message);
    if (!update.has_stamp) continue;
    auto token = der_in(bytes.substr(update.gap + 1, update.after - update.gap - 2));
    if (!token) return fail("a time stamp of the document " + token.error().message);
    added.stamps.push_back(
        {std::move(*token),
         digest.of(update.gap, bytes.substr(update.after, ends[i] - update.after))});
  }
  return added;
}

Expected<std::vector<Stamp>> check_document_stamps(Added& added, Trusted& known, Time now) {
  const auto take_covered_by = [&](std::size_t stamp, Time seen) {
    for (std::size_t i = 0; i < added.statements.size(); ++i) {
      if (added.covered[i] != stamp) continue;
      added.statements[i].seen = seen;
      known.kept.push_back(std::move(added.statements[i]));
    }
  };
  std::vector<Stamp> stamps;
  Time until = std::numeric_limits<Time>::max();
  take_covered_by(added.stamps.size(), now);
  for (std::size_t i = added.stamps.size(); i-- > 0;) {
    auto stamp =
        check_time_stamp(added.stamps[i].token, added.stamps[i].imprint, known, now, until);
    const std::string which = "time stamp " + std::to_string(i + 1) + " of the document ";
    if (!stamp) return fail(which + stamp.error().message);
    if (!stamps.empty() && stamp->time > until + clock_tolerance)
      return fail(which + "is of " + text_of(stamp->time) + ", later than the one that follows it");
    until = stamp->time;
    take_covered_by(i, until);
    stamps.push_back(std::move(*stamp));
  }
  std::reverse(stamps.begin(), stamps.end());
  return stamps;
}

Expected<void> check_needed(const Added& added, const Trusted& known,
                            const std::vector<std::vector<CertificatePtr>>& chains) {
  std::set<std::string> in_chains, found;
  // The last certificate of a chain is the root, which no update contains.
  for (const auto& chain : chains)
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) in_chains.insert(der_of(chain[i].get()));
  for (const std::string& der : added.certificates)
    if (!in_chains.contains(der) || !found.insert(der).second)
      return fail("an update holds a certificate that nothing in the file needs, or twice");
  for (const Statement& s : known.kept)
    if (!s.used || !found.insert(s.der).second)
      return fail(std::string("an update holds ") +
                  (s.answer ? "an answer (OCSP)" : "a revocation list") +
                  " that proves nothing for this file (of another authority, about other "
                  "certificates, or not valid at the time), or is present twice");
  return {};
}

}  // namespace nonio::sign
