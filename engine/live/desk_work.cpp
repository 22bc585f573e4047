// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <ctime>

#include "live/bench.h"
#include "live/desk.h"
#include "platform/storage/serialise.h"

namespace nonio::live {
using storage::Json;

namespace {

constexpr auto patience = std::chrono::seconds(120);

std::string now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

Json figures_of(const std::string& head) {
  Json out = Json::object();
  const Json all = storage::parse_or_discard("{" + head + "}");
  if (!all.is_object() || !all.contains("compare")) return out;
  for (const auto& [name, value] : all["compare"].items())
    if (value.is_number() &&
        (name.starts_with("rms") || name.starts_with("cv_rms") || name.starts_with("noise_floor")))
      out[name] = value;
  return out;
}

}  // namespace

void Remembered::put(const std::string& key, Text text) {
  if (const auto known = texts_.find(key); known != texts_.end()) {
    bytes_ += text.size();
    bytes_ -= known->second.size();
    known->second = std::move(text);
    return;
  }
  bytes_ += text.size();
  texts_[key] = std::move(text);
  order_.push_back(key);
  while (bytes_ > most_bytes && order_.size() > 1) {
    bytes_ -= texts_[order_.front()].size();
    texts_.erase(order_.front());
    order_.pop_front();
  }
}

const Remembered::Text* Remembered::find(const std::string& key) const {
  const auto found = texts_.find(key);
  return found == texts_.end() ? nullptr : &found->second;
}

void Remembered::clear() { *this = Remembered(); }

Json Desk::request_for(const std::string& kind, const std::string& part) const {
  const Trial& trial = session_.trial();
  Json request = {{"kind", kind}, {"part", part}, {"model", trial.model}};
  Json excluded = Json::array();
  for (const Excluded& e : trial.excluded)
    excluded.push_back({{"measurement", e.measurement}, {"row", e.measurement_row}});
  request["excluded"] = std::move(excluded);
  request["period_mm"] = Json::object();
  for (const auto& [axis, mm] : trial.period_mm) request["period_mm"][axis] = mm;
  return request;
}

void Desk::refresh() {
  for (const std::string& part : order_) {
    PartState& state = parts_[part];
    const std::string key = trial_key(request_for("fit", part));
    if (state.key == key) continue;
    for (PartState::Work* work : {&state.fit, &state.explain}) {
      if (work->job != 0) bench_->cancel(work->job);
      *work = {};
      work->state = "queued";
    }
    cancel_waiting(replaced_by(request_for("without", part)));
    const auto* known = fits_.find(key);
    if (known == nullptr && bench_state_ != "open") {
      state.key.clear();
      continue;
    }
    state.key = key;
    if (known != nullptr) {
      state.fit.state = "done";
      state.fit.head = known->head;
      state.fit.rest = known->rest;
      publish("fit", part, {{"part", part}});
    } else {
      state.fit.job = bench_->ask(request_for("fit", part));
    }
    ask_explanation(part, state);
  }
}

void Desk::ask_explanation(const std::string& part, PartState& state) {
  if (state.explain.state != "queued" || state.explain.job != 0) return;
  if (const auto* known = explanations_.find(state.key)) {
    state.explain.state = "done";
    state.explain.head = known->head;
    state.explain.rest = known->rest;
    publish("explain", part, {{"part", part}});
    if (!known->rest.empty()) return;  // otherwise the request for the fingerprints was canceled
  }
  if (bench_state_ == "open") state.explain.job = bench_->ask(request_for("explain", part));
}

void Desk::publish(const char* type, const std::string& about, Json data) {
  Json all = {{"version", session_.version()}};
  all.update(data);
  events_.publish({session_.version(), type, about, storage::dump_line(all)});
}

void Desk::tell(std::uint64_t job, const std::string& state, std::string text) {
  const std::lock_guard lock(mutex_);
  if (over_) return;
  if (job == 0) return take_campaign(state, text);
  if (take_waiting(job, state, text)) return;
  for (const std::string& part : order_) {
    PartState& all = parts_[part];
    if (all.fit.job == job) return take_work(part, all.fit, true, state, std::move(text));
    if (all.explain.job == job) return take_work(part, all.explain, false, state, std::move(text));
  }
}

void Desk::take_campaign(const std::string& state, const std::string& text) {
  if (state == job_state::catalogue) {
    campaign_["catalogue"] = storage::parse(text);
    session_.touch();
    publish("state", "", Json::object());
  } else if (state == job_state::failed) {
    bench_state_ = "failed";
    bench_error_ = text;
    publish("failed", "bench", {{"error", text}});
  } else if (state == "ended") {
    if (bench_state_ == "failed") return;
    bench_state_ = text.empty() ? "failed" : "opening";
    if (text.empty())
      bench_error_ =
          "the process that calculates ended as soon as it had begun; its words are on "
          "the terminal";
    forget_parts();
    publish("state", "", Json::object());
  } else {
    const bool first = order_.empty();
    campaign_ = storage::parse(text);
    const auto model = campaign_.at("model").get<std::vector<std::string>>();
    order_.clear();
    for (const Json& part : campaign_.at("parts")) {
      order_.push_back(part.at("name").get<std::string>());
    }
    if (first)
      session_ = Session(model);
    else if (read_again_)
      session_.was_read_again(model);
    read_again_ = false;
    bench_state_ = "open";
    bench_error_.clear();
    read_at_ = now();
    changed_on_disk_ = false;
    watch_->expect(campaign_.at("inputs").get<std::map<std::string, std::string>>());
    session_.touch();
    forget_parts();
    publish("state", "", Json::object());
  }
  answered_.notify_all();
}

/// Requests all answers again, because the bench process has ended with its requests.
void Desk::forget_parts() {
  for (const std::string& part : order_) {
    parts_[part].fit.job = parts_[part].explain.job = 0;
    parts_[part].key.clear();
  }
  refresh();
}

void Desk::take_work(const std::string& part, PartState::Work& work, bool is_fit,
                     const std::string& state, std::string text) {
  const char* const what = is_fit ? "fit" : "explain";
  if (state == job_state::running) {
    work.seconds = std::atoi(text.c_str());
    if (work.state == "done") return;
    work.state = state;
    publish("progress", part + what, {{"part", part}, {"what", what}, {"seconds", work.seconds}});
    return;
  }
  const bool is_done = state == job_state::done;
  if (state != job_state::begun) work.job = 0;
  if (state == job_state::failed && work.state == "done") {  // only the fingerprints failed
    answered_.notify_all();
    return;
  }
  if (state == job_state::failed) {
    work.state = state;
    work.error = std::move(text);
    publish("failed", part + what, {{"part", part}, {"what", what}, {"error", work.error}});
  } else if (is_fit) {
    take_fit(part, work, text, is_done);
  } else {
    take_explanation(part, work, text, is_done);
  }
  answered_.notify_all();
  search_on();
}

void Desk::take_fit(const std::string& part, PartState::Work& work, const std::string& text,
                    bool is_done) {
  std::string page;
  storage::unpack(text, work.head, page);
  if (!page.empty()) work.rest = std::move(page);
  if (!is_done) return publish("picture", part, {{"part", part}});
  work.state = job_state::done;
  fits_.put(parts_[part].key, {work.head, work.rest, figures_of(work.head)});
  publish("fit", part, {{"part", part}});
}

void Desk::take_explanation(const std::string& part, PartState::Work& work, const std::string& text,
                            bool is_done) {
  (is_done ? work.rest : work.head) = text;
  if (work.head.empty()) return;
  work.state = job_state::done;
  explanations_.put(parts_[part].key, {work.head, work.rest});
  publish(is_done ? "fingerprints" : "explain", part, {{"part", part}});
}

bool Desk::take_waiting(std::uint64_t job, const std::string& state, std::string& text) {
  const auto found = waiting_.find(job);
  if (found == waiting_.end()) return false;
  if (state == job_state::running || state == job_state::begun) return true;
  found->second = {true, state == job_state::done, std::move(text)};
  answered_.notify_all();
  return true;
}

/// A newer request replaces an older one with the same key.
std::string Desk::replaced_by(const Json& request) {
  std::string out;
  for (const char* name : {"kind", "part", "x", "y"}) out += request.value(name, "") + "\n";
  return out;
}

/// The thread that waits for the older request gets an error.
void Desk::cancel_waiting(const std::string& replaces) {
  const auto older = replaces.empty() ? replaceable_.end() : replaceable_.find(replaces);
  if (older == replaceable_.end()) return;
  bench_->cancel(older->second);
  waiting_[older->second] = {true, false, newer_words};
  answered_.notify_all();
}

Desk::Waiting Desk::wait_for(std::unique_lock<std::mutex>& lock, const Json& request,
                             const std::string& replaces) {
  cancel_waiting(replaces);
  const std::uint64_t job = bench_->ask(request);
  waiting_[job];
  if (!replaces.empty()) replaceable_[replaces] = job;
  answered_.wait_for(lock, patience, [&] { return waiting_[job].done || over_; });
  Waiting out = std::move(waiting_[job]);
  waiting_.erase(job);
  if (const auto own = replaceable_.find(replaces); own != replaceable_.end() && own->second == job)
    replaceable_.erase(own);
  if (!out.done) {
    bench_->cancel(job);
    out.text = over_ ? "nonio serve ends" : "no answer in time";
  }
  return out;
}

void Desk::files_changed(bool changed) {
  const std::lock_guard lock(mutex_);
  changed_on_disk_ = changed;
  session_.touch();
  publish("changed", "", {{"changed_on_disk", changed}});
}

}  // namespace nonio::live
