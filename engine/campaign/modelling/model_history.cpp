// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_history.h"

#include "platform/storage/files.h"
#include "platform/storage/json_numbers.h"

namespace nonio::modelling {

namespace {

constexpr std::pair<const char*, std::optional<double> ModelStep::*> step_numbers[] = {
    {"rms_before", &ModelStep::rms_before},
    {"rms_after", &ModelStep::rms_after},
    {"cv_rms_before", &ModelStep::cv_before},
    {"cv_rms_after", &ModelStep::cv_after},
    {"noise_floor", &ModelStep::floor}};

ModelStep step_of(const storage::Json& json) {
  ModelStep step;
  step.why = json.value("why", "");
  const auto action = json.at("action").get<std::string>();
  if (action == "exclude") {
    step.excluded = Exclusion{json.at("measurement").get<std::string>(),
                              json.at("lines").get<std::vector<std::uint32_t>>(), step.why};
    return step;
  }
  if (action == "period") {
    step.period = Period{json.at("axis").get<std::string>(), json.at("period_mm").get<double>()};
    return step;
  }
  step.effect = json.at("effect").get<std::string>();
  step.added = action == "add";
  for (const auto& [name, member] : step_numbers)
    if (const auto number = storage::get(json, name)) {
      step.*member = number->value;
      step.quantity = number->quantity;
    }
  return step;
}

}  // namespace

std::string history_line(const ModelStep& step) {
  storage::Json json;
  if (step.excluded)
    json = {{"action", "exclude"},
            {"measurement", step.excluded->measurement},
            {"lines", step.excluded->lines}};
  else if (step.period)
    json = {{"action", "period"}, {"axis", step.period->axis}, {"period_mm", step.period->mm}};
  else
    json = {{"action", step.added ? "add" : "drop"}, {"effect", step.effect}};
  for (const auto& [name, member] : step_numbers)
    storage::put(json, name, step.*member, step.quantity);
  if (!step.why.empty()) json["why"] = step.why;
  return storage::dump_line(json) + "\n";
}

Expected<std::vector<ModelStep>> parse_history(std::string_view text) {
  std::vector<ModelStep> steps;
  std::uint64_t line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view one = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (one.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    try {
      steps.push_back(step_of(storage::parse(one)));
    } catch (const storage::Json::exception&) {
      return fail(Error{"expected a change of the model as `nonio model` writes it; found \"" +
                            std::string(one.substr(0, 60)) + "\" (the file may be deleted)",
                        history_name, line});
    }
  }
  return steps;
}

Expected<std::vector<ModelStep>> read_history(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / history_name, error)) return std::vector<ModelStep>{};
  NONIO_TRY(const auto text, storage::read_file(folder / history_name));
  return parse_history(text);
}

}  // namespace nonio::modelling
