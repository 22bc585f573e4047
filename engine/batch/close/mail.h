// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/config/manifest.h"
#include "nonio/reports/site.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

struct Letter {
  std::string subject;  ///< UTF-8; line ends are sent as spaces
  std::string text;
  std::string file{};  ///< name of the attachment; empty if there is none
  std::string bytes{};
};

/// Whether the worklist line is severe enough for a mail according to `on`. Acknowledged and fixed
/// lines are not, nor are changes below the significance that a mail requires.
bool is_reason_for_mail(const reports::WorkItem& line, config::Mail::On on);

/// Sends the letter through the program or the server of `mail`, in a child process that may take
/// `seconds` (s). Paths are relative to `site`. No error contains the password.
Expected<void> send_mail(const config::Mail& mail, const std::filesystem::path& site,
                         const Letter& letter, double seconds = 60.0);

/// Sends `body` (JSON) by POST with the header `X-Nonio-Signature: sha256=HEX`, the HMAC-SHA256 of
/// the body. A status other than 2xx is an error. A child process may take `seconds` (s). No error
/// contains the secret.
Expected<void> send_webhook(const config::Webhook& webhook, const std::filesystem::path& site,
                            const std::string& body, double seconds = 5.0);

/// Type of `nonio_post` in a library that is loaded on demand (late_library.h): posts the body in
/// this process and returns an empty text.
using PostTo = Expected<std::string> (*)(const config::Webhook& webhook,
                                         const std::filesystem::path& site, const std::string& body,
                                         double seconds);

/// Type of `nonio_deliver` in a library that is loaded on demand (late_library.h): sends the letter
/// in this process. The mail program may take `seconds` (s) in total, a server for each response.
using Deliver = Expected<std::string> (*)(const config::Mail& mail,
                                          const std::filesystem::path& site, const Letter& letter,
                                          double seconds);

}  // namespace nonio::batch
