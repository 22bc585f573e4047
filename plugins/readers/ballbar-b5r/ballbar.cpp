// SPDX-License-Identifier: Apache-2.0
#include "ballbar.h"

#include <array>
#include <map>

#include "code_pages.h"
#include "fields.h"
#include "runs.h"
#include "xml.h"

namespace nonio::ballbar {
using namespace reading;

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

struct Contents {
  std::map<std::string, std::string> header;  ///< by what it is called in the note
  std::vector<Element> features;
};

void take(const Element& e, Contents& c) {
  static constexpr std::array<std::array<const char*, 3>, 8> wanted{
      {{"PLANE", "TEST_PLANE", "plane"},
       {"TEST_SPEC", "NAME", "test"},
       {"MACHINE_TESTED", "NAME", "machine"},
       {"OPERATOR", "", "operator"},
       {"DATE_STARTED", "", "started"},
       {"SERIAL_NUMBER", "", "ballbar"},
       {"LAST_CALIBRATED", "", "calibrated"},
       {"PART_NUMBER", "", "part"}}};
  if (e.name == "FEATURE") c.features.push_back(e);
  for (const auto& [element, attribute, called] : wanted) {
    if (e.name != element) continue;
    const std::string value = plain(*attribute == 0 ? e.text : e.attribute(attribute));
    if (!value.empty()) c.header.try_emplace(called, value);
  }
}

Expected<Remark> feature_note(const Element& e) {
  const std::string name = plain(e.attribute("NAME")), type = e.attribute("DT");
  const auto unit = units().find(type);
  if (name.empty() || unit == units().end())
    return fail(at_line(e.line, "wanted a FEATURE with NAME and a known DT (unit), found NAME " +
                                    shown(name) + " and DT " + shown(type)));
  Numbers numbers(true);
  const auto value = numbers.reading(e.text, e.line, "the value of " + shown(name));
  if (!value) return fail(value.error());
  return Remark{
      "ballbar.feature", {}, {{"name", name}, {"value", plain(e.text)}, {"unit", unit->second}}};
}

Expected<Observations> read_file(const ReadInput& input) {
  Contents contents;
  const auto scanned = for_each_element(input.bytes, [&](const Element& e) { take(e, contents); });
  if (!scanned) return fail(scanned.error());
  if (contents.features.empty()) return fail("wanted results (elements FEATURE), found none");
  Observations obs;
  obs.measurement = input.measurement.id;
  std::string header;
  for (const auto& [called, value] : contents.header)
    header += (header.empty() ? "" : ", ") + called + " " + value;
  obs.notes.push_back({"ballbar.header", {}, {{"text", header}}});
  for (const Element& e : contents.features) {
    auto note = feature_note(e);
    if (!note) return fail(note.error());
    obs.notes.push_back(std::move(*note));
  }
  return obs;
}

Expected<Observations> read(const ReadInput& input) {
  auto obs = read_file(input);
  if (!obs) obs.error().file = input.measurement.file;
  return obs;
}

/// XML with names of such a file; which root it has is not known.
bool recognises(std::string_view head) {
  const std::string_view text = trimmed(head.starts_with("\xEF\xBB\xBF") ? head.substr(3) : head);
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
  r.reads = [](std::string_view kind) { return kind == "ballbar"; };
  r.read = read;
  return r;
}

}  // namespace nonio::ballbar
