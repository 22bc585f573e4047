// SPDX-License-Identifier: Apache-2.0
#include "certificates/users.h"

#include <argon2.h>
#include <sys/random.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "campaign/config/keys/shared.h"
#include "campaign/config/toml_reader.h"
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

namespace {

constexpr std::uint32_t passes = 3, kibibytes = 1U << 16U, lanes = 1;
constexpr std::size_t salt_bytes = 16, hash_bytes = 32;

/// Removes `name`, for example "m=", and a number from 1 to `most` from the beginning of `text`.
bool takes_number(std::string_view& text, std::string_view name, std::uint32_t most,
                  std::uint32_t& number) {
  if (!text.starts_with(name)) return false;
  text.remove_prefix(name.size());
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || number == 0 || number > most) return false;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return true;
}

bool is_base64(std::string_view text, std::size_t shortest) {
  return text.size() >= shortest && text.size() <= 128 &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
                  c == '+' || c == '/';
         });
}

}  // namespace

Expected<std::string> password_hash(std::string_view password) {
  if (password.size() < shortest_password || password.size() > longest_password)
    return fail("expected a password of " + std::to_string(shortest_password) + " to " +
                std::to_string(longest_password) + " bytes");
  if (std::any_of(password.begin(), password.end(),
                  [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }))
    return fail("expected a password without control characters");
  std::array<unsigned char, salt_bytes> salt{};
  if (::getrandom(salt.data(), salt.size(), 0) != static_cast<ssize_t>(salt.size()))
    return fail(std::string("no random numbers: ") + std::strerror(errno));
  std::string out(::argon2_encodedlen(passes, kibibytes, lanes, salt_bytes, hash_bytes, Argon2_id),
                  '\0');
  const int status =
      ::argon2id_hash_encoded(passes, kibibytes, lanes, password.data(), password.size(),
                              salt.data(), salt.size(), hash_bytes, out.data(), out.size());
  if (status != ARGON2_OK) return fail(std::string("no hash: ") + ::argon2_error_message(status));
  out.resize(std::strlen(out.c_str()));
  return out;
}

bool is_password_hash(const std::string& text) {
  std::string_view rest = text;
  constexpr std::string_view begin = "$argon2id$v=19$";
  if (!rest.starts_with(begin)) return false;
  rest.remove_prefix(begin.size());
  constexpr std::uint32_t most_passes = 100, most_lanes = 16;
  std::uint32_t memory = 0, times = 0, threads = 0;
  if (!takes_number(rest, "m=", most_hash_kibibytes, memory) ||
      !takes_number(rest, ",t=", most_passes, times) ||
      !takes_number(rest, ",p=", most_lanes, threads) || !rest.starts_with('$') ||
      memory * times > most_hash_kibibytes)
    return false;
  rest.remove_prefix(1);
  const std::size_t end = rest.find('$');
  constexpr std::size_t shortest_salt = 11, shortest_hash = 22;
  return end != std::string_view::npos && is_base64(rest.substr(0, end), shortest_salt) &&
         is_base64(rest.substr(end + 1), shortest_hash);
}

bool fits_password(std::string_view password, const std::string& hash) {
  if (password.size() > longest_password) return false;
  if (!hash.empty())
    return ::argon2id_verify(hash.c_str(), password.data(), password.size()) == ARGON2_OK;
  std::array<unsigned char, hash_bytes> unused{};
  constexpr std::array<unsigned char, salt_bytes> no_salt{};
  ::argon2id_hash_raw(passes, kibibytes, lanes, password.data(), password.size(), no_salt.data(),
                      no_salt.size(), unused.data(), unused.size());
  return false;
}

}  // namespace nonio::certificates
