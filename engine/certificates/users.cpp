// SPDX-License-Identifier: Apache-2.0
#include "certificates/users.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>

#include "campaign/config/keys/shared.h"
#include "campaign/config/toml_reader.h"
#include "certificates/password.h"
#include "certificates/person_name.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

struct Users {
  std::vector<User> all;
};

constexpr const char* a_hash = "expected a line that nonio serve SITE --hash-password has printed";

void check_user(config::TableReader& reader, User& user, Users& users) {
  if (!user.password.empty() && !is_password_hash(user.password)) reader.error("password", a_hash);
  if (const std::string mistake = mistake_in_name(user.name); !mistake.empty())
    reader.error("name", mistake);
  for (const User& other : users.all)
    if (&other != &user &&
        (other.account == user.account || likeness_of(other.name) == likeness_of(user.name)))
      reader.error("account", "account and name of each [[user]] have to be its own, found \"" +
                                  user.account + "\", \"" + user.name + "\" again");
}

namespace declared {

using namespace config::declared;

constexpr config::Choice roles[] = {choice(Role::view, "view"), choice(Role::measure, "measure"),
                                    choice(Role::approve, "approve"),
                                    choice(Role::administer, "administer")};

constexpr config::Key user_keys[] = {
    {"account", into<&User::account>,
     "Account, as the reverse proxy states it or the person types it.", required},
    {"name", into<&User::name>, "Name of the person, as documents print it.", required},
    {"role", into<&User::role>,
     "What the person may do; each role may do what those before it may.", required, roles},
    {"password", into<&User::password>,
     "Hash of the password, as `nonio serve SITE --hash-password` prints it.", secret,
     spelled({.letters = "a-zA-Z0-9$=,+/", .begins = "$argon2id$v=19$m="}, a_hash)},
};

constexpr config::Key file_keys[] = {
    format_key,
    {"user", checked<check_user, &Users::all>, "Users of the page of a site, [[user]].", user_keys},
};

constexpr config::Key users_toml{"users.toml", file<Users>,
                                 "Who may do what on the page of a site.", file_keys};

}  // namespace declared
}  // namespace

const config::Key& users_file() { return declared::users_toml; }

const char* to_text(Role role) {
  return declared::roles[static_cast<std::size_t>(role)].name.data();
}

Expected<std::vector<User>> parse_users(std::string_view text) {
  const std::string file = users_name;
  NONIO_TRY(const auto root, config::parse_toml(text, file));
  std::vector<Error> errors;
  config::TableReader top(root, declared::users_toml, file, errors);
  Users users;
  top.fill(users);
  top.finish();
  if (!errors.empty()) return fail(errors.front());
  if (users.all.empty()) return fail(Error{"expected at least one [[user]]", users_name});
  return users.all;
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
