// SPDX-License-Identifier: Apache-2.0
#include "nonio/sign/verify.h"

#include <algorithm>

#include "certificate_use.h"
#include "pdf_signature.h"
#include "signed_data.h"
#include "time_stamp.h"
#include "verify_parts.h"

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

void Report::check_signer(X509* certificate, const Verifier& verifier) {
  const std::string subject = subject_of(certificate), shown = quoted(subject);
  const std::string fingerprint = hex(sha256(der_of(certificate)));
  out_.subject = subject;
  if (verifier.signer.empty())
    return skip("signer.expected", "signed by " + shown + ", certificate " + fingerprint +
                                       "; nobody said who should have signed");
  std::string wanted = verifier.signer;
  const bool by_subject = wanted == subject;
  std::erase(wanted, ':');
  std::transform(wanted.begin(), wanted.end(), wanted.begin(), [](char c) {
    return c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (by_subject || wanted == fingerprint) return add("signer.expected", {}, "signed by " + shown);
  add("signer.expected",
      fail("signed by " + shown + ", certificate " + fingerprint + "; wanted " + verifier.signer),
      {});
}

void Report::check_stamp(const char* id, std::string_view token, std::string_view stamped,
                         const std::string& said, const Trusted& known, const Verifier& verifier) {
  if (token.empty()) return skip(id, "no time stamp: the signer says " + said, false);
  const auto stamp = check_time_stamp(token, stamped, known, verifier.now);
  if (!stamp) return add(id, fail("the time stamp " + stamp.error().message), {});
  out_.at = stamp->time;
  add(id, {}, "signed before " + text_of(stamp->time) + ", says " + quoted(stamp->by));
}

void Report::check_chain(X509* certificate, const std::vector<CertificatePtr>& others,
                         const Trusted& known, const Verifier& verifier) {
  add("certificate.use", check_signer_use(certificate),
      "the certificate is for signatures on documents");
  if (known.roots.empty()) {
    skip("certificate.chain", "nobody said whom to trust");
    return skip("certificate.revocation", "needs the chain", false);
  }
  const auto chain = chain_of(certificate, others, known, out_.at);
  if (!chain) {
    add("certificate.chain",
        fail("not trusted at " + text_of(out_.at) + ": " + chain.error().message), {});
    return skip("certificate.revocation", "needs the chain", false);
  }
  add("certificate.chain", check_only(others, *chain),
      "leads to " + quoted(subject_of(chain->back().get())) + ", valid at " + text_of(out_.at));
  if (verifier.revocation.empty())
    return skip("certificate.revocation", "no revocation list was given", false);
  bool looked = false;
  const auto revocation =
      check_revocation(*chain, known, {out_.at, verifier.now, Revocation::Of::signer}, looked);
  if (revocation && !looked) return skip("certificate.revocation", *revocation);
  add("certificate.revocation", to_void(revocation), revocation ? *revocation : "");
}

std::string quoted(std::string_view text) {
  constexpr std::size_t most = 200;
  return "\"" + std::string(text.substr(0, most)) + (text.size() > most ? "..." : "") + "\"";
}

namespace {

/// The signature first, by its place in the file; what is in the file only where it holds and is of
/// somebody who is trusted.
class PdfCheck {
 public:
  PdfCheck(std::string_view bytes, const Verifier& verifier)
      : bytes_(bytes), verifier_(verifier), report_(out_) {
    out_.at = verifier.now;
  }

  Verified run() {
    if (bytes_.size() > max_file || !bytes_.starts_with("%PDF-")) {
      report_.add(
          "file.structure",
          fail(bytes_.size() > max_file ? too_large : "is neither a PDF nor an XML document"), {});
      return std::move(out_);
    }
    const auto place = signature_at_end(bytes_);
    report_.add("signature.range", to_void(place), "covers the whole file but for itself");
    if (place) check_cms(*place);
    if (out_.holds()) return read(*place);
    for (const char* id : {"file.structure", "signature.one", "attachments"})
      report_.skip(id, "nobody who is trusted signed it");
    return std::move(out_);
  }

 private:
  Verified read(const PdfSignature& found) {
    const auto file = pdf::parse(bytes_);
    report_.add("file.structure", to_void(file),
                "a PDF of one revision, every byte of it accounted for");
    if (!file) return std::move(out_);
    report_.add("signature.one", check_only(*file, found),
                "one signature, " + std::string(sub_filter));
    read_attachments(*file);
    return std::move(out_);
  }

  /// The one that a reader of PDF finds is the one that was checked.
  static Expected<void> check_only(const pdf::File& file, const PdfSignature& found) {
    const auto dictionary = find_signature(file);
    if (!dictionary) return fail(dictionary.error());
    const auto place = signature_of(file, **dictionary);
    if (!place) return fail(place.error());
    if (place->gap != found.gap || place->contents.size() != found.contents.size() ||
        place->time != found.time)
      return fail("has another signature than the last one in the file");
    return {};
  }

  void check_cms(const PdfSignature& place) {
    std::string contents;
    for (std::size_t i = 0; i < place.contents.size(); i += 2)
      contents += static_cast<char>(digit(place.contents[i]) * 16 + digit(place.contents[i + 1]));
    std::string_view rest = contents;
    const auto der = Der::take(rest);
    Expected<void> padded;
    if (!der)
      padded = fail("holds no signature");
    else if (rest.find_first_not_of('\0') != std::string_view::npos)
      padded = fail("holds something behind the signature");
    report_.add("signature.padding", padded, "nothing but zeros behind the signature");
    if (!padded) return;
    auto data = SignedData::parse(der->whole, SignedData::Content::detached);
    report_.add(
        "signature.form", to_void(data),
        data ? *algorithm_of(X509_get0_pubkey(data->certificate()), true) + " over SHA-2" : "");
    if (!data) return;
    report_.add("signature.content", data->check_signature(place.before, place.behind),
                "the content is as it was signed");
    report_.add("signature.certificate", data->check_certificate_named(),
                "the certificate is the one that was signed with");
    out_.certificate = data->certificate_der();
    const auto known = trusted(verifier_.trust, verifier_.revocation);
    if (!known) {
      report_.add("certificate.chain", fail(known.error()), {});
      return;
    }
    report_.check_stamp("signature.time", data->time_stamp(), data->signature(),
                        text_of(place.time), *known, verifier_);
    report_.check_signer(data->certificate(), verifier_);
    report_.check_chain(data->certificate(), data->certificates(), *known, verifier_);
  }

  static int digit(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

  void read_attachments(const pdf::File& file) {
    auto attachments = attachments_of(file);
    if (attachments) out_.attachments = std::move(*attachments);
    const std::size_t n = out_.attachments.size();
    report_.add("attachments", to_void(attachments),
                n == 0 ? "none" : std::to_string(n) + (n == 1 ? " file" : " files"));
  }

  std::string_view bytes_;
  const Verifier& verifier_;
  Verified out_;
  Report report_;
};

}  // namespace

Verified verify_pdf(std::string_view bytes, const Verifier& verifier) {
  return PdfCheck(bytes, verifier).run();
}

Expected<std::vector<Attachment>> unverified_attachments(std::string_view pdf) {
  const auto file = pdf::parse(pdf);
  if (!file) return fail(file.error());
  return attachments_of(*file);
}

}  // namespace nonio::sign
