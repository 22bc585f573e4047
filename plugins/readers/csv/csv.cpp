// SPDX-License-Identifier: Apache-2.0
#include "csv.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "comments.h"
#include "duplicates.h"
#include "header.h"
#include "lines.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "spatial.h"

namespace nonio::csv {
using namespace readers;
namespace {

constexpr std::size_t report_every = std::size_t{4} << 20U;

/// From line counts in windows of the file; only used to reserve memory.
std::size_t estimated_rows(std::string_view bytes, std::size_t columns) {
  constexpr std::size_t window = 4096, windows = 64;
  if (bytes.empty()) return 0;
  const std::size_t shortest = 2 * columns;  // per row: a character and a separator per field
  const std::size_t pieces = bytes.size() <= window * windows ? 1 : windows;
  const std::size_t length = pieces == 1 ? bytes.size() : window;
  std::size_t lines = 0;
  for (std::size_t k = 0; k < pieces; ++k) {
    const std::size_t first = pieces == 1 ? 0 : (bytes.size() - length) / (pieces - 1) * k;
    const std::string_view part = bytes.substr(first, length);
    lines += static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n'));
  }
  const double share = static_cast<double>(lines) / static_cast<double>(pieces * length);
  const auto rows = static_cast<std::size_t>(share * 1.02 * static_cast<double>(bytes.size()));
  return std::min(rows, bytes.size() / shortest) + 64;
}

class Rows {
 public:
  Rows(const Header& header, const Expectation& expectation, Observations& obs)
      : header_(header),
        position_scale_(unit_of(position_of(expectation.rotary)).per_si),
        deviation_scale_(unit_of(deviation_of(expectation.angular_reading())).per_si),
        obs_(obs) {}

  void reserve(std::size_t rows);
  /// False if the row is invalid; `error` contains the reason. A bool is used for speed.
  bool add(std::string_view line, std::uint64_t number);
  const Error& error() const { return error_; }
  Expected<void> finish();

 private:
  struct Row {
    Key key;
    double target = 0.0;   ///< in the unit of the file
    double reading = 0.0;  ///< in the unit of the file
    bool taken = false;
    double extra[5] = {};  ///< values of time and the roles after it
  };
  struct Sample {
    double time, value;
  };
  bool parse_field(std::size_t column, Row& row);
  bool parse(std::size_t column, Field& number);
  bool consistent_mark(const Field& number, std::size_t column);
  Error bad_number(std::size_t column) const;
  Error wrong_count(std::string_view line) const;
  std::vector<double>& extra_column(std::size_t k);
  void store(const Row& row);
  bool refuse(Error error) {
    error_ = std::move(error);
    return false;
  }
  Error at(std::size_t column, std::string message) const {
    Error error{std::move(message)};
    error.column = header_.names[column];
    return error;
  }
  static bool extra(Role role) { return role >= Role::time && role != Role::channel; }
  void put_channels();
  static std::size_t extra_index(Role role) {
    return static_cast<std::size_t>(role) - static_cast<std::size_t>(Role::time);
  }

  const Header& header_;
  double position_scale_, deviation_scale_;
  Observations& obs_;
  std::vector<std::string_view> fields_;
  std::uint64_t line_ = 0;
  std::uint64_t first_point_ = 0, first_comma_ = 0;  ///< first line with each decimal mark, or 0
  std::uint64_t empty_rows_ = 0;
  std::vector<Key> not_taken_;
  std::vector<double> channel_;  ///< channel values of the row, by column
  std::vector<std::vector<Sample>> samples_;
  PassOrder order_;
  Error error_;
};

std::vector<double>& Rows::extra_column(std::size_t k) {
  std::vector<double>* const columns[] = {&obs_.time, &obs_.material, &obs_.air, &obs_.pressure,
                                          &obs_.humidity};
  return *columns[k];
}

void Rows::reserve(std::size_t rows) {
  obs_.deviation.reserve(rows);
  obs_.axes[0].position.reserve(rows);
  obs_.axes[0].approach.reserve(rows);
  obs_.run.reserve(rows);
  obs_.source_line.reserve(rows);
  for (const Role role : header_.roles)
    if (extra(role)) extra_column(extra_index(role)).reserve(rows);
}

Error Rows::wrong_count(std::string_view line) const {
  std::string message = "expected " + std::to_string(header_.roles.size()) +
                        " fields as in the header row, found " + std::to_string(fields_.size());
  if (header_.separator == ',' && fields_.size() > header_.roles.size())
    message += "; a decimal comma needs \";\" or a tab between the fields";
  return Error{message + ": " + shown(line)};
}

Error Rows::bad_number(std::size_t column) const {
  const std::string_view text = fields_[column];
  std::string message = "expected a number, found " + shown(text);
  if (!header_.comma_allowed() && parse_number(text, true).kind == Field::Kind::taken)
    message += "; a decimal comma needs \";\" or a tab between the fields";
  else if (!text.empty() && text.find_first_not_of("0123456789.,' ") == text.npos)
    message += " (no thousands separators, one decimal mark)";
  return at(column, std::move(message));
}

/// Mixed decimal marks are refused, because 1.234 in a file with decimal commas may mean 1234.
bool Rows::consistent_mark(const Field& number, std::size_t column) {
  const bool point = number.mark == DecimalMark::point;
  std::uint64_t& first = point ? first_point_ : first_comma_;
  const std::uint64_t other = point ? first_comma_ : first_point_;
  if (first == 0) first = line_;
  if (other == 0) return true;
  return refuse(at(column, "found " + shown(fields_[column]) + " with a decimal " +
                               (point ? "point" : "comma") + ", but a decimal " +
                               (point ? "comma" : "point") + " in line " + std::to_string(other) +
                               "; expected the same everywhere"));
}

bool Rows::parse(std::size_t column, Field& number) {
  number = parse_number(fields_[column], header_.comma_allowed());
  if (number.kind == Field::Kind::bad) return refuse(bad_number(column));
  if (number.mark == DecimalMark::none || !header_.comma_allowed()) return true;
  return consistent_mark(number, column);
}

bool Rows::parse_field(std::size_t column, Row& row) {
  const std::string_view text = fields_[column];
  const Role role = header_.roles[column];
  if (role == Role::ignored) return true;
  if (role == Role::run) {
    row.key.run = parse_run(text);
    if (row.key.run != 0) return true;
    return refuse(at(column, "expected a whole number from 1 to 4294967295, found " + shown(text)));
  }
  if (role == Role::direction) {
    if (text != "+" && text != "-")
      return refuse(at(column, "expected + or -, found " + shown(text)));
    row.key.approach = text == "+" ? std::int8_t{1} : std::int8_t{-1};
    return true;
  }
  Field number;
  if (!parse(column, number)) return false;
  const bool taken = number.kind == Field::Kind::taken;
  if (role == Role::reading) {
    row.taken = taken;
    row.reading = number.value;
  } else if (role == Role::target) {
    if (!taken) return refuse(at(column, "expected a target, found " + shown(text)));
    row.target = number.value;
    row.key.target = number.value / position_scale_;
  } else if (role == Role::channel) {
    channel_.push_back(taken ? number.value : std::numeric_limits<double>::quiet_NaN());
  } else {
    row.extra[extra_index(role)] = taken ? number.value : std::numeric_limits<double>::quiet_NaN();
  }
  return true;
}

void Rows::store(const Row& row) {
  order_.see(row.key);
  if (!row.taken) {
    not_taken_.push_back(row.key);
    return;
  }
  // Subtraction before conversion, because 100.25 - 100 is exact and 0.10025 - 0.1 is not.
  const double deviation = header_.reading_is_position
                               ? (row.reading - row.target) / position_scale_
                               : row.reading / deviation_scale_;
  obs_.deviation.push_back(deviation);
  obs_.axes[0].position.push_back(row.key.target);
  obs_.axes[0].approach.push_back(row.key.approach);
  obs_.run.push_back(row.key.run);
  obs_.source_line.push_back(static_cast<std::uint32_t>(line_));
  for (const Role role : header_.roles)
    if (extra(role)) extra_column(extra_index(role)).push_back(row.extra[extra_index(role)]);
}

bool Rows::add(std::string_view line, std::uint64_t line_number) {
  line_ = line_number;
  if (!split(line, header_.separator, fields_))
    return refuse({"unterminated quoted field, or text after the closing quote: " + shown(line)});
  // Spreadsheets write rows that contain only separators.
  if (fields_[0].empty() &&
      std::all_of(fields_.begin(), fields_.end(), [](auto field) { return field.empty(); })) {
    ++empty_rows_;
    return true;
  }
  if (fields_.size() != header_.roles.size()) return refuse(wrong_count(line));
  Row row;
  channel_.clear();
  for (std::size_t column = 0; column < fields_.size(); ++column)
    if (!parse_field(column, row)) return false;
  store(row);
  samples_.resize(channel_.size());
  for (std::size_t k = 0; k < channel_.size(); ++k)
    if (std::isfinite(channel_[k]) && std::isfinite(row.extra[0]))
      samples_[k].push_back({row.extra[0], channel_[k]});
  return true;
}

void Rows::put_channels() {
  std::size_t k = 0;
  for (std::size_t column = 0; column < header_.roles.size(); ++column) {
    if (header_.roles[column] != Role::channel || k >= samples_.size()) continue;
    std::vector<Sample>& samples = samples_[k++];
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.time < b.time; });
    samples.erase(std::unique(samples.begin(), samples.end(),
                              [](const Sample& a, const Sample& b) { return a.time == b.time; }),
                  samples.end());
    const std::string& name = header_.names[column];
    for (const ChannelEnding& e : channel_endings) {
      if (!name.ends_with(e.end) || samples.empty()) continue;
      Observations::Channel channel{
          name.substr(0, name.size() - e.end.size()), std::string(e.unit), {}, {}};
      for (const Sample& s : samples)
        channel.time.push_back(s.time), channel.value.push_back(s.value);
      obs_.channels.push_back(std::move(channel));
      break;
    }
  }
}

Expected<void> Rows::finish() {
  if (obs_.size() == 0 && not_taken_.empty())
    return fail("expected readings, found only a header row");
  if (empty_rows_ > 0) obs_.notes.push_back({"csv.empty-rows", {count("rows", empty_rows_)}});
  obs_.missing = not_taken_.size();
  put_channels();
  if (!order_.unique())
    if (auto ok = settle_duplicates(obs_, not_taken_); !ok) return ok;
  if (obs_.size() == 0)
    return fail("expected readings, found " + std::to_string(obs_.missing) +
                " of which not one was taken");
  return {};
}

Expected<Expectation> expectation_of(const ReadInput& input) {
  const Measurement& m = input.measurement;
  if (m.kind == "diagonal") return Expectation{};
  const Axis* axis = input.campaign.machine.axis(m.axis);
  if (axis == nullptr)
    return fail("expected the axis of measurement \"" + m.id + "\" in [machine.axes], found " +
                (m.axis.empty() ? "none" : "\"" + m.axis + "\""));
  const bool straightness = m.kind == "straightness", angle = m.kind == "angle";
  if ((straightness || angle) && axis->rotary)
    return fail("expected a linear axis for " + std::string(angle ? "an angle" : "a straightness") +
                ", found the rotary axis \"" + m.axis + "\"");
  if (straightness && m.lateral.empty())
    return fail("expected `lateral`, the direction of the deviation, in measurement \"" + m.id +
                "\"");
  if (angle && m.lateral.empty())
    return fail("expected `about`, the axis about which it turns, in measurement \"" + m.id + "\"");
  return Expectation{m.axis, axis->rotary, straightness, angle};
}

Observations empty_observations(const Measurement& m, const Expectation& e) {
  Observations obs;
  obs.measurement = m.id;
  obs.angular = e.angular_reading();
  obs.axes.push_back({m.axis, e.rotary, {}, {}});
  Observations::Line line;
  line.name = m.id;
  const std::string& along = e.straightness ? m.lateral : m.axis;
  const std::size_t coordinate =
      along.empty() ? along.npos : std::string_view("XYZ").find(along[0]);
  if (!obs.angular && coordinate != along.npos) line.sense[coordinate] = 1.0;
  obs.lines.push_back(line);
  return obs;
}

Expected<std::string_view> header_line(Lines& lines, const StatedColumns& stated) {
  std::string_view line;
  std::optional<Error> error;
  std::vector<std::string_view> names;
  while (next_content(lines, line, error)) {
    if (stated.empty()) return line;
    if (split(line, find_separator(line, stated), names) && stated.all_in(names)) return line;
  }
  if (error) return fail(std::move(*error));
  return stated.empty() ? fail("expected a header row, found an empty file")
                        : fail("expected a row with the columns " + stated.list() +
                               " (option columns), found none");
}

Expected<Header> read_header(Lines& lines, const Expectation& expectation,
                             const StatedColumns& stated) {
  NONIO_TRY(const auto line, header_line(lines, stated));
  std::optional<Error> error;
  if ((error = not_text(line))) return fail(std::move(*error));
  if ((error = other_separator(lines.separator(), find_separator(line, stated))))
    return fail(std::move(*error));
  return parse_header(line, expectation, stated);
}

Expected<void> read_rows(const ReadInput& input, Lines& lines, const Header& header, Rows& rows) {
  rows.reserve(estimated_rows(input.bytes.substr(lines.offset()), header.roles.size()));
  std::size_t reported = 0;
  std::string_view line;
  std::optional<Error> error;
  while (next_content(lines, line, error)) {
    if (lines.number() > std::numeric_limits<std::uint32_t>::max())
      return fail("expected at most 4294967295 lines");
    if (line.size() > longest_line || !rows.add(line, lines.number())) {
      // An invalid character is a better explanation than an invalid field.
      error = not_text(line);
      if (error) return fail(std::move(*error));
      return fail(rows.error());
    }
    if (input.done_with && lines.offset() - reported >= report_every)
      input.done_with(reported = lines.offset());
  }
  if (error) return fail(std::move(*error));
  return {};
}

}  // namespace

namespace {

bool has_spatial_name(std::string_view line) {
  const auto& known = spatial_names();
  for (const char separator : {',', ';', '\t'}) {
    std::vector<std::string_view> names;
    if (!split(line, separator, names)) continue;
    for (const std::string_view name : names)
      if (std::find(known.begin(), known.end(), name) != known.end()) return true;
  }
  return false;
}

Expected<Observations> read_runs(const ReadInput& input) {
  NONIO_TRY(const auto expectation, expectation_of(input));
  NONIO_TRY(const auto stated, StatedColumns::of(input.options.texts(columns_option)));
  Lines lines(input.bytes);
  const Ends ends = ends_of(input.bytes);
  const auto in_file = [&](Error error, std::uint64_t line) {
    error.file = input.measurement.file;
    if (error.line == 0) error.line = line;
    return fail(std::move(error));
  };
  const Expected<Header> header = read_header(lines, expectation, stated);
  if (!header) return in_file(header.error(), lines.number());
  Observations obs = empty_observations(input.measurement, expectation);
  Rows rows(*header, expectation, obs);
  if (auto ok = read_rows(input, lines, *header, rows); !ok)
    return in_file(ok.error(), lines.number());
  if (auto ok = rows.finish(); !ok) return in_file(ok.error(), 0);
  doubt_comments(input, ends, lines.number(), *header, expectation, obs);
  return obs;
}

Expected<Observations> read_diagonal(const ReadInput& input) {
  NONIO_TRY(const auto span, span_of(input.campaign, input.measurement));
  auto obs = read_runs(input);
  if (!obs) return obs;
  const auto& along = obs->axes.front().position;
  const double slack = 1e-6 * span.length;
  for (std::size_t i = 0; i < along.size(); ++i)
    if (!(along[i] >= -slack && along[i] <= span.length + slack)) {
      Error error{"expected a distance from 0 to the length of the diagonal, " +
                  fixed_text(1e3 * span.length, 3) + " mm (`from`, `to`), found " +
                  fixed_text(1e3 * along[i], 3) + " mm"};
      error.file = input.measurement.file;
      error.line = obs->source_line[i];
      error.column = "target_mm";
      return fail(std::move(error));
    }
  spread(*obs, span);
  return obs;
}

struct Way {
  std::string_view kind;
  Expected<Observations> (*read)(const ReadInput&);
};
constexpr Way ways[] = {{"axis", read_runs},
                        {"straightness", read_runs},
                        {"angle", read_runs},
                        {"diagonal", read_diagonal},
                        {"step-diagonal", read_step_diagonal},
                        {"artefact", read_artefact},
                        {"artefact-certificate", read_artefact_certificate},
                        {"ball-centres", read_ball_centres},
                        {"circle", read_circle},
                        {"rtcp", read_tool_centre},
                        {"thermal", read_thermal},
                        {"spindle", read_spindle},
                        {"lengths", read_lengths},
                        {"observations", read_general}};

}  // namespace

/// Also recognizes UTF-16, so that the error can name it: every second byte of Latin text is zero.
bool recognises(std::string_view head) {
  std::string narrow;
  if (const std::size_t first = head.find('\0'); first != head.npos) {
    for (std::size_t i = first + 1; i < head.size(); i += 2)
      if (head[i] == '\0') return false;
    const bool marked = head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF");
    narrow = head.substr(marked ? 2 : 0);
    std::erase(narrow, '\0');
    head = narrow;
  }
  Lines lines(head);
  std::string_view line;
  while (lines.next(line))
    if (content_of(line) == Content::fields && !(lines.number() == 1 && stated_separator(line)))
      return known_names(line, find_separator(line)) > 0 || has_spatial_name(line);
  return false;
}

Option columns_declared() {
  return {
      std::string(columns_option), std::vector<std::string>(), "",
      "Columns with other names: \"NAME = KNOWN\" for each, such as \"Soll mm = target_mm\", or "
      "\"NAME = ignore\". A column without a name, or with one that occurs twice, has its number: "
      "\"#3 = target_mm\". Kinds axis, straightness, angle and diagonal, where rows above the one "
      "that has them are not read; part, and methods of other plugins"};
}

Expected<std::vector<std::vector<std::string>>> first_rows(std::string_view bytes,
                                                           std::size_t most) {
  std::vector<std::vector<std::string>> out;
  Lines lines(bytes);
  std::string_view line;
  std::optional<Error> error;
  std::vector<std::string_view> fields;
  char separator = ',';
  while (out.size() < most && next_content(lines, line, error)) {
    if (auto wrong = not_text(line)) return fail(std::move(*wrong));
    const auto in_line = [&](char c) { return std::count(line.begin(), line.end(), c); };
    if (out.empty())
      for (const char other : {';', '\t'})
        if (in_line(other) > in_line(separator)) separator = other;
    if (split(line, separator, fields)) out.emplace_back(fields.begin(), fields.end());
  }
  if (error) return fail(std::move(*error));
  return out;
}

bool reads(std::string_view kind) {
  return std::any_of(std::begin(ways), std::end(ways),
                     [&](const Way& w) { return w.kind == kind; });
}

Expected<Observations> read(const ReadInput& input) {
  if (input.method != nullptr && !input.method->columns.empty()) return read_declared(input);
  for (const Way& way : ways)
    if (way.kind == input.measurement.kind) return way.read(input);
  return read_runs(input);
}

}  // namespace nonio::csv
