// SPDX-License-Identifier: Apache-2.0
#include "live/desk.h"

#include <algorithm>
#include <charconv>
#include <chrono>

namespace nonio::live {
using storage::Json;

namespace {

constexpr auto fit_patience = std::chrono::seconds(2);
constexpr const char* json_type = "application/json";

std::string with_version(std::uint64_t version, const std::string& object) {
  return "{\"version\":" + std::to_string(version) + "," + object.substr(1);
}

std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Desk::Desk(Launcher& launcher, const std::filesystem::path& folder, std::string name, bool edit,
           std::string engine)
    : folder_(folder), name_(std::move(name)), engine_(std::move(engine)), edit_(edit) {
  watch_ = std::make_unique<Watch>(folder, [this](bool changed) { files_changed(changed); });
  bench_ = std::make_unique<BenchClient>(
      launcher, folder, [this](std::uint64_t job, const std::string& state, std::string text) {
        tell(job, state, std::move(text));
      });
}

Desk::~Desk() {
  close();
  watch_.reset();
  bench_.reset();
}

void Desk::close() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  answered_.notify_all();
  events_.close();
}

bool Desk::has_unsaved() const {
  const std::lock_guard lock(mutex_);
  const Trial& trial = session_.trial();
  return trial.model != session_.saved() || !trial.excluded.empty() || !trial.period_mm.empty();
}

std::vector<Route> Desk::routes(const std::string& base) {
  std::vector<Route> out;
  for (const char* path :
       {"state", "parts/{part}/look", "parts/{part}/picture", "parts/{part}/fit",
        "parts/{part}/explain", "parts/{part}/without", "parts/{part}/fingerprints",
        "parts/{part}/series", "parts/{part}/readings", "page/{part}", "report", "save", "events"})
    out.push_back({Method::get, base + "/api/" + path});
  for (const char* path : {"model", "undo", "redo", "name", "goto", "exclude", "include", "period",
                           "suggest", "finish", "cancel", "reload"})
    out.push_back({Method::post, base + "/api/" + path, false, false, json_type});
  out.push_back({Method::post, base + "/api/save", false, true, json_type});
  return out;
}

Answer Desk::answer(const std::string& what, const std::string& part, const Request& request) {
  if (request.route.method == Method::post) {
    const Json body = storage::parse_once(request.body.empty() ? "{}" : request.body);
    if (!body.is_object()) return refused(400, "no_object");
    try {
      return post(what, body, request);
    } catch (const Json::exception&) {
      return refused(400, "body_form", {{"path", "/api/" + what}});
    }
  }
  if (what == "events") return events(request);
  if (what == "state") return state(request.may_write);
  if (what == "save") return difference();
  if (what == "report") return document("report", "");
  {
    const std::lock_guard lock(mutex_);
    if (bench_state_ == "failed") return refusal(503, bench_error_);
    if (bench_state_ == "open" && !has_part(part))
      return refused(404, "no_part", {{"part", part.substr(0, 100)}});
  }
  const std::string last = what.substr(what.rfind('/') + 1);
  if (what == "page/{part}") return document("page", part);
  if (last == "fit" || last == "picture") return fit(part, request, last == "picture");
  if (last == "explain" || last == "fingerprints") return explain(part, last == "fingerprints");
  return asked(last, part, request);
}

Json Desk::part_state(const PartState& state) const {
  Json json = {{"fit", state.fit.state}, {"explain", state.explain.state}};
  const std::string& error = state.fit.error.empty() ? state.explain.error : state.fit.error;
  if (!error.empty()) json["error"] = error;
  if (state.fit.state == "running" && !state.fit.rest.empty()) json["picture"] = true;
  if (!state.explain.rest.empty()) json["fingerprints"] = true;
  const int seconds = std::max(state.fit.seconds, state.explain.seconds);
  if (state.fit.state == "running" || state.explain.state == "running") json["seconds"] = seconds;
  return json;
}

Json Desk::parts_state() const {
  Json json = Json::object();
  for (const std::string& part : order_) json[part] = part_state(parts_.at(part));
  return json;
}

Json Desk::steps() const {
  Json list = Json::array();
  for (const Step& step : session_.steps()) {
    Json one = {{"n", step.n},
                {"name", step.name},
                {"what", step.what},
                {"model", step.trial.model},
                {"excluded", step.trial.excluded.size()},
                {"parts", Json::object()}};
    for (const std::string& part : order_) {
      Json request = {{"part", part}, {"model", step.trial.model}};
      request["excluded"] = Json::array();
      for (const Excluded& e : step.trial.excluded)
        request["excluded"].push_back({{"measurement", e.measurement}, {"row", e.measurement_row}});
      request["period_mm"] = Json::object();
      for (const auto& [axis, mm] : step.trial.period_mm) request["period_mm"][axis] = mm;
      if (const auto* known = fits_.find(trial_key(request))) one["parts"][part] = known->figures;
    }
    list.push_back(std::move(one));
  }
  return list;
}

std::string Desk::command() const {
  const std::string change = command_of(name_, session_.saved(), session_.trial());
  return change.empty() ? "nonio model compare " + quoted_for_shell(name_) : change;
}

Answer Desk::state(bool may_write) {
  const std::lock_guard lock(mutex_);
  Json excluded = Json::array();
  for (const Excluded& e : session_.trial().excluded)
    excluded.push_back({{"part", e.part},
                        {"row", e.row},
                        {"measurement", e.measurement},
                        {"file", e.file},
                        {"line", e.line},
                        {"why", e.why}});
  Json json = {{"schema", "nonio-live/1"},
               {"version", session_.version()},
               {"engine", engine_},
               {"edit", edit_ && may_write},
               {"language", campaign_.value("language", "en")},
               {"bench", bench_state_},
               {"bench_error", bench_error_}};
  json["campaign"] = {{"id", campaign_.value("id", "")},
                      {"folder", name_},
                      {"machine", campaign_.value("machine", Json::object())},
                      {"customer", campaign_.value("customer", "")},
                      {"date", campaign_.value("date", "")},
                      {"manifest_sha256", campaign_.value("manifest_sha256", "")},
                      {"read_at", read_at_},
                      {"changed_on_disk", changed_on_disk_}};
  json["errors"] = campaign_.value("errors", Json::array());
  json["mistakes"] = campaign_.value("mistakes", Json::array());
  json["parts"] = campaign_.value("parts", Json::array());
  json["kinds"] = campaign_.value("kinds", Json::array());
  json["model"] = session_.trial().model;
  json["saved_model"] = session_.saved();
  json["catalogue"] = campaign_.value("catalogue", Json::array());
  if (json["catalogue"].is_null()) json["catalogue"] = Json::array();
  json["excluded"] = std::move(excluded);
  json["period_mm"] = Json::object();
  for (const auto& [axis, mm] : session_.trial().period_mm) json["period_mm"][axis] = mm;
  json["steps"] = steps();
  json["at"] = session_.at();
  json["can_undo"] = session_.can_undo();
  json["can_redo"] = session_.can_redo();
  json["parts_state"] = parts_state();
  if (searching_) json["job"] = {{"job", searching_->job}, {"kind", searching_->kind}};
  json["command"] = command();
  return {200, json_type, storage::dump_line(json)};
}

/// Waits at most 2 s for the fit; status 409 if it is not ready. If `picture`, the fitted curves
/// are sufficient, before the residuals have been tested for remaining structure (member `places`).
Answer Desk::fit(const std::string& part, const Request& request, bool picture) {
  std::unique_lock lock(mutex_);
  const auto is_known = [&] {
    const auto found = parts_.find(part);
    if (over_ || bench_state_ == "failed") return true;
    if (found == parts_.end()) return false;
    const PartState::Work& work = found->second.fit;
    return work.state == "done" || work.state == "failed" || (picture && !work.rest.empty());
  };
  answered_.wait_for(lock, fit_patience, is_known);
  const auto found = parts_.find(part);
  if (bench_state_ == "failed") return refusal(503, bench_error_);
  if (found == parts_.end() || !is_known() || over_) {
    Json json = {{"error", "the fit is not ready yet"}, {"status", 409}};
    json["state"] = found == parts_.end() ? Json::object() : part_state(found->second);
    return {409, json_type, storage::dump_line(json)};
  }
  const PartState::Work& work = found->second.fit;
  if (work.state == "failed") return refusal(422, work.error);
  const bool partial = work.state != "done";
  const std::string tag = "\"" + std::to_string(session_.version()) + "\"";
  if (!partial && request.head.first("If-None-Match") == tag)
    return {304, json_type, "", {{"ETag", tag}}};
  const bool with_page = request.query("page").value_or("1") != "0";
  Answer out{200, json_type,
             "{\"version\":" + std::to_string(session_.version()) + "," + work.head +
                 (partial ? ",\"partial\":true" : "") +
                 (with_page ? ",\"page\":" + work.rest : "") + "}"};
  if (!partial) out.headers = {{"ETag", tag}};
  return out;
}

Answer Desk::explain(const std::string& part, bool fingerprints) {
  std::unique_lock lock(mutex_);
  const auto found = parts_.find(part);
  if (found == parts_.end()) return refused(409, "not_read");
  PartState& one = found->second;
  if (bench_state_ == "open" && !one.key.empty()) ask_explanation(part, one);
  const std::string key = one.key;
  const auto& text = fingerprints ? one.explain.rest : one.explain.head;
  if (fingerprints && one.explain.state == "done")
    answered_.wait_for(lock, fit_patience, [&] {
      return over_ || one.key != key || !text.empty() || one.explain.job == 0;
    });
  if (one.explain.state == "failed") return refusal(422, one.explain.error);
  if (one.explain.state != "done" || text.empty()) {
    Json json = {{"error", "the explanation is not ready yet"}, {"status", 409}};
    json["state"] = part_state(one);
    return {409, json_type, storage::dump_line(json)};
  }
  return {200, json_type, with_version(session_.version(), text)};
}

Answer Desk::asked(const std::string& kind, const std::string& part, const Request& request) {
  std::unique_lock lock(mutex_);
  Json wish = request_for(kind, part);
  for (const char* name : {"x", "y"})
    if (const auto text = request.query(name)) wish[name] = *text;
  for (const char* name : {"x0", "x1", "px", "from", "count"})
    if (const auto text = request.query(name); text && !text->empty()) {
      const auto value = number_of(*text);
      const bool is_count = name[0] != 'x';
      if (!value || (is_count && !(*value >= 0.0 && *value <= 1e9)))
        return refused(400, "number", {{"name", name}});
      if (is_count)
        wish[name] = static_cast<std::uint64_t>(*value);
      else
        wish[name] = *value;
    }
  constexpr std::uint64_t most_px = 4000, most_rows = 1000;
  if (wish.contains("px"))
    wish["px"] = std::clamp<std::uint64_t>(wish["px"].get<std::uint64_t>(), 1, most_px);
  if (wish.contains("count"))
    wish["count"] = std::min(wish["count"].get<std::uint64_t>(), most_rows);
  if (const auto text = request.query("rows")) {
    const Json rows = storage::parse_or_discard("[" + *text + "]");
    if (!rows.is_array() || rows.size() > most_rows ||
        !std::all_of(rows.begin(), rows.end(),
                     [](const Json& row) { return row.is_number_unsigned(); }))
      return refused(400, "rows");
    wish["rows"] = rows;
  }
  const Waiting done = wait_for(lock, wish, kind == "readings" ? "" : replaced_by(wish));
  if (!done.done) return refusal(503, done.text);
  if (!done.well) return refusal(done.text == newer_words ? 409 : 422, done.text);
  return {200, json_type, with_version(session_.version(), done.text)};
}

Answer Desk::document(const std::string& kind, const std::string& part) {
  std::unique_lock lock(mutex_);
  const Waiting done = wait_for(lock, request_for(kind, part), kind + part);
  if (!done.done) return refusal(503, done.text);
  if (!done.well) return refusal(done.text == newer_words ? 409 : 422, done.text);
  const bool page = kind == "page";
  std::string name = page ? "model-" + part + ".html" : campaign_.value("id", "report") + ".pdf";
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.' && c != '_')
      c = '_';
  // Sent as an attachment, because a displayed page could run its script with the address of this
  // server.
  return {200,
          page ? "application/octet-stream" : "application/pdf",
          done.text,
          {{"Content-Disposition", "attachment; filename=\"" + name + "\""}}};
}

Answer Desk::events(const Request& request) {
  std::uint64_t since = 0;
  if (const auto text = request.query("since")) {
    const auto value = number_of(*text);
    if (!value || !(*value >= 0.0)) return refused(400, "since");
    since = static_cast<std::uint64_t>(*value);
  }
  Answer out{200, "text/event-stream", "", {}, {}, events_.listen(since), &events_};
  if (!out.stream) return refused(503, "streams");
  return out;
}

}  // namespace nonio::live
