// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/nearest.h"

#include <algorithm>
#include <iterator>

#include "nonio/sdk/fields.h"

namespace nonio::storage {

namespace {

std::size_t common_letters(std::string one, std::string other) {
  std::sort(one.begin(), one.end()), std::sort(other.begin(), other.end());
  std::string both;
  std::set_intersection(one.begin(), one.end(), other.begin(), other.end(),
                        std::back_inserter(both));
  return both.size();
}

}  // namespace

std::string suggestion(std::string_view found, const std::vector<std::string>& candidates) {
  if (found.size() > 100) return {};
  const std::string* best = nullptr;
  std::size_t least = std::max<std::size_t>(2, found.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = readers::edit_distance(found, candidate);
    if (distance < least && 2 * common_letters(std::string(found), candidate) >= found.size()) {
      least = distance;
      best = &candidate;
    }
  }
  return best == nullptr ? "" : " (nearest: \"" + *best + "\")";
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

std::string not_one_of(const std::vector<std::string>& choices, std::string_view found,
                       std::string list) {
  return "expected one of " + (list.empty() ? listed(choices) : std::move(list)) + "; found \"" +
         std::string(found) + "\"" + suggestion(found, choices);
}

}  // namespace nonio::storage
