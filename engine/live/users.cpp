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

/// As users_file() declares them.
constexpr std::array roles{"view", "measure", "approve", "administer"};

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
  const std::string file = users_name;
  NONIO_TRY(const auto root, config::parse_toml(text, file));
  std::vector<Error> errors;
  config::TableReader top(root, config::users_file(), file, errors);
  top.integer("format");
  std::vector<User> out;
  for (config::TableReader& reader : top.tables("user")) {
    User user{reader.text("account"), reader.text("name")};
    const std::string role = reader.text("role");
    user.role = static_cast<Role>(std::find(roles.begin(), roles.end(), role) - roles.begin());
    for (const User& other : out)
      if (other.account == user.account || other.name == user.name)
        reader.error("account", "account and name of each [[user]] have to be its own, found \"" +
                                    user.account + "\", \"" + user.name + "\" again");
    reader.finish();
    out.push_back(std::move(user));
  }
  top.finish();
  if (!errors.empty()) return fail(errors.front());
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
