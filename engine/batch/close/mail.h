// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/config/manifest.h"
#include "nonio/reports/site.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

struct Letter {
  std::string subject;  ///< subject of the mail in UTF-8; line ends are sent as spaces
  std::string text;     ///< body of the mail in UTF-8
  std::string file{};   ///< name of the attached file; empty: none
  std::string bytes{};  ///< its content
};

/// Returns whether this worklist line is severe enough for a mail, according to the setting `on`.
/// Lines that were acknowledged or fixed are not severe enough, and neither are changes below the
/// significance that a mail requires.
bool is_reason_for_mail(const reports::WorkItem& line, config::Mail::On on);

/// Sends the letter once, through the program or the server of `mail`. Paths are relative to
/// `site`. Runs in a child process that may take `seconds` (s) in total. The password appears in no
/// error.
Expected<void> send_mail(const config::Mail& mail, const std::filesystem::path& site,
                         const Letter& letter, double seconds = 60.0);

/// Sends `body` (JSON) by POST, with the header `X-Nonio-Signature: sha256=HEX`, the HMAC of the
/// body by the secret. A status other than 2xx is an error. Runs in a child process that may take
/// `seconds` (s) in total; the secret appears in no error.
Expected<void> send_webhook(const config::Webhook& webhook, const std::filesystem::path& site,
                            const std::string& body, double seconds = 5.0);

/// Posts the body in this process and returns an empty text; exported as `nonio_post` by a library
/// that is loaded late (late_library.h).
using PostTo = Expected<std::string> (*)(const config::Webhook& webhook,
                                         const std::filesystem::path& site, const std::string& body,
                                         double seconds);

/// Sends the letter in this process; exported as `nonio_deliver` by a library that is loaded late
/// (late_library.h). The mail program may take `seconds` (s) in total; a server may take `seconds`
/// (s) for each answer.
using Deliver = Expected<std::string> (*)(const config::Mail& mail,
                                          const std::filesystem::path& site, const Letter& letter,
                                          double seconds);

}  // namespace nonio::batch
