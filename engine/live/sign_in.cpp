// SPDX-License-Identifier: Apache-2.0
#include "live/sign_in.h"

#include <algorithm>

#include "live/random_token.h"
#include "platform/storage/digest.h"

namespace nonio::live {
using certificates::User;

namespace {

constexpr const char* cookie_rules = "; Path=/; HttpOnly; SameSite=Strict";

std::size_t place_of(const std::string& account) {
  constexpr int hexadecimal = 16;
  return std::stoul(storage::sha256(account).substr(0, 2), nullptr, hexadecimal);
}

std::string cookie_of(const Head& head, const std::string& name) {
  std::string found;
  for (const std::string& line : head.all("Cookie"))
    for (std::string_view rest = line; !rest.empty();) {
      const std::size_t end = std::min(rest.find(';'), rest.size());
      std::string_view one = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
      if (!one.starts_with(name + "=")) continue;
      if (!found.empty()) return {};
      found = one.substr(name.size() + 1);
    }
  return found;
}

}  // namespace

SignIn::Checked SignIn::check(const std::string& account, const std::string& password,
                              const std::optional<User>& user, bool of_session) {
  constexpr int most_waiting = 3;
  struct Waiting {
    std::atomic<int>& count;
    const int before = count++;
    ~Waiting() { --count; }
  };
  const Waiting waiting{waiting_};
  if (waiting.before >= most_waiting) return {false, 1};
  const std::lock_guard lock(checking_);
  Wrong& wrong = user ? wrong_[user->account + (of_session ? " in a session" : "")]
                      : wrong_of_others_[place_of(account)];
  if (const auto left = wrong.until - now_(); left > Clock::duration::zero())
    return {false, static_cast<int>(std::chrono::ceil<std::chrono::seconds>(left).count())};
  if (certificates::fits_password(password, user ? user->password : std::string())) {
    wrong = {};
    return {true};
  }
  constexpr int most_doublings = 6, most_seconds = 60;
  const int seconds = std::min(1 << std::min(wrong.times, most_doublings), most_seconds);
  ++wrong.times;
  wrong.until = now_() + std::chrono::seconds(seconds);
  return {};
}

Expected<std::string> SignIn::begin(const User& user, bool secure) {
  NONIO_TRY(const auto token, random_token());
  NONIO_TRY(const auto name, random_token());
  const std::lock_guard lock(mutex_);
  // Cookies do not distinguish ports, so each server uses its own name.
  if (cookie_.empty()) cookie_ = "nonio-" + name.substr(0, 8);
  const auto now = now_();
  std::erase_if(sessions_, [&](const auto& one) { return now - one.second.since > lasting; });
  std::vector<std::map<std::string, Session>::iterator> own;
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it)
    if (it->second.account == user.account) own.push_back(it);
  if (own.size() >= most_of_account)
    sessions_.erase(*std::min_element(own.begin(), own.end(), [](const auto& a, const auto& b) {
      return a->second.since < b->second.since;
    }));
  sessions_[storage::sha256(token)] = {user.account, user.password, now};
  return cookie_ + "=" + token + cookie_rules +
         "; Max-Age=" + std::to_string(std::chrono::seconds(lasting).count()) +
         (secure ? "; Secure" : "");
}

std::string SignIn::key_of(const Head& head) const {
  const std::string token = cookie_.empty() ? std::string() : cookie_of(head, cookie_);
  return token.empty() ? std::string() : storage::sha256(token);
}

std::optional<User> SignIn::user_of(const Head& head, const std::vector<User>& users) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key_of(head));
  if (found == sessions_.end()) return std::nullopt;
  const Session& session = found->second;
  auto user = certificates::user_with(users, session.account);
  if (user && user->password == session.password_hash && now_() - session.since <= lasting)
    return user;
  sessions_.erase(found);
  return std::nullopt;
}

std::string SignIn::end(const Head& head) {
  const std::lock_guard lock(mutex_);
  sessions_.erase(key_of(head));
  return (cookie_.empty() ? std::string("nonio") : cookie_) + "=" + cookie_rules + "; Max-Age=0";
}

}  // namespace nonio::live
