// SPDX-License-Identifier: Apache-2.0
#include "runs.h"

#include <algorithm>
#include <cmath>

namespace nonio::readers {

Error at_line(std::uint64_t line, std::string message) {
  Error error{std::move(message)};
  error.line = line;
  return error;
}

std::vector<std::string_view> by_blanks(std::string_view line) {
  constexpr std::string_view blanks = " \t";
  std::vector<std::string_view> fields;
  std::size_t from = line.find_first_not_of(blanks);
  while (from < line.size()) {
    const std::size_t to = std::min(line.find_first_of(blanks, from), line.size());
    fields.push_back(line.substr(from, to - from));
    from = line.find_first_not_of(blanks, to);
  }
  return fields;
}

std::optional<std::vector<std::string_view>> by_separator(std::string_view line, char separator) {
  if (separator == ' ') return by_blanks(line);
  if (separator == '|') {
    line = trimmed(line);
    if (line.starts_with('|')) line.remove_prefix(1);
    if (line.ends_with('|')) line.remove_suffix(1);
  }
  std::vector<std::string_view> fields;
  if (!split(line, separator, fields)) return std::nullopt;
  return fields;
}

Expected<double> Numbers::reading(std::string_view text, std::uint64_t line,
                                  std::string_view what) {
  const Field field = parse_number(text, comma_allowed_);
  if (field.kind == Field::Kind::bad)
    return fail(at_line(line, "expected " + std::string(what) + ", found " + shown(text)));
  if (field.mark != DecimalMark::none) {
    const bool point = field.mark == DecimalMark::point;
    std::uint64_t& first = point ? first_point_ : first_comma_;
    const std::uint64_t other = point ? first_comma_ : first_point_;
    if (first == 0) first = line;
    if (other != 0)
      return fail(at_line(line, "found " + shown(text) + " with a decimal " +
                                    (point ? "point" : "comma") + ", but a decimal " +
                                    (point ? "comma" : "point") + " in line " +
                                    std::to_string(other) + "; expected the same everywhere"));
  }
  return field.kind == Field::Kind::taken ? field.value : std::numeric_limits<double>::quiet_NaN();
}

Expected<double> Numbers::number(std::string_view text, std::uint64_t line, std::string_view what) {
  auto value = reading(text, line, what);
  if (value && std::isnan(*value))
    return fail(at_line(line, "expected " + std::string(what) + ", found " + shown(text)));
  return value;
}

std::uint32_t whole_number(std::string_view text, std::uint32_t most) {
  const std::uint32_t n = parse_run(text);
  return n <= most ? n : 0;
}

bool is_other_axis(const Machine& machine, const Measurement& m, std::string_view name) {
  const std::string own = control_axis(machine, m);
  if (name.empty() || name == own || (name == m.axis && m.side != "slave")) return false;
  for (const Axis& axis : machine.axes)
    if ((name == axis.name && axis.name != m.axis) || name == axis.slave) return true;
  // With numbered gantry sides, X1 and X2 differ.
  return m.side == "slave" && name.size() == own.size() && name.size() > 1 &&
         name.substr(0, name.size() - 1) == own.substr(0, own.size() - 1) && name.back() >= '0' &&
         name.back() <= '9';
}

bool is_other_letter(std::string_view own, std::string_view name) {
  constexpr std::string_view letters = "XYZABCUVW", figures = "0123456789";
  return !own.empty() && !name.empty() && name.size() <= 2 &&
         letters.find(name[0]) != letters.npos && name[0] != own[0] &&
         (name.size() == 1 || figures.find(name[1]) != figures.npos);
}

Expected<const Axis*> axis_of(const ReadInput& input) {
  const Measurement& m = input.measurement;
  const Axis* const axis = input.campaign.machine.axis(m.axis);
  if (axis == nullptr)
    return fail("expected the axis of measurement \"" + m.id + "\" in [machine.axes], found " +
                (m.axis.empty() ? "none" : "\"" + m.axis + "\""));
  return axis;
}

Expected<Observations> read_of_axis(const ReadInput& input,
                                    Expected<Observations> (*read)(const ReadInput&, const Axis&)) {
  NONIO_TRY(const Axis* axis, axis_of(input));
  auto obs = read(input, *axis);
  if (!obs && obs.error().key.empty()) obs.error().file = input.measurement.file;
  return obs;
}

Runs::Runs(const ReadInput& input, const Axis& axis, bool angular) {
  const Measurement& m = input.measurement;
  obs_.measurement = m.id;
  obs_.angular = angular;
  obs_.axes.push_back({axis.name, axis.rotary, {}, {}});
  Observations::Line line;
  line.name = m.id;
  if (const std::size_t k = coordinate_of(axis.name); !angular && k < 3) line.sense[k] = 1.0;
  obs_.lines.push_back(line);
}

Expected<void> Runs::add(const Reading& r) {
  const auto [known, first] = lines_.try_emplace({r.run, r.approach, r.target}, r.line);
  if (!first)
    return fail(at_line(r.line, "a reading of the same run, direction and target as in line " +
                                    std::to_string(known->second) + "; expected each once"));
  if (std::isnan(r.deviation)) {
    ++obs_.missing;
    if (not_taken_.empty() || not_taken_.back() != r.line) not_taken_.push_back(r.line);
    return {};
  }
  obs_.deviation.push_back(r.deviation);
  obs_.axes[0].position.push_back(r.target);
  obs_.axes[0].approach.push_back(r.approach);
  obs_.run.push_back(r.run);
  obs_.source_line.push_back(static_cast<std::uint32_t>(r.line));
  if (std::isfinite(r.time)) obs_.time.push_back(r.time);
  return {};
}

Expected<Observations> Runs::finish() {
  if (obs_.size() == 0)
    return fail("expected readings, found " + std::to_string(obs_.missing) +
                " of which not one was taken");
  if (!not_taken_.empty()) {
    constexpr std::size_t most = 20;
    std::string lines;
    for (std::size_t k = 0; k < std::min(most, not_taken_.size()); ++k)
      lines += (k == 0 ? "" : ", ") + std::to_string(not_taken_[k]);
    obs_.notes.push_back({"readings.lines-not-taken",
                          {},
                          {{"lines", lines + (not_taken_.size() > most ? ", ..." : "")}}});
  }
  return std::move(obs_);
}

int sense_of(const std::vector<double>& values) {
  bool rises = values.size() > 1, falls = rises;
  for (std::size_t i = 1; i < values.size(); ++i) {
    rises = rises && values[i] > values[i - 1];
    falls = falls && values[i] < values[i - 1];
  }
  return rises ? 1 : falls ? -1 : 0;
}

Straight straight_through(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double x_mean = 0.0, y_mean = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) x_mean += x[i] / n, y_mean += y[i] / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - x_mean) * (x[i] - x_mean);
    xy += (x[i] - x_mean) * (y[i] - y_mean);
  }
  const double slope = xy / xx;
  return {y_mean - slope * x_mean, slope};
}

Number counted(std::string name, std::uint64_t n) {
  return {std::move(name), static_cast<double>(n), Quantity::count};
}

}  // namespace nonio::readers
