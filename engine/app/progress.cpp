// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "common.h"
#include "platform/storage/json_values.h"
#include "text_layout.h"

namespace nonio::app {

namespace {

using storage::Json;

void print_event(const Json& event) {
  std::cout << event.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
}

std::string duration(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return std::to_string(s) + " s";
  if (s < 3600) return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
  return std::to_string(s / 3600) + " h " + std::to_string(s / 60 % 60) + " min";
}

std::string message_of(const batch::CampaignState& c) {
  return c.errors.empty() ? c.reason : text_of(c.errors.front());
}

}  // namespace

Progress::Progress(const Common& common, bool quiet, bool json)
    : words_(common),
      quiet_(quiet),
      json_(json),
      bar_(!quiet && !json && ::isatty(STDERR_FILENO) == 1) {}

std::string Progress::failed_word() const {
  constexpr std::size_t column = 9;
  return coloured(padded(words()("status.failed"), column), Colour::red, STDERR_FILENO);
}

batch::RunEvents Progress::events() {
  return {[this](const std::string& m) { note(m); },
          [this](std::size_t n, std::size_t k) { planned(n, k); },
          [this](const batch::CampaignState& c) { finished(c); },
          [this] {
            if (bar_) draw();
          },
          [this](const char* name) {
            if (json_) print_event({{"event", "stage"}, {"name", name}});
          },
          [this](const config::TerminalWords& words) { words_.take(words); }};
}

void Progress::note(const std::string& message) {
  if (json_)
    print_event({{"event", "note"}, {"message", message}});
  else
    std::cerr << "nonio: " << message << "\n";
}

void Progress::planned(std::size_t campaigns, std::size_t to_do) {
  to_do_ = to_do;
  began_ = Clock::now();
  if (json_)
    print_event({{"event", "planned"}, {"campaigns", campaigns}, {"to_do", to_do}});
  else if (!quiet_)
    std::cerr << words().counted("run.planned", campaigns, {{"todo", std::to_string(to_do)}})
              << "\n";
}

void Progress::finished(const batch::CampaignState& c) {
  // Reports that are written again because of a changed history were not planned.
  to_do_ = std::max(to_do_, ++done_);
  const bool failed = c.status == evaluation::Status::failed;
  if (failed) ++failed_;
  if (json_) {
    Json event = {{"event", "campaign"}, {"id", c.id},    {"status", to_text(c.status)},
                  {"reason", c.reason},  {"done", done_}, {"to_do", to_do_}};
    if (failed) event["message"] = message_of(c);
    return print_event(event);
  }
  if (failed) {
    clear();
    std::cerr << failed_word() << " " << c.id << ": " << message_of(c) << "\n";
  }
  if (bar_) draw();
}

void Progress::draw() {
  const auto now = Clock::now();
  if (drawn_once_ && now - drawn_ < std::chrono::milliseconds(100) && done_ < to_do_) return;
  drawn_ = now;
  drawn_once_ = true;
  const double elapsed = std::chrono::duration<double>(now - began_).count();
  const double rate = elapsed > 0.0 ? static_cast<double>(done_) / elapsed : 0.0;
  std::string text = " " + std::to_string(done_) + "/" + std::to_string(to_do_) + "  " +
                     words()("run.failed", {{"count", std::to_string(failed_)}});
  if (done_ > 0 && rate > 0.0) {
    std::string r = std::to_string(rate);
    r.erase(r.find('.') + 2);
    text += "  " + r + "/s  " +
            words()("run.left", {{"time", duration(static_cast<double>(to_do_ - done_) / rate)}});
  }
  const std::size_t width = line_width(STDERR_FILENO), used = columns_of(text) + 4;
  const std::size_t cells = width > used ? std::min<std::size_t>(width - used, 40) : 0;
  const std::size_t full = to_do_ == 0 ? cells : cells * done_ / to_do_;
  std::cerr << "\r\033[K[" << std::string(full, '#') << std::string(cells - full, '.') << "]"
            << text << std::flush;
}

void Progress::clear() {
  if (bar_ && drawn_once_) std::cerr << "\r\033[K";
}

void Progress::still_failed(const batch::RunResult& run) {
  for (const batch::CampaignState& c : run.campaigns)
    if (c.status == evaluation::Status::failed &&
        c.action == batch::CampaignState::Action::unchanged)
      std::cerr << failed_word() << " " << c.id << " (" << words()("run.unchanged")
                << "): " << message_of(c) << "\n";
}

void Progress::end() {
  if (bar_ && drawn_once_) std::cerr << "\n";
}

}  // namespace nonio::app
