// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/config/manifest.h"
#include "nonio/reports/site.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

struct Letter {
  std::string subject;  ///< UTF-8; line ends become spaces
  std::string text;     ///< UTF-8
};

/// Whether this line is severe enough for a mail, by the setting `on`. A line that was acknowledged
/// or fixed is not, nor is a change that is not significant enough.
bool is_reason_for_mail(const reports::WorkItem& line, config::Mail::On on);

/// Gives the letter to the program or the server of `mail`, once. Paths are relative to `site`. In
/// a process of its own, which may take `seconds` (s) in all. The password appears in no error.
Expected<void> send_mail(const config::Mail& mail, const std::filesystem::path& site,
                         const Letter& letter, double seconds = 60.0);

/// POSTs a body of JSON, with header `X-Nonio-Signature: sha256=HEX`, its HMAC by the secret. Any
/// status but 2xx is an error. In a process of its own, as above; the secret appears in no error.
Expected<void> send_webhook(const config::Webhook& webhook, const std::filesystem::path& site,
                            const std::string& body, double seconds = 20.0);

/// The same of `send_webhook`, as `nonio_post`.
using PostTo = Expected<std::string> (*)(const config::Webhook& webhook,
                                         const std::filesystem::path& site, const std::string& body,
                                         double seconds);

/// The way to the server or program, as `nonio_deliver` of a library that is loaded late
/// (late_library.h). A server may take `seconds` (s).
using Deliver = Expected<std::string> (*)(const config::Mail& mail,
                                          const std::filesystem::path& site, const Letter& letter,
                                          double seconds);

}  // namespace nonio::batch
