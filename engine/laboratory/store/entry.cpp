// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/entry.h"

#include <simdjson.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <new>
#include <stdexcept>

#include "campaign/config/machines.h"
#include "laboratory/store/entry_json.h"
#include "platform/storage/digest.h"

namespace nonio::store {

namespace dom = simdjson::dom;

namespace {

std::string text_at(dom::object of, std::string_view key) {
  std::string_view text;
  return of[key].get(text) == simdjson::SUCCESS ? std::string(text) : std::string();
}

std::optional<double> number_at(dom::object of, std::string_view key) {
  double number = 0.0;
  if (of[key].get(number) != simdjson::SUCCESS) return std::nullopt;
  return number;
}

dom::array list_at(dom::object of, std::string_view key) {
  static dom::parser none;
  static const dom::element empty = none.parse(std::string_view("[]"));
  dom::array list;
  return of[key].get(list) == simdjson::SUCCESS ? list : dom::array(empty);
}

std::string instrument_key(const InstrumentAsStated& i) {
  if (i.serial.empty()) return {};
  std::string out = "instrument";
  for (const std::string& part : {i.maker, i.model, i.serial, i.certificate, i.calibrated})
    if (!part.empty()) out += ' ' + part;
  return out;
}

class EntryReader {
 public:
  EntryReader(dom::object json, const reading::Inputs& inputs) : json_(json) {
    entry_.campaign_sha256 = store::campaign_sha256(inputs);
  }

  Entry read() {
    if (text_at(json_, "schema") != "nonio-results/1")
      throw std::runtime_error("expected schema nonio-results/1");
    read_campaign(json_["campaign"]);
    entry_.status = std::string(std::string_view(json_["status"]));
    for (const dom::object error : list_at(json_, "errors"))
      if (entry_.message.empty()) entry_.message = text_at(error, "message");
    read_followed();
    for (const dom::object c : list_at(json_, "conformity")) {
      if (!text_at(c, "measurement").empty())
        axes_.emplace(text_at(c, "measurement"), text_at(c, "axis"));
      if (text_at(c, "reason") == "no-value")
        entry_.without_value.push_back({text_at(c, "measurement"), text_at(c, "axis"),
                                        text_at(c, "name"), text_at(c, "unit"), c["tolerance"]});
    }
    for (const dom::element t : list_at(json_, "control_tables"))
      entry_.control_tables.push_back(
          {text_at(t, "measurement"), text_at(t, "axis"), simdjson::minify(t)});
    for (const dom::object a : list_at(json_, "analyses")) read_analysis(a);
    for (const dom::object t : list_at(json_, "tables")) {
      for (const dom::object p : list_at(t, "predictions"))
        read_prediction(p, text_at(t, "plugin"));
      read_findings(t, {});
    }
    dom::object certificate;
    if (json_["certificate"].get(certificate) == simdjson::SUCCESS) read_certificate(certificate);
    return std::move(entry_);
  }

 private:
  void read_campaign(dom::object c) {
    entry_.campaign = std::string(std::string_view(c["id"]));
    entry_.day = text_at(c, "date");
    entry_.customer = text_at(c, "customer");
    entry_.place = text_at(c, "site");
    entry_.purpose = text_at(c, "purpose");
    if (dom::object m; c["machine"].get(m) == simdjson::SUCCESS) {
      entry_.machine = {text_at(m, "asset"), text_at(m, "maker"), text_at(m, "model"),
                        text_at(m, "serial")};
      entry_.control = text_at(m, "control");
    }
    if (dom::object i; c["instrument"].get(i) == simdjson::SUCCESS)
      entry_.instrument = {text_at(i, "maker"),       text_at(i, "model"),
                           text_at(i, "serial"),      text_at(i, "calibrated"),
                           text_at(i, "certificate"), text_at(i, "valid_until")};
  }

  /// The state is "check" for all results of a check campaign; by default "as-found". A check
  /// continues the series, because it shows what a table did.
  std::string state(std::string said) const {
    if (entry_.purpose == "check") return "check";
    return said.empty() ? "as-found" : said;
  }

  void read_followed() {
    for (const dom::object f : list_at(json_, "followed")) {
      ResultRow row{.measurement = text_at(f, "measurement"),
                    .axis = text_at(f, "axis"),
                    .quantity = std::string(std::string_view(f["quantity"])),
                    .source = "followed",
                    .unit = text_at(f, "unit"),
                    .state = state(text_at(f, "state")),
                    .value = f["value"],
                    .u_repeat = number_at(f, "u")};
      for (const dom::object c : list_at(f, "common"))
        row.common.push_back({std::string(std::string_view(c["source"])), c["u"]});
      if (dom::element conditions; f["conditions"].get(conditions) == simdjson::SUCCESS)
        row.conditions = simdjson::minify(conditions);
      for (const dom::element key : list_at(f, "not_stated"))
        row.not_stated += (row.not_stated.empty() ? "" : ", ") + std::string(std::string_view(key));
      if (!row.measurement.empty()) axes_.emplace(row.measurement, row.axis);
      states_.emplace(row.measurement, row.state);
      entry_.results.push_back(std::move(row));
    }
    for (const dom::object c : list_at(json_, "followed_covariance")) {
      CovarianceRow row{c["first"], c["count"], {}};
      if (dom::element targets; c["other_targets"].get(targets) == simdjson::SUCCESS)
        row.other_targets = simdjson::minify(targets);
      for (const double x : list_at(c, "upper")) row.upper.push_back(x);
      if (row.count > entry_.results.size() || row.first > entry_.results.size() - row.count ||
          row.upper.size() != row.count * (row.count + 1) / 2)
        throw std::runtime_error("followed_covariance does not belong to followed");
      entry_.covariance.push_back(std::move(row));
    }
  }

  void read_analysis(dom::object a) {
    const std::string measurement = text_at(a, "measurement");
    const std::string plugin = std::string(std::string_view(a["plugin"]));
    if (const std::string left = text_at(a, "state"); !left.empty())
      states_.try_emplace(measurement, state(left));
    dom::object values;
    if (a["values"].get(values) == simdjson::SUCCESS)
      for (const auto [name, value] : values) read_value(a, measurement, plugin, name, value);
    read_findings(a, measurement);
  }

  void read_value(dom::object analysis, const std::string& measurement, const std::string& plugin,
                  std::string_view name, dom::object v) {
    ResultRow row{.measurement = measurement,
                  .axis = axis_of(measurement),
                  .quantity = std::string(name),
                  .source = plugin,
                  .unit = text_at(v, "unit"),
                  .state = state_of(measurement),
                  .value = v["value"],
                  .u_repeat = {},
                  .expanded = number_at(v, "U"),
                  .k = number_at(v, "k")};
    row.tolerance = number_at(v, "tolerance");
    row.decision = text_at(v, "decision");
    if (std::uint64_t edition = 0; analysis["edition"].get(edition) == simdjson::SUCCESS)
      row.conditions = R"({"edition":)" + std::to_string(edition) + "}";
    if (dom::object budget; analysis["budget"].get(budget) == simdjson::SUCCESS)
      read_parts(budget, name, row);
    entry_.results.push_back(std::move(row));
  }

  void read_prediction(dom::object p, const std::string& plugin) {
    const std::string measurement = text_at(p, "measurement");
    entry_.results.push_back({.measurement = measurement,
                              .axis = axis_of(measurement),
                              .quantity = std::string(std::string_view(p["name"])),
                              .source = plugin,
                              .unit = text_at(p, "unit"),
                              .state = predicted_state,
                              .value = p["predicted"]});
  }

  /// The contributions of an instrument with a serial number and of the expansion of an axis are
  /// common to several campaigns; all others are independent.
  void read_parts(dom::object budget, std::string_view name, ResultRow& row) {
    dom::object results, one, parts;
    if (budget["results"].get(results) != simdjson::SUCCESS ||
        results[name].get(one) != simdjson::SUCCESS || one["u"].get(parts) != simdjson::SUCCESS)
      return;
    double repeat = 0.0;
    for (const auto [id, u_of] : parts) {
      const double u = u_of;
      std::string shared;
      if (id.starts_with("device")) shared = instrument_key(entry_.instrument);
      if (id == "expansion" && !row.axis.empty()) shared = "expansion of axis " + row.axis;
      if (shared.empty() || u == 0.0)
        repeat += u * u;
      else
        row.common.push_back({std::move(shared), u});
    }
    row.u_repeat = std::sqrt(repeat);
  }

  void read_findings(dom::object of, const std::string& measurement) {
    for (const dom::object f : list_at(of, "findings")) {
      const std::string own = text_at(f, "measurement");
      entry_.findings.push_back({own.empty() ? measurement : own,
                                 std::string(std::string_view(of["plugin"])),
                                 std::string(std::string_view(f["id"])), text_at(f, "severity")});
    }
  }

  void read_certificate(dom::object c) {
    CertificateRow row{text_at(c, "number"), text_at(c, "date"), text_at(c, "replaces"),
                       entry_.campaign_sha256};
    if (!row.number.empty()) entry_.certificate = std::move(row);
  }

  std::string axis_of(const std::string& measurement) const {
    const auto found = axes_.find(measurement);
    return found == axes_.end() ? std::string() : found->second;
  }
  std::string state_of(const std::string& measurement) const {
    const auto found = states_.find(measurement);
    return found == states_.end() ? state({}) : found->second;
  }

  dom::object json_;
  Entry entry_;
  std::map<std::string, std::string> axes_, states_;
};

/// Writes each field with its length, so that different entries never give the same text.
class Canonical {
 public:
  Canonical& operator()(std::string_view text) {
    out_ += std::to_string(text.size()) + ':';
    out_ += text;
    return *this;
  }
  Canonical& operator()(double x) {
    std::array<char, 32> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), x);
    return (*this)(std::string_view(text.data(), static_cast<std::size_t>(end - text.data())));
  }
  Canonical& operator()(const std::optional<double>& x) {
    return x ? (*this)(*x) : (*this)(std::string_view("-"));
  }
  Canonical& operator()(std::size_t n) { return (*this)(std::string_view(std::to_string(n))); }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

void put_result(Canonical& put, const ResultRow& r) {
  put(r.measurement)(r.axis)(r.quantity)(r.source)(r.unit)(r.state)(r.value)(r.u_repeat);
  put(r.expanded)(r.k)(r.tolerance)(r.decision)(r.conditions)(r.not_stated)(r.common.size());
  for (const CommonPart& c : r.common) put(c.source)(c.u);
}

std::string canonical_of(const Entry& e) {
  Canonical put;
  put(e.campaign)(e.campaign_sha256)(e.day)(e.customer)(e.purpose)(e.status)(e.message);
  put(e.machine.asset)(e.machine.maker)(e.machine.model)(e.machine.serial);
  if (!e.place.empty() || !e.control.empty()) put(e.place)(e.control);
  const InstrumentAsStated& i = e.instrument;
  put(i.maker)(i.model)(i.serial)(i.calibrated)(i.certificate)(i.valid_until);
  put(e.results.size());
  for (const ResultRow& r : e.results) put_result(put, r);
  put(e.covariance.size());
  for (const CovarianceRow& c : e.covariance) {
    put(std::to_string(c.first))(std::to_string(c.count));
    for (const double x : c.upper) put(x);
    if (!c.other_targets.empty()) put(c.other_targets);
  }
  put(e.findings.size());
  for (const FindingRow& f : e.findings) put(f.measurement)(f.source)(f.id)(f.severity);
  for (const ControlTableRow& t : e.control_tables) put(t.measurement)(t.axis)(t.state);
  for (const LimitRow& l : e.without_value)
    put(l.measurement)(l.axis)(l.quantity)(l.unit)(l.tolerance);
  return put.take();
}

}  // namespace

std::string campaign_sha256(const reading::Inputs& inputs) {
  std::vector<std::string> own;
  for (const auto& [name, digest] : inputs)
    if (name != "site.toml" && name != "plugins" && name != "templates" && name != "version" &&
        !name.starts_with(config::machine_prefix))
      own.push_back(name + '\n' + digest);
  std::sort(own.begin(), own.end());
  std::string all;
  for (const std::string& one : own) all += one + '\n';
  return storage::sha256(all);
}

std::string digest_of(const Entry& e) { return storage::sha256(canonical_of(e)); }

Entry read_entry(dom::object results, const reading::Inputs& inputs) {
  return EntryReader(results, inputs).read();
}

Expected<Entry> entry_of(std::string_view results, const reading::Inputs& inputs,
                         const std::string& id) {
  try {
    dom::parser parser;
    Entry entry = read_entry(parser.parse(results), inputs);
    // A database server cannot store a character 0.
    std::string texts = canonical_of(entry);
    if (const auto& c = entry.certificate) texts += c->number + c->day + c->replaces;
    if (texts.find('\0') != std::string::npos)
      return fail(std::string(evaluation::results_name) + ": a text with a character 0 in it");
    if (entry.campaign == id) return entry;
    return fail(std::string(evaluation::results_name) + ": expected campaign " + id + ", found \"" +
                entry.campaign + "\"");
  } catch (const simdjson::simdjson_error& e) {
    if (e.error() == simdjson::MEMALLOC) throw std::bad_alloc();
    return fail(std::string(evaluation::results_name) + " cannot be read: " + e.what());
  } catch (const std::runtime_error& e) {
    return fail(std::string(evaluation::results_name) + ": " + e.what());
  }
}

}  // namespace nonio::store
