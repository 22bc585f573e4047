// SPDX-License-Identifier: Apache-2.0
#include "live/watch.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>

#include "platform/storage/digest.h"

namespace nonio::live {

namespace {

/// Returns a text that changes when the file is written or replaced; empty if it does not exist.
std::string stamp_of(const std::filesystem::path& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return {};
  return std::to_string(s.st_size) + " " + std::to_string(s.st_mtim.tv_sec) + " " +
         std::to_string(s.st_mtim.tv_nsec) + " " + std::to_string(s.st_ino);
}

}  // namespace

Watch::Watch(std::filesystem::path folder, Tell tell)
    : folder_(std::move(folder)), tell_(std::move(tell)) {
  thread_ = std::thread([this] { run(); });
}

Watch::~Watch() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  over_or_new_.notify_all();
  thread_.join();
}

void Watch::expect(std::map<std::string, std::string> digests) {
  const std::lock_guard lock(mutex_);
  expected_ = std::move(digests);
  changed_ = false;
}

bool Watch::is_changed(const std::string& file, const std::string& digest) {
  const std::string stamp = stamp_of(folder_ / file);
  Seen& seen = seen_[file];
  if (seen.stamp != stamp || stamp.empty()) {
    const auto now = storage::sha256_of_file(folder_ / file);
    seen = {stamp, now ? *now : std::string()};
  }
  return seen.digest != digest;
}

void Watch::look() {
  std::map<std::string, std::string> expected;
  {
    const std::lock_guard lock(mutex_);
    expected = expected_;
  }
  const bool changed = std::any_of(expected.begin(), expected.end(), [&](const auto& one) {
    return is_changed(one.first, one.second);
  });
  {
    const std::lock_guard lock(mutex_);
    if (changed == changed_ || expected != expected_) return;
    changed_ = changed;
  }
  tell_(changed);
}

void Watch::run() {
  constexpr auto pause = std::chrono::seconds(1);
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (over_or_new_.wait_for(lock, pause, [&] { return over_; })) return;
    }
    look();
  }
}

}  // namespace nonio::live
