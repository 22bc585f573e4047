// SPDX-License-Identifier: Apache-2.0
#include "certificates/users.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "campaign/config/toml_reader.h"
#include "certificates/password.h"
#include "certificates/person_name.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

/// Names of the roles in the order of `Role`, as users_file() declares them.
constexpr std::array role_names{"view", "measure", "approve", "administer"};

}  // namespace

const char* to_text(Role role) { return role_names[static_cast<std::size_t>(role)]; }

Expected<std::vector<User>> parse_users(std::string_view text) {
  const std::string file = users_name;
  NONIO_TRY(const auto root, config::parse_toml(text, file));
  std::vector<Error> errors;
  config::TableReader top(root, config::users_file(), file, errors);
  top.integer("format");
  std::vector<User> out;
  for (config::TableReader& reader : top.tables("user")) {
    User user{reader.text("account"), reader.text("name")};
    const auto* const role = std::find(role_names.begin(), role_names.end(), reader.text("role"));
    user.role = static_cast<Role>(role - role_names.begin());
    user.password = reader.text("password");
    if (!user.password.empty() && !is_password_hash(user.password))
      reader.error("password", "expected a line that nonio serve SITE --hash-password has printed");
    if (const std::string mistake = mistake_in_name(user.name); !mistake.empty())
      reader.error("name", mistake);
    for (const User& other : out)
      if (other.account == user.account || likeness_of(other.name) == likeness_of(user.name))
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

bool has_users(const fs::path& site) {
  struct stat info {};
  return ::lstat((site / users_name).c_str(), &info) == 0 || errno != ENOENT;
}

Expected<std::vector<User>> read_users(const fs::path& site) {
  const fs::path file = site / users_name;
  struct stat info {};
  if (::lstat(file.c_str(), &info) == 0) {
    if (S_ISLNK(info.st_mode))
      return fail(
          Error{"it is a symbolic link; expected the file itself, in the folder of the site",
                file.string()});
    if ((info.st_mode & (S_IWGRP | S_IWOTH)) != 0)
      return fail(
          Error{"other users can write it; expected chmod 640 " + file.string(), file.string()});
  }
  NONIO_TRY(const auto text, storage::read_small_file(file));
  return parse_users(text);
}

std::optional<User> user_with(const std::vector<User>& users, const std::string& account) {
  const auto found = std::find_if(users.begin(), users.end(),
                                  [&](const User& one) { return one.account == account; });
  return found == users.end() ? std::nullopt : std::optional(*found);
}

}  // namespace nonio::certificates
