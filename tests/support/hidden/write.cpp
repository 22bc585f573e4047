// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "hidden/generator.h"
#include "nonio/sdk/format.h"

namespace nonio::hidden {
namespace {

std::string quoted(const std::vector<std::string>& words) {
  std::string text = "[";
  for (const std::string& w : words) text += (text.size() > 1 ? ", \"" : "\"") + w + "\"";
  return text + "]";
}

/// With all digits.
std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 64> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string manifest(const Hidden& h) {
  const Axis& axis = h.campaign.machine.axes.front();
  std::string text =
      "# Simulated: nobody measured this machine.\nformat = 1\n\n[campaign]\nid = \"" +
      h.campaign.id + "\"\ncustomer = \"" + h.campaign.customer + "\"\n\n[machine.axes." +
      axis.name + "]\nkind = \"" + (axis.rotary ? "rotary" : "linear") + "\"\n";
  if (axis.screw_pitch)
    text += "screw_pitch_mm = " + number(printed(*axis.screw_pitch, Quantity::length)) + "\n";
  if (axis.teeth) text += "teeth = " + std::to_string(*axis.teeth) + "\n";
  const Measurement& m = h.campaign.measurements.front();
  text += "\n[[measurement]]\nid = \"" + m.id + "\"\nkind = \"axis\"\naxis = \"" + m.axis +
          "\"\nfile = \"" + m.file + "\"\n";
  if (!h.campaign.model.empty()) text += "\n[model]\neffects = " + quoted(h.campaign.model) + "\n";
  return text;
}

std::string readings(const Hidden& h) {
  const Observations& o = h.table;
  const Observations::AxisColumn& axis = o.axes.front();
  std::string text = axis.rotary ? "run,direction,target_deg,deviation_arcsec"
                                 : "run,direction,target_mm,deviation_um";
  if (!o.time.empty()) text += ",time_s";
  if (!o.material.empty()) text += ",material_c";
  text += "\n";
  const auto at = axis.rotary ? Quantity::angle : Quantity::length;
  const auto off = axis.rotary ? Quantity::angular_deviation : Quantity::deviation;
  for (std::size_t i = 0; i < o.size(); ++i) {
    text += std::to_string(o.run[i]) + (axis.approach[i] > 0 ? ",+," : ",-,") +
            fixed_text(printed(axis.position[i], at), 3) + "," +
            fixed_text(printed(o.deviation[i], off), 4);
    if (!o.time.empty()) text += "," + fixed_text(o.time[i], 1);
    if (!o.material.empty()) text += "," + fixed_text(o.material[i], 2);
    text += "\n";
  }
  return text;
}

std::string truth_text(const Hidden& h) {
  const Truth& t = h.truth;
  std::ostringstream out;
  out << "{\"schema\": \"nonio-hidden-truth/1\", \"seed\": " << h.scenario.seed
      << ",\n \"verdict\": \"" << t.verdict << "\",\n \"model\": " << quoted(t.model)
      << ",\n \"hidden\": " << quoted(t.hidden) << ",\n \"places\": " << quoted(t.places)
      << ",\n \"at_si\": " << (t.at ? number(*t.at) : "null")
      << ",\n \"noise_si\": " << number(h.scenario.noise) << ",\n \"causes\": [";
  std::size_t k = 0;
  for (const auto* pieces : {&h.scenario.model, &h.scenario.hidden})
    for (const Piece& p : *pieces)
      out << (k++ ? ", " : "") << "{\"cause\": \"" << to_text(p.source)
          << "\", \"rms_in_noise\": " << number(p.size) << "}";
  out << "],\n \"values\": [";
  for (k = 0; k < t.values.size(); ++k)
    out << (k ? ", " : "") << "{\"effect\": \"" << t.values[k].effect << "\", \"name\": \""
        << t.values[k].name << "\", \"value_si\": " << number(t.values[k].value) << "}";
  out << "],\n \"misread_lines\": [";
  for (k = 0; k < h.misread.size(); ++k)
    out << (k ? ", " : "") << h.table.source_line[h.misread[k]];
  out << "]}\n";
  return out.str();
}

Expected<void> put(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  if (!file) return fail("cannot write " + path.string());
  return {};
}

}  // namespace

Expected<void> write(const Hidden& h, const std::filesystem::path& folder,
                     const std::filesystem::path& truth) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail("cannot make the folder " + folder.string() + ": " + error.message());
  auto done = put(folder / "campaign.toml", manifest(h));
  if (done) done = put(folder / h.campaign.measurements.front().file, readings(h));
  if (done) done = put(truth, truth_text(h));
  return done;
}

}  // namespace nonio::hidden
