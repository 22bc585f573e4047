// SPDX-License-Identifier: Apache-2.0
#include "tables.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <set>

#include "campaign/modelling/model_json.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_numbers.h"
#include "platform/storage/nearest.h"
#include "text_layout.h"

namespace nonio::app {
using config::TerminalWords;
using storage::Json;

void line(std::ostream& out, const std::string& name, const std::string& value) {
  const std::size_t width = std::max<std::size_t>(18, columns_of(name) + 2);
  out << "  " << padded(name, width)
      << wrapped(value, width + 2, sentence_width(STDOUT_FILENO)).substr(width + 2);
}

void sentence(std::ostream& out, std::size_t indent, const std::string& text) {
  if (!text.empty()) out << wrapped(text, indent, sentence_width(STDOUT_FILENO), 2);
}

namespace {

constexpr std::size_t bar_width = 40;

/// Returns part / whole as a bar of `width` columns, with "|" at the value `mark`.
std::string bar(double part, double whole, std::size_t width, std::optional<double> mark = {}) {
  const auto cells = [&](double value) {
    const double share = whole > 0.0 ? std::clamp(value / whole, 0.0, 1.0) : 0.0;
    return static_cast<std::size_t>(std::lround(share * static_cast<double>(width)));
  };
  std::string text(cells(part), '#');
  text.resize(width, ' ');
  if (mark) {
    const std::size_t at = std::min(cells(*mark), width - 1);
    text[at] = '|';
  }
  return text;
}

std::string p_text(double p, const TerminalWords& say) {
  return p < 1e-4 ? "< " + say.number("0.0001") : say.number(short_text(p, 2));
}

std::string text_in(const Json& json, const char* name) { return json.value(name, ""); }

std::string list_in(const Json& json, const char* name) {
  return storage::listed(json.at(name).get<std::vector<std::string>>());
}

double size_in(const Json& json, const std::string& name) {
  const auto found = storage::get(json, name);
  return found ? found->value : 0.0;
}

void sentences(std::ostream& out, const Json& list, const std::string& label = {}) {
  for (const Json& one : list)
    sentence(out, 2, label + (one.is_string() ? one : one.at("says")).get<std::string>());
}

/// Reversal spikes of a circle can be many readings.
void print_suspects(std::ostream& out, const Json& part, const TerminalWords& say) {
  constexpr std::size_t most = 5;
  const Json& all = part.at("suspects");
  const std::size_t shown = all.size() > most + 1 ? most : all.size();
  for (std::size_t i = 0; i < shown; ++i)
    sentence(out, 2, say("suspect") + ": " + text_in(all[i], "says"));
  if (shown < all.size())
    sentence(out, 2, say("suspects.more", {{"count", std::to_string(all.size() - shown)}}));
}

void print_floor(std::ostream& out, const Json& part, const TerminalWords& say) {
  if (storage::get(part, "noise_floor"))
    line(out, say("floor"),
         with_unit(part, "noise_floor", say) + ", u = " + with_unit(part, "noise_floor_u", say));
}

void print_head(std::ostream& out, const Json& part, const TerminalWords& say) {
  const std::string effects = list_in(part.at("model"), "effects");
  sentence(out, 0,
           say("head." + text_in(part, "kind")) + " " + text_in(part, "axis") + " (" +
               say.counted("head.from", part.at("measurements").size(),
                           {{"ids", list_in(part, "measurements")}}) +
               "): " +
               say("head.readings", {{"count", part.at("observations").dump()},
                                     {"model", effects.empty() ? say("head.empty") : effects}}));
}

void print_parameter(std::ostream& out, const Json& p, const TerminalWords& say) {
  out << padded(text_in(p, "name"), 8) << " ";
  if (p.contains("held")) {
    out << text_in(p, "written") << "  " << say("held") << "\n";
    return;
  }
  const double value = p.value("value", NAN);
  const bool is_count = p.contains("value") && p.at("value").is_number_integer();
  if (const auto both = rounded_result(value, p.value("u", NAN)); both && !is_count)
    out << say.number(both->value) << ", u = " << say.number(both->U);
  else
    out << say.number(is_count ? fixed_text(value, 0) : short_text(value, 4));
  const std::string unit = p.at("unit");
  out << (unit.empty() ? "" : " ") << unit;
  if (p.contains("of_manifest")) out << "  " << say("stated.manifest");
  if (p.contains("searched")) out << "  " << say(p.contains("stated") ? "stated" : "searched");
  out << "\n";
}

void print_parameters(std::ostream& out, const Json& model, const TerminalWords& say) {
  if (model.at("parameters").empty()) return;
  out << "  " << say("parameters") << "\n";
  std::map<std::string, std::string> curves;
  for (const Json& curve : model.value("curves", Json::array()))
    curves.emplace(curve.at("effect"), curve.at("says"));
  std::string last_curve;
  for (const Json& p : model.at("parameters")) {
    const std::string effect = p.at("effect");
    const auto curve = curves.find(effect);
    const bool is_curve = curve != curves.end() && !p.contains("searched");
    if (is_curve && last_curve == effect) continue;
    out << "    " << padded(effect, 20) << " ";
    if (is_curve)
      out << curve->second << "\n", last_curve = effect;
    else
      print_parameter(out, p, say);
  }
}

std::string where_text(const Json& place, const TerminalWords& say) {
  const std::string names = place.at("where");
  const std::size_t by = names.find(" x ");
  std::string text = say.of("where", names.substr(0, by));
  if (by != std::string::npos) text += " x " + say.of("where", names.substr(by + 3));
  return place.contains("line") ? text + " (" + text_in(place, "line") + ")" : text;
}

void print_places(std::ostream& out, const Json& part, const TerminalWords& say) {
  if (part.at("fails").empty()) {
    const auto floor = storage::get(part, "noise_floor"),
               rms = storage::get(part.at("model"), "rms");
    if (!floor || !rms || !(floor->value > 0.0))
      return line(out, say("fails"), say("fails.nowhere"));
    const std::string times = say.number(short_text(rms->value / floor->value));
    return line(out, say("fails"), say("fails.nowhere-times", {{"times", times}}));
  }
  out << "  " << say("fails") << "\n";
  for (const Json& place : part.at(part.at("left").empty() ? "fails" : "left"))
    out << "    " << padded(where_text(place, say) + " ", 29)
        << wrapped(text_in(place, "says"), 33, sentence_width(STDOUT_FILENO)).substr(33);
}

/// Prints the error predicted after compensation, if a table can compensate an effect of the model.
void print_after_table(std::ostream& out, const Json& part, const TerminalWords& say) {
  if (!part.contains("after_table")) return;
  const Json& predicted = part.at("after_table");
  line(out, say("after-table"),
       say("after-table.rms", {{"before", with_unit(predicted, "rms_before", say)},
                               {"after", with_unit(predicted, "rms", say)},
                               {"effects", list_in(predicted, "takes")}}));
  for (const Json& test : predicted.at("tests")) {
    std::string text;
    for (const char* name : {"E", "A", "R"})
      if (storage::get(test.at("before"), name))
        text += (text.empty() ? ": " : ", ") + std::string(name) + " " +
                with_unit(test.at("before"), name, say) + " -> " +
                with_unit(test.at("after"), name, say);
    if (!text.empty()) line(out, "", text_in(test, "measurement") + text);
  }
}

std::string largest_text(const Json& largest, const TerminalWords& say) {
  Number target = storage::get(largest, "target").value_or(Number{});
  target.name.clear();
  const bool has_run = largest.contains("run");
  std::string text = say(has_run ? "largest.at" : "largest.in-time",
                         {{"value", with_unit(largest, "residual", say)},
                          {"position", say.number(evidence_text(target)) + " " +
                                           std::string(unit_of(target.quantity).symbol)},
                          {"run", has_run ? largest.at("run").dump() : ""}});
  if (largest.contains("direction"))
    text += ", " + say("largest.direction", {{"direction", text_in(largest, "direction")}});
  text += ", " + text_in(largest, "file");
  return largest.contains("line") ? text + ":" + largest.at("line").dump() : text;
}

void print_candidates(std::ostream& out, const Json& part, bool all, const TerminalWords& say) {
  std::vector<Json> shown;
  std::size_t left = 0;
  for (const Json& c : part.at("candidates"))
    if (all ? c.value("score", 0.0) > 0.0 : c.contains("best"))
      shown.push_back(c);
    else if (c.value("score", 0.0) > 0.0)
      ++left;
  if (shown.empty()) return;
  double best = 0.0;
  for (const Json& c : shown) best = std::max(best, c.at("score").get<double>());
  const auto width = [&](const char* name, std::size_t least) {
    return std::max(least, columns_of(say(name)) + 2);
  };
  const std::size_t alone = width("evidence.alone", 9), within = width("evidence.within", 10),
                    after = width("rms-after", 14), left_out = width("left-out", 18);
  out << "  " << padded(say("candidate"), 22) << padded(say("evidence"), 13)
      << padded(say("evidence.alone"), alone) << padded(say("evidence.within"), within)
      << padded(say("rms-after"), after) << padded(say("left-out"), left_out) << "p\n";
  const auto evidence = [&](double score) {
    return score > 0.0 ? say.number(fixed_text(score, 1)) : "-";
  };
  for (const Json& c : shown)
    out << "  " << padded(text_in(c, "effect") + " ", 22) << bar(c.at("score"), best, 12) << " "
        << padded(evidence(c.value("score_alone", 0.0)), alone)
        << padded(evidence(c.value("score_within", 0.0)), within)
        << padded(with_unit(c, "rms", say), after) << padded(with_unit(c, "cv_rms", say), left_out)
        << p_text(c.value("p", NAN), say) << "\n";
  if (left > 0) out << "  " << say("show.more", {{"count", std::to_string(left)}}) << " (--all)\n";
}

/// States the counts that the search used, and that of the effect, or of all effects.
void print_priors(std::ostream& out, const Json& part, const Json& effects,
                  const std::string& effect) {
  if (!part.contains("priors")) return;
  sentence(out, 2, text_in(part.at("priors"), "says"));
  for (const Json& e : effects)
    if (e.contains("prior") && (effect.empty() || e.at("effect") == effect))
      sentence(out, 4, text_in(e.at("prior"), "says"));
}

/// Prints the effects that the best explanation adds, if there are several; for the verdict
/// "unknown" only those that are not significant.
void print_set(std::ostream& out, const Json& part, const TerminalWords& say) {
  const bool unknown = part.at("verdict").at("kind") == "unknown";
  const Json& significant = part.at("significant");
  std::vector<std::string> names;
  for (const Json& name : part.at("together"))
    if (!unknown || std::find(significant.begin(), significant.end(), name) == significant.end())
      names.push_back(name);
  if (names.size() > (unknown ? 0U : 1U))
    sentence(out, 2,
             say(unknown ? "together.unknown" : "together") + ": " + storage::listed(names));
}

void print_advice(std::ostream& out, const Json& part, const std::string& folder,
                  const TerminalWords& say) {
  const Json& verdict = part.at("verdict");
  const std::string effect = text_in(verdict, "effect");
  sentences(out, part.at("descriptions"));
  for (const auto& [what, label] : {std::pair{"is", "why"}, {"remedy", "do"}})
    if (verdict.contains(what)) sentence(out, 2, say(label) + ": " + text_in(verdict, what));
  for (const Json& c : part.at("candidates"))
    if (c.contains("prior_price") && c.at("effect") == effect)
      sentence(out, 2, say("rare", {{"price", say.number(fixed_text(c.at("prior_price"), 1))}}));
  const bool only_plans = !part.at("plans").empty() && !part.contains("sensors");
  sentences(out, part.at("next"), say(only_plans ? "next.apart" : "next") + ": ");
  if (verdict.at("kind") == "missing" && !effect.empty())
    out << "  " << say("command") << ": nonio model add " << folder << " "
        << text_in(verdict, "entry") << "\n";
}

void print_limits(std::ostream& out, const Json& part, bool all, const TerminalWords& say) {
  sentence(out, 2, text_in(part, "false_alarms"));
  sentence(out, 2, text_in(part, "no_sign"));
  std::vector<std::string> untested;
  for (const Json& one : part.at("unseen")) {
    // Effects that need a longer test are listed in the JSON output only.
    if (one.at("why_not") == "short-test") continue;
    if (all)
      sentence(out, 2, text_in(one, "says"));
    else
      untested.push_back(one.at("effect"));
  }
  if (!untested.empty())
    sentence(out, 2, say("untested", {{"effects", storage::listed(untested)}}));
}

void print_foresight(std::ostream& out, const Json& what_if, const TerminalWords& say) {
  out << "  " << say("what-if") << (what_if.empty() ? ": " + say("what-if.none") : "") << "\n";
  const auto number = [&](const Json& value) {
    return say.number(short_text(value.get<double>()));
  };
  const auto row = [&](const std::string& name, const Json& now, const Json& then) {
    out << "    " << padded(name, 30) << padded(number(now), 10) << "-> " << number(then);
  };
  for (const Json& one : what_if) {
    out << "  " << say("what-if." + text_in(one, "plan"), {{"readings", one.at("readings").dump()}})
        << "\n";
    for (const Json& p : one.at("parameters")) {
      row("u " + text_in(p, "effect") + " " + text_in(p, "name"), p.at("u"), p.at("then"));
      out << " " << text_in(p, "unit") << "\n";
    }
    for (const Json& e : one.at("evidence")) {
      row(say("what-if.evidence") + " " + text_in(e, "effect"), e.at("score"), e.at("then"));
      out << "\n";
    }
  }
}

/// The bar marks the noise floor with "|". Returns "-" if the step lacks the RMS.
std::string bar_of(const Json& step, const std::string& name, double whole,
                   const TerminalWords& say) {
  if (!storage::get(step, name)) return "-";
  std::optional<double> floor;
  if (const auto found = storage::get(step, "noise_floor")) floor = found->value;
  return bar(size_in(step, name), whole, bar_width, floor) + " " + with_unit(step, name, say);
}

void print_bars(std::ostream& out, const Json& step, const TerminalWords& say) {
  const double whole = std::max(
      {size_in(step, "rms_before"), size_in(step, "rms_after"), size_in(step, "noise_floor")});
  for (const char* name : {"before", "after"})
    if (const std::string text = bar_of(step, std::string("rms_") + name, whole, say); text != "-")
      out << "  " << padded(say(name), 8) << text << "\n";
}

}  // namespace

std::string with_unit(double value, Quantity q) {
  return short_text(printed(value, q)) + " " + std::string(unit_of(q).symbol);
}

std::string with_unit(double value, Quantity q, const TerminalWords& say) {
  return say.number(short_text(printed(value, q))) + " " + std::string(unit_of(q).symbol);
}

std::string with_unit(const Json& json, const std::string& name, const TerminalWords& say) {
  const auto found = storage::get(json, name);
  return found ? with_unit(found->value, found->quantity, say) : "-";
}

void print_comparison(std::ostream& out, const Json& part, const TerminalWords& say) {
  const Json& model = part.at("model");
  print_head(out, part, say);
  line(out, "RMS", with_unit(model, "rms", say));
  line(out, say("left-out"),
       storage::get(model, "cv_rms") ? with_unit(model, "cv_rms", say) : say("left-out.one-run"));
  print_floor(out, part, say);
  if (part.contains("noise_floor_unknown"))
    line(out, say("floor"), say("floor." + text_in(part, "noise_floor_unknown")));
  if (part.contains("largest")) line(out, say("largest"), largest_text(part.at("largest"), say));
  line(out, say("redundancy"), part.at("redundancy").dump());
  if (part.contains("lack_of_fit") && part.at("lack_of_fit").contains("says"))
    line(out, say("lack-of-fit"), text_in(part.at("lack_of_fit"), "says"));
  print_parameters(out, model, say);
  for (const Json& pair : part.at("correlations"))
    line(
        out, say("correlated"),
        say("correlated.pair", {{"one", text_in(pair, "one")}, {"other", text_in(pair, "other")}}) +
            ": r = " + say.number(fixed_text(pair.at("r"), 3)));
  if (!model.at("effects").empty()) sentence(out, 2, say("aliases.elsewhere"));
  print_places(out, part, say);
  if (part.contains("means")) line(out, "", say("means", {{"count", part.at("means").dump()}}));
  print_suspects(out, part, say);
  print_after_table(out, part, say);
  sentences(out, part.at("warnings"), say("warning") + ": ");
}

void print_model(std::ostream& out, const Json& part, const TerminalWords& say) {
  const Json& model = part.at("model");
  print_head(out, part, say);
  line(out, "RMS", with_unit(model, "rms", say));
  if (storage::get(model, "cv_rms")) line(out, say("left-out"), with_unit(model, "cv_rms", say));
  print_floor(out, part, say);
  print_parameters(out, model, say);
  sentences(out, part.at("warnings"), say("warning") + ": ");
}

void print_explanation(std::ostream& out, const Json& part, const std::string& folder, bool all,
                       const TerminalWords& say) {
  const Json& verdict = part.at("verdict");
  const std::string effect = text_in(verdict, "effect");
  print_head(out, part, say);
  line(out, "RMS", with_unit(part.at("model"), "rms", say));
  print_floor(out, part, say);
  // Without repeats the noise is unknown, so that no residuals can show that a model is complete.
  const bool is_unjudged = verdict.at("kind") == "nothing" && !storage::get(part, "noise_floor");
  out << "  " << say("verdict") << ": "
      << say.of("verdict", is_unjudged ? "unjudged" : text_in(verdict, "kind"))
      << (effect.empty() ? "" : " " + effect) << "\n";
  sentence(out, 2, text_in(verdict, "says"));
  print_candidates(out, part, all, say);
  print_priors(out, part, effect.empty() ? Json::array() : part.at("candidates"), effect);
  print_set(out, part, say);
  print_advice(out, part, folder, say);
  print_limits(out, part, all, say);
  print_suspects(out, part, say);
  sentences(out, part.at("warnings"), say("warning") + ": ");
  if (part.contains("what_if")) print_foresight(out, part.at("what_if"), say);
}

void print_change(std::ostream& out, const Json& change, const TerminalWords& say) {
  const Json& step = change.at("step");
  const std::string effects = list_in(change, "effects");
  out << say(step.at("action") == "add" ? "added" : "dropped",
             {{"effect", text_in(step, "effect")},
              {"model", effects.empty() ? say("model.empty") : effects}})
      << "\n";
  if (change.contains("no_before"))
    out << "  " << say("before") << ": " << text_in(change, "no_before") << "\n";
  const std::size_t width = std::max<std::size_t>(18, columns_of(say("left-out")) + 2);
  const auto row = [&](const std::string& label, const std::string& name) {
    out << "  " << padded(label, width) << padded(with_unit(step, name + "_before", say), 14)
        << with_unit(step, name + "_after", say) << "\n";
  };
  out << "  " << padded("", width) << padded(say("before"), 14) << say("after") << "\n";
  row("RMS", "rms");
  row(say("left-out"), "cv_rms");
  if (storage::get(step, "noise_floor"))
    line(out, say("floor"), with_unit(step, "noise_floor", say));
  print_bars(out, step, say);
  if (!change.contains("after")) return;
  print_parameters(out, change.at("after").at("model"), say);
  sentences(out, change.at("after").at("warnings"), say("warning") + ": ");
}

namespace {

void print_joint_part(std::ostream& out, const Json& part, const TerminalWords& say) {
  const Json& campaigns = part.at("campaigns");
  std::set<std::string> names;  // as found and as left are two members of one campaign
  for (const Json& c : campaigns) names.insert(text_in(c, "campaign"));
  sentence(out, 0,
           say("joint.head", {{"part", text_in(part, "part")},
                              {"count", std::to_string(names.size())},
                              {"first", text_in(campaigns.front(), "campaign")},
                              {"last", text_in(campaigns.back(), "campaign")},
                              {"readings", part.at("observations").dump()}}));
  if (part.contains("machines") && part["machines"].size() > 1)
    sentence(out, 2,
             say("joint.machines", {{"count", std::to_string(part["machines"].size())},
                                    {"machines", list_in(part, "machines")}}));
  line(out, "RMS", with_unit(part.at("model"), "rms", say));
  line(out, say("floor"), with_unit(part, "noise_floor", say));
  sentence(out, 2, text_in(part.at("verdict"), "says"));
  for (const Json& e : part.at("effects")) {
    sentence(out, 2, text_in(e, "says"));
    if (!e.at("aliases").empty())
      sentence(out, 4, say("joint.aliases", {{"effects", list_in(e, "aliases")}}));
  }
  print_priors(out, part, part.at("effects"), "");
  for (const Json& plan : part.at("plans"))
    sentence(out, 2,
             say("next.apart") + " (" + text_in(plan, "campaign") + "): " + text_in(plan, "says"));
  const Json& candidates = part.at("candidates");
  if (candidates.empty()) return;
  out << "  " << padded(say("candidate"), 22) << padded(say("evidence.alone"), 12)
      << padded(say("rms-after"), 15) << say("joint.values") << "\n";
  for (const Json& e : candidates)
    if (e.contains("best"))
      out << "  " << padded(text_in(e, "effect"), 22)
          << padded(say.number(short_text(e.at("score"), 4)), 12)
          << padded(with_unit(e, "rms", say), 15)
          << say(e.at("per_campaign") == "shared" ? "joint.is-shared" : "joint.is-own") << "\n";
}

void print_alone(std::ostream& out, const Json& document, const TerminalWords& say) {
  constexpr std::size_t most = 20;
  sentence(out, 0, say("joint.alone", {{"parts", list_in(document, "alone")}}));
  const Json& all = document.at("alone_verdicts");
  for (std::size_t i = 0; i < std::min(all.size(), most); ++i)
    sentence(out, 2, text_in(all[i], "part") + ": " + text_in(all[i], "says"));
  if (all.size() > most)
    sentence(out, 2, say("joint.more-alone", {{"count", std::to_string(all.size() - most)}}));
}

}  // namespace

void print_together(std::ostream& out, const Json& document, const TerminalWords& say) {
  constexpr std::size_t most = 8;
  for (const Json& part : modelling::parts_of(document)) print_joint_part(out, part, say);
  if (document.contains("alone")) print_alone(out, document, say);
  if (document.contains("parts_differ"))
    for (const Json& of : document.at("parts_differ"))
      sentence(out, 0, say("joint.parts-differ", {{"campaigns", of.get<std::string>()}}));
  const Json& next = document.at("next");
  if (next.size() > 1) out << say("joint.next") << "\n";
  for (std::size_t i = 0; i < std::min(next.size(), most) && next.size() > 1; ++i)
    sentence(out, 2,
             std::to_string(i + 1) + ". " + text_in(next[i], "campaign") + ", " +
                 text_in(next[i], "part") + ": " + text_in(next[i], "says"));
  if (next.size() > most)
    out << "  " << say("joint.more-next", {{"count", std::to_string(next.size() - most)}}) << "\n";
}

void print_step(std::ostream& out, const Json& step, const TerminalWords& say) {
  if (step.at("action") == "exclude") {
    std::string lines;
    for (const Json& line : step.at("lines")) lines += (lines.empty() ? "" : ", ") + line.dump();
    out << say("excluded", {{"measurement", text_in(step, "measurement")},
                            {"lines", lines},
                            {"why", text_in(step, "why")}});
  } else if (step.at("action") == "period") {
    out << say("period", {{"axis", text_in(step, "axis")},
                          {"mm", say.number(short_text(step.at("period_mm").get<double>()))}});
  }
  out << "\n";
}

void print_history(std::ostream& out, const Json& history, const TerminalWords& say) {
  if (history.empty()) return;
  out << say("history") << "\n";
  double whole = 0.0;
  for (const Json& step : history)
    whole = std::max({whole, size_in(step, "rms_before"), size_in(step, "rms_after")});
  for (const Json& step : history) {
    out << "  ";
    if (!step.contains("effect")) {
      print_step(out, step, say);
      continue;
    }
    out << padded((step.at("action") == "add" ? "+ " : "- ") + text_in(step, "effect"), 24)
        << bar_of(step, "rms_after", whole, say) << "\n";
  }
}

}  // namespace nonio::app
