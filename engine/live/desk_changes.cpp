// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>

#include "campaign/modelling/model_json.h"
#include "live/bench.h"
#include "live/desk.h"

namespace nonio::live {
using storage::Json;

namespace {

constexpr std::size_t most_added = 12;
constexpr std::size_t longest_text = 2000;

}  // namespace

Answer Desk::post(const std::string& what, const Json& body, const Request& request) {
  {
    const std::lock_guard lock(mutex_);
    if (bench_state_ == "failed" && what != "reload") return refusal(503, bench_error_);
    if (order_.empty() && what != "reload") return refused(409, "not_read");
  }
  if (what == "exclude") return exclude(body);
  if (what == "suggest" || what == "finish") return search(what);
  if (what == "cancel") return cancel(body);
  if (what == "save") return save(request);
  if (what == "reload") return reload();
  const std::lock_guard lock(mutex_);
  if (what != "name") end_search();
  const Trial before = session_.trial();
  std::string shown_command;
  const auto done = change(what, body, shown_command);
  if (shown_command.empty()) shown_command = command_between(name_, before, session_.trial());
  return changed(done, shown_command);
}

Answer Desk::changed(const Done& done, const std::string& command_now) {
  if (!done) return refused(422, done.error().name, done.error().places);
  refresh();
  publish("state", "", Json::object());
  return json_answer(200, {{"version", session_.version()}, {"command", command_now}});
}

Done Desk::known(const std::vector<std::string>& effects) const {
  for (const std::string& effect : effects) {
    if (std::find(session_.saved().begin(), session_.saved().end(), effect) !=
        session_.saved().end())
      continue;
    const Json& catalogue = campaign_.at("catalogue");
    if (catalogue.is_null()) return tl::unexpected<Said>(Said{"no_catalogue"});
    if (std::none_of(catalogue.begin(), catalogue.end(),
                     [&](const Json& one) { return one.at("effect") == effect; }))
      return tl::unexpected<Said>(Said{"not_shown", {{"effect", effect.substr(0, 100)}}});
  }
  return {};
}

Done Desk::change_model(const Json& body) {
  if (body.contains("drop")) return session_.drop(body.at("drop").get<std::string>());
  if (body.contains("add")) {
    const auto effect = body.at("add").get<std::string>();
    if (auto right = known({effect}); !right) return right;
    return session_.add(effect);
  }
  const auto model = body.at("model").get<std::vector<std::string>>();
  if (auto right = known(model); !right) return right;
  return session_.set(model);
}

Done Desk::change(const std::string& what, const Json& body, std::string& shown_command) {
  if (what == "model") return change_model(body);
  if (what == "undo") return session_.undo();
  if (what == "redo") return session_.redo();
  if (what == "goto") return session_.go_to(body.at("n").get<std::size_t>());
  if (what == "name") {
    shown_command = command();
    return session_.name(body.at("n").get<std::size_t>(), body.at("name").get<std::string>());
  }
  if (what == "include") {
    shown_command = "nonio model compare " + quoted_for_shell(name_);
    return session_.include(body.at("part").get<std::string>(),
                            body.at("rows").get<std::vector<std::size_t>>());
  }
  const auto axis = body.at("axis").get<std::string>();
  const Json& axes = campaign_.at("machine").at("axes");
  if (std::none_of(axes.begin(), axes.end(), [&](const Json& one) {
        return one.at("name") == axis && !one.at("rotary").get<bool>();
      }))
    return tl::unexpected<Said>(Said{"no_linear_axis", {{"axis", axis.substr(0, 40)}}});
  return session_.period(axis, body.at("period_mm").get<double>());
}

Answer Desk::exclude(const Json& body) {
  const auto part = body.at("part").get<std::string>();
  const auto rows = body.at("rows").get<std::vector<std::size_t>>();
  const auto why = body.at("why").get<std::string>();
  if (why.empty() || why.size() > longest_text || why.find('\n') != std::string::npos)
    return refused(422, "why");
  if (rows.empty()) return refused(422, "no_rows");
  std::unique_lock lock(mutex_);
  if (!has_part(part)) return refused(404, "no_part", {{"part", part.substr(0, 100)}});
  end_search();
  Json wish = request_for("places", part);
  wish["rows"] = rows;
  const Waiting found = wait_for(lock, wish, "");
  if (!found.well) return refusal(422, found.text);
  std::vector<Excluded> readings;
  const Json list = storage::parse(found.text);
  for (const Json& one : list.at("readings"))
    readings.push_back({part, one.at("row").get<std::size_t>(),
                        one.at("measurement").get<std::string>(), one.at("file").get<std::string>(),
                        one.at("measurement_row").get<std::uint32_t>(),
                        one.value("line", std::uint64_t{0}), why});
  const Trial before = session_.trial();
  const auto done = session_.exclude(readings);
  return changed(done, command_between(name_, before, session_.trial()));
}

void Desk::read_again() {
  read_again_ = true;
  bench_state_ = "opening";
  fits_.clear();
  explanations_.clear();
  bench_->restart();
  forget_parts();
}

Json Desk::save_request(const std::string& kind) const {
  std::map<std::string, std::pair<Json, std::string>> of;
  for (const Excluded& e : session_.trial().excluded) {
    auto& [rows, why] = of[e.measurement];
    rows.push_back(e.measurement_row);
    if (why.find(e.why) == std::string::npos) why += (why.empty() ? "" : "; ") + e.why;
  }
  Json request = request_for(kind, "");
  request["exclusions"] = Json::array();
  for (const auto& [measurement, one] : of)
    request["exclusions"].push_back(
        {{"measurement", measurement}, {"rows", one.first}, {"why", one.second}});
  return request;
}

Answer Desk::reload() {
  const std::lock_guard lock(mutex_);
  end_search();
  read_again();
  publish("state", "", Json::object());
  return json_answer(202, {{"version", session_.version()},
                           {"command", "nonio model compare " + quoted_for_shell(name_)}});
}

Answer Desk::difference() {
  std::unique_lock lock(mutex_);
  const Waiting done = wait_for(lock, save_request("difference"), "");
  if (!done.well) return refusal(done.done ? 422 : 503, done.text);
  Json json = {{"version", session_.version()}};
  json.update(storage::parse(done.text));
  json["model"] = session_.trial().model;
  json["command"] = command();
  return json_answer(200, json);
}

Answer Desk::save(const Request& request) {
  const std::string wanted = request.head.first("If-Match");
  if (wanted.empty()) return refused(428, "match");
  std::unique_lock lock(mutex_);
  const Waiting looked = wait_for(lock, save_request("difference"), "");
  if (!looked.well) return refusal(looked.done ? 422 : 503, looked.text);
  const Json now = storage::parse(looked.text);
  const std::string digest = now.at("manifest_sha256").get<std::string>();
  if (wanted != "\"" + digest + "\"" || now.at("changed_on_disk").get<bool>()) {
    Json more = {{"yours", session_.trial().model}, {"manifest_sha256", digest}};
    more["on_disk"] = now.value("on_disk", Json(nullptr));
    Answer out = refused(412, "changed");
    out.body = storage::dump_line(more);
    return out;
  }
  const Json body = storage::parse_once(request.body.empty() ? "{}" : request.body);
  const std::string shown_command = command();
  Json wish = save_request("save");
  wish["why"] = body.value("why", "").substr(0, longest_text);
  const Waiting done = wait_for(lock, wish, "");
  if (!done.well)
    return done.text.find("changed while") != std::string::npos ? refused(412, "changed")
                                                                : refusal(422, done.text);
  const Json saved = storage::parse(done.text);
  const Trial& trial = session_.trial();
  const bool reads_others = !trial.excluded.empty() || !trial.period_mm.empty();
  session_.was_saved(saved.at("model").get<std::vector<std::string>>());
  campaign_["manifest_sha256"] = saved.at("manifest_sha256");
  campaign_["inputs"]["campaign.toml"] = saved.at("manifest_sha256");
  watch_->expect(campaign_.at("inputs").get<std::map<std::string, std::string>>());
  // The file now states other readings or another machine, so it is read again.
  if (reads_others) end_search(), read_again();
  publish("state", "", Json::object());
  return json_answer(200, {{"version", session_.version()},
                           {"manifest_sha256", saved.at("manifest_sha256")},
                           {"steps", saved.at("steps")},
                           {"command", shown_command}});
}

Answer Desk::search(const std::string& kind) {
  const std::lock_guard lock(mutex_);
  if (bench_state_ != "open") return refused(409, "not_read");
  end_search();
  searching_ = Searching{++searches_, kind, {}, {}};
  for (const std::string& part : order_) ask_explanation(part, parts_[part]);
  publish("progress", "job", {{"job", searching_->job}, {"kind", kind}, {"state", "running"}});
  Json answer = {{"version", session_.version()},
                 {"command", "nonio model explain " + quoted_for_shell(name_) +
                                 (kind == "finish" ? " --auto" : "")}};
  const std::uint64_t job = searching_->job;
  search_on();
  answer["version"] = session_.version();
  // All explanations were in the cache, so the search has ended already.
  if (!searching_) return json_answer(200, answer);
  answer["job"] = job;
  return json_answer(202, answer);
}

bool Desk::is_explained() const {
  return std::all_of(order_.begin(), order_.end(), [&](const std::string& part) {
    const std::string& state = parts_.at(part).explain.state;
    return state == "done" || state == "failed";
  });
}

void Desk::search_ended(const std::string& state, const std::string& says) {
  publish("done", "job",
          {{"job", searching_->job},
           {"kind", searching_->kind},
           {"state", state},
           {"added", searching_->added},
           {"says", says}});
  searching_.reset();
}

void Desk::fail_search(const std::string& words, const std::string& name) {
  Json data = {{"job", searching_->job}, {"error", words}};
  if (!name.empty()) data["id"] = name;
  publish("failed", "job", data);
  searching_.reset();
}

void Desk::end_search() {
  if (searching_) search_ended("cancelled", "");
}

/// When all parts are explained, adds the next effect or ends the search. If an effect makes the
/// explanation of a part fail, it is removed and the search ends.
void Desk::search_on() {
  while (searching_ && is_explained()) {
    std::vector<modelling::PartVerdict> verdicts;
    std::string says;
    for (const std::string& part : order_) {
      const PartState& one = parts_.at(part);
      if (one.explain.state == "failed") {
        auto& before = searching_->failed_before;
        if (searching_->added.empty()) {
          before.push_back(part);
        } else if (std::find(before.begin(), before.end(), part) == before.end()) {
          const std::string words = one.explain.error;
          if (session_.undo()) searching_->added.pop_back();
          fail_search(words);
          refresh();
          publish("state", "", Json::object());
          return;
        }
        continue;
      }
      const Json verdict = storage::parse(one.explain.head).at("explain");
      verdicts.push_back({verdict.at("verdict").at("kind").get<std::string>(),
                          verdict.at("verdict").value("effect", ""),
                          verdict.at("certain").get<std::vector<std::string>>()});
      says += (says.empty() ? "" : "\n") + verdict.at("verdict").value("says", "");
    }
    const std::string next = modelling::next_effect(verdicts);
    if (next.empty()) return search_ended("done", says);
    if (searching_->added.size() == most_added)
      return fail_search("12 effects were added and one is still missing; stopped", "most_added");
    if (const auto added = session_.add(next); !added)
      return fail_search(added.error().name, added.error().name);
    searching_->added.push_back(next);
    refresh();
    publish("state", "", Json::object());
    if (searching_->kind == "suggest") return search_ended("done", says);
    publish("progress", "job",
            {{"job", searching_->job},
             {"kind", searching_->kind},
             {"state", "running"},
             {"added", searching_->added}});
  }
}

Answer Desk::cancel(const Json& body) {
  const auto job = body.at("job").get<std::uint64_t>();
  const std::lock_guard lock(mutex_);
  if (!searching_ || searching_->job != job)
    return refused(404, "no_job", {{"job", std::to_string(job)}});
  end_search();
  return json_answer(200, {{"version", session_.version()}, {"command", ""}});
}

}  // namespace nonio::live
