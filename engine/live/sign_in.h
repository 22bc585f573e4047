// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "certificates/users.h"
#include "live/guard.h"
#include "nonio/sdk/error.h"

/// Who is signed in at the page of a site that has no proxy for it: passwords of users.toml, and a
/// session in a cookie.
namespace nonio::live {

class SignIn {
 public:
  using Clock = std::chrono::steady_clock;
  /// A session ends after it, at the end of the server, with another password, and with the user.
  static constexpr std::chrono::hours lasting{12};

  /// How a password was.
  struct Checked {
    bool fits = false;
    int wait_s = 0;  ///< not checked: wrong passwords came before, wait so long
  };
  /// One after the other, so that guessing takes no more than one processor; few may wait for it. After a
  /// wrong one the account is not checked for 1, 2, 4 ... 60 s; whether it exists is not shown.
  /// `of_session`: of a person who is signed in, whom wrong passwords of others do not stop.
  Checked check(const std::string& account, const std::string& password,
                const std::optional<certificates::User>& user, bool of_session = false);

  /// Value of Set-Cookie for a new session. `secure`: not over plain HTTP.
  Expected<std::string> begin(const certificates::User& user, bool secure);
  /// The account of the request's session as long as its user has the password of that time.
  std::optional<certificates::User> user_of(const Head& head,
                                            const std::vector<certificates::User>& users);
  /// Value of Set-Cookie that removes it.
  std::string end(const Head& head);

 private:
  struct Session {
    std::string account, password_hash;
    Clock::time_point since;
  };
  struct Wrong {
    int times = 0;
    Clock::time_point until{};
  };
  std::string key_of(const Head& head) const;

  std::mutex mutex_, checking_;
  std::string cookie_{};                       ///< its name; another one for each start of a server
  std::map<std::string, Session> sessions_{};  ///< by the SHA-256 of what the cookie has
  std::map<std::string, Wrong> wrong_{};       ///< by account, and by account in a session
  std::array<Wrong, 256> wrong_of_others_{};   ///< of no user: by the account's SHA-256
  std::atomic<int> waiting_ = 0;
};

}  // namespace nonio::live
