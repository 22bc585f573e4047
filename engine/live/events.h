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

/// Events that the server sends to open pages. Of what a newer event replaces only the newest is
/// kept, so a slow page holds no queue, and a page that comes back gets all that it has missed.
namespace nonio::live {

struct Event {
  std::uint64_t version = 0;  ///< of the state, as `id:`
  std::string type;           ///< "state", "fit", "explain", "progress", "changed", "failed"
  std::string about;          ///< a newer event of this type about the same replaces it: a part
  std::string data;           ///< JSON, one line
};

/// "id: 17\nevent: fit\ndata: {...}\n\n"
std::string event_text(const Event& event);

/// One page that listens.
class Listener {
 public:
  /// What came since the last call, oldest first; waits for it. Empty: nothing came in that time.
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
  /// Events of `since` and later first, those about the same only once. None if `most_listeners`
  /// listen already, or the server ends. A version that is not known yet is one of an earlier
  /// server: everything then.
  std::shared_ptr<Listener> listen(std::uint64_t since);
  void leave(const std::shared_ptr<Listener>& listener);
  std::size_t listeners() const;
  /// All listeners end.
  void close();

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;
  std::deque<Event> latest_;  ///< of each type and subject the newest, oldest first
  std::uint64_t version_ = 0;
  bool closed_ = false;
};

}  // namespace nonio::live
