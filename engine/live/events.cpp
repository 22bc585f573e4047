// SPDX-License-Identifier: Apache-2.0
#include "live/events.h"

#include <algorithm>

namespace nonio::live {

namespace {

void replace_in(std::deque<Event>& events, const Event& event) {
  std::erase_if(events,
                [&](const Event& e) { return e.type == event.type && e.about == event.about; });
  events.push_back(event);
}

}  // namespace

std::string event_text(const Event& event) {
  std::string data;
  for (const char c : event.data)
    if (c != '\n' && c != '\r') data += c;
  return "id: " + std::to_string(event.version) + "\nevent: " + event.type + "\ndata: " + data +
         "\n\n";
}

std::vector<Event> Listener::wait(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, patience, [&] { return closed_ || !waiting_.empty(); });
  std::vector<Event> out(waiting_.begin(), waiting_.end());
  waiting_.clear();
  return out;
}

bool Listener::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

void Listener::put(const Event& event) {
  {
    const std::lock_guard lock(mutex_);
    replace_in(waiting_, event);
  }
  arrived_.notify_one();
}

void Listener::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_one();
}

void Events::publish(Event event) {
  const std::lock_guard lock(mutex_);
  version_ = std::max(version_, event.version);
  replace_in(latest_, event);
  for (const auto& listener : listeners_) listener->put(event);
}

std::shared_ptr<Listener> Events::listen(std::uint64_t since) {
  const std::lock_guard lock(mutex_);
  if (closed_ || listeners_.size() >= most_listeners) return nullptr;
  auto listener = std::make_shared<Listener>();
  for (const Event& event : latest_)
    if (since > version_ || event.version >= since) listener->put(event);
  listeners_.push_back(listener);
  return listener;
}

void Events::leave(const std::shared_ptr<Listener>& listener) {
  const std::lock_guard lock(mutex_);
  std::erase(listeners_, listener);
}

std::size_t Events::listeners() const {
  const std::lock_guard lock(mutex_);
  return listeners_.size();
}

void Events::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (const auto& listener : listeners_) listener->close();
}

}  // namespace nonio::live
