// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "campaign/loader/plugins.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {

namespace {

using storage::Json;

const char* to_text(ControlTable::Sign s) {
  return s == ControlTable::Sign::error ? "error" : "correction";
}
const char* to_text(ControlTable::Entry e) {
  return e == ControlTable::Entry::absolute    ? "absolute"
         : e == ControlTable::Entry::increment ? "increment"
                                               : "position";
}
const char* to_text(ControlTable::Zero z) {
  return z == ControlTable::Zero::free        ? "free"
         : z == ControlTable::Zero::reference ? "reference"
                                              : "machine zero";
}
const char* to_text(ControlTable::Confidence c) {
  return c == ControlTable::Confidence::documented ? "documented"
         : c == ControlTable::Confidence::run      ? "run"
         : c == ControlTable::Confidence::inferred ? "inferred"
                                                   : "unsure";
}

const ControlTable::Fact* sign_fact(const ControlTable& t) {
  for (const ControlTable::Fact& f : t.facts)
    if (f.id == "sign") return &f;
  return nullptr;
}

bool sign_unknown(const ControlTable& t) {
  const auto* f = sign_fact(t);
  return f != nullptr && f->confidence == ControlTable::Confidence::unsure;
}

Json control_json(const Controller& o) {
  const ControlTable& t = o.table;
  Json json = {{"name", o.info.name},
               {"version", o.info.version},
               {"summary", o.info.summary},
               {"table", t.name},
               {"on_request", o.info.opt_in},
               {"takes",
                {{"rotary", t.rotary},
                 {"bidirectional", t.bidirectional},
                 {"straightness", t.straightness},
                 {"squareness", t.squareness},
                 {"volumetric", t.volumetric}}}};
  if (t.points > 0) json["points"] = t.points;
  json["entry"] = to_text(t.entry);
  if (!sign_unknown(t)) json["sign"] = to_text(t.sign);
  json["spacing"] = t.grid == ControlTable::Grid::even ? "even" : "listed";
  json["zero"] = to_text(t.zero);
  json["step_mm"] = printed(t.value_step.linear, Quantity::length);
  if (t.rotary) json["step_deg"] = printed(t.value_step.rotary, Quantity::angle);
  if (t.increment) json["increment"] = {t.increment->first, t.increment->second};
  if (t.largest > 0.0) json["largest"] = t.largest;
  if (!t.backlash.empty()) json["backlash"] = t.backlash;
  json["facts"] = Json::array();
  for (const ControlTable::Fact& f : t.facts)
    json["facts"].push_back(
        {{"id", f.id}, {"confidence", to_text(f.confidence)}, {"says", f.description}});
  return json;
}

std::string cell(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text + " ";
}

/// Without an exponent.
std::string step_text(double mm) {
  std::string text = fixed_text(mm, 9);
  return text.erase(text.find_last_not_of('0') + 1);
}

void print_head() {
  for (const auto& [head, width] : {std::pair{"control", 18},
                                    {"points", 6},
                                    {"both ways", 9},
                                    {"straight", 8},
                                    {"square", 6},
                                    {"volume", 6},
                                    {"sign", 11},
                                    {"entry", 9},
                                    {"digit mm", 9}})
    std::cout << cell(head, static_cast<std::size_t>(width));
  std::cout << "backlash\n";
}

/// Descriptions may begin with the confidence that the line states before them.
std::string without_confidence(const ControlTable::Fact& f) {
  const std::string confidence = std::string(to_text(f.confidence)) + ": ";
  const auto same = [](char a, char b) { return std::tolower(a) == std::tolower(b); };
  const bool repeats =
      f.description.size() > confidence.size() &&
      std::equal(confidence.begin(), confidence.end(), f.description.begin(), same);
  return repeats ? f.description.substr(confidence.size()) : f.description;
}

void print_control(const Controller& o, bool facts) {
  const ControlTable& t = o.table;
  const auto yes = [](bool is, std::size_t width) { return cell(is ? "yes" : "-", width); };
  std::cout << cell(o.info.name, 18) << cell(t.points > 0 ? std::to_string(t.points) : "any", 6)
            << yes(t.bidirectional, 9) << yes(t.straightness, 8) << yes(t.squareness, 6)
            << yes(t.volumetric, 6) << cell(sign_unknown(t) ? "not known" : to_text(t.sign), 11)
            << cell(to_text(t.entry), 9) << cell(step_text(t.value_step.linear * 1e3), 9)
            << (t.backlash.empty() ? "-" : "yes") << "\n";
  if (!facts) return;
  const std::size_t width = line_width(STDOUT_FILENO);
  std::cout << wrapped(o.info.summary, 4, width)
            << wrapped("table: " + t.name + "; zero: " + to_text(t.zero) +
                           (t.backlash.empty() ? "" : "; backlash parameter: " + t.backlash),
                       4, width, 2);
  for (const ControlTable::Fact& f : t.facts)
    std::cout << wrapped(cell(to_text(f.confidence), 11) + without_confidence(f), 4, width, 12);
}

int list_controls(const std::vector<std::string>& names, const Common& common) {
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  std::vector<const Controller*> all;
  for (const Controller& o : plugins.controllers()) all.push_back(&o);
  std::sort(all.begin(), all.end(),
            [](const Controller* a, const Controller* b) { return a->info.name < b->info.name; });
  for (const std::string& name : names)
    if (std::none_of(all.begin(), all.end(),
                     [&](const Controller* o) { return o->info.name == name; })) {
      return complain(plugins.absence("controller", name));
    }
  if (!names.empty())
    std::erase_if(all, [&](const Controller* o) {
      return std::find(names.begin(), names.end(), o->info.name) == names.end();
    });
  if (common.json) {
    Json json = {{"schema", "nonio-controllers/1"}, {"controllers", Json::array()}};
    for (const Controller* o : all) json["controllers"].push_back(control_json(*o));
    print_json(json);
    return exit_done;
  }
  print_head();
  for (const Controller* o : all) print_control(*o, !names.empty());
  return exit_done;
}

}  // namespace

Verb controls_verb(Common& common) {
  auto names = std::make_shared<std::vector<std::string>>();
  return {.name = "controls",
          .summary = "Lists the controls that tables are written for, and what each supports",
          .arguments = joined(
              {{"NAME", names.get(), "Only these controls, with the confidence of each fact"}},
              common_arguments(common)),
          .footer =
              "points: of one table. both ways: a table for each direction of travel. straight, "
              "square: an axis by the position of another. volume: all errors of the machine in "
              "one file. sign: whether an entry is the measured error (actual - nominal) or the "
              "correction. backlash: a parameter of lost motion (with NAME: which). If the sign is "
              "undocumented, no table is written before a sign probe has "
              "shown it (`nonio table probe`). Name the control in the campaign:\n    "
              "[machine]\n    control = \"fagor-8055\"",
          .examples = {"nonio table controls pmac ecmc"},
          .run = [names, &common] { return list_controls(*names, common); }};
}

}  // namespace nonio::app
