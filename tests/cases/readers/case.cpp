// SPDX-License-Identifier: Apache-2.0
#include "case.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

namespace reader_cases {
namespace {

std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// \xHH, \r and \\ of a line of a file in a case.
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      out += text[i];
      continue;
    }
    const char c = text[++i];
    if (c == 'x' && i + 2 < text.size()) {
      out += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      out += c == 'r' ? '\r' : c == 'n' ? '\n' : c;
    }
  }
  return out;
}

bool replace_all(std::string& in, const std::string& from, const std::string& to) {
  bool found = false;
  for (std::size_t at = in.find(from); at != in.npos; at = in.find(from, at + to.size())) {
    in.replace(at, from.size(), to);
    found = true;
  }
  return found;
}

class Parser {
 public:
  Parser(const std::filesystem::path& path, const std::filesystem::path& data)
      : path_(path), data_(data) {}

  std::vector<Case> parse(std::string& error, int& absent) {
    std::ifstream in(path_);
    if (!in) error = "cannot read " + path_.string();
    std::string line;
    while (error.empty() && std::getline(in, line)) {
      ++number_;
      if (!take(line))
        error = path_.filename().string() + ":" + std::to_string(number_) + ": " + line;
    }
    finish();
    absent = absent_;
    return std::move(cases_);
  }

 private:
  void finish() {
    if (open_ && !lacks_file_) cases_.push_back(now_);
    if (open_ && lacks_file_) ++absent_;
    open_ = lacks_file_ = false;
  }
  void begin() {
    open_ = true;
    now_.name = path_.filename().string() + ":" + std::to_string(number_);
    now_.expectations.clear();
  }

  bool take(const std::string& line) {
    if (line.starts_with("|")) {
      if (!in_file_) now_.bytes.clear();
      in_file_ = true;
      now_.bytes += unescaped(line.size() > 2 ? line.substr(2) : "") + "\n";
      return open_;
    }
    in_file_ = false;
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word.empty() || word[0] == '#') return true;
    std::string rest;
    std::getline(words >> std::ws, rest);
    if (word == "reader") {
      finish();
      now_ = Case{};
      now_.reader = rest;
      begin();
      return true;
    }
    if (word == "again") {  // the same file, options and machine
      const bool lacks_file = lacks_file_;
      finish();
      begin();
      lacks_file_ = lacks_file;
      return lacks_file || !now_.bytes.empty();
    }
    return open_ && take_key(word, rest);
  }

  bool take_key(const std::string& word, const std::string& rest) {
    if (word == "axis") return now_.axis = rest, true;
    if (word == "kind") return now_.kind = rest, true;
    if (word == "rotary") return now_.rotary = true, true;
    if (word == "other-axis") return now_.other_axis = rest, true;
    if (word == "serial") return now_.serial = rest, true;
    if (word == "date") return now_.date = rest, true;
    if (word == "slave") return now_.slave = rest, true;
    if (word == "side") return now_.side = rest, true;
    if (word == "expansion") return now_.expansion = std::stod(rest), true;
    if (word == "without-end") return now_.bytes.pop_back(), true;
    if (word == "expect") return now_.expectations.push_back({number_, rest}), true;
    if (word == "option") {
      const std::size_t blank = rest.find(' ');
      now_.options[rest.substr(0, blank)] = blank == rest.npos ? "" : rest.substr(blank + 1);
      return true;
    }
    if (word == "replace") {
      const std::size_t arrow = rest.find(" =>");
      if (arrow == rest.npos) return false;
      return replace_all(now_.bytes, unescaped(rest.substr(0, arrow)),
                         unescaped(rest.substr(std::min(arrow + 4, rest.size()))));
    }
    if (word == "real") {
      lacks_file_ = !std::filesystem::exists(data_ / rest);
      if (!lacks_file_) now_.bytes = file_text(data_ / rest);
      return true;
    }
    return false;
  }

  std::filesystem::path path_, data_;
  std::vector<Case> cases_;
  Case now_;
  bool open_ = false, in_file_ = false, lacks_file_ = false;
  std::size_t number_ = 0;
  int absent_ = 0;
};

}  // namespace

std::vector<Case> read_cases(const std::filesystem::path& path, const std::filesystem::path& data,
                             std::string& error, int& absent) {
  return Parser(path, data).parse(error, absent);
}

}  // namespace reader_cases
