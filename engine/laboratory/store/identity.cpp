// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/identity.h"

#include <algorithm>
#include <map>

namespace nonio::store {

namespace {

/// Removes differences that are easily overlooked: case, spaces, punctuation, O and 0, I, l and 1.
std::string carelessly(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool ascii = static_cast<unsigned char>(c) < 0x80;
    if (c == 'o' || c == 'O') {
      out += '0';
    } else if (c == 'i' || c == 'I' || c == 'l' || c == 'L') {
      out += '1';
    } else if (c >= 'A' && c <= 'Z') {
      out += static_cast<char>(c - 'A' + 'a');
    } else if (!ascii || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      out += c;
    }
  }
  return out;
}

Spelling pair_of(const NamedMachine& a, const NamedMachine& b, std::string why) {
  const bool first = a.campaigns != b.campaigns ? a.campaigns > b.campaigns : a.name < b.name;
  return {first ? a.name : b.name, first ? b.name : a.name, std::move(why)};
}

}  // namespace

std::string machine_of(const MachineAsStated& m) {
  if (!m.asset.empty()) return m.asset;
  if (m.maker.empty() || m.serial.empty()) return {};
  return m.maker + " " + m.serial;
}

std::vector<Spelling> spellings(const std::vector<NamedMachine>& machines) {
  std::vector<Spelling> found;
  std::map<std::string, std::vector<const NamedMachine*>> alike, numbered;
  for (const NamedMachine& m : machines) {
    if (m.name.empty()) continue;
    if (const std::string key = carelessly(m.name); !key.empty()) alike[key].push_back(&m);
    if (!m.stated.maker.empty() && !m.stated.serial.empty())
      numbered[carelessly(m.stated.maker + " " + m.stated.serial)].push_back(&m);
  }
  const auto propose = [&](const auto& groups, const char* why) {
    for (const auto& [key, group] : groups)
      for (std::size_t i = 1; i < group.size(); ++i) {
        Spelling pair = pair_of(*group.front(), *group[i], why);
        const bool known = std::any_of(found.begin(), found.end(), [&](const Spelling& s) {
          return s.one == pair.one && s.other == pair.other;
        });
        if (!known) found.push_back(std::move(pair));
      }
  };
  propose(alike, "spelled alike");
  propose(numbered, "same maker and serial");
  return found;
}

}  // namespace nonio::store
