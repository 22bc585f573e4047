// SPDX-License-Identifier: Apache-2.0
#include "batch/commit/committer.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace nonio::batch {

namespace {

/// A crash affects at most 64 campaigns, and their answers fit into the channel.
constexpr std::size_t largest_batch = 64;

struct StoredMessage {
  std::size_t campaign = 0;
  bool stored = false;
  std::array<char, 500> why{};
};

StoredMessage message_of(std::size_t campaign, const Expected<void>& result) {
  StoredMessage message{campaign, result.has_value()};
  if (!result) result.error().message.copy(message.why.data(), message.why.size() - 1);
  return message;
}

void serve(const Committer::Task& task, int channel) {
  for (Committer::Given given; ::read(channel, &given, sizeof given) == sizeof given;) {
    std::vector<Committer::Given> batch{given};
    while (batch.size() < largest_batch &&
           ::recv(channel, &given, sizeof given, MSG_DONTWAIT) == sizeof given)
      batch.push_back(given);
    const auto results = task(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const StoredMessage message = message_of(batch[i].campaign, results[i]);
      if (::write(channel, &message, sizeof message) != sizeof message) return;
    }
  }
}

}  // namespace

Expected<void> Committer::start() {
  constexpr const char* purpose = "what stores results";
  NONIO_TRY(auto ends, process::channel_pair(SOCK_SEQPACKET, purpose));
  NONIO_TRY(child_, process::Child::start(purpose, {.silent = true}, [&] {
              ends[0] = process::Handle();
              serve(task_, ends[1].get());
            }));
  channel_ = std::move(ends[0]);
  return {};
}

void Committer::end() {
  channel_ = process::Handle();
  child_.end();
}

Expected<void> Committer::give(Given campaign) {
  if (!channel_)
    if (auto started = start(); !started) return started;
  pending_.push_back(campaign);
  // If the process has ended, done() returns the campaign.
  [[maybe_unused]] const ssize_t n = ::send(channel(), &campaign, sizeof campaign, MSG_NOSIGNAL);
  return {};
}

std::vector<Committer::Done> Committer::done() {
  std::vector<Done> out;
  while (channel_ && !pending_.empty()) {
    StoredMessage message;
    const ssize_t n = ::recv(channel(), &message, sizeof message, MSG_DONTWAIT);
    if (n == sizeof message) {
      const auto it = std::find_if(pending_.begin(), pending_.end(),
                                   [&](const Given& g) { return g.campaign == message.campaign; });
      if (it == pending_.end()) continue;
      out.push_back({*it, message.stored ? "" : message.why.data()});
      pending_.erase(it);
      continue;
    }
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) break;
    end();
    for (const Given& given : std::exchange(pending_, {}))
      out.push_back({given, "the process that stores died", true});
  }
  return out;
}

}  // namespace nonio::batch
