// SPDX-License-Identifier: Apache-2.0
#include "certificates/trust.h"

#include <chrono>
#include <cstdlib>
#include <ctime>

#include "campaign/config/site_files.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

constexpr sign::Time day = 86400;

/// `date`: YYYY-MM-DD, UTC.
sign::Time begin_of(const std::string& date) {
  namespace chrono = std::chrono;
  const auto number = [&](std::size_t from, std::size_t size) {
    return std::atoi(date.substr(from, size).c_str());
  };
  const chrono::sys_days begin = chrono::year(number(0, 4)) / static_cast<unsigned>(number(5, 2)) /
                                 static_cast<unsigned>(number(8, 2));
  return chrono::sys_seconds(begin).time_since_epoch().count();
}

std::vector<sign::ExpectedSigner> signers_of(const config::Signing& signing) {
  std::vector<sign::ExpectedSigner> signers;
  if (!signing.signer.empty()) signers.push_back({signing.signer});
  for (const config::SignerRule& rule : signing.signers) {
    sign::ExpectedSigner one{rule.who};
    if (!rule.from.empty()) one.from = begin_of(rule.from);
    if (!rule.until.empty()) one.before = begin_of(rule.until) + day;
    signers.push_back(std::move(one));
  }
  return signers;
}

/// An empty path gives an empty text; an empty file is an error, because it cannot be intended.
Expected<std::string> text_at(const fs::path& path) {
  if (path.empty()) return std::string();
  auto text = storage::read_file(path);
  if (text && text->empty())
    return fail(path.string() + " is empty; expected certificates in PEM form");
  return text;
}

/// A root that is trusted for time stamps must not be able to certify signers.
Expected<std::string> single_root(const fs::path& path) {
  auto text = text_at(path);
  if (!text) return text;
  const auto count = sign::number_of_roots(*text);
  if (!count) return fail(path.string() + " " + count.error().message);
  if (*count == 1) return text;
  return fail(path.string() + " holds " + std::to_string(*count) +
              " certificates, and with trust each of them would be accepted for signers and for "
              "time servers. Write the roots of signers into one file (--signer-roots; "
              "signer_roots in [signing] of site.toml) and those of time servers into another one "
              "(--time-stamp-roots; time_stamp_roots)");
}

Expected<sign::Verifier> read_trust(const VerifyOptions& o,
                                    std::vector<sign::ExpectedSigner> signers) {
  sign::Verifier verifier;
  auto signer_roots = text_at(o.signer_roots), time_roots = text_at(o.time_stamp_roots);
  for (const auto* text : {&signer_roots, &time_roots})
    if (!*text) return fail(text->error());
  verifier.signer_roots = std::move(*signer_roots);
  verifier.time_stamp_roots = std::move(*time_roots);
  if (!o.trust.empty()) {
    NONIO_TRY(auto both, single_root(o.trust));
    verifier.signer_roots = both;
    verifier.time_stamp_roots = std::move(both);
  }
  if (!o.revocation.empty()) {
    NONIO_TRY(auto lists, storage::read_file(o.revocation));
    verifier.revocation = std::move(lists);
  }
  verifier.signers = std::move(signers);
  verifier.now = std::time(nullptr);
  if (auto sound = sign::check_verifier(verifier); !sound) return fail(sound.error());
  return verifier;
}

}  // namespace

config::Checked<sign::Verifier> verifier_of(const VerifyOptions& options) {
  const auto refused = [](Error error) {
    return tl::unexpected(std::vector<Error>{std::move(error)});
  };
  VerifyOptions o = options;
  const bool given = !o.signer_roots.empty() || !o.time_stamp_roots.empty();
  if (given && !o.trust.empty())
    return refused(Error{"--trust excludes --signer-roots and --time-stamp-roots"});
  std::vector<sign::ExpectedSigner> signers;
  for (const std::string& one : o.signers) signers.push_back({one});
  if (!o.site.empty()) {
    std::string digest;
    const auto site = config::read_site(o.site, digest);
    if (!site) return tl::unexpected(site.error());
    if (const auto& s = site->signing) {
      const auto take = [&](fs::path& to, const std::string& name) {
        if (to.empty() && !name.empty()) to = o.site / name;
      };
      if (!given) take(o.trust, s->trust);
      if (o.trust.empty()) {
        take(o.signer_roots, s->signer_roots);
        take(o.time_stamp_roots, s->time_stamp_roots);
      }
      take(o.revocation, s->revocation);
      if (signers.empty()) signers = signers_of(*s);
    }
  }
  auto verifier = read_trust(o, std::move(signers));
  if (!verifier) return refused(verifier.error());
  return std::move(*verifier);
}

}  // namespace nonio::certificates
