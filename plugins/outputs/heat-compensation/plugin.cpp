// SPDX-License-Identifier: Apache-2.0
// The model of displacements over time as the thermal compensation of a control.
#include "formats.h"

namespace nonio::heat_compensation {

namespace {

Finding refusal(std::string id, const Format& format, const Law& law) {
  return {
      .id = std::move(id),
      .attention = true,
      .texts = {{"control", format.name}, {"axis", law.axis}, {"displacement", law.displacement}}};
}

void add(OutputResult& result, const OutputInput& in, const Format& format, const Law& law) {
  if (std::string id = format.refusal(law); !id.empty()) {
    result.findings.push_back(refusal(std::move(id), format, law));
    return;
  }
  if (!(law.after < law.before)) {
    Finding f = refusal("heat-compensation.no-gain", format, law);
    f.evidence = {{"before", law.before, Quantity::deviation},
                  {"after", law.after, Quantity::deviation}};
    result.findings.push_back(std::move(f));
    return;
  }
  for (Artifact& file : format.files(in, law)) result.artifacts.push_back(std::move(file));
  result.predictions.push_back(
      {law.measurement, law.displacement + " RMS", law.before, law.after, Quantity::deviation});
  result.notes.push_back({.id = "heat-compensation.predicted",
                          .evidence = {{"before", law.before, Quantity::deviation},
                                       {"after", law.after, Quantity::deviation}},
                          .texts = {{"displacement", law.displacement}, {"axis", law.axis}},
                          .measurement = law.measurement});
  for (const std::string& effect : law.left_out)
    result.notes.push_back({.id = effect.find('@') == std::string::npos
                                      ? "heat-compensation.left-out"
                                      : "heat-compensation.grouped",
                            .texts = {{"effect", effect}, {"displacement", law.displacement}},
                            .measurement = law.measurement});
}

Expected<OutputResult> write(const OutputInput& in) {
  const std::string control = in.options.text("control");
  OutputResult result;
  auto all = laws(in, result.findings);
  if (!all) return tl::unexpected<Error>(all.error());
  if (all->empty() && result.findings.empty())
    result.findings.push_back({.id = "heat-compensation.no-model", .attention = true});
  for (const Format& format : formats()) {
    if (format.name != control) continue;
    for (const Law& law : *all) add(result, in, format, law);
    if (format.note != nullptr && !result.artifacts.empty())
      result.notes.push_back({.id = format.note, .texts = {{"control", control}}});
  }
  return result;
}

std::vector<std::string> controls() {
  std::vector<std::string> out;
  for (const Format& format : formats()) out.emplace_back(format.name);
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {
      "heat-compensation",
      "1.0.0",
      "The model of displacements over time as the thermal compensation of a control.",
      {{.name = "control",
        .default_value = std::string("linuxcnc"),
        .unit = "",
        .help = "The control that compensates.",
        .choices = controls()},
       {.name = "axes",
        .default_value = std::vector<std::string>{},
        .unit = "",
        .help = "Axis of each displacement, \"ch3 = Z\", or \"ch3 = -Z\" where the sensor counts "
                "against the axis; without it z, z1, ... are of Z."},
       {.name = "period_s",
        .default_value = 0.001,
        .unit = "s",
        .help = "Period of the thread that runs the filters (linuxcnc).",
        .min = 1e-5,
        .max = 1.0}},
      true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::heat_compensation
