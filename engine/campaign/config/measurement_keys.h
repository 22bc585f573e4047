// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "campaign/config/keys.h"
#include "nonio/sdk/plugin.h"

/// The classes refer to the methods, which must outlive them.
namespace nonio::config {

/// Returns null unless all methods share the key; no method may declare such a key.
const Key* common_key(std::string_view name);

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

/// Declaration of campaign.toml in which a key of a method is allowed only for the kinds that
/// declare it. A key that two kinds declare differently is `Key::Holds::by_kind`.
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
  std::deque<Kinds> kinds_;
  Key file_;
};

}  // namespace nonio::config
