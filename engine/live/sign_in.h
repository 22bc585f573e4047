// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "certificates/users.h"
#include "live/guard.h"
#include "nonio/sdk/error.h"

/// Sessions of the users of a site without a proxy: checks the passwords of users.toml and
/// identifies a session by a cookie.
namespace nonio::live {

class SignIn {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;
  explicit SignIn(Now now = Clock::now) : now_(std::move(now)) {}
  /// Longest duration of a session. It also ends with the server, a change of the password and the
  /// removal of the user.
  static constexpr std::chrono::hours lasting{12};
  /// Limit of sessions per account; the oldest is ended.
  static constexpr std::size_t most_of_account = 20;

  struct Checked {
    bool fits = false;
    /// Waiting time, s; if it is not 0, the password was not checked because of wrong passwords or
    /// other checks.
    int wait_s = 0;
  };
  /// Checks run one by one, so that guessing uses at most one processor, and at most two others are
  /// waited for. After a wrong password the account is blocked for 1, 2, 4 ... 60 s, whether it
  /// exists or not. `of_session` is for a user with a session, whom wrong passwords of others do
  /// not block.
  Checked check(const std::string& account, const std::string& password,
                const std::optional<certificates::User>& user, bool of_session = false);

  /// Starts a session and returns the value of Set-Cookie. `secure` restricts the cookie to TLS.
  Expected<std::string> begin(const certificates::User& user, bool secure);
  /// Returns the user of the session, or std::nullopt if there is none or it has ended.
  std::optional<certificates::User> user_of(const Head& head,
                                            const std::vector<certificates::User>& users);
  /// Ends the session and returns the value of Set-Cookie that removes the cookie.
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

  Now now_;
  std::mutex mutex_, checking_;
  /// Name of the cookie; random for each start of the server.
  std::string cookie_{};
  std::map<std::string, Session> sessions_{};  ///< by SHA-256 of the value of the cookie
  /// By account, and separately by account with a session.
  std::map<std::string, Wrong> wrong_{};
  /// For accounts that do not exist, by SHA-256 of the account.
  std::array<Wrong, 256> wrong_of_others_{};
  std::atomic<int> waiting_ = 0;
};

}  // namespace nonio::live
