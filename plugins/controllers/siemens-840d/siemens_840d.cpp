// SPDX-License-Identifier: Apache-2.0
#include "cross_tables.h"
#include "merge.h"
#include "nonio/controllers/kit.h"
#include "parse.h"

namespace nonio::siemens_840d {
namespace {

using controllers::AxisJob;
using controllers::decimal;
using controllers::Sheet;
using Confidence = ControlTable::Confidence;

ControlTable declared() {
  ControlTable t;
  t.name = "$AA_ENC_COMP, $AN_CEC";
  t.zero = ControlTable::Zero::reference;
  t.position_step = {1e-4 / 1e3, 1e-3 / deg_per_rad};
  t.value_step = {1e-9, 1e-6 / deg_per_rad};  // no limit in practice: 1 nm, 0.004 arcsec
  t.points = 200;                             // 808D, 828D; others state MD38000 and MD18342
  t.bidirectional = t.straightness = t.squareness = true;
  t.backlash = "MD32450";
  t.facts = {{"sign", Confidence::documented, "A positive entry drives the axis towards minus."},
             {"form", Confidence::inferred,
              "Inferred: comment lines and the TEA block of the backlash file."},
             {"cec", Confidence::inferred,
              "Inferred: whether setpoint or actual value indexes a CEC table (editions of the "
              "manual contradict each other); form of the axis names (option quoted_axes)."}};
  return t;
}

std::string axis_name(const Sheet& s) { return "AX" + std::to_string(s.job.number); }

std::string remarks(const Sheet& s, const std::vector<std::string>& of_table) {
  return controllers::comments(s.warning, "; ") + controllers::comments(s.job.about, "; ") +
         controllers::comments(of_table, "; ");
}

const char* const sign_is =
    "entries are the measured deviation (actual - nominal) with its own sign:";
const char* const sign_does =
    "the control adds them to the actual position, a positive entry drives towards minus";

std::string range_lines(const std::string& variable, const std::string& index, const Sheet& s) {
  const auto line = [&](const char* name, const std::string& value) {
    return "$" + variable + "_" + name + "[" + index + "]=" + value + "\n";
  };
  const double mm = s.position_unit();
  return line("STEP", decimal(s.grid.step / mm, 6)) + line("MIN", decimal(s.grid.first / mm, 6)) +
         line("MAX", decimal(s.grid.last() / mm, 6)) + line("IS_MODULO", s.job.turn ? "1" : "0");
}

std::string encoder_table(const Sheet& s) {
  const std::string system = std::to_string(s.input.options.integer("measuring_system"));
  const std::string axis = axis_name(s);
  std::string out = "%_N_" + axis + "_EEC_INI\nCHANDATA(1)\n";
  out +=
      remarks(s, {sign_is, sign_does,
                  "zero at the reference position " + controllers::with_unit(s.job, s.reference, 4),
                  s.outside_words(), s.zero_and_size().back(),
                  controllers::reversal_words(s.job, controllers::Columns::mean),
                  "MD38000[" + system + "] >= " + std::to_string(s.grid.points) +
                      "; load with MD32700[" + system + "] = 0, then 1, power on, reference"});
  for (std::size_t i = 0; i < s.plus.size(); ++i)
    out += "$AA_ENC_COMP[" + system + "," + std::to_string(i) + "," + axis +
           "]=" + s.entry(s.plus[i]) + "\n";
  return out + range_lines("AA_ENC_COMP", system + "," + axis, s) + "M17\n";
}

std::string backlash_file(const Sheet& s) {
  return "%_N_" + axis_name(s) + "_TEA_INI\nCHANDATA(1)\n" +
         remarks(s, {controllers::reversal_words(s.job, controllers::Columns::mean),
                     "MD32450: positive where the encoder leads the machine part (lost motion)"}) +
         "$MA_BACKLASH[" + std::to_string(s.input.options.integer("measuring_system")) + "," +
         axis_name(s) + "]=" + decimal(s.backlash() * s.job.per_si(), 6) + "\nM17\n";
}

std::int64_t first_table(const Sheet& s) {
  return s.input.options.integer("first_cec_table") +
         2 * (static_cast<std::int64_t>(s.job.number) - 1);
}

// Direction-dependent pitch: input axis = output axis, one table for each direction of travel.
std::string direction_tables(const Sheet& s) {
  const bool quoted = s.input.options.flag("quoted_axes");
  const std::string axis = (quoted ? "\"" : "(") + axis_name(s) + (quoted ? "\"" : ")");
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n";
  out += remarks(
      s, {sign_is, sign_does,
          "mean of both directions zero at " + controllers::with_unit(s.job, s.reference, 4),
          s.outside_words(), s.zero_and_size().back(),
          controllers::reversal_words(s.job, controllers::Columns::both),
          chosen_words(first_table(s), 2),
          "MD18342[t] >= " + std::to_string(s.grid.points) +
              "; enable MD32710 of the axis and SD41300[t]"});
  std::int64_t number = first_table(s);
  for (const int direction : {1, -1}) {
    const std::string t = std::to_string(number++);
    const auto& entries = direction > 0 ? s.plus : s.minus;
    for (std::size_t i = 0; i < entries.size(); ++i)
      out += "$AN_CEC[" + t + "," + std::to_string(i) + "]=" + s.entry(entries[i]) + "\n";
    out += "$AN_CEC_INPUT_AXIS[" + t + "]=" + axis + "\n$AN_CEC_OUTPUT_AXIS[" + t + "]=" + axis +
           "\n" + range_lines("AN_CEC", t, s) + "$AN_CEC_DIRECTION[" + t +
           "]=" + std::to_string(direction) + "\n$AN_CEC_MULT_BY_TABLE[" + t + "]=0\n";
  }
  return out + "M17\n";
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  const std::string stem = "siemens-840d-" + s.job.stem;
  if (s.directions)
    if (auto free = free_tables(first_table(s), 2, s.input.options); !free)
      return fail("axis " + s.job.axis + ": " + free.error().message);
  if (s.directions) return std::vector<Artifact>{{stem + "-CEC.ini", direction_tables(s)}};
  std::vector<Artifact> out{{stem + "-EEC.ini", encoder_table(s)}};
  if (s.job.curve.bidirectional()) out.push_back({stem + "-backlash.ini", backlash_file(s)});
  return out;
}

Expected<OutputResult> write(const ControllerInput& input) {
  OutputResult result;
  auto table = controllers::chosen(declared(), input.options);
  if (!input.options.flag("directions")) table->facts.pop_back();
  const controllers::Writer writer{.name = "siemens-840d",
                                   .table = *table,
                                   .keys = {"number:", "step", "first", "reference", "backlash"},
                                   .files = files,
                                   .parse = parse,
                                   .holds_documented = true};
  const auto jobs = controllers::write_axes(input, writer, result);
  if (!jobs) return tl::unexpected<Error>(jobs.error());
  for (const AxisJob& job : *jobs)
    if (job.loaded && input.options.flag("directions") && job.curve.bidirectional())
      note_chosen(job.axis,
                  input.options.integer("first_cec_table") +
                      2 * (static_cast<std::int64_t>(job.number) - 1),
                  2, result);
  if (auto done = write_cross_tables(input, *jobs, result); !done)
    return tl::unexpected<Error>(done.error());
  controllers::note_facts(writer, result);
  return result;
}

std::vector<Option> options() {
  std::vector<Option> list = controllers::table_options(
      declared(),
      "number (n of AXn), step_mm, first_mm, reference_mm, backlash_mm (MD32450 while measured), "
      "and the same with _deg",
      {within(0.0, 1.0, {"measuring_system", std::int64_t{0}, "", "Encoder: 0 first, 1 second."}),
       within(0.0, 120.0,
              {"first_cec_table", std::int64_t{0}, "",
               "Number of the first CEC table; axis n takes this + 2 (n - 1) and the next."}),
       {"taken", std::vector<std::string>{}, "",
        "Numbers of CEC tables that are in use in the control, \"0\", \"4-9\": none of them is "
        "written."},
       controllers::squareness_option(),
       {"quoted_axes", false, "", "CEC axes as \"AX1\" (newer) and not as (AX1)."}});
  return list;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"siemens-840d", "1.1.0",
       "Leadscrew error tables (EEC), direction tables (CEC) and backlash for SINUMERIK.",
       options()},
      declared(), write, parse, controllers::Offered::always);
  controller.merge = merge;
  registry.add(std::move(controller));
}

}  // namespace nonio::siemens_840d
