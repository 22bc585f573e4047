// SPDX-License-Identifier: Apache-2.0
#include "live/bench_client.h"

#include <sys/socket.h>

#include <chrono>

#include "live/bench.h"
#include "platform/storage/serialise.h"

namespace nonio::live {

namespace {

constexpr const char* gone_words =
    "the process that calculates has ended, with all that it was asked; it is started again";

}  // namespace

BenchClient::BenchClient(Launcher& launcher, std::filesystem::path campaign, Tell tell)
    : launcher_(launcher), campaign_(std::move(campaign)), tell_(std::move(tell)) {
  listener_ = std::thread([this] { listen(); });
}

BenchClient::~BenchClient() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    if (channel_) ::shutdown(channel_.get(), SHUT_RDWR);
  }
  wanted_.notify_all();
  listener_.join();
}

bool BenchClient::send(std::string_view what, std::uint64_t job, const std::string& text) {
  return channel_ && process::write_text(channel_.get(), storage::pack(what, job, text));
}

std::uint64_t BenchClient::ask(const storage::Json& request) {
  std::uint64_t job = 0;
  {
    const std::lock_guard lock(mutex_);
    job = ++last_;
    open_.insert(job);
    again_ = true;
    const std::string text = storage::dump_line(request);
    if (!send("do", job, text)) unsent_[job] = text;
  }
  wanted_.notify_all();
  return job;
}

void BenchClient::cancel(std::uint64_t job) {
  const std::lock_guard lock(mutex_);
  if (unsent_.erase(job) == 0 && open_.erase(job) > 0) send("cancel", job, "");
}

void BenchClient::restart() {
  {
    const std::lock_guard lock(mutex_);
    again_ = true;
    if (channel_) ::shutdown(channel_.get(), SHUT_RDWR);
  }
  wanted_.notify_all();
}

void BenchClient::fail_all(const std::string& words) {
  std::set<std::uint64_t> open;
  {
    const std::lock_guard lock(mutex_);
    open.swap(open_);
    for (const auto& [job, text] : unsent_) open.erase(job), open_.insert(job);
  }
  for (const std::uint64_t job : open) tell_(job, job_state::failed, words);
}

bool BenchClient::connect() {
  auto channel = launcher_.open(campaign_);
  if (!channel) {
    tell_(0, job_state::failed, channel.error().message);
    return false;
  }
  const std::lock_guard lock(mutex_);
  if (over_) return false;  // the destructor has begun, so nothing would end this process
  channel_ = std::move(*channel);
  for (const auto& [job, text] : unsent_) send("do", job, text);
  unsent_.clear();
  return true;
}

void BenchClient::hear() {
  int from = -1;
  {
    const std::lock_guard lock(mutex_);
    from = channel_.get();
  }
  for (std::string bytes; process::read_text(from, bytes);) {
    std::uint64_t job = 0;
    std::string state, text;
    if (!storage::unpack(bytes, job, state, text)) continue;
    if (job != 0) {
      const bool goes_on = state == job_state::running || state == job_state::begun;
      const std::lock_guard lock(mutex_);
      // The job was canceled.
      if (goes_on ? !open_.contains(job) : open_.erase(job) == 0) continue;
    }
    tell_(job, state, text);
  }
}

void BenchClient::listen() {
  using Clock = std::chrono::steady_clock;
  constexpr auto soon = std::chrono::seconds(2);
  while (true) {
    bool is_begun_again = false;
    {
      std::unique_lock lock(mutex_);
      wanted_.wait(lock, [&] { return again_ || over_; });
      if (over_) return;
      again_ = false;
    }
    const auto begun = Clock::now();
    if (connect()) {
      hear();
      const std::lock_guard lock(mutex_);
      channel_ = process::Handle();
      if (Clock::now() - begun > soon) again_ = true;
      if (over_) return;
      is_begun_again = again_;
    } else if (const std::lock_guard lock(mutex_); over_) {
      return;
    }
    tell_(0, "ended", is_begun_again ? "again" : "");
    fail_all(gone_words);
  }
}

}  // namespace nonio::live
