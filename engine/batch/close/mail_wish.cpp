// SPDX-License-Identifier: Apache-2.0
#include "batch/close/mail.h"
#include "batch/state/read_apart.h"
#include "platform/storage/late_library.h"

namespace nonio::batch {

bool is_reason_for_mail(const reports::WorkItem& line, config::Mail::On on) {
  using Kind = reports::WorkItem::Kind;
  if (!reports::asks_by_mail(line)) return false;
  switch (on) {
    case config::Mail::On::lost:
      return line.kind <= Kind::failed;
    case config::Mail::On::out:
      return line.kind <= Kind::out;
    case config::Mail::On::decision:
      break;
  }
  return true;
}

Expected<void> send_mail(const config::Mail& mail, const std::filesystem::path& site,
                         const Letter& letter, double seconds) {
  const auto sent = read_apart<std::string>(
      "the answer to the mail", seconds, [&](process::SignsOfLife&) -> Expected<std::string> {
        NONIO_TRY(const auto deliver,
                  storage::exported_as<Deliver>("libnonio_mail.so", "nonio_deliver"));
        return (*deliver)(mail, site, letter, seconds / 2);
      });
  if (!sent) return fail("the mail was not sent: " + sent.error().message);
  return {};
}

Expected<void> send_webhook(const config::Webhook& webhook, const std::filesystem::path& site,
                            const std::string& body, double seconds) {
  const auto sent = read_apart<std::string>(
      "the answer of the webhook", seconds, [&](process::SignsOfLife&) -> Expected<std::string> {
        NONIO_TRY(const auto post, storage::exported_as<PostTo>("libnonio_mail.so", "nonio_post"));
        return (*post)(webhook, site, body, seconds / 2);
      });
  if (!sent) return fail(sent.error());
  return {};
}

}  // namespace nonio::batch
