// SPDX-License-Identifier: Apache-2.0
#include "live/users.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "campaign/config/toml_reader.h"
#include "platform/process/channel.h"
#include "platform/storage/files.h"

namespace nonio::live {
namespace fs = std::filesystem;

namespace {

constexpr std::array roles{"view", "measure", "approve", "administer"};

tl::unexpected<Error> wrong(const toml::node& node, std::string message) {
  return fail(Error{std::move(message), users_name, node.source().begin.line});
}

Expected<User> user_of(const toml::table& table) {
  User user;
  std::string role;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    std::string* const to = name == "account" ? &user.account
                            : name == "name"  ? &user.name
                            : name == "role"  ? &role
                                              : nullptr;
    if (to == nullptr)
      return wrong(node, "unknown key " + name + "; expected account, name and role");
    const auto text = node.value<std::string>();
    if (!text || text->empty()) return wrong(node, name + ": expected a text");
    *to = *text;
  }
  if (user.account.empty() || user.name.empty() || role.empty())
    return wrong(table, "expected account, name and role of a [[user]]");
  const auto* const known =
      std::find_if(roles.begin(), roles.end(), [&](const char* one) { return role == one; });
  if (known == roles.end())
    return wrong(table,
                 "role: expected view, measure, approve or administer, found \"" + role + "\"");
  user.role = static_cast<Role>(known - roles.begin());
  return user;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

}  // namespace

const char* to_text(Role role) { return roles[static_cast<std::size_t>(role)]; }

Expected<std::vector<User>> parse_users(std::string_view text) {
  NONIO_TRY(const auto root, config::parse_toml(text, users_name));
  std::vector<User> out;
  for (const auto& [key, node] : root) {
    if (key.str() == "format" && node.value<std::int64_t>() == 1) continue;
    const toml::array* const all = key.str() == "user" ? node.as_array() : nullptr;
    if (all == nullptr) return wrong(node, "expected format = 1 and [[user]]");
    for (const toml::node& one : *all) {
      const toml::table* const table = one.as_table();
      if (table == nullptr) return wrong(one, "expected [[user]]");
      NONIO_TRY(auto user, user_of(*table));
      for (const User& other : out)
        if (other.account == user.account || other.name == user.name)
          return wrong(*table, "account and name of each [[user]] have to be its own, found \"" +
                                   user.account + "\", \"" + user.name + "\" again");
      out.push_back(std::move(user));
    }
  }
  if (out.empty()) return fail(Error{"expected at least one [[user]]", users_name});
  return out;
}

Expected<std::vector<User>> read_users(const fs::path& site) {
  NONIO_TRY(const auto text, storage::read_small_file(site / users_name));
  return parse_users(text);
}

Expected<void> AuditLog::write(storage::Json entry) {
  storage::Json line = {{"at", utc_now()}};
  line.update(entry);
  const std::string text = storage::dump_line(line) + "\n";
  const std::lock_guard lock(mutex_);
  const process::Handle file(
      ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640));
  if (!file || ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::fdatasync(file.get()) != 0)
    return fail(file_.string() + ": " + std::strerror(errno));
  return {};
}

Expected<std::string> AuditLog::text() const {
  NONIO_TRY(const auto there, storage::is_there(file_));
  return there ? storage::read_file(file_) : std::string();
}

}  // namespace nonio::live
