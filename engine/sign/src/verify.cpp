// SPDX-License-Identifier: Apache-2.0
#include "nonio/sign/verify.h"

#include <algorithm>

#include "key.h"
#include "nonio/pdf/signature_field.h"
#include "signed_data.h"
#include "time_stamp.h"
#include "verify_parts.h"
#include "verify_updates.h"

namespace nonio::sign {

using State = Check::State;

bool Verified::holds() const {
  return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const Check& c) {
    return c.state == State::holds || (c.state == State::not_checked && !c.essential);
  });
}

void Report::add(const char* id, const Expected<void>& result, const std::string& well) {
  out_.checks.push_back(
      {id, result ? State::holds : State::fails, result ? well : result.error().message});
}

void Report::skip(const char* id, const std::string& why, bool essential) {
  out_.checks.push_back({id, State::not_checked, why, essential});
}

namespace {

/// Whether `who` is the subject, or the SHA-256 in hexadecimal digits with or without colons.
bool is_of(std::string who, const std::string& subject, const std::string& fingerprint) {
  if (who == subject) return true;
  std::erase(who, ':');
  std::transform(who.begin(), who.end(), who.begin(), [](char c) {
    return c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return who == fingerprint;
}

std::string words_of(const ExpectedSigner& one) {
  return one.who + (one.from == 0 ? "" : " from " + text_of(one.from)) +
         (one.before ? " before " + text_of(*one.before) : "");
}

}  // namespace

void Report::check_signer(X509* certificate, const Verifier& verifier) {
  const std::string subject = subject_of(certificate), shown = quoted(subject);
  const std::string fingerprint = hex(sha256(der_of(certificate)));
  out_.subject = subject;
  if (!verifier.issued_by.empty())
    return add("signer.expected", {},
               "signed by " + shown + ", certificate " + fingerprint + "; " + verifier.issued_by);
  if (verifier.signers.empty())
    return skip("signer.expected", "signed by " + shown + ", certificate " + fingerprint +
                                       "; the expected signer was not stated");
  std::string wanted;
  for (const ExpectedSigner& one : verifier.signers) {
    if (is_of(one.who, subject, fingerprint) && out_.at >= one.from &&
        (!one.before || out_.at < *one.before))
      return add("signer.expected", {}, "signed by " + shown);
    wanted += (wanted.empty() ? "" : " or ") + words_of(one);
  }
  add("signer.expected",
      fail("signed by " + shown + ", certificate " + fingerprint + ", at " + text_of(out_.at) +
           "; expected " + wanted),
      {});
}

std::vector<CertificatePtr> Report::check_stamp(const char* id, std::string_view token,
                                                std::string_view stamped, const std::string& said,
                                                const Trusted& known, const Verifier& verifier,
                                                Time existed) {
  if (token.empty()) {
    if (existed == 0)
      skip(id, "no time stamp: the signer states " + said, false);
    else
      add(id, {}, "signed before " + text_of(existed) + ", states a time stamp of the document");
    if (existed != 0) out_.at = existed;
    return {};
  }
  auto stamp = check_time_stamp(token, sha256(stamped), known, verifier.now,
                                existed == 0 ? std::numeric_limits<Time>::max() : existed);
  if (stamp && existed != 0 && stamp->time > existed + clock_tolerance)
    stamp = fail("is of " + text_of(stamp->time) + ", later than one that covers it");
  if (!stamp) {
    add(id, fail("the time stamp " + stamp.error().message), {});
    return {};
  }
  out_.at = stamp->time;
  add(id, {}, "signed before " + text_of(stamp->time) + ", states " + quoted(stamp->by));
  return std::move(stamp->chain);
}

std::vector<CertificatePtr> Report::check_chain(X509* certificate,
                                                const std::vector<CertificatePtr>& others,
                                                const Trusted& known, const Verifier& verifier) {
  add("certificate.use", check_signer_use(certificate),
      "the certificate is for signatures on documents");
  if (known.signer_roots.empty()) {
    skip("certificate.chain", "no trusted certificates were given");
    skip("certificate.revocation", "needs the chain", false);
    return {};
  }
  auto chain = chain_of(certificate, others, known.signer_roots, out_.at);
  if (!chain) {
    add("certificate.chain",
        fail("not trusted at " + text_of(out_.at) + ": " + chain.error().message), {});
    skip("certificate.revocation", "needs the chain", false);
    return {};
  }
  add("certificate.chain", check_only(others, *chain),
      "leads to " + quoted(subject_of(chain->back().get())) + ", valid at " + text_of(out_.at));
  if (known.lists.empty() && known.kept.empty()) {
    skip("certificate.revocation", "no revocation list was given", false);
    return std::move(*chain);
  }
  bool looked = false;
  const auto revocation =
      check_revocation(*chain, known, {out_.at, verifier.now, Revocation::Of::signer}, looked);
  // Statements about other certificates do not check the signer's certificate.
  if (revocation && !looked)
    skip("certificate.revocation", *revocation, !known.lists.empty());
  else
    add("certificate.revocation", to_void(revocation), revocation ? *revocation : "");
  return std::move(*chain);
}

namespace {

/// Parses the content only if no essential check of the signature has failed or was omitted.
class PdfCheck {
 public:
  PdfCheck(std::string_view bytes, const Verifier& verifier)
      : bytes_(bytes), verifier_(verifier), report_(out_) {
    out_.at = verifier.now;
  }

  Verified run() {
    if (bytes_.size() > pdf::max_file || !bytes_.starts_with("%PDF-")) {
      report_.add(
          "file.structure",
          fail(bytes_.size() > pdf::max_file ? too_large : "is neither a PDF nor an XML document"),
          {});
      return std::move(out_);
    }
    ends_ = pdf::ends_of_parts(bytes_);
    signed_ = bytes_.substr(0, ends_.front());
    out_.issued = signed_.size();
    const auto place = pdf::signature_at_end(signed_);
    report_.add("signature.range", to_void(place),
                ends_.size() == 1 ? "covers the entire file except itself"
                                  : "covers the entire file as it was signed except itself");
    if (place) check_cms(*place);
    if (out_.holds()) return read(*place);
    for (const char* id : {"file.structure", "signature.one", "attachments"})
      report_.skip(id, "no trusted signer signed it");
    return std::move(out_);
  }

 private:
  const Expected<pdf::File>& file() {
    if (!file_) file_ = pdf::parse(signed_);
    return *file_;
  }

  Verified read(const pdf::PdfSignature& found) {
    report_.add("file.structure", to_void(file()),
                "a PDF of one revision, every byte of it accounted for");
    if (!file()) return std::move(out_);
    report_.add("signature.one", check_only(*file(), found),
                "one signature, " + std::string(pdf::sub_filter));
    read_attachments(*file());
    return std::move(out_);
  }

  /// Checks that the signature that a PDF reader finds is the one that was checked.
  static Expected<void> check_only(const pdf::File& file, const pdf::PdfSignature& found) {
    NONIO_TRY(const auto dictionary, pdf::find_signature(file));
    NONIO_TRY(const auto place, pdf::signature_of(file, *dictionary));
    if (place.gap != found.gap || place.contents.size() != found.contents.size() ||
        place.time != found.time)
      return fail("has another signature than the last one in the file");
    return {};
  }

  void check_cms(const pdf::PdfSignature& place) {
    const auto der = der_in(place.contents);
    report_.add("signature.padding", to_void(der), "only zeros after the signature");
    if (!der) return;
    auto data = SignedData::parse(*der, SignedData::Content::detached);
    if (data)
      if (auto expected = data->check_attributes(); !expected) data = fail(expected.error());
    report_.add(
        "signature.form", to_void(data),
        data ? *algorithm_of(X509_get0_pubkey(data->certificate()), true) + " over SHA-2" : "");
    if (!data) return;
    report_.add("signature.content", data->check_signature(place.before, place.after),
                "the content is as it was signed");
    report_.add("signature.certificate", data->check_certificate_named(),
                "the certificate is the one that was signed with");
    out_.certificate = data->certificate_der();
    auto known = trusted(verifier_);
    if (!known) {
      report_.add("certificate.chain", fail(known.error()), {});
      return;
    }
    check_people(place, *data, *known);
  }

  void check_people(const pdf::PdfSignature& place, const SignedData& data, Trusted& known) {
    std::vector<std::vector<CertificatePtr>> chains;
    std::optional<Added> added;
    if (ends_.size() > 1 && out_.holds() && !is_trusted(data, known)) {
      report_.skip("file.updates", "not read: no trusted signer signed what precedes them");
    } else if (ends_.size() > 1) {
      auto updates = check_updates(known, chains);
      report_.add("file.updates", to_void(updates),
                  updates ? words_of(*updates, chains.size()) : "");
      if (!updates) return;
      added = std::move(*updates);
    }
    chains.push_back(report_.check_stamp("signature.time", data.time_stamp(), data.signature(),
                                         text_of(place.time), known, verifier_, out_.existed));
    report_.check_signer(data.certificate(), verifier_);
    chains.push_back(
        report_.check_chain(data.certificate(), data.certificates(), known, verifier_));
    if (added)
      report_.add("updates.needed", check_needed(*added, known, chains),
                  "all of it is about these signatures");
  }

  bool is_trusted(const SignedData& data, const Trusted& known) const {
    X509* signer = data.certificate();
    const Time last = time_of(X509_get0_notAfter(signer)) - 1;
    return !known.signer_roots.empty() &&
           chain_of(signer, data.certificates(), known.signer_roots, std::min(verifier_.now, last));
  }

  /// The caller has checked that the signer is trusted, because anyone can append updates.
  Expected<Added> check_updates(Trusted& known, std::vector<std::vector<CertificatePtr>>& chains) {
    if (!out_.holds()) return fail("are not read: the signature does not hold");
    if (!file()) return fail(file().error());
    NONIO_TRY(auto updater, pdf::Updater::of(*file()));
    auto added = read_updates(bytes_, ends_, updater);
    if (!added) return fail(added.error());
    NONIO_TRY(auto stamps, check_document_stamps(*added, known, verifier_.now));
    if (!stamps.empty()) out_.existed = stamps.front().time;
    for (Stamp& stamp : stamps) {
      stamped_ += (stamped_.empty() ? "" : ", ") + text_of(stamp.time) + " by " + quoted(stamp.by);
      chains.push_back(std::move(stamp.chain));
    }
    return added;
  }

  std::string words_of(const Added& added, std::size_t stamps) const {
    const auto number = [](std::size_t n, const char* one, const char* more) {
      return std::to_string(n) + " " + (n == 1 ? one : more);
    };
    return number(ends_.size() - 1, "update", "updates") + ", nothing in them but " +
           number(added.covered.size(), "revocation list or answer",
                  "revocation lists and answers") +
           ", " + number(added.certificates.size(), "certificate", "certificates") + ", " +
           number(stamps, "time stamp", "time stamps") + (stamped_.empty() ? "" : ": " + stamped_);
  }

  void read_attachments(const pdf::File& file) {
    auto attachments = pdf::attachments_of(file);
    if (attachments) out_.attachments = std::move(*attachments);
    const std::size_t n = out_.attachments.size();
    report_.add("attachments", to_void(attachments),
                n == 0 ? "none" : std::to_string(n) + (n == 1 ? " file" : " files"));
  }

  std::string_view bytes_, signed_;
  const Verifier& verifier_;
  std::vector<std::size_t> ends_;
  std::optional<Expected<pdf::File>> file_;
  std::string stamped_;
  Verified out_;
  Report report_;
};

}  // namespace

Verified verify_pdf(std::string_view bytes, const Verifier& verifier) {
  return PdfCheck(bytes, verifier).run();
}

std::string_view issued_part(std::string_view file) {
  return file.starts_with("%PDF-") ? file.substr(0, pdf::ends_of_parts(file).front()) : file;
}

Expected<Identity> unverified_signer(std::string_view signed_pdf) {
  const auto place = pdf::signature_at_end(issued_part(signed_pdf));
  NONIO_TRY(const auto der, place ? der_in(place->contents) : fail(place.error()));
  NONIO_TRY(const auto data, SignedData::parse(der, SignedData::Content::detached));
  X509* certificate = data.certificate();
  return Identity{subject_of(certificate), hex(sha256(der_of(certificate))),
                  *algorithm_of(X509_get0_pubkey(certificate), true),
                  time_of(X509_get0_notBefore(certificate)),
                  time_of(X509_get0_notAfter(certificate))};
}

Expected<std::vector<pdf::Attachment>> unverified_attachments(std::string_view pdf) {
  NONIO_TRY(const auto file, pdf::parse(pdf));
  return pdf::attachments_of(file);
}

}  // namespace nonio::sign
