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

/// Sessions of the users of a site without a proxy: checks the passwords of users.toml, and
/// identifies a session by a cookie.
namespace nonio::live {

class SignIn {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;
  explicit SignIn(Now now = Clock::now) : now_(std::move(now)) {}
  /// Longest duration of a session. It also ends with the server, with a change of the password,
  /// and with the removal of the user.
  static constexpr std::chrono::hours lasting{12};
  /// Sessions of one account; one more ends the oldest of this account.
  static constexpr std::size_t most_of_account = 20;

  /// Result of checking a password.
  struct Checked {
    bool fits = false;
    int wait_s = 0;  ///< time to wait in s if the password was not checked, after wrong passwords
                     ///< or because too many checks wait; otherwise 0
  };
  /// Checks a password. Checks run one after the other, so that guessing uses at most one
  /// processor, and at most two others are waited for; each takes as long as
  /// `certificates::is_password_hash` permits. After wrong passwords the account is not checked for 1, 2,
  /// 4 ... 60 s, whether it exists or not. `of_session`: for a person who is signed in; wrong
  /// passwords of others do not block this person.
  Checked check(const std::string& account, const std::string& password,
                const std::optional<certificates::User>& user, bool of_session = false);

  /// Starts a session and returns the value of Set-Cookie. `secure`: send the cookie over TLS only.
  Expected<std::string> begin(const certificates::User& user, bool secure);
  /// Returns the user of the request's session; none if there is no session or it has ended (see
  /// `lasting`).
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
  std::string cookie_{};                       ///< name of the cookie; random for each start of a
                                               ///< server
  std::map<std::string, Session> sessions_{};  ///< sessions, by SHA-256 of the cookie's value
  std::map<std::string, Wrong> wrong_{};       ///< wrong passwords by account, and separately by
                                               ///< account of a user who is signed in
  std::array<Wrong, 256> wrong_of_others_{};   ///< wrong passwords for accounts that do not exist,
                                               ///< by SHA-256 of the account
  std::atomic<int> waiting_ = 0;
};

}  // namespace nonio::live
