// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "campaign/config/keys.h"
#include "nonio/sdk/plugin.h"

/// The keys of [[measurement]]: those of every method, and those that a method declares. What is
/// made here refers to the methods, which have to outlive it.
namespace nonio::config {

/// A key of [[measurement]] that no method may declare, since every method has it; null if none.
const Key* common_key(std::string_view name);

/// The table [[measurement]] of one kind.
class KindKeys {
 public:
  explicit KindKeys(const Method& method);
  KindKeys(const KindKeys&) = delete;
  KindKeys& operator=(const KindKeys&) = delete;
  const Key& table() const { return table_; }

 private:
  friend class CampaignKeys;
  Key key_of(const Option& option);

  std::deque<std::vector<Choice>> choices_;
  std::deque<std::string> texts_;
  std::vector<Key> keys_;
  Key table_;
};

/// campaign.toml with the keys of all methods in [[measurement]], each only where the kind declares
/// it. A key that two kinds declare differently is `Key::Holds::by_kind`.
class CampaignKeys {
 public:
  explicit CampaignKeys(const std::vector<Method>& methods);
  CampaignKeys(const CampaignKeys&) = delete;
  CampaignKeys& operator=(const CampaignKeys&) = delete;
  const Key& file() const { return file_; }

 private:
  void add(const Method& method, const Key& key);

  struct Kinds {
    std::vector<std::string_view> declaring, requiring;
  };
  std::deque<KindKeys> of_kinds_;
  std::vector<Key> measurement_, top_;
  std::deque<Kinds> kinds_;  ///< of the keys behind the common ones
  Key file_;
};

}  // namespace nonio::config
