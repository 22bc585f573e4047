// SPDX-License-Identifier: Apache-2.0
#include "nonio/sign/prolong.h"

#include <openssl/err.h>
#include <openssl/x509v3.h>

#include <set>

#include "http.h"
#include "nonio/pdf/signature_field.h"
#include "signed_data.h"
#include "verify_parts.h"
#include "verify_updates.h"

namespace nonio::sign {

namespace {

struct Used {
  std::vector<CertificatePtr> chain;
  Revocation revocation;
};

std::string text_of_uri(const GENERAL_NAME* name) {
  if (name->type != GEN_URI) return {};
  std::string url(bytes_of(name->d.uniformResourceIdentifier));
  return url.starts_with("http://") ? url : "";
}

/// Returns the addresses of OCSP responders (RFC 5280, 4.2.2.1) that begin with http://.
std::vector<std::string> responders_of(X509* certificate) {
  std::vector<std::string> out;
  const std::unique_ptr<AUTHORITY_INFO_ACCESS, Freed<AUTHORITY_INFO_ACCESS_free>> all(
      static_cast<AUTHORITY_INFO_ACCESS*>(
          X509_get_ext_d2i(certificate, NID_info_access, nullptr, nullptr)));
  for (int i = 0; all && i < sk_ACCESS_DESCRIPTION_num(all.get()); ++i) {
    const ACCESS_DESCRIPTION* one = sk_ACCESS_DESCRIPTION_value(all.get(), i);
    if (OBJ_obj2nid(one->method) != NID_ad_OCSP) continue;
    if (auto url = text_of_uri(one->location); !url.empty()) out.push_back(std::move(url));
  }
  return out;
}

/// Returns the addresses of revocation lists (RFC 5280, 4.2.1.13) that begin with http://.
std::vector<std::string> places_of_lists(X509* certificate) {
  std::vector<std::string> out;
  const std::unique_ptr<CRL_DIST_POINTS, Freed<CRL_DIST_POINTS_free>> all(
      static_cast<CRL_DIST_POINTS*>(
          X509_get_ext_d2i(certificate, NID_crl_distribution_points, nullptr, nullptr)));
  for (int i = 0; all && i < sk_DIST_POINT_num(all.get()); ++i) {
    const DIST_POINT* one = sk_DIST_POINT_value(all.get(), i);
    if (one->distpoint == nullptr || one->distpoint->type != 0) continue;
    const GENERAL_NAMES* names = one->distpoint->name.fullname;
    for (int k = 0; k < sk_GENERAL_NAME_num(names); ++k)
      if (auto url = text_of_uri(sk_GENERAL_NAME_value(names, k)); !url.empty())
        out.push_back(std::move(url));
  }
  return out;
}

std::string question_about(X509* certificate, X509* issuer) {
  const std::unique_ptr<OCSP_REQUEST, Freed<OCSP_REQUEST_free>> request(OCSP_REQUEST_new());
  // SHA-1 only identifies the certificate and protects nothing; every responder supports it (RFC
  // 6960, 4.3).
  OCSP_CERTID* id = OCSP_cert_to_id(EVP_sha1(), certificate, issuer);
  if (!request || id == nullptr) return {};
  if (OCSP_request_add0_id(request.get(), id) == nullptr) {
    OCSP_CERTID_free(id);
    return {};
  }
  return der_of(request.get(), &i2d_OCSP_REQUEST);
}

constexpr std::size_t longest_answer = 100'000, longest_list = 9'000'000;

class Prolongation {
 public:
  Prolongation(std::string_view bytes, const Prolonging& how)
      : bytes_(bytes), how_(how), ends_(pdf::ends_of_parts(bytes)) {}

  Expected<Prolonged> run() {
    if (auto sound = check(bytes_, "is not prolonged"); !sound) return fail(sound.error());
    file_ = pdf::parse(bytes_.substr(0, ends_.front()));
    if (!file_) return fail(file_.error());
    NONIO_TRY(auto updater, pdf::Updater::of(*file_));
    NONIO_TRY(auto added, read_updates(bytes_, ends_, updater));
    if (auto known = read_known(); !known) return fail(known.error());
    if (auto used = read_chains(added); !used) return fail(used.error());
    for (const std::string& der : added.certificates) there_.insert(der);
    for (const Used& used : used_)
      if (auto done = collect(used); !done) return fail(done.error());
    auto update = updater.write(store_, !how_.stamping.url.empty());
    if (!update)
      return fail("gets nothing new: revocation data are in it, and no time stamp is asked for");
    return finish(*update);
  }

 private:
  Expected<void> check(std::string_view bytes, const char* what) const {
    const Verified verified = verify_pdf(bytes, how_.verifier);
    for (const Check& c : verified.checks)
      if (c.state == Check::State::fails || (c.state == Check::State::not_checked && c.essential))
        return fail(std::string(what) + ": " + c.id + ": " + c.says);
    return {};
  }

  Expected<void> read_known() {
    NONIO_TRY(auto known, trusted(how_.verifier));
    known_ = std::move(known);
    for (const std::string& der : how_.answers) {
      auto answer = Statement::of_answer(der);
      if (!answer) return fail("what was given holds " + answer.error().message);
      at_hand_.push_back(std::move(*answer));
    }
    for (const RevocationPtr& list : known_.lists) {
      NONIO_TRY(auto statement, Statement::of_list(der_of(list.get(), &i2d_X509_CRL)));
      at_hand_.push_back(std::move(statement));
    }
    for (Statement& s : at_hand_) s.seen = how_.verifier.now;
    return {};
  }

  Expected<void> read_chains(Added& added) {
    const Time now = how_.verifier.now;
    NONIO_TRY(auto stamps, check_document_stamps(added, known_, now));
    const Time existed = stamps.empty() ? 0 : stamps.front().time;
    const auto until = [&](std::size_t next) {
      return next < stamps.size() ? stamps[next].time : std::numeric_limits<Time>::max();
    };
    const auto place = pdf::signature_at_end(file_->bytes);
    NONIO_TRY(const auto der, place ? der_in(place->contents) : fail("has no signature"));
    NONIO_TRY(const auto data, SignedData::parse(der, SignedData::Content::detached));
    Time at = existed == 0 ? now : existed;
    if (!data.time_stamp().empty()) {
      auto stamp =
          check_time_stamp(data.time_stamp(), sha256(data.signature()), known_, now, until(0));
      if (!stamp) return fail(stamp.error());
      at = stamp->time;
      used_.push_back({std::move(stamp->chain), {at, now, Revocation::Of::time_server, until(0)}});
    }
    NONIO_TRY(auto chain,
              chain_of(data.certificate(), data.certificates(), known_.signer_roots, at));
    used_.push_back({std::move(chain), {at, now, Revocation::Of::signer}});
    for (std::size_t i = 0; i < stamps.size(); ++i)
      used_.push_back({std::move(stamps[i].chain),
                       {stamps[i].time, now, Revocation::Of::time_server, until(i + 1)}});
    return {};
  }

  Expected<void> collect(const Used& used) {
    for (std::size_t i = 0; i + 1 < used.chain.size(); ++i) {
      X509* one = used.chain[i].get();
      const std::string der = der_of(one);
      if (there_.insert(der).second) {
        store_.certificates.push_back(der);
        added_.push_back("certificate of " + subject_of(one));
      }
      if (auto done = find_statement(one, used.chain[i + 1].get(), used.revocation); !done)
        return done;
    }
    return {};
  }

  Expected<bool> is_in(const std::vector<Statement>& statements, X509* one, X509* issuer,
                       const Revocation& revocation, bool take) {
    for (const Statement& s : statements) {
      NONIO_TRY(const auto good, vouches(s, one, issuer, revocation));
      if (!good) continue;
      if (take) keep(s);
      return true;
    }
    return false;
  }

  void keep(const Statement& s) {
    if (!there_.insert(s.der).second) return;
    (s.answer ? store_.answers : store_.lists).push_back(s.der);
    const std::string made =
        s.answer ? "" : " of " + text_of(time_of(X509_CRL_get0_lastUpdate(s.list.get())));
    added_.push_back((s.answer ? "answer (OCSP)" : "revocation list") + made);
  }

  Expected<void> find_statement(X509* one, X509* issuer, const Revocation& revocation) {
    for (const auto& [statements, take] :
         {std::pair(&known_.kept, false), std::pair(&at_hand_, true)}) {
      NONIO_TRY(const auto found, is_in(*statements, one, issuer, revocation, take));
      if (found) return {};
    }
    std::string why;
    if (how_.fetch) {
      NONIO_TRY(const auto found, ask(one, issuer, revocation, why));
      if (found) return {};
      if (why.empty()) why = "its certificate names no address that begins with http://";
    } else {
      why = "no server may be asked (--no-fetch)";
    }
    return fail("nothing states whether the certificate of " + quoted(subject_of(one)) +
                " was revoked: no list or answer that was given does, and " + why);
  }

  Expected<bool> ask(X509* one, X509* issuer, const Revocation& revocation, std::string& why) {
    const auto take = [&](const std::string& url, Expected<std::string> bytes,
                          Expected<Statement> (*read)(std::string_view)) -> Expected<bool> {
      auto statement = bytes ? read(*bytes) : fail(bytes.error());
      if (!statement) {
        why += (why.empty() ? "" : "; ") + (bytes ? url + ": " : "") + statement.error().message;
        return false;
      }
      statement->seen = how_.verifier.now;
      const auto good = vouches(*statement, one, issuer, revocation);
      if (!good) return fail(url + ": " + good.error().message);
      if (*good) keep(*statement);
      if (!*good)
        why += (why.empty() ? "" : "; ") + url + " is empty about it that is of use at the time";
      at_hand_.push_back(std::move(*statement));
      return *good;
    };
    for (const std::string& url : responders_of(one)) {
      const auto done = take(url,
                             ask_server(url, {.query = "application/ocsp-request",
                                              .reply = "application/ocsp-response",
                                              .body = question_about(one, issuer),
                                              .longest = longest_answer,
                                              .seconds = how_.seconds}),
                             &Statement::of_answer);
      if (!done || *done) return done;
    }
    for (const std::string& url : places_of_lists(one)) {
      const auto done =
          take(url, ask_server(url, {.longest = longest_list, .seconds = how_.seconds}),
               &Statement::of_list);
      if (!done || *done) return done;
    }
    return false;
  }

  Expected<Prolonged> finish(pdf::Update& update) {
    Prolonged out;
    out.bytes = std::string(bytes_) + update.bytes;
    if (out.bytes.size() > pdf::max_file ||
        out.bytes.size() - ends_.front() > pdf::most_update_bytes ||
        ends_.size() > pdf::most_updates)
      return fail("would become too large, or get more than " + std::to_string(pdf::most_updates) +
                  " updates");
    if (update.has_stamp) {
      const std::string_view all = out.bytes;
      const auto token = ask_for_time_stamp(
          how_.stamping, sha256(all.substr(0, update.gap), all.substr(update.after)),
          how_.verifier.now);
      if (!token) return fail("no time stamp: " + token.error().message);
      if (token->size() > pdf::usual_room)
        return fail("the time stamp has " + std::to_string(token->size()) +
                    " bytes and does not fit into " + std::to_string(pdf::usual_room));
      out.bytes.replace(update.gap + 1, 2 * token->size(), hex(*token));
      added_.push_back("time stamp of " + how_.stamping.url);
    }
    if (auto sound = check(out.bytes, "would not be accepted"); !sound) return fail(sound.error());
    out.added = std::move(added_);
    return out;
  }

  std::string_view bytes_;
  const Prolonging& how_;
  std::vector<std::size_t> ends_;
  Expected<pdf::File> file_;
  Trusted known_;
  std::vector<Statement> at_hand_;
  std::vector<Used> used_;
  std::set<std::string> there_;  ///< DER objects that the file contains or will contain
  pdf::Store store_;
  std::vector<std::string> added_;
};

}  // namespace

Expected<Prolonged> prolong(std::string_view signed_pdf, const Prolonging& how) {
  return Prolongation(signed_pdf, how).run();
}

}  // namespace nonio::sign
