// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// An event that the server sends to open pages. Only the newest of several events with the same
/// type and subject is kept, so a slow page needs no queue, and a page that reconnects gets
/// everything that it missed.
namespace nonio::live {

struct Event {
  std::uint64_t version = 0;  ///< version of the state, sent as `id:`
  std::string type;           ///< type of the event, for example "state", "fit" or "progress"
  std::string about;          ///< subject, for example a part: a newer event of this type with the
                              ///< same subject replaces it
  std::string data;           ///< content of the event: JSON on one line
};

/// Returns the event as sent, for example "id: 17\nevent: fit\ndata: {...}\n\n".
std::string event_text(const Event& event);

/// The connection of one open page.
class Listener {
 public:
  /// Waits for events and returns the events since the last call, oldest first; empty if none came
  /// within `patience`.
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
  /// Returns a listener that gets the events of `since` and later first. Null if there are
  /// `most_listeners` already, or the server ends. An unknown version belongs to an earlier start
  /// of the server: then all events are sent.
  std::shared_ptr<Listener> listen(std::uint64_t since);
  void leave(const std::shared_ptr<Listener>& listener);
  std::size_t listeners() const;
  /// Ends all listeners.
  void close();

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;
  std::deque<Event> latest_;  ///< newest event of each type and subject, oldest first
  std::uint64_t version_ = 0;
  bool closed_ = false;
};

}  // namespace nonio::live
