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
  const std::string subject = subject_of(certificate);
  const std::string fingerprint = hex(sha256(der_of(certificate)));
  out_.subject = subject;
  if (verifier.signer.empty())
    return skip("signer.expected", "signed by " + subject + ", certificate " + fingerprint +
                                       "; nobody said who should have signed");
  std::string wanted = verifier.signer;
  const bool by_subject = wanted == subject;
  std::erase(wanted, ':');
  std::transform(wanted.begin(), wanted.end(), wanted.begin(), [](char c) {
    return c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (by_subject || wanted == fingerprint)
    return add("signer.expected", {}, "signed by " + subject);
  add("signer.expected",
      fail("signed by " + subject + ", certificate " + fingerprint + "; wanted " + verifier.signer),
      {});
}

void Report::check_chain(X509* certificate, const std::vector<CertificatePtr>& others,
                         const Trusted& known, bool revocation_given) {
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
  auto issued = check_issued(others, known);
  add("certificate.chain", issued,
      "leads to " + subject_of(chain->back().get()) + ", valid at " + text_of(out_.at));
  if (!revocation_given)
    return skip("certificate.revocation", "no revocation list was given", false);
  bool looked = false;
  const auto revocation = check_revocation(*chain, known, out_.at, looked);
  if (revocation && !looked) return skip("certificate.revocation", *revocation);
  if (!revocation)
    add("certificate.revocation", fail(revocation.error()), {});
  else
    add("certificate.revocation", {}, *revocation);
}

namespace {

class PdfCheck {
 public:
  PdfCheck(std::string_view bytes, const Verifier& verifier)
      : bytes_(bytes), verifier_(verifier), report_(out_) {
    out_.at = verifier.now;
  }

  Verified run() {
    const auto file = parse();
    report_.add("file.structure", to_void(file),
                "a PDF of one revision, every byte of it accounted for");
    if (!file) return std::move(out_);
    const auto dictionary = find_signature(*file);
    report_.add("signature.one", to_void(dictionary), "one signature, " + std::string(sub_filter));
    if (!dictionary) return std::move(out_);
    const auto place = signature_of(*file, **dictionary);
    report_.add("signature.range", to_void(place), "covers the whole file but for itself");
    if (!place) return std::move(out_);
    check_cms(*place);
    read_attachments(*file);
    return std::move(out_);
  }

 private:
  template <class T>
  static Expected<void> to_void(const Expected<T>& result) {
    if (result) return {};
    return fail(result.error());
  }

  Expected<pdf::File> parse() const {
    if (bytes_.size() > max_file) return fail("is larger than 500 MB");
    return pdf::parse(bytes_);
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
    check_stamp(*data, *known, place.time);
    report_.check_signer(data->certificate(), verifier_);
    report_.check_chain(data->certificate(), data->certificates(), *known,
                        !verifier_.revocation.empty());
  }

  void check_stamp(const SignedData& data, const Trusted& known, const std::string& said) {
    if (data.time_stamp().empty())
      return report_.skip("signature.time", "no time stamp: the signer says " + said, false);
    const auto stamp = check_time_stamp(data.time_stamp(), data.signature(), known);
    if (!stamp)
      return report_.add("signature.time", fail("the time stamp " + stamp.error().message), {});
    out_.at = stamp->time;
    report_.add("signature.time", {},
                "signed before " + text_of(stamp->time) + ", says " + stamp->by);
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

}  // namespace nonio::sign
