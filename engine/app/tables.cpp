// SPDX-License-Identifier: Apache-2.0
#include "tables.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <tuple>

#include "campaign/modelling/after_table.h"
#include "campaign/modelling/held_terms.h"
#include "nonio/sdk/format.h"
#include "text_layout.h"

namespace nonio::app {

void line(std::ostream& out, const std::string& name, const std::string& value) {
  out << "  " << padded(name, 18) << wrapped(value, 20, sentence_width(STDOUT_FILENO)).substr(20);
}

void sentence(std::ostream& out, std::size_t indent, const std::string& text) {
  if (!text.empty()) out << wrapped(text, indent, sentence_width(STDOUT_FILENO), 2);
}

namespace {

constexpr std::size_t bar_width = 40;

/// Returns `part` of `whole` as a bar of at most `width` columns, with "|" at `mark`.
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

std::string p_text(double p, const config::TerminalWords& say) {
  return p < 1e-4 ? "< " + say.number("0.0001") : say.number(short_text(p, 2));
}

std::string floor_text(const model::NoiseFloor& floor, Quantity q,
                       const config::TerminalWords& say) {
  return with_unit(floor.s, q, say) + ", u = " + with_unit(floor.u, q, say);
}

const char* head_of(const model::Part& part) {
  switch (part.kind) {
    case model::Part::Kind::axis:
      return "head.axis";
    case model::Part::Kind::space:
      return "head.axes";
    case model::Part::Kind::balls:
      return "head.balls";
    case model::Part::Kind::course:
      break;
  }
  return "head.course";
}

void print_head(std::ostream& out, const modelling::PartModel& part,
                const modelling::ModelWords& words) {
  const config::TerminalWords say = words.terminal();
  const std::string effects = storage::listed(part.names());
  sentence(out, 0,
           say(head_of(part.part)) + " " + part.part.name + " (" +
               say.counted("head.from", part.part.measurements.size(),
                           {{"ids", storage::listed(part.part.measurements)}}) +
               "): " +
               say("head.readings", {{"count", std::to_string(part.part.table.size())},
                                     {"model", effects.empty() ? say("head.empty") : effects}}));
}

/// Returns the value of a parameter that the model fixes, as stated there; empty if it is not
/// fixed.
std::string held_text(const modelling::PartModel& part, const model::Parameter& p) {
  for (const auto& held : part.held)
    if (held.parameter.effect == p.effect) return *modelling::entry_of(held.text).value;
  return {};
}

/// Prints the parameters of a fit; curves are represented by their RMS.
void print_parameters(std::ostream& out, const model::Fit& fit, const modelling::PartModel& part,
                      const modelling::ModelWords& words) {
  if (fit.parameters.empty()) return;
  const config::TerminalWords say = words.terminal();
  out << "  " << say("parameters") << "\n";
  std::string told;
  for (const model::Parameter& p : fit.parameters) {
    const auto term = std::find_if(fit.terms.begin(), fit.terms.end(),
                                   [&](const model::Term& t) { return t.name() == p.effect; });
    const auto curve =
        term == fit.terms.end()
            ? std::nullopt
            : modelling::curve_of(part, fit, static_cast<std::size_t>(term - fit.terms.begin()));
    if (curve && !p.shape) {
      if (told != p.effect)
        out << "    " << padded(p.effect, 20) << " " << words.curve(*curve, part) << "\n";
      told = p.effect;
      continue;
    }
    if (p.held) {
      out << "    " << padded(p.effect, 20) << " " << padded(p.name, 8) << " " << held_text(part, p)
          << "  " << words.terminal()("held") << "\n";
      continue;
    }
    const double value = printed(p.value, p.quantity);
    out << "    " << padded(p.effect, 20) << " " << padded(p.name, 8) << " "
        << say.number(p.quantity == Quantity::count ? fixed_text(value, 0) : short_text(value, 4));
    if (std::isfinite(p.u)) out << ", u = " << say.number(short_text(printed(p.u, p.quantity), 2));
    const std::string_view unit = unit_of(p.quantity).symbol;
    const bool stated = p.shape && term != fit.terms.end() && model::has_stated(*term) &&
                        term->effect->shapes[term->stated->shape].parameter.name == p.name;
    out << (unit.empty() ? "" : " ") << unit;
    if (p.shape) out << "  " << words.terminal()(stated ? "stated" : "searched");
    out << "\n";
  }
}

/// Returns a place such as "direction x position" in the language of the words.
std::string where_text(const model::Where& where, const config::TerminalWords& say) {
  const std::string names = to_text(where);
  const std::size_t by = names.find(" x ");
  const std::string first = say.of("where", names.substr(0, by));
  return by == std::string::npos ? first : first + " x " + say.of("where", names.substr(by + 3));
}

/// Prints where the model does not fit; each place is fitted together with those above it.
void print_places(std::ostream& out, const model::Comparison& c, const modelling::ModelWords& words,
                  Quantity deviation) {
  const config::TerminalWords say = words.terminal();
  if (!c.fails()) return line(out, say("fails"), say("fails.nowhere"));
  out << "  " << say("fails") << "\n";
  for (const model::Place& place : c.seats.empty() ? c.places : c.seats)
    out << "    " << padded(where_text(place.where, say) + modelling::on_line(place), 25)
        << wrapped(words.place(place, deviation), 29, sentence_width(STDOUT_FILENO)).substr(29);
}

void print_suspects(std::ostream& out, const model::Comparison& c, const modelling::PartModel& part,
                    const Campaign& campaign, const modelling::ModelWords& words) {
  for (const model::Suspect& s : c.suspects)
    sentence(out, 2,
             words.terminal()("suspect") + ": " +
                 words.suspect(s, modelling::place_of(part, campaign, s.row), part.deviation()));
}

/// Prints the predicted result of a compensation table in the control; nothing if the model has no
/// effect that a table can compensate.
void print_after_table(std::ostream& out, const modelling::PartModel& part, const model::Fit& fit,
                       Quantity q, const config::TerminalWords& say) {
  const modelling::AfterTable predicted = modelling::after_table(part, fit);
  if (predicted.effects.empty()) return;
  const auto value = [q, &say](double v) { return std::isfinite(v) ? with_unit(v, q, say) : "-"; };
  line(out, say("after-table"),
       say("after-table.rms", {{"before", value(predicted.rms_before)},
                               {"after", value(predicted.rms)},
                               {"effects", storage::listed(predicted.effects)}}));
  for (const auto& [measurement, was, is] : predicted.tests) {
    std::string text = measurement + ":";
    for (const auto& [name, before, after] :
         {std::tuple("E", was.E, is.E), std::tuple("A", was.A, is.A), std::tuple("R", was.R, is.R)})
      if (std::isfinite(before))
        text += std::string(text.ends_with(':') ? " " : ", ") + name + " " + value(before) +
                " -> " + value(after);
    if (!text.ends_with(':')) line(out, "", text);
  }
}

std::string largest_text(const modelling::Compared& compared, const Campaign& campaign,
                         const config::TerminalWords& say) {
  const modelling::PartModel& part = compared.part;
  const auto at = modelling::place_of(part, campaign, compared.comparison.largest_row);
  const std::string direction = at.direction > 0 ? "+" : "-";
  std::string text =
      say(at.run == 0 ? "largest.in-time" : "largest.at",
          {{"value", with_unit(compared.comparison.largest, part.deviation(), say)},
           {"position", say.number(evidence_text({"", at.target, at.position})) + " " +
                            std::string(unit_of(at.position).symbol)},
           {"run", std::to_string(at.run)}}) +
      (at.direction == 0 ? "" : ", " + say("largest.direction", {{"direction", direction}})) +
      ", " + at.file;
  return at.line == 0 ? text : text + ":" + std::to_string(at.line);
}

/// Prints the candidates as bars; without `all`, those of the best explanation and the five best.
void print_candidates(std::ostream& out, const modelling::Explained& e, bool all,
                      const config::TerminalWords& say) {
  constexpr std::size_t most_shown = 5;
  const Quantity q = e.part.deviation();
  const auto& together = e.explanation.together;
  std::vector<const model::Candidate*> shown;
  std::size_t left = 0;
  for (const model::Candidate& c : e.explanation.candidates) {
    if (!modelling::is_ranked(c) || !(c.score > 0.0)) continue;
    const bool is_best = shown.size() < most_shown || std::find(together.begin(), together.end(),
                                                                c.term.name()) != together.end();
    if (all || is_best)
      shown.push_back(&c);
    else
      ++left;
  }
  if (shown.empty()) return;
  double best = 0.0;
  for (const model::Candidate* c : shown) best = std::max(best, c->score);
  out << "  " << padded(say("candidate"), 22) << padded(say("evidence"), 13)
      << padded(say("evidence.alone"), 9) << padded(say("evidence.within"), 10)
      << padded(say("rms-after"), 14) << padded(say("left-out"), 18) << "p\n";
  const auto evidence = [&](double score) {
    return score > 0.0 ? say.number(fixed_text(score, 1)) : "-";
  };
  for (const model::Candidate* c : shown)
    out << "  " << padded(c->term.name() + " ", 22) << bar(c->score, best, 12) << " "
        << padded(evidence(c->alone), 9) << padded(evidence(c->within), 10)
        << padded(with_unit(c->rms, q, say), 14)
        << padded(c->cv_rms ? with_unit(*c->cv_rms, q, say) : "-", 18) << p_text(c->p, say) << "\n";
  if (left > 0) out << "  " << say("show.more", {{"count", std::to_string(left)}}) << " (--all)\n";
}

/// Prints the effects that the best explanation adds, if they are several. If the verdict is that
/// the cause is unknown, prints those of them that are not significant.
void print_together(std::ostream& out, const model::Explanation& x,
                    const config::TerminalWords& say) {
  const bool unknown = x.verdict.kind == model::Verdict::Kind::unknown;
  std::vector<std::string> names;
  for (const std::string& name : x.together)
    if (!unknown || std::find(x.certain.begin(), x.certain.end(), name) == x.certain.end())
      names.push_back(name);
  if (names.size() > (unknown ? 0U : 1U))
    sentence(out, 2,
             say(unknown ? "together.unknown" : "together") + ": " + storage::listed(names));
}

void print_verdict(std::ostream& out, const modelling::Explained& e,
                   const modelling::ModelWords& words) {
  const model::Explanation& x = e.explanation;
  const config::TerminalWords say = words.terminal();
  out << "  " << say("verdict") << ": " << say.of("verdict", modelling::to_text(x.verdict.kind))
      << (x.verdict.effect.empty() ? "" : " " + x.verdict.effect) << "\n";
  sentence(out, 2, words.verdict(x, e.part));
}

/// Prints the reason, the recommended action, and the command to continue with.
void print_advice(std::ostream& out, const modelling::Explained& e, const std::string& folder,
                  const modelling::ModelWords& words) {
  const model::Explanation& x = e.explanation;
  const config::TerminalWords say = words.terminal();
  for (const model::Description& d : x.descriptions) sentence(out, 2, words.description(d, e.part));
  for (const auto& [what, label] : {std::pair{"is", "why"}, {"remedy", "do"}})
    if (const std::string text = words.card(x.verdict.effect, what); !text.empty())
      sentence(out, 2, say(label) + ": " + text);
  for (const model::Candidate& c : x.candidates)
    if (c.term.price > 0.0 && c.term.name() == x.verdict.effect)
      sentence(out, 2, say("rare", {{"price", say.number(fixed_text(c.term.price, 1))}}));
  for (const std::string& text : words.next(x, e.part))
    sentence(out, 2, say(x.plans.empty() ? "next" : "next.apart") + ": " + text);
  if (x.verdict.kind == model::Verdict::Kind::missing && !x.verdict.effect.empty())
    out << "  " << say("command") << ": nonio model add " << folder << " " << x.verdict.effect
        << "\n";
}

/// Prints the limitations of the verdict. Without `all`, effects that could not be tested are
/// listed by name only; those that need a longer test are left out.
void print_limits(std::ostream& out, const modelling::Explained& e, const Campaign& campaign,
                  bool all, const modelling::ModelWords& words) {
  const config::TerminalWords say = words.terminal();
  if (e.explanation.verdict.trials > 0) sentence(out, 2, words.false_alarms(e.explanation.verdict));
  sentence(out, 2, words.no_sign(e.explanation, e.part));
  std::vector<std::string> untested;
  for (const model::Candidate& candidate : e.explanation.candidates) {
    // Effects that need a longer test are stated in the JSON only.
    if (modelling::is_ranked(candidate) || candidate.why == "short-test") continue;
    if (all)
      sentence(out, 2,
               words.unseen(candidate, modelling::place_of(e.part, campaign, candidate.rows)));
    else
      untested.push_back(candidate.term.name());
  }
  if (!untested.empty())
    sentence(out, 2, say("untested", {{"effects", storage::listed(untested)}}));
}

void print_bars(std::ostream& out, const modelling::ModelStep& step,
                const config::TerminalWords& say) {
  const double whole = std::max(
      {step.rms_before.value_or(0.0), step.rms_after.value_or(0.0), step.floor.value_or(0.0)});
  const Quantity q = step.quantity;
  const auto one = [&](const std::string& name, const std::optional<double>& rms) {
    if (rms)
      out << "  " << padded(name, 8) << bar(*rms, whole, bar_width, step.floor) << " "
          << with_unit(*rms, q, say) << "\n";
  };
  one(say("before"), step.rms_before);
  one(say("after"), step.rms_after);
}

}  // namespace

std::string with_unit(double value, Quantity q) {
  return short_text(printed(value, q)) + " " + std::string(unit_of(q).symbol);
}

std::string with_unit(double value, Quantity q, const config::TerminalWords& say) {
  return say.number(short_text(printed(value, q))) + " " + std::string(unit_of(q).symbol);
}

void print_comparison(std::ostream& out, const modelling::Compared& compared,
                      const Campaign& campaign, const modelling::ModelWords& words) {
  const model::Comparison& c = compared.comparison;
  const modelling::PartModel& part = compared.part;
  const Quantity q = part.deviation();
  const config::TerminalWords say = words.terminal();
  print_head(out, part, words);
  line(out, "RMS", with_unit(c.fit.rms, q, say));
  line(out, say("left-out"), c.cv_rms ? with_unit(*c.cv_rms, q, say) : say("left-out.one-run"));
  const std::vector<std::uint32_t>& run = part.part.table.run;
  const bool runs = std::adjacent_find(run.begin(), run.end(), std::not_equal_to<>()) != run.end();
  line(out, say("floor"),
       c.floor ? floor_text(*c.floor, q, say) : say(runs ? "floor.short-runs" : "floor.unknown"));
  if (c.largest != 0.0) line(out, say("largest"), largest_text(compared, campaign, say));
  line(out, say("redundancy"), std::to_string(c.fit.redundancy));
  if (c.lack_of_fit && std::isfinite(c.lack_of_fit->F))
    line(out, say("lack-of-fit"), words.lack_of_fit(c, q));
  print_parameters(out, c.fit, part, words);
  for (const modelling::Correlated& pair : modelling::correlated(c.fit))
    line(out, say("correlated"),
         say("correlated.pair", {{"one", pair.one->effect + " " + pair.one->name},
                                 {"other", pair.other->effect + " " + pair.other->name}}) +
             ": r = " + say.number(fixed_text(pair.r, 3)));
  print_places(out, c, words, part.deviation());
  if (c.means > 0) line(out, "", say("means", {{"count", std::to_string(c.means)}}));
  print_suspects(out, c, part, campaign, words);
  print_after_table(out, part, c.fit, q, say);
  for (const std::string& warning : modelling::warnings_of(part, c.fit, words))
    sentence(out, 2, say("warning") + ": " + warning);
}

void print_model(std::ostream& out, const modelling::Compared& compared,
                 const modelling::ModelWords& words) {
  const model::Comparison& c = compared.comparison;
  const Quantity q = compared.part.deviation();
  const config::TerminalWords say = words.terminal();
  print_head(out, compared.part, words);
  line(out, "RMS", with_unit(c.fit.rms, q, say));
  if (c.cv_rms) line(out, say("left-out"), with_unit(*c.cv_rms, q, say));
  if (c.floor) line(out, say("floor"), floor_text(*c.floor, q, say));
  print_parameters(out, c.fit, compared.part, words);
  for (const std::string& warning : modelling::warnings_of(compared.part, c.fit, words))
    sentence(out, 2, say("warning") + ": " + warning);
}

void print_explanation(std::ostream& out, const modelling::Explained& e, const Campaign& campaign,
                       const std::string& folder, bool all, const modelling::ModelWords& words) {
  const model::Comparison& c = e.explanation.comparison;
  const Quantity q = e.part.deviation();
  const config::TerminalWords say = words.terminal();
  print_head(out, e.part, words);
  line(out, "RMS", with_unit(c.fit.rms, q, say));
  if (c.floor) line(out, say("floor"), floor_text(*c.floor, q, say));
  print_verdict(out, e, words);
  print_candidates(out, e, all, say);
  print_together(out, e.explanation, say);
  print_advice(out, e, folder, words);
  print_limits(out, e, campaign, all, words);
  print_suspects(out, c, e.part, campaign, words);
  for (const std::string& warning : modelling::warnings_of(e.part, c.fit, words))
    sentence(out, 2, say("warning") + ": " + warning);
}

void print_foresight(std::ostream& out, const modelling::Explained& e,
                     const config::TerminalWords& say) {
  out << "  " << say("what-if") << (e.what_if->empty() ? ": -" : "") << "\n";
  for (const model::Foresight& one : *e.what_if) {
    out << "  " << say("what-if." + one.id, {{"readings", std::to_string(one.readings)}}) << "\n";
    for (const auto& f : one.parameters)
      for (const model::Parameter& p : e.explanation.comparison.fit.parameters)
        if (p.effect == f.effect && p.name == f.parameter)
          out << "    " << padded("u " + p.effect + " " + p.name, 30)
              << padded(say.number(short_text(printed(p.u, p.quantity))), 10) << "-> "
              << with_unit(p.u * f.factor, p.quantity, say) << "\n";
    for (const auto& x : one.evidence)
      out << "    " << padded(say("what-if.evidence") + " " + x.effect, 30)
          << padded(say.number(short_text(x.now)), 10) << "-> " << say.number(short_text(x.then))
          << "\n";
  }
}

void print_change(std::ostream& out, const modelling::Change& change,
                  const modelling::ModelWords& words) {
  const modelling::ModelStep& step = change.step;
  const config::TerminalWords say = words.terminal();
  out << say(step.added ? "added" : "dropped",
             {{"effect", step.effect},
              {"model",
               change.effects.empty() ? say("model.empty") : storage::listed(change.effects)}})
      << "\n";
  if (!change.no_before.empty()) out << "  " << say("before") << ": " << change.no_before << "\n";
  const Quantity q = step.quantity;
  const auto row = [&](const std::string& name, const std::optional<double>& before,
                       const std::optional<double>& after) {
    out << "  " << padded(name, 18) << padded(before ? with_unit(*before, q, say) : "-", 14)
        << (after ? with_unit(*after, q, say) : "-") << "\n";
  };
  out << "  " << padded("", 18) << padded(say("before"), 14) << say("after") << "\n";
  row("RMS", step.rms_before, step.rms_after);
  row(say("left-out"), step.cv_before, step.cv_after);
  if (step.floor) line(out, say("floor"), with_unit(*step.floor, q, say));
  print_bars(out, step, say);
  if (!change.after) return;
  print_parameters(out, change.after->comparison.fit, change.after->part, words);
  for (const std::string& warning :
       modelling::warnings_of(change.after->part, change.after->comparison.fit, words))
    sentence(out, 2, say("warning") + ": " + warning);
}

void print_step(std::ostream& out, const modelling::ModelStep& step,
                const config::TerminalWords& say) {
  if (step.excluded) {
    std::string lines;
    for (const std::uint32_t line : step.excluded->lines)
      lines += (lines.empty() ? "" : ", ") + std::to_string(line);
    out << say("excluded", {{"measurement", step.excluded->measurement},
                            {"lines", lines},
                            {"why", step.excluded->why}});
  } else if (step.period) {
    out << say("period",
               {{"axis", step.period->axis}, {"mm", say.number(short_text(step.period->mm))}});
  }
  out << "\n";
}

void print_history(std::ostream& out, const std::vector<modelling::ModelStep>& history,
                   const config::TerminalWords& say) {
  if (history.empty()) return;
  out << say("history") << "\n";
  double whole = 0.0;
  for (const modelling::ModelStep& step : history)
    whole = std::max({whole, step.rms_before.value_or(0.0), step.rms_after.value_or(0.0)});
  for (const modelling::ModelStep& step : history) {
    if (step.excluded || step.period) {
      out << "  ";
      print_step(out, step, say);
      continue;
    }
    out << "  " << padded((step.added ? "+ " : "- ") + step.effect, 24)
        << (step.rms_after ? bar(*step.rms_after, whole, bar_width, step.floor) + " " +
                                 with_unit(*step.rms_after, step.quantity, say)
                           : "-")
        << "\n";
  }
}

}  // namespace nonio::app
