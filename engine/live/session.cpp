// SPDX-License-Identifier: Apache-2.0
#include "live/session.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "campaign/modelling/model_change.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

namespace {

constexpr std::size_t most_steps = 1000, longest_name = 200, most_effects = 500;

bool has(const std::vector<std::string>& list, const std::string& one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

std::string differences(const std::vector<std::string>& from, const std::vector<std::string>& to) {
  std::string out;
  for (const modelling::ModelEdit& edit : modelling::edits_between(from, to))
    out += (out.empty() ? "" : ", ") + std::string(edit.add ? "+ " : "- ") + edit.effect;
  return out;
}

tl::unexpected<Said> no(std::string name,
                        std::vector<std::pair<std::string, std::string>> places = {}) {
  return tl::unexpected<Said>(Said{std::move(name), std::move(places)});
}

}  // namespace

tl::unexpected<Said> Session::no_step(std::size_t n) const {
  return no("no_step", {{"n", std::to_string(n)}, {"last", std::to_string(steps_.size() - 1)}});
}

Session::Session(std::vector<std::string> saved) : saved_(std::move(saved)) {
  steps_.front().trial.model = saved_;
}

void Session::take(Trial trial, std::string what) {
  if (trial == steps_[at_].trial) return;
  ++version_;
  steps_.resize(at_ + 1);
  if (steps_.size() == most_steps) {
    steps_.erase(steps_.begin());
    for (std::size_t n = 0; n < steps_.size(); ++n) steps_[n].n = n;
  }
  steps_.push_back({steps_.size(), "", std::move(what), std::move(trial)});
  at_ = steps_.size() - 1;
}

std::vector<std::string> Session::in_order(const std::vector<std::string>& model) const {
  std::vector<std::string> out;
  for (const std::string& effect : saved_)
    if (has(model, effect)) out.push_back(effect);
  for (const std::string& effect : model)
    if (!has(out, effect)) out.push_back(effect);
  return out;
}

Done Session::set(const std::vector<std::string>& model) {
  if (model.size() > most_effects)
    return no("most_effects", {{"most", std::to_string(most_effects)}});
  for (std::size_t i = 0; i < model.size(); ++i)
    if (std::find(model.begin(), model.begin() + static_cast<std::ptrdiff_t>(i), model[i]) !=
        model.begin() + static_cast<std::ptrdiff_t>(i))
      return no("twice", {{"effect", model[i]}});
  Trial next = trial();
  next.model = in_order(model);
  std::string what = differences(trial().model, next.model);
  take(std::move(next), std::move(what));
  return {};
}

Done Session::add(const std::string& effect) {
  if (has(trial().model, effect)) return no("in_model", {{"effect", effect}});
  auto model = trial().model;
  model.push_back(effect);
  return set(model);
}

Done Session::drop(const std::string& effect) {
  if (!has(trial().model, effect)) return no("not_in_model", {{"effect", effect}});
  auto model = trial().model;
  std::erase(model, effect);
  return set(model);
}

Done Session::undo() {
  if (!can_undo()) return no("no_step_before");
  return go_to(at_ - 1);
}

Done Session::redo() {
  if (!can_redo()) return no("no_step_after");
  return go_to(at_ + 1);
}

Done Session::go_to(std::size_t n) {
  if (n >= steps_.size()) return no_step(n);
  if (n != at_) ++version_;
  at_ = n;
  return {};
}

Done Session::name(std::size_t n, const std::string& name) {
  if (n >= steps_.size()) return no_step(n);
  if (name.size() > longest_name) return no("long_name", {{"most", std::to_string(longest_name)}});
  if (steps_[n].name != name) ++version_;
  steps_[n].name = name;
  return {};
}

Done Session::exclude(const std::vector<Excluded>& readings) {
  Trial next = trial();
  for (const Excluded& one : readings) {
    if (one.why.empty()) return no("why");
    std::erase_if(next.excluded,
                  [&](const Excluded& e) { return e.part == one.part && e.row == one.row; });
    next.excluded.push_back(one);
  }
  std::sort(next.excluded.begin(), next.excluded.end(), [](const Excluded& a, const Excluded& b) {
    return std::pair(a.part, a.row) < std::pair(b.part, b.row);
  });
  take(std::move(next), "excluded " + std::to_string(readings.size()));
  return {};
}

Done Session::include(const std::string& part, const std::vector<std::size_t>& rows) {
  Trial next = trial();
  const std::size_t before = next.excluded.size();
  std::erase_if(next.excluded, [&](const Excluded& e) {
    return e.part == part && std::find(rows.begin(), rows.end(), e.row) != rows.end();
  });
  if (next.excluded.size() == before) return no("none_excluded");
  const std::size_t back = before - next.excluded.size();
  take(std::move(next), "included " + std::to_string(back));
  return {};
}

Done Session::period(const std::string& axis, double period_mm) {
  constexpr double most = 1e5;
  if (!std::isfinite(period_mm) || period_mm < 0.0 || period_mm > most) return no("period");
  Trial next = trial();
  if (period_mm > 0.0)
    next.period_mm[axis] = period_mm;
  else
    next.period_mm.erase(axis);
  take(std::move(next), "period of " + axis);
  return {};
}

void Session::was_saved(const std::vector<std::string>& model) {
  saved_ = model;
  ++version_;
}

void Session::was_read_again(const std::vector<std::string>& model) {
  saved_ = model;
  ++version_;
  for (Step& step : steps_) step.trial.excluded.clear(), step.trial.period_mm.clear();
  Trial next = trial();
  next.model = model;
  take(std::move(next), "campaign.toml");
}

std::string quoted_for_shell(const std::string& word) {
  constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_between(const std::string& campaign, const Trial& from, const Trial& to) {
  std::string out;
  const auto run = [&](const char* verb, const std::string& what) {
    out += (out.empty() ? "" : " && ") + std::string("nonio model ") + verb + " " +
           quoted_for_shell(campaign) + " " + what;
  };
  std::map<std::string, std::pair<std::set<std::uint64_t>, std::string>> excluded;
  for (const Excluded& e : to.excluded) {
    if (std::find(from.excluded.begin(), from.excluded.end(), e) != from.excluded.end()) continue;
    auto& [lines, why] = excluded[e.measurement];
    lines.insert(e.line);
    if (why.find(e.why) == std::string::npos) why += (why.empty() ? "" : "; ") + e.why;
  }
  for (const auto& [measurement, one] : excluded) {
    std::string lines;
    for (const std::uint64_t line : one.first)
      lines += (lines.empty() ? "" : ",") + std::to_string(line);
    run("exclude",
        quoted_for_shell(measurement) + " " + lines + " --why " + quoted_for_shell(one.second));
  }
  for (const auto& [axis, mm] : to.period_mm)
    if (const auto was = from.period_mm.find(axis);
        was == from.period_mm.end() || was->second != mm)
      run("period", quoted_for_shell(axis) + " " + storage::Json(mm).dump());
  for (const modelling::ModelEdit& edit : modelling::edits_between(from.model, to.model))
    run(edit.add ? "add" : "drop", quoted_for_shell(edit.effect));
  return out;
}

std::string command_of(const std::string& campaign, const std::vector<std::string>& saved,
                       const Trial& trial) {
  return command_between(campaign, Trial{saved, {}, {}}, trial);
}

}  // namespace nonio::live
