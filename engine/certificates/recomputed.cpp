// SPDX-License-Identifier: Apache-2.0
#include "certificates/recomputed.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "campaign/evaluation/record.h"
#include "nonio/sdk/format.h"
#include "nonio/sign/dcc.h"
#include "platform/storage/json_values.h"

namespace nonio::certificates {

namespace {

constexpr const char* no_results =
    "the attached results.json is none, or has a key twice in one object";

/// Tolerance 1e-9 plus 1e-9 of the larger number: last printed digits may depend on the processor.
bool same(double a, double b) {
  return std::fabs(a - b) <= 1e-9 + 1e-9 * std::max(std::fabs(a), std::fabs(b));
}

class Comparison {
 public:
  std::size_t numbers = 0;
  std::string difference;

  void compare(const storage::Json& attached, const storage::Json& again,
               const std::string& where) {
    if (!difference.empty()) return;
    if (attached.is_number() && again.is_number()) {
      ++numbers;
      if (!same(attached.get<double>(), again.get<double>()))
        difference = where + " is " + attached.dump() + " in the certificate, and " + again.dump() +
                     " from the attached readings";
    } else if (attached.is_object() && again.is_object()) {
      compare_objects(attached, again, where);
    } else if (attached.is_array() && again.is_array() && attached.size() == again.size()) {
      for (std::size_t i = 0; i < attached.size(); ++i)
        compare(attached[i], again[i], where + "[" + std::to_string(i) + "]");
    } else if (attached != again) {
      difference = where + " differs";
    }
  }

 private:
  void compare_objects(const storage::Json& attached, const storage::Json& again,
                       const std::string& where) {
    // Certificates of earlier versions state neither k, which was 2, nor the budget.
    for (const auto& [key, value] : again.items())
      if (!attached.contains(key) && key != "k" && key != "budget")
        difference = where + " lacks " + key;
    for (const auto& [key, value] : attached.items()) {
      if (!again.contains(key)) {
        difference = where + " " + key + " is not found again";
        return;
      }
      compare(value, again[key], where + " " + key);
    }
  }
};

storage::Json values_of(const storage::Json& analysis) {
  storage::Json out = storage::Json::object();
  for (const char* key :
       {"values", "points", "point_units", "point_U", "rows", "row_units", "series", "budget"})
    if (analysis.contains(key)) out[key] = analysis[key];
  return out;
}

std::string name_of(const storage::Json& analysis) {
  std::string name = analysis.value("plugin", "?");
  const std::string measurement = analysis.value("measurement", "");
  return measurement.empty() ? name : name + " of " + measurement;
}

/// Analyses may have the same name: a model for each displacement of a measurement.
std::vector<const storage::Json*> all_of_name(const storage::Json& results,
                                              const std::string& name) {
  std::vector<const storage::Json*> out;
  for (const storage::Json& a : results["analyses"])
    if (name_of(a) == name) out.push_back(&a);
  return out;
}

bool is_analysis(const storage::Json& a) {
  return a.is_object() && a.contains("plugin") && a["plugin"].is_string() &&
         (!a.contains("measurement") || a["measurement"].is_string()) &&
         (!a.contains("values") || a["values"].is_object());
}

bool is_results(const storage::Json& json) {
  if (!json.is_object() || !json.contains("analyses") || !json["analyses"].is_array()) return false;
  return std::all_of(json["analyses"].begin(), json["analyses"].end(), is_analysis);
}

}  // namespace

Expected<std::string> same_values(std::string_view attached_text, std::string_view again_text) {
  const storage::Json attached = storage::parse_once(attached_text);
  const storage::Json again = storage::parse_or_discard(again_text);
  if (!is_results(attached) || !is_results(again)) return fail(no_results);
  Comparison comparison;
  std::map<std::string, std::size_t> taken;
  for (const storage::Json& a : attached["analyses"]) {
    const auto same = all_of_name(again, name_of(a));
    const std::size_t place = taken[name_of(a)]++;
    if (place >= same.size())
      return fail("the analysis " + name_of(a) +
                  " is not found again: is its plugin installed (`nonio plugin list`)?");
    comparison.compare(values_of(a), values_of(*same[place]), name_of(a));
  }
  if (attached["analyses"].size() != again["analyses"].size())
    return fail("the attached readings give " + std::to_string(again["analyses"].size()) +
                " analyses, the certificate has " + std::to_string(attached["analyses"].size()));
  const auto decisions = [](const storage::Json& r) {
    return r.contains("conformity") ? r["conformity"] : storage::Json::array();
  };
  comparison.compare(decisions(attached), decisions(again), "conformity");
  if (!comparison.difference.empty()) return fail(comparison.difference);
  if (comparison.numbers == 0) return fail("the certificate holds no value");
  return "the attached readings give the same " + std::to_string(comparison.numbers) +
         " numbers in " + std::to_string(attached["analyses"].size()) + " analyses";
}

namespace {

/// Replaces numbers and SHA-256 digests, which may depend on the processor. Texts with the same
/// shape have the same keys in the same order, so every JSON parser reads them in the same way.
std::string shape_of(std::string_view json) {
  constexpr std::string_view number = "+-.0123456789eE";
  constexpr std::size_t digest = 64;
  std::string shape;
  for (std::size_t i = 0; i < json.size();) {
    if (json[i] == '"') {
      std::size_t end = i + 1;
      while (end < json.size() && json[end] != '"') end += json[end] == '\\' ? 2 : 1;
      const std::string_view text = json.substr(i + 1, end - i - 1);
      shape += text.size() == digest && text.find_first_not_of("0123456789abcdef") == text.npos
                   ? "\"#"
                   : "\"" + std::string(text);
      shape += '"';
      i = end + 1;
    } else if (json[i] == '-' || (json[i] >= '0' && json[i] <= '9')) {
      shape += '#';
      i = std::min(json.find_first_not_of(number, i), json.size());
    } else {
      shape += json[i++];
    }
  }
  return shape;
}

/// Digests of files that are not attached may depend on the processor.
void forget_digests(storage::Json& results, const std::vector<std::string>& attached) {
  if (!results.contains("outputs") || !results["outputs"].is_array()) return;
  for (storage::Json& file : results["outputs"])
    if (file.is_object() && file.contains("file") &&
        std::find(attached.begin(), attached.end(), file["file"]) == attached.end())
      file.erase("sha256");
}

}  // namespace

Expected<void> same_results(std::string_view attached_text, std::string_view again_text,
                            const std::vector<std::string>& files) {
  storage::Json attached = storage::parse_once(attached_text);
  storage::Json again = storage::parse_or_discard(again_text);
  if (!is_results(attached) || !is_results(again)) return fail(no_results);
  forget_digests(attached, files);
  forget_digests(again, files);
  Comparison comparison;
  comparison.compare(attached, again, evaluation::results_name);
  if (!comparison.difference.empty()) return fail(comparison.difference);
  if (shape_of(attached_text) != shape_of(again_text))
    return fail(std::string(evaluation::results_name) +
                " has the same values, but not the text that a run writes: its order or its white "
                "space differs");
  return {};
}

namespace {

bool is_number(const storage::Json& value, const char* key) {
  return value.is_object() && value.contains(key) && value[key].is_number();
}

/// A DCC states digits rounded according to U; DCCs of earlier versions stated all digits. `U`: NaN
/// without an uncertainty.
bool same_when_rounded(const sign::DccValue& v, double value, double U) {
  if (v.U.has_value() != std::isfinite(U)) return false;
  const double stated_U = v.U.value_or(0.0);
  if (same(value, v.value) && (!v.U || same(U, stated_U))) return true;
  const auto rounded = rounded_result(value, U);
  return rounded && std::strtod(rounded->value.c_str(), nullptr) == v.value &&
         std::strtod(rounded->U.c_str(), nullptr) == stated_U;
}

/// Returns an empty text if the value agrees with `value` of results.json.
std::string contradiction(const sign::DccValue& v, const storage::Json& value) {
  if (!is_number(value, "value")) return "is no number in results.json";
  if (!value.contains("unit") || value["unit"] != v.unit) return "has another unit in results.json";
  const bool has_U = is_number(value, "U");
  if (!same_when_rounded(v, value["value"].get<double>(),
                         has_U ? value["U"].get<double>() : std::nan("")))
    return "is another number in results.json, or has another uncertainty there";
  // Results of earlier versions do not state k, which was 2.
  if (has_U && !same(is_number(value, "k") ? value["k"].get<double>() : 2.0, v.k))
    return "has another coverage factor in results.json";
  return {};
}

/// Returns an empty text if one of the analyses of this name has the value.
std::string contradiction_in(const storage::Json& results, const sign::DccValue& v) {
  std::string why = "is not in results.json";
  for (const storage::Json* a : all_of_name(results, v.analysis)) {
    if (!a->contains("values") || !(*a)["values"].contains(v.name)) continue;
    why = contradiction(v, (*a)["values"][v.name]);
    if (why.empty()) return {};
  }
  return v.analysis + " " + v.name + " " + why;
}

}  // namespace

sign::Check check_dcc(const pdf::Attachment& dcc, const pdf::Attachment* results) {
  using State = sign::Check::State;
  sign::Check check{"dcc.values", State::fails, {}};
  const auto values = sign::read_dcc(dcc.bytes);
  if (!values) {
    check.says = dcc.name + ": " + values.error().message;
    return check;
  }
  const std::string count = std::to_string(values->size()) + " values, units and lists sound";
  check.state = State::holds;
  check.says = dcc.name + ": " + count;
  if (results == nullptr) {
    check.says += "; by itself, without results to compare";
    return check;
  }
  const storage::Json json = storage::parse_once(results->bytes);
  std::string wrong = is_results(json) ? "" : no_results;
  for (const sign::DccValue& v : *values)
    if (wrong.empty()) wrong = contradiction_in(json, v);
  if (wrong.empty()) {
    check.says += ", the same as in results.json";
  } else {
    check.state = State::fails;
    check.says = dcc.name + ": " + wrong;
  }
  return check;
}

}  // namespace nonio::certificates
