// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "der.h"
#include "nonio/sign/verify.h"
#include "openssl.h"
#include "pdf_reader.h"
#include "signed_data.h"

namespace nonio::sign {

/// The lines of a verification as they are found.
class Report {
 public:
  explicit Report(Verified& out) : out_(out) {}
  void add(const char* id, const Expected<void>& result, const std::string& well);
  void skip(const char* id, const std::string& why, bool essential = true);
  void check_signer(X509* certificate, const Verifier& verifier);
  /// At `Verified::at`.
  void check_chain(X509* certificate, const std::vector<CertificatePtr>& others,
                   const Trusted& known, bool revocation_given);

 private:
  Verified& out_;
};

/// The embedded files of a PDF in the order of their names.
Expected<std::vector<Attachment>> attachments_of(const pdf::File& file);

}  // namespace nonio::sign
