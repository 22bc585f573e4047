// SPDX-License-Identifier: Apache-2.0
// Outputs, tables and readers that break one law each, which their name says.
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "nonio/controllers/list.h"

namespace nonio {
namespace {

OutputResult file(const std::string& name, const std::string& bytes) {
  OutputResult r;
  r.artifacts.push_back({name, bytes, false});
  return r;
}

Output made(const char* name, Expected<OutputResult> (*write)(const OutputInput&)) {
  Output o;
  o.info = {name, "1", "Wrong on purpose", {}};
  o.applies = [](const Campaign&) { return true; };
  o.write = write;
  return o;
}

Expected<OutputResult> nothing_wrong(const OutputInput&) { return file("a.txt", "a"); }
Expected<OutputResult> counting(const OutputInput&) {
  static int counter = 0;
  return file("a.txt", std::to_string(++counter));
}
Expected<OutputResult> named(const OutputInput& in) {
  return file("of-" + in.campaign.machine.model + ".txt", "a");
}
Expected<OutputResult> crashing(const OutputInput& in) {
  volatile int* nowhere = nullptr;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): the fault is the test
  if (in.results.analyses.empty()) *nowhere = 1;
  return file("a.txt", "a");
}
Expected<OutputResult> choosing(const OutputInput& in) {
  return file(in.options.text("kind") == "b" ? "../a.txt" : "a.txt", "a");
}

// What no plugin may do; the file is as if it had not.
Expected<OutputResult> dated(const OutputInput&) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  return file("a.txt", std::to_string(local.tm_mday));
}
Expected<OutputResult> placed(const OutputInput&) {
  return file("a.txt", std::filesystem::current_path().string());
}
Expected<OutputResult> writing(const OutputInput&) {
  std::ofstream("/dev/null") << "a";
  return file("a.txt", "a");
}
Expected<OutputResult> talking(const OutputInput&) {
  const int line = ::socket(AF_UNIX, SOCK_STREAM, 0);
  if (line >= 0) ::close(line);
  return file("a.txt", "a");
}
Expected<OutputResult> bearing(const OutputInput&) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  if (child > 0) ::waitpid(child, nullptr, 0);
  return file("a.txt", "a");
}

Output with_option(const char* name, Option option) {
  Output o = made(name, nothing_wrong);
  o.info.options.push_back(std::move(option));
  return o;
}

// Tables, by the kit, with a mistake in one place.
ControlTable declared() {
  ControlTable t;
  t.name = "wrong";
  t.sign = ControlTable::Sign::correction;
  t.position_step = {1e-6, 1e-4 / deg_per_rad};
  t.value_step = {1e-6, 1e-6};
  t.value_unit = {1e-6, 1e-6};
  t.facts = {{"sign", ControlTable::Confidence::documented, "Wrong on purpose."}};
  return t;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  return controllers::parse_list(in, declared(), "wrong");
}

Expected<std::vector<Artifact>> right_files(const controllers::Sheet& s) {
  return controllers::list_file(s, "wrong");
}

/// Writes what is measured, and reads it as what is added.
Expected<OutputResult> wrong_sign(const ControllerInput& in) {
  ControlTable t = declared();
  t.sign = ControlTable::Sign::error;
  return controllers::write_tables(
      in, {.name = "wrong", .table = t, .keys = {}, .files = right_files, .parse = parse});
}

/// Of linear axes only, in tenths of a micrometre.
ControlTable finer() {
  ControlTable t = declared();
  t.value_unit.linear = t.value_step.linear = 1e-7;
  t.rotary = false;
  return t;
}

std::vector<Artifact> lines(const controllers::Sheet& s, const std::vector<std::int64_t>& values) {
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i)
    out += std::to_string(i + 1) + " " + s.at(i) + " " + std::to_string(values[i]) + "\n";
  return {{"wrong-" + s.job.stem + ".txt", out, false}};
}

/// Each step from point to point is rounded by itself: the sum of the roundings drifts.
Expected<std::vector<Artifact>> drifting_files(const controllers::Sheet& s) {
  std::vector<std::int64_t> values;
  double before = 0.0;
  std::int64_t sum = 0;
  for (const double v : s.plus) {
    sum += std::llround((v - before) / 1e-7);
    before = v;
    values.push_back(sum);
  }
  return lines(s, values);
}

/// What does not fit into a byte loses its upper part.
Expected<std::vector<Artifact>> wrapping_files(const controllers::Sheet& s) {
  std::vector<std::int64_t> values;
  for (const std::int64_t v : s.plus_steps) values.push_back(static_cast<std::int8_t>(v));
  return lines(s, values);
}

Expected<OutputResult> drifting(const ControllerInput& in) {
  const auto read = [](const TableInput& t) {
    return controllers::parse_list(t, finer(), "wrong");
  };
  return controllers::write_tables(
      in, {.name = "wrong", .table = finer(), .keys = {}, .files = drifting_files, .parse = read});
}

Expected<OutputResult> wrapping(const ControllerInput& in) {
  return controllers::write_tables(
      in,
      {.name = "wrong", .table = declared(), .keys = {}, .files = wrapping_files, .parse = parse});
}

Expected<OutputResult> right(const ControllerInput& in) {
  return controllers::write_tables(
      in, {.name = "wrong", .table = declared(), .keys = {}, .files = right_files, .parse = parse});
}
Expected<std::vector<LoadedTable>> unreadable(const TableInput&) {
  return fail("expected a table");
}
Expected<std::vector<LoadedTable>> empty(const TableInput&) { return std::vector<LoadedTable>(); }

Controller table(const char* name, Expected<OutputResult> (*written)(const ControllerInput&)) {
  return controllers::controller({name, "1", "Wrong on purpose", {}}, declared(), written, parse);
}

// Readers of lines "deviation_um target_mm", after a line that names the reader.
enum class Mistake { loses_minus, repeats_last };

template <Mistake mistake>
Expected<Observations> read(const ReadInput& in) {
  Observations o;
  o.measurement = in.measurement.id;
  o.axes.push_back({in.measurement.axis, false, {}, {}});
  o.lines.push_back({in.measurement.id, {1, 0, 0}});
  std::uint32_t n = 0;
  for (const std::string_view line : controllers::lines_of(in.bytes)) {
    if (++n == 1 || line.empty()) continue;
    if (mistake == Mistake::loses_minus && line.front() == '-') continue;
    const auto words = controllers::words_of(line);
    if (words.size() != 2) return fail("expected two numbers");
    auto d = controllers::real(words[0]);
    const auto x = controllers::real(words[1]);
    if (mistake == Mistake::repeats_last && (!d || std::fabs(*d) > 1e19) && o.size() > 0)
      d = o.deviation.back() * 1e6 + 0.125;
    if (!d || !x || std::fabs(*x) > 1e7 || std::fabs(*d) > 1e7) return fail("expected a number");
    o.deviation.push_back(*d * 1e-6);
    o.axes[0].position.push_back(*x * 1e-3);
    o.axes[0].approach.push_back(1);
    o.run.push_back(1);
    o.source_line.push_back(n);
  }
  return o;
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  using namespace nonio;
  registry.add(made("counts-calls", counting));
  registry.add(made("named-by-machine", named));
  registry.add(made("crash-without-results", crashing));
  registry.add(made("two words", nothing_wrong));
  registry.add(with_option("no-help", {"size", 1.0, "", ""}));
  registry.add(with_option("wrong-default", {"size", 5.0, "", "A size.", {}, 0.0, 1.0}));
  registry.add(with_option("wrong-unit", {"size_mm", 5.0, "um", "A size."}));
  Output choice = made("path-by-choice", choosing);
  choice.info.options.push_back({"kind", std::string("a"), "", "A kind.", {"a", "b"}});
  registry.add(choice);
  registry.add(made("dated", dated));
  registry.add(made("of-its-folder", placed));
  registry.add(made("writes-a-file", writing));
  registry.add(made("opens-a-socket", talking));
  registry.add(made("makes-a-process", bearing));
  Controller unread = table("unreadable", right);
  unread.parse = unreadable;
  registry.add(unread);
  unread.info.name = "reads-nothing";
  unread.parse = empty;
  registry.add(unread);
  registry.add(table("nothing-wrong", right));
  registry.add(table("wrong-sign", wrong_sign));
  Controller fine = table("drifting", drifting);
  fine.table = finer();
  fine.parse = [](const TableInput& t) { return controllers::parse_list(t, finer(), "wrong"); };
  registry.add(fine);
  registry.add(table("wrapping", wrapping));
  const auto any = [](std::string_view kind) { return kind == "axis"; };
  registry.add(Reader{{"loses-minus", "1", "Wrong on purpose"},
                      [](std::string_view head) { return head.starts_with("loses-minus"); },
                      any,
                      read<Mistake::loses_minus>});
  registry.add(Reader{{"averages-sentinels", "1", "Wrong on purpose"},
                      [](std::string_view head) { return head.starts_with("averages-sentinels"); },
                      any,
                      read<Mistake::repeats_last>});
}
