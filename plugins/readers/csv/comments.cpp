// SPDX-License-Identifier: Apache-2.0
#include "comments.h"

#include <algorithm>
#include <optional>

#include "lines.h"
#include "nonio/sdk/fields.h"
#include "runs.h"

namespace nonio::csv {
using namespace readers;
namespace {

constexpr std::size_t head_and_foot = 65536;  ///< bytes that are checked at each end

/// A word of a comment in lower case, with the adjacent characters.
struct Word {
  std::string text;
  char before = ' ', behind = ' ';
};

std::vector<Word> words_of(std::string_view comment) {
  std::vector<Word> words;
  char before = ' ';
  for (std::size_t i = 0; i < comment.size();) {
    const auto belongs = [&](char c) {
      return readers::detail::is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
             static_cast<unsigned char>(c) >= 0x80;
    };
    if (!belongs(comment[i])) {
      if (comment[i] != ' ' && comment[i] != '\t') before = comment[i];
      ++i;
      continue;
    }
    Word& word = words.emplace_back();
    word.before = std::exchange(before, ' ');
    for (; i < comment.size() && belongs(comment[i]); ++i)
      word.text +=
          comment[i] >= 'A' && comment[i] <= 'Z' ? static_cast<char>(comment[i] + 32) : comment[i];
    const std::size_t next = std::min(comment.find_first_not_of(" \t", i), comment.size());
    word.behind = next == comment.size() ? '.' : comment[next];
  }
  return words;
}

enum class About { nothing, deviation, target, all };

struct Stem {
  std::string_view text;
  About about;
};
/// Start of a word, or any part of it in languages without spaces.
constexpr Stem stems[] = {{"deviation", About::deviation},
                          {"abweichung", About::deviation},
                          {"scostament", About::deviation},
                          {"deviazion", About::deviation},
                          {"desviaci", About::deviation},
                          {"error", About::deviation},
                          {"fehler", About::deviation},
                          {"偏差", About::deviation},
                          {"误差", About::deviation},
                          {"target", About::target},
                          {"soll", About::target},
                          {"position", About::target},
                          {"posizion", About::target},
                          {"posici", About::target},
                          {"quot", About::target},
                          {"目标", About::target},
                          {"位置", About::target},
                          {"unit", About::all},
                          {"einheit", About::all},
                          {"unidad", About::all},
                          {"单位", About::all}};

About about(const Word& word) {
  for (const Stem& stem : stems)
    if (static_cast<unsigned char>(stem.text[0]) >= 0x80
            ? word.text.find(stem.text) != word.text.npos
            : word.text.starts_with(stem.text))
      return stem.about;
  return About::nothing;
}

constexpr std::string_view fillers[] = {
    "in",      "en",    "is",     "are",    "sind",   "ist", "the", "values", "werte", "valori",
    "valores", "given", "stated", "column", "spalte", "of",  "all", "alle",   "sono",  "son"};

/// Returns the unit as in column names, or an empty text. "m" and "in" are units only in brackets.
std::string_view unit_in(const Word& word) {
  struct Name {
    std::string_view word, unit;
  };
  static constexpr Name names[] = {
      {"um", "um"},         {"µm", "um"},         {"μm", "um"},
      {"micron", "um"},     {"microns", "um"},    {"micrometer", "um"},
      {"micrometre", "um"}, {"mikrometer", "um"}, {"微米", "um"},
      {"nm", "nm"},         {"nanometer", "nm"},  {"nanometre", "nm"},
      {"纳米", "nm"},       {"mm", "mm"},         {"millimeter", "mm"},
      {"millimetre", "mm"}, {"毫米", "mm"},       {"cm", "cm"},
      {"inch", "inch"},     {"inches", "inch"},   {"zoll", "inch"},
      {"pollici", "inch"},  {"pulgadas", "inch"}, {"mil", "mil"},
      {"mils", "mil"},      {"thou", "mil"},      {"deg", "deg"},
      {"degree", "deg"},    {"degrees", "deg"},   {"grad", "deg"},
      {"gradi", "deg"},     {"arcsec", "arcsec"}, {"bogensekunden", "arcsec"},
      {"arcmin", "arcmin"}, {"rad", "rad"},       {"mrad", "mrad"},
      {"urad", "urad"},     {"µrad", "urad"},     {"pm", "pm"}};
  for (const Name& name : names)
    if (word.text == name.word) return name.unit;
  const bool in_brackets =
      (word.before == '[' && word.behind == ']') || (word.before == '(' && word.behind == ')');
  const bool stated = in_brackets || word.before == ':' || word.before == '=';
  if (word.text == "m" && stated && (in_brackets || word.behind == '.')) return "m";
  if (word.text == "in" && in_brackets) return "inch";
  return {};
}

struct Contradiction {
  std::string_view unit;
  std::string column;
};

/// A unit in the comment that contradicts the column to which it refers.
std::optional<Contradiction> wrong_unit_in(const std::vector<Word>& words, const Header& header,
                                           const Expectation& e) {
  const std::string_view target = e.rotary ? "deg" : "mm";
  const std::string_view deviation = header.reading_is_position ? std::string_view()
                                     : e.angular_reading()      ? "arcsec"
                                                                : "um";
  About now = About::nothing;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Word& word = words[i];
    if (const About next = about(word); next != About::nothing) {
      if (next != About::all || now == About::nothing) now = next;
      continue;
    }
    const std::string_view unit = unit_in(word);
    const bool thermal = unit == "deg" && i + 1 < words.size() &&
                         (words[i + 1].text == "c" || words[i + 1].text == "f");
    if (!unit.empty() && !thermal) {
      const bool of_target = now == About::target && unit != target;
      const bool of_deviation = now == About::deviation && !deviation.empty() && unit != deviation;
      const bool of_none = now == About::all && unit != target && unit != deviation;
      if (of_target) return Contradiction{unit, e.target()};
      if (of_deviation || (of_none && !deviation.empty()))
        return Contradiction{unit, e.deviation()};
      if (of_none) return Contradiction{unit, e.target()};
      now = About::nothing;
      continue;
    }
    if (std::find(std::begin(fillers), std::end(fillers), word.text) == std::end(fillers))
      now = About::nothing;
  }
  return std::nullopt;
}

/// The axis Y of "axis: Y", if it is another axis of the machine.
std::optional<std::string> other_axis(const std::vector<Word>& words, const ReadInput& input) {
  constexpr std::string_view names[] = {"axis", "achse", "asse", "eje", "轴"};
  const Measurement& m = input.measurement;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (std::find(std::begin(names), std::end(names), words[i].text) == std::end(names)) continue;
    const Word& value = words[i + 1];
    if ((value.before != ':' && value.before != '=') ||
        std::string_view(".,;)").find(value.behind) == std::string_view::npos)
      continue;
    std::string name = value.text;
    for (char& c : name) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
    if (name == m.axis || name == m.lateral) continue;
    if (is_other_axis(input.campaign.machine, m, name) ||
        (!m.axis.empty() && is_other_letter(m.axis, name)))
      return name;
  }
  return std::nullopt;
}

}  // namespace

Ends ends_of(std::string_view bytes) {
  if (bytes.size() <= 2 * head_and_foot) return {std::string(bytes), {}};
  const std::size_t after_head = bytes.rfind('\n', head_and_foot - 1) + 1;
  const std::size_t foot = bytes.rfind('\n', bytes.size() - head_and_foot - 2) + 1;
  return {std::string(bytes.substr(0, after_head)),
          std::string(bytes.substr(std::max(after_head, foot)))};
}

void doubt_comments(const ReadInput& input, const Ends& ends, std::uint64_t last_line,
                    const Header& header, const Expectation& expectation, Observations& obs) {
  bool unit = false, axis = false;
  const auto look = [&](std::string_view text, std::uint64_t before) {
    Lines lines(text);
    std::string_view line;
    while (!(unit && axis) && lines.next(line)) {
      if (content_of(line) != Content::comment) continue;
      const auto words = words_of(line.substr(line.find('#') + 1));
      const std::string where =
          input.measurement.file + ":" + std::to_string(before + lines.number());
      const auto add = [&](const char* id, const std::string& found, const std::string& expected) {
        obs.doubts.push_back(
            {.id = id,
             .attention = true,
             .texts = {{"where", where}, {"found", found}, {"expected", expected}}});
      };
      if (const auto wrong = unit ? std::nullopt : wrong_unit_in(words, header, expectation)) {
        add("plausibility.comment-unit", std::string(wrong->unit), wrong->column);
        unit = true;
      }
      if (const auto other = axis ? std::nullopt : other_axis(words, input)) {
        add("plausibility.name-of-another", *other,
            control_axis(input.campaign.machine, input.measurement));
        axis = true;
      }
    }
  };
  look(ends.head, 0);
  Lines counted(ends.foot);
  std::string_view line;
  while (counted.next(line)) {
  }
  look(ends.foot, last_line - counted.number());
}

}  // namespace nonio::csv
