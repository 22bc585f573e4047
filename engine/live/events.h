// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

/// An event for open pages. A newer event of the same type and subject replaces an older one, so
/// that slow pages need no queue and a page that reconnects gets the present state.
namespace nonio::live {

struct Event {
  std::uint64_t version = 0;  ///< version of the state, sent as `id:`
  std::string type;           ///< for example "state", "fit" or "progress"
  std::string about;          ///< subject, for example a part
  std::string data;           ///< JSON on one line
};

/// Returns the event as sent, for example "id: 17\nevent: fit\ndata: {...}\n\n".
std::string event_text(const Event& event);

/// The connection of one open page.
class Listener {
 public:
  /// Returns the events since the last call, oldest first; empty if none arrives within `patience`.
  std::vector<Event> wait(std::chrono::milliseconds patience);
  bool closed() const;

 private:
  friend class Events;
  void put(const Event& event);
  void close();

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Event> waiting_;
  bool closed_ = false;
};

class Events {
 public:
  static constexpr std::size_t most_listeners = 8;

  void publish(Event event);
  /// Returns a listener that first gets the events of version `since` and later, or all events if
  /// this version is unknown because the server was restarted. Null if there are `most_listeners`
  /// or the server ends.
  std::shared_ptr<Listener> listen(std::uint64_t since);
  void leave(const std::shared_ptr<Listener>& listener);
  std::size_t listeners() const;
  void close();

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;
  std::deque<Event> latest_;  ///< newest event of each type and subject, oldest first
  std::uint64_t version_ = 0;
  bool closed_ = false;
};

}  // namespace nonio::live
