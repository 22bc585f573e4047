// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "campaign/config/manifest.h"
#include "campaign/reading/checked_read.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"
#include "plugin_check/plugin_check_truth.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

char any_byte(storage::Random& random) {
  return static_cast<char>(static_cast<unsigned char>(random.uniform() * 256.0));
}

constexpr std::size_t most_tokens = 120, damages = 300;
constexpr double no_reading = 1e6;  // larger than any deviation, m or rad

struct ReadFile {
  std::string sample;
  Campaign campaign;
  std::size_t measurement = 0;
  Settings options;
  std::string bytes;
  const Method* method = nullptr;

  std::string where() const {
    return "sample " + sample + ", " + campaign.measurements[measurement].file;
  }
};

std::vector<ReadFile> files_of(const Reader& r, const Bench& bench) {
  std::vector<ReadFile> files;
  for (const Source& source : bench.sources) {
    const auto manifest = config::parse_manifest(source.manifest, source.name, bench.methods);
    if (!manifest) continue;
    const Campaign& c = manifest->campaign;
    for (std::size_t i = 0; i < c.measurements.size(); ++i) {
      const Measurement& m = c.measurements[i];
      if (!m.reader.empty() ? m.reader != r.info.name
                            : !reading::reads(r, m, method_of(m, bench.methods)))
        continue;
      for (const Artifact& f : source.files)
        if (f.name == m.file && (!m.reader.empty() || r.recognises(f.bytes.substr(0, 4096))))
          files.push_back({source.name, c, i,
                           settings_for(r.info, {source.name, c, manifest->options, {}}), f.bytes,
                           method_of(m, bench.methods)});
    }
  }
  return files;
}

Expected<Observations> read(const Reader& r, const ReadFile& f, std::string_view bytes) {
  return r.read(
      {bytes, f.campaign, f.campaign.measurements[f.measurement], f.options, {}, f.method});
}

const char* const no_file =
    "no sample file of its format; put a campaign with one into cases/<name>/campaign.toml";

Verdict each_file(const Reader& r, const Bench& bench,
                  const std::function<std::string(const ReadFile&, const Observations&)>& law) {
  if (!r.recognises || !r.reads || !r.read) return failed("recognises, reads or read is missing");
  const auto files = files_of(r, bench);
  if (files.empty()) return skipped(no_file);
  for (const ReadFile& f : files) {
    bench.stage(f.where());
    const auto o = read(r, f, f.bytes);
    if (!o) return failed(f.where() + ": " + o.error().message);
    if (const std::string why = law(f, *o); !why.empty()) return failed(f.where() + ": " + why);
  }
  return passed();
}

using Row = std::vector<double>;

Row row_of(const Observations& o, std::size_t i, bool placed = true) {
  // The name of the line is used, because its index changes if the file ends before the first row
  // of another line.
  const double line =
      o.lines.empty() ? 0.0
                      : static_cast<double>(std::hash<std::string>()(o.lines[o.line_of(i)].name));
  Row row{o.deviation[i], line, o.run.empty() ? 0.0 : static_cast<double>(o.run[i])};
  for (const auto& axis : o.axes) {
    row.push_back(placed ? axis.position[i] : 0.0);
    row.push_back(axis.approach.empty() ? 0.0 : static_cast<double>(axis.approach[i]));
  }
  return row;
}

std::map<Row, int> rows_of(const Observations& o, bool placed = true) {
  std::map<Row, int> rows;
  for (std::size_t i = 0; i < o.size(); ++i) ++rows[row_of(o, i, placed)];
  return rows;
}

std::string words_of(const Row& row) {
  return "a reading of " + short_text(row[0] * 1e6, 6) + " um or urad at " +
         (row.size() > 3 ? short_text(row[3] * 1e3, 6) + " mm or mrad" : std::string("?"));
}

std::string strangers(const std::map<Row, int>& base, std::size_t n, const Observations& o,
                      std::size_t& lost, bool placed = true) {
  auto left = base;
  std::size_t found = 0;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const Row row = row_of(o, i, placed);
    const auto at = left.find(row);
    if (at == left.end() || at->second == 0) return words_of(row);
    --at->second, ++found;
  }
  lost = n - found;
  return {};
}

Verdict reader_reads(const Reader& r, const Bench& bench) {
  return each_file(r, bench, [](const ReadFile&, const Observations& o) -> std::string {
    if (const std::string why = unsound(o); !why.empty()) return why;
    return o.size() == 0 ? "it finds no reading" : "";
  });
}

Verdict reader_again(const Reader& r, const Bench& bench) {
  return each_file(r, bench, [&](const ReadFile& f, const Observations& o) -> std::string {
    const auto two = read(r, f, f.bytes);
    if (!two || two->size() != o.size()) return "it reads something else the second time";
    for (std::size_t i = 0; i < o.size(); ++i)
      if (row_of(o, i) != row_of(*two, i)) return "it reads something else the second time";
    return {};
  });
}

Verdict reader_empty(const Reader& r, const Bench& bench) {
  if (r.recognises && r.recognises("")) return failed("it accepts an empty file");
  return each_file(r, bench, [&](const ReadFile& f, const Observations&) -> std::string {
    for (const char* bytes : {"", "\n", "\xef\xbb\xbf", " \r\n \r\n"})
      if (const auto o = read(r, f, bytes); o && o->size() > 0)
        return "it finds readings in an empty file";
    return {};
  });
}

Verdict reader_truncated(const Reader& r, const Bench& bench) {
  return each_file(r, bench, [&](const ReadFile& f, const Observations& whole) -> std::string {
    // The position of a step depends on the number of steps in the file, so it is not compared.
    const bool placed = f.campaign.measurements[f.measurement].kind != "step-diagonal";
    const auto base = rows_of(whole, placed);
    for (std::size_t k = 1; k < 50; ++k) {
      const std::size_t length = f.bytes.size() * k / 50;
      auto o = read(r, f, std::string_view(f.bytes).substr(0, length));
      if (!o) continue;
      const std::string cut = "cut off after " + std::to_string(length) + " bytes: ";
      if (const std::string why = unsound(*o); !why.empty()) return cut + why;
      // The reading of the last source line may be incomplete, so it is excluded. It need not be
      // the last observation, because a reader may reorder lines.
      const std::uint32_t last =
          o->source_line.empty() ? 0
                                 : *std::max_element(o->source_line.begin(), o->source_line.end());
      std::vector<std::uint32_t> kept;
      for (std::uint32_t i = 0; i < o->size(); ++i)
        if (o->source_line.empty() ? i + 1 < o->size() : o->source_line[i] != last)
          kept.push_back(i);
      std::size_t lost = 0;
      if (const std::string why = strangers(base, whole.size(), rearranged(*o, kept), lost, placed);
          !why.empty())
        return cut + "it has " + why + ", which the whole file has not";
    }
    return {};
  });
}

Verdict reader_damaged(const Reader& r, const Bench& bench) {
  storage::Random random = bench.random(6);
  return each_file(r, bench, [&](const ReadFile& f, const Observations&) -> std::string {
    for (std::size_t k = 0; k < damages; ++k) {
      std::string bytes = f.bytes;
      for (int n = 0; n <= static_cast<int>(k % 4); ++n) {
        const auto at =
            static_cast<std::size_t>(random.uniform() * static_cast<double>(bytes.size()));
        bytes[at] = any_byte(random);
      }
      if (const auto o = read(r, f, bytes))
        if (const std::string why = unsound(*o); !why.empty())
          return "with " + std::to_string(k % 4 + 1) + " bytes changed: " + why;
    }
    return {};
  });
}

struct Token {
  std::size_t at, length;
};

std::vector<Token> numbers_of(std::string_view bytes, storage::Random& random) {
  const auto digit = [&](std::size_t i) {
    return i < bytes.size() && bytes[i] >= '0' && bytes[i] <= '9';
  };
  const auto word = [&](std::size_t i) {
    const char c = i < bytes.size() ? bytes[i] : ' ';
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '.';
  };
  std::vector<Token> all;
  for (std::size_t i = 0; i < bytes.size();) {
    if (!digit(i) || (i > 0 && (word(i - 1) || digit(i - 1)))) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (digit(end) || (bytes.substr(end, 1) == "." && digit(end + 1))) ++end;
    const std::size_t from = i > 0 && (bytes[i - 1] == '-' || bytes[i - 1] == '+') ? i - 1 : i;
    if (!word(end)) all.push_back({from, end - from});
    i = end + 1;
  }
  if (all.size() <= most_tokens) return all;
  std::vector<Token> some;
  for (std::size_t k = 0; k < most_tokens; ++k)
    some.push_back(all[static_cast<std::size_t>((static_cast<double>(k) + random.uniform()) /
                                                static_cast<double>(most_tokens) *
                                                static_cast<double>(all.size() - 1))]);
  return some;
}

std::string with_token(const std::string& bytes, const Token& t, const std::string& text) {
  return bytes.substr(0, t.at) + text + bytes.substr(t.at + t.length);
}

std::string line_words(const std::string& bytes, std::size_t at) {
  return "line " +
         std::to_string(
             1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

std::size_t readings_of_line(const Observations& o, const std::string& bytes, std::size_t at) {
  if (o.source_line.empty()) return 3;  // up to three coordinates of a ball
  const auto line = static_cast<std::uint32_t>(
      1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  return static_cast<std::size_t>(std::count(o.source_line.begin(), o.source_line.end(), line));
}

Verdict reader_sentinels(const Reader& r, const Bench& bench) {
  storage::Random random = bench.random(7);
  return each_file(r, bench, [&](const ReadFile& f, const Observations& whole) -> std::string {
    const auto base = rows_of(whole);
    for (const Token& t : numbers_of(f.bytes, random))
      for (const char* sentinel : {"NaN", "-1e20", "1e20"}) {
        const std::string bytes = with_token(f.bytes, t, sentinel);
        const auto o = read(r, f, bytes);
        if (!o) continue;
        const std::string what = std::string(sentinel) + " in place of " +
                                 f.bytes.substr(t.at, t.length) + " in " +
                                 line_words(f.bytes, t.at) + ": ";
        if (const std::string why = unsound(*o); !why.empty()) return what + why;
        for (const double d : o->deviation)
          if (std::fabs(d) > no_reading) return what + "it became a reading";
        std::size_t lost = 0;
        if (const std::string why = strangers(base, whole.size(), *o, lost); !why.empty())
          return what + why + " appears: expected it missing or an error, the others as they are";
        if (lost > readings_of_line(whole, f.bytes, t.at))
          return what + std::to_string(lost) + " readings are gone";
      }
    return {};
  });
}

Verdict reader_signs(const Reader& r, const Bench& bench) {
  storage::Random random = bench.random(8);
  return each_file(r, bench, [&](const ReadFile& f, const Observations& whole) -> std::string {
    for (const Token& t : numbers_of(f.bytes, random)) {
      const std::string number = f.bytes.substr(t.at, t.length);
      const std::string size = number[0] == '-' || number[0] == '+' ? number.substr(1) : number;
      for (const std::string& other : {size, "-" + size, "+" + size}) {
        const auto o = read(r, f, with_token(f.bytes, t, other));
        if (o && o->size() < whole.size())
          return other + " in place of " + number + " in " + line_words(f.bytes, t.at) + ": " +
                 std::to_string(whole.size() - o->size()) + " readings are gone";
      }
    }
    return {};
  });
}

/// Applies only to readers with an option that states the unit of the file.
Verdict reader_inch(const Reader& r, const Bench& bench) {
  const auto has = [](const Option& o, const char* choice) {
    return std::find(o.choices.begin(), o.choices.end(), choice) != o.choices.end();
  };
  for (const Option& option : r.info.options) {
    if (!has(option, "mm") || !has(option, "inch")) continue;
    return each_file(r, bench, [&](const ReadFile& f, const Observations&) -> std::string {
      ReadFile mm = f, inch = f;
      mm.options.values[option.name] = std::string("mm");
      inch.options.values[option.name] = std::string("inch");
      const auto one = read(r, mm, f.bytes), two = read(r, inch, f.bytes);
      if (!one || !two || one->size() != two->size() || one->axes.empty())
        return "it fails in inch";
      for (std::size_t axis = 0; axis < one->axes.size(); ++axis)
        for (std::size_t i = 0; i < one->size(); ++i) {
          const double a = one->axes[axis].position[i], b = two->axes[axis].position[i];
          const double times = one->axes[axis].rotary ? 1.0 : 25.4;
          if (std::fabs(times * a - b) > 1e-9 * std::fabs(b))
            return "a target of " + short_text(a * 1e3, 6) + " mm or mrad is one of " +
                   short_text(b * 1e3, 6) + " in inch: expected " + short_text(times, 3) + " times";
        }
      return {};
    });
  }
  return skipped("no option has the choices mm and inch");
}

/// A person wrote readings.csv, because a data file alone does not show whether it was read
/// correctly.
Verdict reader_truth(const Reader& r, const Bench& bench) {
  std::size_t compared = 0;
  Verdict v = each_file(r, bench, [&](const ReadFile& f, const Observations& o) -> std::string {
    for (const Source& source : bench.sources)
      if (source.name == f.sample)
        return differs_from_truth(o, f.campaign.measurements[f.measurement], source, compared);
    return {};
  });
  if (v.state == Verdict::State::passed && compared == 0)
    return skipped(
        "no readings.csv next to a file of a case: write down what the instrument showed");
  return v;
}

/// If a reader does not reject a file of another format, it must return an error or valid
/// observations.
Verdict reader_foreign(const Reader& r, const Bench& bench) {
  storage::Random random = bench.random(9);
  if (!r.recognises || !r.reads || !r.read) return failed("recognises, reads or read is missing");
  std::string noise(4096, '\0');
  for (char& c : noise) c = any_byte(random);
  const std::vector<std::pair<const char*, std::string>> foreign = {
      {"random bytes", noise},
      {"a PDF", "%PDF-1.4\n%\xe2\xe3\xcf\xd3\n1 0 obj\n<< /Type /Catalog >>\nendobj\n"},
      {"a long line", std::string(200000, '1')},
      {"zeros", std::string(4096, '\0')},
      {"JSON", "{\"schema\": \"x\", \"values\": [1, 2, 3]}\n"}};
  for (const auto& [name, bytes] : foreign) {
    bench.stage(name);
    const bool knows = r.recognises(std::string_view(bytes).substr(0, 4096));
    if (knows) return failed(std::string("it accepts ") + name);
    for (const Sample& s : bench.samples) {
      const auto o =
          r.read({bytes, s.campaign, s.campaign.measurements[0], settings_for(r.info, s)});
      if (o && !unsound(*o).empty()) return failed(std::string(name) + ": " + unsound(*o));
    }
  }
  return passed();
}

}  // namespace

Verdict fingerprint(const Reader& r, const Bench& bench) {
  if (!r.recognises || !r.reads || !r.read) return skipped("recognises, reads or read is missing");
  const auto files = files_of(r, bench);
  if (files.empty()) return skipped(no_file);
  if (bench.only_plugin) bench.only_plugin();
  std::string all;
  for (const ReadFile& f : files) {
    bench.stage(f.where());
    const auto o = read(r, f, f.bytes);
    all += f.where() + (o ? std::string("\n") : ": " + o.error().message + "\n");
    for (std::size_t i = 0; o && i < o->size(); ++i) {
      for (const double x : row_of(*o, i)) all += exact_text(x) + " ";
      all += "\n";
    }
  }
  return {Verdict::State::passed, storage::sha256(all)};
}

const std::vector<Check<Reader>>& reader_checks() {
  static const std::vector<Check<Reader>> checks = {
      {"reads", "It reads its samples: columns of equal length, only numbers.", reader_reads},
      {"true-values", "Each reading equals that of readings.csv.", reader_truth},
      {"again", "The same input gives the same bytes.", reader_again},
      {"empty", "An empty file gives no readings.", reader_empty},
      {"foreign", "It does not accept files of other kinds.", reader_foreign},
      {"truncated", "A truncated file is rejected or gives readings of the whole file.",
       reader_truncated},
      {"damaged", "Damaged bytes cause no crash, no hang and no invalid number.", reader_damaged},
      {"sentinels", "NaN, -1e20 and 1e20 are missing or an error, and change no other reading.",
       reader_sentinels},
      {"signs", "No reading is lost because of a sign before a number.", reader_signs},
      {"inch", "Inches give the same readings as millimetres.", reader_inch}};
  return checks;
}

}  // namespace nonio::plugin_check::kit
