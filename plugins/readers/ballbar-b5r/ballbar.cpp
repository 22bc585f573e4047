// SPDX-License-Identifier: Apache-2.0
#include "ballbar.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "code_pages.h"
#include "nonio/sdk/fields.h"
#include "runs.h"
#include "xml.h"

namespace nonio::ballbar {
using namespace readers;

namespace {

/// What a value is in, by the attribute DT of its element.
const std::map<std::string, std::string, std::less<>>& units() {
  static const std::map<std::string, std::string, std::less<>> by_type{
      {"UT_LENGTH_UM", "um"},      {"UT_LENGTH_MM", "mm"},  {"UT_LENGTH_M", "m"},
      {"UT_FEEDRATE", "mm/min"},   {"UT_SPEED", "mm/s"},    {"UT_SQUARENESS", "um/m"},
      {"UT_SERVO_MISMATCH", "ms"}, {"UT_ANGLE", "deg"},     {"UT_SCALE_ERROR", "ppm"},
      {"UT_PERCENT", "%"},         {"UT_RANKING", "(rank)"}};
  return by_type;
}

/// One line of words: notes have no other.
std::string plain(const std::string& text) { return decoded(text, "utf-8").value_or(""); }

/// What a result is of, by where it stands in the file.
struct Part {
  enum class Kind { none, run, analysis };
  Kind kind = Kind::none;
  std::uint64_t element = 0;  ///< number of the element that holds it
};

struct Feature {
  Element element;
  Part of;
};

struct Contents {
  std::map<std::string, std::string> header;  ///< by what it is called in the note
  std::vector<Feature> features;
  std::vector<std::uint64_t> runs;                 ///< elements, in the order of the file
  std::map<std::uint64_t, std::string> direction;  ///< of a run: CCW, CW
  std::map<std::uint64_t, std::string> analysis;   ///< its name
  std::set<std::string> axis_a, axis_b;            ///< as the planes of the file name them
};

Part part_of(const std::vector<Element>& within) {
  for (auto e = within.rbegin(); e != within.rend(); ++e) {
    if (e->name == "BALLBAR_RUN") return {Part::Kind::run, e->number};
    if (e->name == "ANALYSIS") return {Part::Kind::analysis, e->number};
  }
  return {};
}

void take(const Element& e, const std::vector<Element>& within, Contents& c) {
  static constexpr std::array<std::array<const char*, 3>, 11> wanted{
      {{"PLANE", "TEST_PLANE", "plane"},
       {"A_AXIS_NAME", "", "axis A"},
       {"B_AXIS_NAME", "", "axis B"},
       {"TEST_SPEC", "NAME", "test"},
       {"MACHINE_TESTED", "NAME", "machine"},
       {"OPERATOR", "", "operator"},
       {"DATE_STARTED", "", "started"},
       {"SERIAL_NUMBER", "", "ballbar"},
       {"LAST_CALIBRATED", "", "calibrated"},
       {"PART_NUMBER", "", "part"},
       {"PROGRAMMED_FEEDRATE", "", "feed rate"}}};
  if (e.name == "BALLBAR_RUN") c.runs.push_back(e.number);
  if (e.name == "ANALYSIS") c.analysis.emplace(e.number, plain(e.attribute("NAME")));
  if (e.name == "FEATURE") c.features.push_back({e, part_of(within)});
  if (e.name == "RUN_DIRECTION")
    if (const Part run = part_of(within); run.kind == Part::Kind::run) {
      const auto [known, fresh] = c.direction.emplace(run.element, plain(e.text));
      if (!fresh && known->second != plain(e.text)) known->second += "/" + plain(e.text);
    }
  if (e.name == "A_AXIS_NAME") c.axis_a.insert(plain(e.text));
  if (e.name == "B_AXIS_NAME") c.axis_b.insert(plain(e.text));
  for (const auto& [element, attribute, called] : wanted) {
    if (e.name != element) continue;
    const std::string value = plain(*attribute == 0 ? e.text : e.attribute(attribute));
    if (!value.empty()) c.header.try_emplace(called, value);
  }
}

/// AF_BACKLASH_A_POS as "AF_BACKLASH_A_POS (A = X)", where the file names one axis A only.
std::string with_axis(const std::string& name, const Contents& c) {
  for (const auto& [letter, axes] : {std::pair{"A", &c.axis_a}, {"B", &c.axis_b}}) {
    const std::string place = std::string("_") + letter;
    const bool of_it = name.ends_with(place) || name.find(place + "_") != name.npos;
    if (of_it && axes->size() == 1 && !axes->begin()->empty())
      return name + " (" + letter + " = " + *axes->begin() + ")";
  }
  return name;
}

/// "1 CCW": the number of the run in the file, and its direction where the file says it.
std::string run_words(std::uint64_t element, const Contents& c) {
  const auto at = std::find(c.runs.begin(), c.runs.end(), element);
  const auto direction = c.direction.find(element);
  return std::to_string(at - c.runs.begin() + 1) +
         (direction == c.direction.end() ? "" : " " + direction->second);
}

Expected<Remark> feature_note(const Feature& feature, const Contents& contents) {
  const Element& e = feature.element;
  const std::string name = plain(e.attribute("NAME")), type = e.attribute("DT");
  const auto unit = units().find(type);
  if (name.empty() || (unit == units().end() && !type.empty()))
    return fail(at_line(e.line, "expected a FEATURE with NAME and a known DT (unit), found NAME " +
                                    shown(name) + " and DT " + shown(type)));
  if (!type.empty()) {
    Numbers numbers(true);
    const auto value = numbers.reading(e.text, e.line, "the value of " + shown(name));
    if (!value) return fail(value.error());
  }
  Remark note{type.empty() ? "ballbar.feature-no-unit" : "ballbar.feature",
              {},
              {{"name", with_axis(name, contents)},
               {"value", plain(e.text)},
               {"line", std::to_string(e.line)}}};
  if (!type.empty()) note.texts.emplace_back("unit", unit->second);
  if (feature.of.kind == Part::Kind::run) {
    note.id += "-run";
    note.texts.emplace_back("run", run_words(feature.of.element, contents));
  } else if (feature.of.kind == Part::Kind::analysis) {
    note.id += "-analysis";
    note.texts.emplace_back("analysis", contents.analysis.at(feature.of.element));
  }
  return note;
}

Expected<Observations> read_file(const ReadInput& input) {
  Contents contents;
  const auto scanned = for_each_element(
      input.bytes,
      [&](const Element& e, const std::vector<Element>& within) { take(e, within, contents); });
  if (!scanned) return fail(scanned.error());
  if (contents.features.empty()) return fail("expected results (elements FEATURE), found none");
  std::sort(contents.runs.begin(), contents.runs.end());
  Observations obs;
  obs.measurement = input.measurement.id;
  std::string header;
  for (const auto& [called, value] : contents.header)
    header += (header.empty() ? "" : ", ") + called + " " + value;
  obs.notes.push_back({"ballbar.header", {}, {{"text", header}}});
  for (const Feature& f : contents.features) {
    auto note = feature_note(f, contents);
    if (!note) return fail(note.error());
    obs.notes.push_back(std::move(*note));
  }
  return obs;
}

Expected<Observations> read(const ReadInput& input) {
  if (input.measurement.kind == "circle") {
    Error error{
        "expected the path of the circle; where it lies in a file of Ballbar 20 (.b5r) is not "
        "known. "
        "Export the path as text with direction, angle_deg and deviation_um, or list the results "
        "of "
        "this file as kind = \"ballbar\""};
    error.file = input.measurement.file;
    return fail(std::move(error));
  }
  auto obs = read_file(input);
  if (!obs) obs.error().file = input.measurement.file;
  return obs;
}

/// XML with names of such a file; which root it has is not known.
bool recognises(std::string_view head) {
  const std::string_view text = trimmed(without_mark(head));
  if (!text.starts_with('<')) return false;
  for (const char* name : {"BALLBAR", "Ballbar", "<TEST_SPEC", "TEST_PLANE", "<FEATURE"})
    if (text.find(name) != text.npos) return true;
  return false;
}

}  // namespace

Reader reader() {
  Reader r;
  r.info = {"ballbar-b5r", "1.0",
            "Header and results of Renishaw's Ballbar 20 (.b5r), as notes; no readings."};
  r.recognises = recognises;
  r.reads = [](std::string_view kind) { return kind == "ballbar" || kind == "circle"; };
  r.read = read;
  return r;
}

}  // namespace nonio::ballbar
