// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "authority.h"

namespace nonio::sign_tests {

/// An RFC 3161 server on the loopback interface.
class TimeServer {
 public:
  enum class Mood { honest, silent, refuses, other_imprint, other_nonce, nonsense };

  explicit TimeServer(Holder holder, sign::Time time = now, Mood mood = Mood::honest);
  ~TimeServer();
  TimeServer(const TimeServer&) = delete;
  TimeServer& operator=(const TimeServer&) = delete;

  sign::TimeStamping stamping(const std::string& trust) const;

 private:
  void serve();
  std::string answer_to(const std::string& query) const;

  Holder holder_;
  sign::Time time_;
  Mood mood_;
  int socket_ = -1;
  int port_ = 0;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace nonio::sign_tests
