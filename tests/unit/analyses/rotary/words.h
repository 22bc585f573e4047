// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

/// The words of findings and notes, enough of TOML for templates/words/<language>/rotary.toml.
namespace nonio::turntable {

/// Names in the places of the words of each finding and note, by its id: {name}, {name\u00b1U}, {name%}.
inline std::map<std::string, std::set<std::string>> word_places(const std::string& language) {
  std::ifstream in(std::filesystem::path(NONIO_WORDS) / language / "rotary.toml");
  static const std::regex place("(?:\\{|\u00b1)([^{}%\xC2]*)%?(?=\\}|\u00b1)");
  std::map<std::string, std::set<std::string>> out;
  std::string id;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("[finding.\"", 0) == 0) id = line.substr(10, line.find("\"]") - 10);
    if (line.rfind("[note]", 0) == 0) id = "note";
    if (line.empty() || line[0] == '[' || line[0] == '#') continue;
    const std::string key = id == "note" ? line.substr(1, line.find('"', 1) - 1) : id;
    auto& places = out[key];
    for (std::sregex_iterator it(line.begin(), line.end(), place), end; it != end; ++it)
      places.insert((*it)[1]);
  }
  return out;
}

}  // namespace nonio::turntable
