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
#include <string_view>
#include <utility>

#include "campaign/config/keys/shared.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/characters.h"
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

namespace {

using Code = std::uint32_t;

struct Range {
  Code from, to;
};

template <std::size_t N>
bool in(Code c, const std::array<Range, N>& ranges) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [c](const Range& r) { return c >= r.from && c <= r.to; });
}

/// Characters that are variants of others: ligatures, letters of full width, mathematical letters,
/// and circled, raised or lowered characters.
constexpr std::array<Range, 10> forms{{{0x2070, 0x209F},
                                       {0x2100, 0x214F},
                                       {0x2460, 0x24FF},
                                       {0xFB00, 0xFB4F},
                                       {0xFB50, 0xFDFF},
                                       {0xFE30, 0xFE4F},
                                       {0xFE70, 0xFEFE},
                                       {0xFF00, 0xFFEF},
                                       {0x1D400, 0x1D7FF},
                                       {0x1F100, 0x1F1FF}}};
constexpr std::array<Range, 6> blanks{{{0xA0, 0xA0},
                                       {0x1680, 0x1680},
                                       {0x2000, 0x200A},
                                       {0x202F, 0x202F},
                                       {0x205F, 0x205F},
                                       {0x3000, 0x3000}}};
constexpr std::array<Range, 5> marks{
    {{0x300, 0x36F}, {0x1AB0, 0x1AFF}, {0x1DC0, 0x1DFF}, {0x20D0, 0x20FF}, {0xFE20, 0xFE2F}}};

/// Alphabets with letters that look like each other.
enum class Alphabet { none, latin, greek, cyrillic, armenian, cherokee };

Alphabet alphabet_of(Code c) {
  if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z')) return Alphabet::latin;
  if (in(c, std::array<Range, 4>{
                {{0xC0, 0x2AF}, {0x1D00, 0x1DBF}, {0x1E00, 0x1EFF}, {0xA720, 0xA7FF}}}))
    return c == 0xD7 || c == 0xF7 ? Alphabet::none : Alphabet::latin;
  if (in(c, std::array<Range, 2>{{{0x370, 0x3FF}, {0x1F00, 0x1FFF}}})) return Alphabet::greek;
  if (in(c, std::array<Range, 4>{
                {{0x400, 0x52F}, {0x1C80, 0x1C8F}, {0x2DE0, 0x2DFF}, {0xA640, 0xA69F}}}))
    return Alphabet::cyrillic;
  if (in(c, std::array<Range, 1>{{{0x531, 0x58F}}})) return Alphabet::armenian;
  if (in(c, std::array<Range, 2>{{{0x13A0, 0x13FF}, {0xAB70, 0xABBF}}})) return Alphabet::cherokee;
  return Alphabet::none;
}

/// Small Greek and Cyrillic letters and the dotless i, each with a Latin letter of this shape.
constexpr std::array<std::pair<Code, char>, 37> look_alikes{
    {{0x3B1, 'a'}, {0x3B2, 'b'}, {0x3B5, 'e'}, {0x3B6, 'z'}, {0x3B7, 'h'}, {0x3B9, 'i'},
     {0x3BA, 'k'}, {0x3BC, 'm'}, {0x3BD, 'n'}, {0x3BF, 'o'}, {0x3C1, 'p'}, {0x3C4, 't'},
     {0x3C5, 'y'}, {0x3C7, 'x'}, {0x3F2, 'c'}, {0x3F3, 'j'}, {0x430, 'a'}, {0x432, 'b'},
     {0x435, 'e'}, {0x43A, 'k'}, {0x43C, 'm'}, {0x43D, 'h'}, {0x43E, 'o'}, {0x440, 'p'},
     {0x441, 'c'}, {0x442, 't'}, {0x443, 'y'}, {0x445, 'x'}, {0x455, 's'}, {0x456, 'i'},
     {0x458, 'j'}, {0x4AF, 'y'}, {0x4BB, 'h'}, {0x501, 'd'}, {0x51B, 'q'}, {0x51D, 'w'},
     {0x131, 'i'}}};

/// Converts Latin, Greek and Cyrillic letters; other characters are returned unchanged.
Code small(Code c) {
  if (c >= 'A' && c <= 'Z') return c + 32;
  if (c >= 0xC0 && c <= 0xDE && c != 0xD7) return c + 32;
  const bool pairs_from_even =
      (c >= 0x100 && c <= 0x12F) || (c >= 0x132 && c <= 0x137) || (c >= 0x14A && c <= 0x177) ||
      (c >= 0x1DE && c <= 0x1EF) || (c >= 0x1F8 && c <= 0x21F) || (c >= 0x222 && c <= 0x233) ||
      (c >= 0x1E00 && c <= 0x1E95) || (c >= 0x1EA0 && c <= 0x1EFF) || (c >= 0x460 && c <= 0x481) ||
      (c >= 0x48A && c <= 0x4BF) || (c >= 0x4D0 && c <= 0x52F);
  if (pairs_from_even) return c | 1U;
  if ((c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17E)) return c % 2 == 1 ? c + 1 : c;
  if (c == 0x178) return 0xFF;
  if (c >= 0x391 && c <= 0x3A9) return c + 32;
  if (c >= 0x410 && c <= 0x42F) return c + 32;
  if (c >= 0x400 && c <= 0x40F) return c + 80;
  if (c == 0x3F9) return 0x3F2;
  if (c == 0x37F) return 0x3F3;
  return c;
}

bool is_letter_or_digit(Code c) {
  if (c < 0x80) return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  const bool signs = (c >= 0x80 && c <= 0xBF) || (c >= 0x2010 && c <= 0x206F) || c == 0x3001;
  return !signs && !in(c, blanks);
}

std::string mistake_at(Code c, bool after_letter) {
  if (!storage::is_shown(c)) return "an invisible character";
  if (in(c, blanks)) return "a blank that is not the usual one";
  if (in(c, forms)) return "a compatibility character (full width, ligature, formula)";
  if (after_letter && in(c, marks))
    return "an accent apart from its letter; expected the letter with its accent as one character";
  return {};
}

}  // namespace

std::string mistake_in_name(const std::string& name) {
  constexpr std::size_t longest = 100;
  const std::string wanted = "expected the name of a person, one line of up to 100 bytes";
  if (!has_content(name) || name.size() > longest) return wanted;
  Alphabet of_word = Alphabet::none;
  bool after_letter = false;
  for (std::string_view rest = name; !rest.empty();) {
    const storage::Character c = storage::first_of(rest);
    if (c.size == 0) return "the name is not UTF-8; " + wanted;
    if (const std::string mistake = mistake_at(c.code, after_letter); !mistake.empty())
      return "the name has " + mistake + "; " + wanted;
    const Alphabet alphabet = alphabet_of(c.code);
    if (alphabet != Alphabet::none) {
      if (of_word != Alphabet::none && of_word != alphabet)
        return "a word of the name has letters of two alphabets that look alike; " + wanted;
      of_word = alphabet;
    } else if (!is_letter_or_digit(c.code)) {
      of_word = Alphabet::none;
    }
    after_letter = alphabet != Alphabet::none;
    rest.remove_prefix(c.size);
  }
  return {};
}

std::string likeness_of(const std::string& name) {
  std::string out;
  for (std::string_view rest = name; !rest.empty();) {
    const storage::Character c = storage::first_of(rest);
    const std::size_t size = c.size == 0 ? 1 : c.size;
    if (c.size != 0 && is_letter_or_digit(c.code)) {
      const Code letter = small(c.code);
      const auto* like = std::find_if(look_alikes.begin(), look_alikes.end(),
                                      [&](const auto& one) { return one.first == letter; });
      if (like != look_alikes.end())
        out += like->second;
      else if (letter < 0x80)
        out += static_cast<char>(letter);
      else
        out += "<" + std::to_string(letter) + ">";
    }
    rest.remove_prefix(size);
  }
  return out;
}

}  // namespace nonio::certificates
