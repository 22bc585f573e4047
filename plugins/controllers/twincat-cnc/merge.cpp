// SPDX-License-Identifier: Apache-2.0
#include "merge.h"

#include <optional>

#include "nonio/controllers/text.h"

namespace nonio::twincat_cnc {
namespace {

constexpr std::string_view lose = "getriebe[0].lose";

std::string_view first_word(std::string_view line) {
  const auto words = controllers::words_of(line);
  return words.empty() ? std::string_view() : words.front();
}

bool is_table(std::string_view line) { return first_word(line).starts_with("kw.ssfk."); }

/// "# P-AXIS-00103 getriebe[0].lose = 40"
bool is_word(std::string_view line) {
  return line.starts_with("# P-AXIS-00103 ") && line.find(lose) != std::string_view::npos;
}

std::optional<std::int64_t> number_of(const std::string& list) {
  for (const std::string_view line : controllers::lines_of(list))
    if (const auto words = controllers::words_of(line);
        words.size() > 1 && (words[0] == "kopf.achs_nr" || words[0] == "kopf.log_achs_nr"))
      return controllers::whole(words[1]);
  return std::nullopt;
}

std::string lose_of(std::string_view word) {
  const auto words = controllers::words_of(word.substr(word.find(lose) + lose.size()), " =\t\r");
  return words.empty() ? std::string() : std::string(words.front());
}

}  // namespace

Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  const Artifact* table = nullptr;
  for (const Artifact& f : in.table)
    if (f.bytes.find("kw.ssfk.") != std::string::npos) table = &f;
  const auto number = table == nullptr ? std::nullopt : number_of(table->bytes);
  if (!number) return fail("no new table of axis " + in.axis);
  std::string fresh, value;
  for (const std::string_view line : controllers::lines_of(table->bytes)) {
    if (is_word(line)) value = lose_of(line);
    if (line.starts_with('#') || is_table(line)) fresh += std::string(line) + "\n";
  }
  std::vector<Artifact> out;
  for (const Artifact& f : in.backup) {
    if (number_of(f.bytes) != number) continue;
    if (!out.empty())
      return fail("two files of the backup are lists of axis " + std::to_string(*number));
    const std::string kept =
        controllers::without_origin(f.bytes, "#", in.axis, [](std::string_view) { return true; });
    auto text = *controllers::with_lines(
        kept, [](std::string_view line) { return is_table(line) || is_word(line); }, fresh,
        kept.size());
    if (!value.empty())
      if (auto with_value = controllers::with_lines(
              text, [](std::string_view line) { return first_word(line) == lose; },
              std::string(lose) + "  " + value + "\n", {}))
        text = std::move(*with_value);
    out.push_back({f.name, std::move(text)});
  }
  if (out.empty())
    return fail("the backup holds no list of axis " + std::to_string(*number) +
                " (kopf.achs_nr): load the new list as it is");
  return out;
}

}  // namespace nonio::twincat_cnc
