// SPDX-License-Identifier: Apache-2.0
#include "certificates/signer.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>
#include <utility>

#include "campaign/config/site_files.h"
#include "platform/process/guarded.h"
#include "platform/process/stop.h"
#include "platform/process/watched.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

Expected<std::string> password_of(const config::Signing& s, const fs::path& site) {
  return config::read_password(
      {s.password_file, s.password_env, s.password_credential, "the key's password", "signing"},
      site);
}

std::string in_site(const fs::path& site, const std::string& path) {
  return path.empty() ? path : (site / path).string();
}

Expected<sign::Key> open_key(const config::Signing& s, const fs::path& site) {
  if (!s.pkcs12.empty())
    if (auto well = config::check_secret(site / s.pkcs12, "the signing key"); !well)
      return fail(well.error());
  NONIO_TRY(auto password, password_of(s, site));
  auto key =
      sign::Key::open({in_site(site, s.pkcs12), s.pkcs11, s.module, in_site(site, s.certificates)},
                      password, std::time(nullptr));
  std::string& secret = password;
  explicit_bzero(secret.data(), secret.size());  // unlike a plain fill, this is not optimized away
  return key;
}

Expected<sign::TimeStamping> stamping_of(const config::Signing& s, const fs::path& site) {
  sign::TimeStamping stamping;
  if (s.time_stamp.empty()) return stamping;
  NONIO_TRY(auto roots,
            storage::read_file(in_site(site, s.trust.empty() ? s.time_stamp_roots : s.trust)));
  stamping.url = s.time_stamp;
  stamping.required = s.time_stamp_required;
  stamping.seconds = s.time_stamp_seconds;
  stamping.trust = std::move(roots);
  // After one failure the server is not contacted again, so that its time limit passes only once.
  stamping.away = std::make_shared<std::string>();
  return stamping;
}

constexpr const char* signing_process = "the process that signs";

/// An empty request is answered with the identity of the signer. The answer consists of an error
/// (or ""), a message about a missing time stamp, and the signed bytes. The main process ends a
/// worker that does not finish its request.
void answer(int stream, const Expected<sign::Key>& key,
            const Expected<sign::TimeStamping>& stamping) {
  std::string request;
  if (!process::read_text(stream, request)) return;
  const auto reply = [&](const std::string& why, const sign::Signed& done) {
    [[maybe_unused]] const bool heard = process::write_text(stream, why) &&
                                        process::write_text(stream, done.no_time_stamp) &&
                                        process::write_text(stream, done.bytes);
  };
  if (!key) return reply(key.error().message, {});
  if (!stamping) return reply(stamping.error().message, {});
  if (request.empty()) {
    const sign::Identity& who = key->identity();
    return reply("", {std::to_string(who.not_after) + " " + who.subject});
  }
  const auto done = process::guarded("the signature", [&] {
    return key->sign(std::move(request), std::time(nullptr), *stamping);
  });
  done ? reply("", *done) : reply(done.error().message, {});
}

/// `go_on`, which may be empty, is called repeatedly until the answer begins; if it returns false,
/// the request is given up.
Expected<sign::Signed> ask(int channel, std::string_view bytes,
                           const std::function<bool()>& go_on = {}) {
  NONIO_TRY(auto ends, process::channel_pair(SOCK_STREAM, signing_process));
  const process::Handle own = std::move(ends[0]);
  bool asked = false;
  {
    const process::Handle theirs = std::move(ends[1]);
    asked = process::send_descriptors(channel, 's', {theirs.get()});
  }
  asked = asked && process::write_text(own.get(), bytes);
  pollfd answered{own.get(), POLLIN, 0};
  while (asked && go_on && ::poll(&answered, 1, 100) <= 0)
    if (!go_on()) return fail("no answer");
  std::string why;
  sign::Signed done;
  if (!asked || !process::read_text(own.get(), why) ||
      !process::read_text(own.get(), done.no_time_stamp) ||
      !process::read_text(own.get(), done.bytes))
    return fail("the process that signs died");
  if (!why.empty()) return fail(why);
  return done;
}

}  // namespace

Signer::Signer(const config::Signing& signing, fs::path site, double disk_seconds)
    : signing_(signing), site_(std::move(site)), disk_seconds_(disk_seconds) {}

Expected<void> Signer::fork_process() {
  NONIO_TRY(child_, process::Child::start("the signature", {.silent = true}, [this] { serve(); }));
  return {};
}

void Signer::serve() {
  ::prctl(PR_SET_DUMPABLE, 0);  // no other process can read the key from memory
  to_ = process::Handle();
  constexpr int most_deaths = 5;
  const auto key = process::guarded("the signing key", [&]() -> Expected<sign::Key> {
    if (!given_up_.empty()) return fail(given_up_);
    if (deaths_ > most_deaths) return fail("the process that opens it dies again and again");
    return open_key(signing_, site_);
  });
  const auto stamping = key ? stamping_of(signing_, site_) : fail(key.error());
  while (const auto asked = process::receive_descriptors(from_.get()))
    for (const process::Handle& stream : asked->descriptors) answer(stream.get(), key, stamping);
}

Expected<sign::Identity> Signer::start() {
  NONIO_TRY(auto ends, process::channel_pair(SOCK_SEQPACKET, signing_process));
  to_ = std::move(ends[0]);
  from_ = std::move(ends[1]);
  if (auto made = fork_process(); !made) return fail(made.error());
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(disk_seconds_);
  const auto hello = ask(to_.get(), {}, [&] {
    revive();
    return !process::is_stop_requested() && std::chrono::steady_clock::now() < deadline;
  });
  if (!hello && std::chrono::steady_clock::now() >= deadline) {
    given_up_ = process::no_answer(disk_seconds_);
    child_.end();
    revive();
    return fail("the signing key: " + given_up_);
  }
  if (!hello) return fail(hello.error());
  sign::Identity who;
  const std::size_t blank = hello->bytes.find(' ');
  who.not_after = std::atoll(hello->bytes.c_str());
  who.subject = hello->bytes.substr(blank + 1);
  return who;
}

void Signer::revive() {
  if (child_ && !child_.has_ended()) return;
  ++deaths_;
  // If this fails, a later call tries again.
  [[maybe_unused]] const auto made = fork_process();
}

void Signer::leave_to_worker() {
  from_ = process::Handle();
  if (!signing_.password_env.empty()) ::unsetenv(signing_.password_env.c_str());
}

Expected<sign::Signed> Signer::sign(const std::string& bytes) const {
  return ask(to_.get(), bytes);
}

}  // namespace nonio::certificates
