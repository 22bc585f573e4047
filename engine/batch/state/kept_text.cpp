// SPDX-License-Identifier: Apache-2.0
#include "batch/state/kept_text.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace nonio::batch {

namespace {

constexpr std::size_t block_size = 1 << 18;
constexpr std::size_t most_shared = 500;
/// As the first byte: the length is in the next eight.
constexpr unsigned char is_long = 255;

/// Blocks that texts are written into one behind the other.
struct KeptTexts {
  std::mutex mutex;
  std::vector<std::unique_ptr<char[]>> blocks;
  char* at = nullptr;
  std::size_t left = 0;
  std::map<std::string, KeptText, std::less<>> shared;

  char* take(std::size_t size) {
    if (size > left) {
      left = std::max(size, block_size);
      at = blocks.emplace_back(new char[left]).get();
    }
    char* const taken = at;
    at += size;
    left -= size;
    return taken;
  }
};

KeptTexts& kept_texts() {
  static auto* const all = new KeptTexts;
  return *all;
}

}  // namespace

KeptText::KeptText(std::string_view text) {
  if (text.empty()) return;
  const std::size_t size = text.size();
  const bool fits = size < is_long;
  const std::size_t before = fits ? 1 : 1 + sizeof size;
  const std::scoped_lock lock(kept_texts().mutex);
  char* const to = kept_texts().take(before + size);
  to[0] = static_cast<char>(fits ? size : is_long);
  if (!fits) std::memcpy(to + 1, &size, sizeof size);
  std::memcpy(to + before, text.data(), size);
  at_ = to;
}

KeptText KeptText::shared(std::string_view text) {
  {
    const std::scoped_lock lock(kept_texts().mutex);
    if (const auto known = kept_texts().shared.find(text); known != kept_texts().shared.end())
      return known->second;
  }
  const KeptText kept(text);
  const std::scoped_lock lock(kept_texts().mutex);
  if (kept_texts().shared.size() < most_shared) kept_texts().shared.emplace(text, kept);
  return kept;
}

std::string_view KeptText::view() const {
  if (at_ == nullptr) return {};
  std::size_t size = static_cast<unsigned char>(at_[0]);
  if (size != is_long) return {at_ + 1, size};
  std::memcpy(&size, at_ + 1, sizeof size);
  return {at_ + 1 + sizeof size, size};
}

}  // namespace nonio::batch
