// SPDX-License-Identifier: Apache-2.0
//
// What comes back from a control: cut anywhere, with the line ends of Windows, with comments. It is
// read as the whole table, or not at all.
#include <cmath>
#include <cstring>

#include "workshop.h"

namespace backups_test {

using namespace workshop;

namespace {

struct Kind {
  const char* name;
  const char* plugin;
  Options options;
  const char* comment = nullptr;  ///< begins a line that says nothing
  bool below = false;
  std::string axes = "X number=1";
  /// Nothing in the control's layout says where it ends: cut behind a whole line it is a shorter
  /// table.
  bool ends_say_nothing = false;
};

std::vector<Kind> kinds() {
  const Options error{{"sign", std::string("error")}}, both{{"directions", true}};
  return {{"siemens-840d", "siemens-840d", {}, ";"},
          {"siemens-840d directions", "siemens-840d", both, ";"},
          {"heidenhain-tnc", "heidenhain-tnc", {}},
          {"heidenhain-tnc directions", "heidenhain-tnc", both},
          {"heidenhain-tnc itnc530",
           "heidenhain-tnc",
           {{"layout", std::string("itnc530")}},
           nullptr,
           false,
           "X number=1",
           true},
          {"fanuc", "fanuc", {{"extended", true}}},
          {"fanuc directions", "fanuc", {{"extended", true}, {"directions", true}}},
          {"linuxcnc", "linuxcnc", {}},
          {"twincat-cnc", "twincat-cnc", {}, "#"},
          {"twincat-cnc directions", "twincat-cnc", both, "#"},
          {"twincat-nc-ptp", "twincat-nc-ptp", {}},
          {"twincat-volumetric", "twincat-volumetric", error, "//", false, "X number=1", true},
          {"fagor-8055", "fagor-8055", error, "#"},
          {"haas-classic", "haas-classic", error, "#", true},
          {"mitsubishi", "mitsubishi", {}, "#"},
          {"pmac", "pmac", {}, nullptr, false, "X number=1 counts_per_mm=2000"},
          {"aerotech", "aerotech", {}, ";"},
          {"ecmc", "ecmc", {}, "#"}};
}

Bench machine(bool below) {
  Measured m;
  m.targets = even(below ? -16 * 12.7 * mm : -100 * mm, below ? 12.7 * mm : 25 * mm, 17);
  m.plus = [](double x) { return 8.37 * um * std::sin(x / (60 * mm)); };
  m.minus = [p = m.plus](double x) { return p(x) + 4.2 * um; };
  return Bench(m);
}

Options with_axes(const Kind& k) {
  Options o = k.options;
  o["axes"] = std::vector<std::string>{k.axes};
  return o;
}

using Tables = std::vector<LoadedTable>;

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::fabs(a[i] - b[i]) > 1e-12) return false;
  return true;
}

/// What a cut may leave: the table itself, and the backlash value or nothing of it.
bool same(const Tables& cut, const Tables& whole, bool backlash_too) {
  if (cut.size() != whole.size()) return false;
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const LoadedTable &a = cut[i], &b = whole[i];
    if (a.output != b.output || a.input != b.input || a.outside != b.outside ||
        !same(a.position[0], b.position[0]) || !same(a.plus, b.plus) || !same(a.minus, b.minus))
      return false;
    if (backlash_too && a.backlash.has_value() != b.backlash.has_value()) return false;
    if (a.backlash && (!b.backlash || std::fabs(*a.backlash - *b.backlash) > 1e-12)) return false;
  }
  return true;
}

std::string with_windows_ends(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return out;
}

/// The line with the last digit of its last number changed; empty if it has no number.
std::string changed(std::string line) {
  const std::size_t at = line.find_last_of("0123456789");
  if (at == std::string::npos) return {};
  line[at] = line[at] == '9' ? '1' : static_cast<char>(line[at] + 1);
  return line;
}

/// Without a number that the control takes: notes, names of files and sections. A second line of
/// CONFIG.CMA is another set of tables, of which one is active.
bool is_note(const std::string& line, const std::string& file) {
  const std::size_t at = line.find_first_not_of(" \t");
  if (at == std::string::npos || file.ends_with("CONFIG.CMA")) return true;
  for (const char* begin : {"#", ";", "//", "%_N_", "["})
    if (line.compare(at, std::strlen(begin), begin) == 0) return true;
  return false;
}

}  // namespace

// One law for all: a line that is repeated with another number is an error or has an effect. A
// parser that ignores it shows another table than the control has.
TEST(Backup, ASecondLineWithAnotherNumberIsNamedOrHasAnEffect) {
  for (const Kind& k : kinds()) {
    const Controller output = plugin(k.plugin);
    const auto r = machine(k.below).write(output, with_axes(k));
    ASSERT_TRUE(r) << k.name;
    const auto whole = read_back(output, r->artifacts, with_axes(k), {{.name = "X"}});
    ASSERT_TRUE(whole) << k.name;
    int named = 0, seen = 0;
    for (std::size_t f = 0; f < r->artifacts.size(); ++f) {
      if (r->artifacts.size() > 1 && r->artifacts[f].name.ends_with(".txt"))
        continue;  // words for people
      const std::string& bytes = r->artifacts[f].bytes;
      for (std::size_t from = 0, end = 0; (end = bytes.find('\n', from)) != std::string::npos;
           from = end + 1) {
        const std::string line = bytes.substr(from, end - from), other = changed(line);
        if (other.empty() || is_note(line, r->artifacts[f].name)) continue;
        auto files = r->artifacts;
        files[f].bytes.insert(end + 1, other + "\n");
        const auto read = read_back(output, files, with_axes(k), {{.name = "X"}});
        if (!read)
          ++named;
        else if (!same(*read, *whole, true))
          ++seen;
        else
          ADD_FAILURE() << k.name << ", " << files[f].name << ": ignored: " << other;
      }
    }
    EXPECT_GT(named + seen, 2) << k.name;
  }
}

TEST(Backup, CutAtEveryByteItIsTheWholeTableOrNone) {
  for (const Kind& k : kinds()) {
    const Controller output = plugin(k.plugin);
    const auto r = machine(k.below).write(output, with_axes(k));
    ASSERT_TRUE(r) << k.name << r.error().message;
    const auto whole = read_back(output, r->artifacts, with_axes(k), {{.name = "X"}});
    ASSERT_TRUE(whole) << k.name << whole.error().message;
    int refused = 0, wrong = 0;
    for (std::size_t f = 0; f < r->artifacts.size(); ++f)
      for (std::size_t n = 1; n < r->artifacts[f].bytes.size() && wrong == 0; ++n) {
        auto files = r->artifacts;
        files[f].bytes.resize(n);
        if (k.ends_say_nothing && files[f].bytes.back() == '\n') continue;
        const auto read = read_back(output, files, with_axes(k), {{.name = "X"}});
        if (!read || read->empty()) {
          ++refused;
        } else if (!same(*read, *whole, false)) {
          ++wrong;
          ADD_FAILURE() << k.name << ": " << files[f].name << " cut behind byte " << n
                        << " is read as another table; it ends with\n"
                        << files[f].bytes.substr(n < 120 ? 0 : n - 120);
        }
      }
    EXPECT_GT(refused, 30) << k.name;
  }
}

TEST(Backup, LineEndsOfWindowsAndCommentsChangeNothing) {
  for (const Kind& k : kinds()) {
    const Controller output = plugin(k.plugin);
    const auto r = machine(k.below).write(output, with_axes(k));
    ASSERT_TRUE(r) << k.name;
    const auto whole = read_back(output, r->artifacts, with_axes(k), {{.name = "X"}});
    ASSERT_TRUE(whole) << k.name;
    auto windows = r->artifacts;
    for (Artifact& a : windows) a.bytes = with_windows_ends(a.bytes);
    const auto read = read_back(output, windows, with_axes(k), {{.name = "X"}});
    ASSERT_TRUE(read) << k.name << ": " << read.error().message;
    EXPECT_TRUE(same(*read, *whole, true)) << k.name;
    if (k.comment == nullptr) continue;
    auto commented = r->artifacts;
    for (Artifact& a : commented)
      for (std::size_t at = 0; (at = a.bytes.find('\n', at)) != std::string::npos;)
        a.bytes.insert(++at, std::string(k.comment) + " a note 17 4\n"),
            at = a.bytes.find('\n', at) + 1;
    const auto noted = read_back(output, commented, with_axes(k), {{.name = "X"}});
    ASSERT_TRUE(noted) << k.name << ": " << noted.error().message;
    EXPECT_TRUE(same(*noted, *whole, true)) << k.name;
  }
}

// kw.crosscomp of which the end is missing: what is left is a table of a shorter way.
TEST(Backup, ACrossTableOfTwincatHasAllItsPoints) {
  const Controller output = plugin("twincat-cnc");
  std::string list =
      "kopf.achs_nr 2\nkw.crosscomp.unit 1\nkw.crosscomp.last_index 2\n"
      "kw.crosscomp.master_ax_nr 1\n";
  for (int i = 0; i < 3; ++i)
    for (const char* what : {"setpoint", "correction"})
      list += "kw.crosscomp.table[" + std::to_string(i) + "]." + what + " " +
              std::to_string(100 * i) + "\n";
  const Options options{{"cross_sign", std::string("error")}};
  EXPECT_TRUE(read_back(output, {{"Y.lis", list}}, options));
  const std::size_t third = list.find("kw.crosscomp.table[2]");
  const auto read = read_back(output, {{"Y.lis", list.substr(0, third)}}, options);
  ASSERT_FALSE(read);
  EXPECT_TRUE(contains(read.error().message, "last_index")) << read.error().message;
}

}  // namespace backups_test
