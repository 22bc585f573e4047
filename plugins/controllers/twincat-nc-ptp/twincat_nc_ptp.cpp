// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/list.h"

namespace nonio::twincat_nc_ptp {
namespace {

using Confidence = ControlTable::Confidence;
using controllers::Sheet;

// MC_TableBasedPositionCompensation: equidistant, increasing positions with the value that is
// added.
ControlTable declared() {
  ControlTable t;
  t.name = "ST_PositionCompensationTableElement";
  t.sign = ControlTable::Sign::correction;
  t.zero = ControlTable::Zero::reference;
  t.points = 10000;
  t.backlash = "MC_BacklashCompensation.Backlash";
  t.facts = {{"text", Confidence::inferred,
              "Inferred: the text is IEC 61131-3, to be pasted into a global variable list."},
             {"directions", Confidence::unsure,
              "Not written: a table for each direction (E_WorkDirection has names for it that were "
              "not found)."}};
  t.runs_gcode = false;
  return t;
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  const std::string name = "Axis_" + controllers::file_part(s.job.stem);
  std::string out = controllers::comments(s.words(), "// ") + "VAR_GLOBAL\n  " + name +
                    "_Table : ARRAY[1.." + std::to_string(s.plus.size()) +
                    "] OF ST_PositionCompensationTableElement := [\n";
  for (std::size_t i = 0; i < s.plus.size(); ++i)
    out += "    (Position := " + s.at(i) + ", Compensation := " + s.entry(s.plus[i]) + ")" +
           (i + 1 < s.plus.size() ? ",\n" : "];\n");
  out += "  " + name +
         "_Parameter : ST_PositionCompensationTableParameter := (MinPosition := " + s.at(0) +
         ", MaxPosition := " + s.at(s.plus.size() - 1) +
         ", NoOfTableElements := " + std::to_string(s.plus.size()) +
         ", Direction := WorkDirectionBoth, Modulo := " + (s.job.turn ? "TRUE" : "FALSE") + ");\n";
  return std::vector<Artifact>{{"twincat-nc-ptp-" + s.job.stem + ".st", out + "END_VAR\n"}};
}

std::optional<std::int64_t> number_behind(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const auto words = controllers::words_of(text.substr(at + key.size(), 40), " :=],);\r\n");
  return words.empty() ? std::nullopt : controllers::whole(words.front());
}

/// If the number of elements differs from the declared one, the text was truncated.
Expected<void> whole(const Artifact& f) {
  const std::string_view text = f.bytes;
  const std::string_view element = "Compensation :=";
  std::int64_t found = 0;
  for (std::size_t at = 0; (at = text.find(element, at)) != std::string_view::npos; ++at) ++found;
  if (found == 0) return {};
  for (const std::string_view once : {"ARRAY[1..", "NoOfTableElements"})
    if (const std::size_t first = text.find(once);
        first != std::string_view::npos && text.find(once, first + 1) != std::string_view::npos)
      return fail(f.name + ": " + std::string(once) + " occurs twice: one table is expected");
  const auto declared = number_behind(text, "ARRAY[1..");
  const auto said = number_behind(text, "NoOfTableElements");
  if (!declared || *declared != found || (said && *said != found))
    return fail(f.name + ": " + std::to_string(found) + " elements, " +
                (declared ? "ARRAY[1.." + std::to_string(*declared) + "]" : "no ARRAY[1..n]") +
                (said ? ", NoOfTableElements " + std::to_string(*said) : "") +
                ": the file was cut or changed");
  if (text.find("END_VAR") == std::string_view::npos)
    return fail(f.name + ": no END_VAR: the file was cut");
  return {};
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  for (const Artifact& f : in.files)
    if (auto ok = whole(f); !ok) return tl::unexpected<Error>(ok.error());
  const auto take = [](std::string_view line, controllers::RawTable& raw) -> Expected<bool> {
    const auto w = controllers::words_of(line, " (),];");
    if (w.size() < 3 || w[0] != "Position") return false;
    const auto x = controllers::real(w[2]);
    const auto c = controllers::real(w.size() == 6 && w[3] == "Compensation" ? w[5] : "");
    if (!x || !c) return controllers::no_point(line);
    raw.position.push_back(*x);
    raw.plus.push_back(*c);
    return true;
  };
  return controllers::parse_files(in, declared(), "twincat-nc-ptp", take);
}

Expected<OutputResult> write(const ControllerInput& in) {
  return controllers::write_tables(in, {"twincat-nc-ptp",
                                        *controllers::chosen(declared(), in.options),
                                        {"step", "first", "reference", "backlash"},
                                        files,
                                        parse});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"twincat-nc-ptp", "1.0.0", "Position compensation tables (Tc2_MC2) for TwinCAT NC PTP.",
       controllers::table_options(
           declared(), "step_mm, first_mm, reference_mm, backlash_mm and the same with _deg")},
      declared(), write, parse));
}

}  // namespace nonio::twincat_nc_ptp
