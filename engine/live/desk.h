// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>

#include "live/bench_client.h"
#include "live/service.h"
#include "live/session.h"
#include "live/watch.h"

namespace nonio::live {

struct PartState {
  struct Work {
    std::string state = "none";  ///< none, queued, running, done or failed
    std::uint64_t job = 0;
    std::string error;
    int seconds = 0;
    /// The answer in two parts. For a fit they are the members "compare" and "text", and the value
    /// of "page"; before the fit is done, the test of the residuals is missing. For an explanation
    /// they are {"explain": ...} and, possibly later, {"fingerprints": ...}.
    std::string head, rest;
  };
  std::string key;  ///< trial_key of `fit` and `explain`
  Work fit, explain;
};

/// Answers by the data on which they depend; the newest 64 MB are kept.
class Remembered {
 public:
  struct Text {
    std::string head, rest;
    /// RMS, cross-validation RMS and noise floor of a fit, by names with units.
    storage::Json figures = storage::Json::object();
    std::size_t size() const { return head.size() + rest.size(); }
  };
  void put(const std::string& key, Text text);
  const Text* find(const std::string& key) const;
  void clear();

 private:
  static constexpr std::size_t most_bytes = 64 << 20;
  std::map<std::string, Text> texts_;
  std::deque<std::string> order_;
  std::size_t bytes_ = 0;
};

struct Searching {
  std::uint64_t job = 0;
  std::string kind;  ///< suggest or finish
  std::vector<std::string> added;
  std::vector<std::string> failed_before;  ///< parts without an explanation at the start
};

/// A campaign with its page: session, bench process and events. The threads of the server call its
/// functions, the thread of the bench calls `tell`.
class Desk {
 public:
  /// `name` is the folder as stated by the user, for use in commands.
  Desk(Launcher& launcher, const std::filesystem::path& folder, std::string name, bool edit,
       std::string engine);
  ~Desk();

  /// Answers a request. `what` is the path after "/api/" with placeholders, such as
  /// "parts/{part}/fit".
  Answer answer(const std::string& what, const std::string& part, const Request& request);
  /// Whether model, excluded readings or periods differ from the saved ones.
  bool has_unsaved() const;
  void close();

  static std::vector<Route> routes(const std::string& base);

 private:
  using Json = storage::Json;
  static constexpr const char* newer_words = "a newer request has taken the place of this one";
  struct Waiting {
    bool done = false, well = false;
    std::string text;
  };

  Answer state(bool may_write);
  Answer fit(const std::string& part, const Request& request, bool picture);
  Answer explain(const std::string& part, bool fingerprints);
  Answer asked(const std::string& kind, const std::string& part, const Request& request);
  Answer document(const std::string& kind, const std::string& part);
  Answer difference();
  Answer events(const Request& request);

  Answer post(const std::string& what, const Json& body, const Request& request);
  Answer exclude(const Json& body);
  Answer search(const std::string& kind);
  Answer cancel(const Json& body);
  Answer save(const Request& request);
  Answer reload();
  Answer changed(const Done& done, const std::string& command);
  Done change(const std::string& what, const Json& body, std::string& command);
  Done change_model(const Json& body);
  Done known(const std::vector<std::string>& effects) const;

  void tell(std::uint64_t job, const std::string& state, std::string text);
  void take_campaign(const std::string& state, const std::string& text);
  void take_work(const std::string& part, PartState::Work& work, bool is_fit,
                 const std::string& state, std::string text);
  void take_fit(const std::string& part, PartState::Work& work, const std::string& text,
                bool is_done);
  void take_explanation(const std::string& part, PartState::Work& work, const std::string& text,
                        bool is_done);
  bool take_waiting(std::uint64_t job, const std::string& state, std::string& text);

  Json request_for(const std::string& kind, const std::string& part) const;
  void refresh();
  void forget_parts();
  static std::string replaced_by(const Json& request);
  void cancel_waiting(const std::string& replaces);
  void ask_explanation(const std::string& part, PartState& state);
  void search_on();
  bool is_explained() const;
  void search_ended(const std::string& state, const std::string& says);
  /// Ends the search with an error: a message of the program, or the name of a sentence of the
  /// page.
  void fail_search(const std::string& words, const std::string& name = "");
  void end_search();
  /// Cancels an earlier request with the key `replaces`, sends the request and waits at most 120 s
  /// for its answer. `lock` is released during the wait.
  Waiting wait_for(std::unique_lock<std::mutex>& lock, const Json& request,
                   const std::string& replaces);
  void publish(const char* type, const std::string& about, Json data);
  void files_changed(bool changed);
  Json parts_state() const;
  Json part_state(const PartState& state) const;
  Json steps() const;
  Json save_request(const std::string& kind) const;
  void read_again();
  std::string command() const;
  bool has_part(const std::string& part) const { return parts_.contains(part); }

  std::filesystem::path folder_;
  std::string name_, engine_;
  bool edit_;
  mutable std::mutex mutex_;
  std::condition_variable answered_;
  Events events_;
  Session session_;
  std::string bench_state_ = "opening", bench_error_, read_at_;
  Json campaign_ = Json::object();
  bool read_again_ = false, changed_on_disk_ = false, over_ = false;
  std::vector<std::string> order_;
  std::map<std::string, PartState> parts_;
  Remembered fits_, explanations_;
  std::map<std::uint64_t, Waiting> waiting_;
  std::map<std::string, std::uint64_t> replaceable_;
  std::optional<Searching> searching_;
  std::uint64_t searches_ = 0;
  std::unique_ptr<Watch> watch_;
  /// Declared last, because its thread uses all other members.
  std::unique_ptr<BenchClient> bench_;
};

}  // namespace nonio::live
