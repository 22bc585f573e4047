// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/conditions.h"
#include "campaign/config/keys/machine_of_campaign.h"
#include "campaign/config/keys/measurement.h"

namespace nonio::config {
namespace declared {

constexpr Choice purposes[] = {{"periodic"}, {"acceptance"}, {"after-repair"}, {"check"}};
constexpr Key campaign_keys[] = {
    {.name = "id",
     .holds = text,
     .help = "Name of the campaign, unique in the site: a-z 0-9 . _ -, at most 100.",
     .required = true,
     .wanted = campaign_id_wanted,
     .text = campaign_id_rule},
    {"customer", text, "Name of the customer."},
    {"site", text, "Location of the machine."},
    {"operator", text, "Name of the operator."},
    {"customer_address", text, "Address or contact of the customer, for the certificate."},
    {"date", date, "Day of the measurements, or the first of them."},
    {"end_date", date, "Last day of the measurements, if there was more than one."},
    {"received", date, "Day on which the item was received, for the certificate."},
    {.name = "purpose",
     .holds = text,
     .help = "Reason for the measurements. Checks are a series of their own in the machine's "
             "history; the other reasons are shown in it.",
     .otherwise = "periodic",
     .choices = purposes},
};

constexpr Choice compensated[] = {{"readings"}, {"model"}};
constexpr Key model_keys[] = {
    {.name = "effects",
     .holds = texts,
     .help = "Effects of the machine's error model, \"kind:axis\"; `nonio model add` and `drop` "
             "edit the list.",
     .named = Named::effect},
    {.name = "compensate",
     .holds = text,
     .help = "Basis of tables: the means of the readings, or the compensable effects of the "
             "model, without drift and noise.",
     .otherwise = "readings",
     .choices = compensated},
    {.name = "formula",
     .holds = tables,
     .help = "Your own effect, as a formula.",
     .keys = formula_keys},
};

constexpr Key certificate_of_campaign[] = {
    languages_key,
    template_key,
    location_key,
    procedure_key,
    title_key,
    decision_rule_key,
    {"deviations", text,
     "Additions to the method, deviations from it and exclusions, in addition to those "
     "that the program finds."},
    {.name = "no_other_deviations_by",
     .holds = text,
     .help = "The person who states that, apart from the departures listed in the certificate, the "
             "method was followed. Without it no such statement is printed.",
     .former = "nothing_else_by"},
    {"conditions", text,
     "Conditions that influence the results; required if no readings have temperatures."},
    {"opinions", text, "Opinions and interpretations; the certificate marks them as such."},
    {"amendment", text, "Reason why an earlier certificate is replaced."},
    {"customer_data", texts,
     "Keys of this file with values stated by the customer, [\"machine.serial\"]; the "
     "certificate marks them."},
};

constexpr Key accepted_finding_keys[] = {
    {.name = "finding",
     .holds = text,
     .help = "Id of a finding that makes readings implausible, \"plausibility.passes-identical\".",
     .required = true,
     .missing = "expected the id of a finding",
     .wanted = "expected the id of a finding, \"plausibility.passes-identical\"; found \"{}\"",
     .text = {.letters = "a-z.-", .begins = "plausibility."}},
    {.name = "reason",
     .holds = text,
     .help = "Reason why tables may be written from these readings.",
     .required = true,
     .missing = "expected why a table may be written despite the finding"},
};

constexpr Key tables_keys[] = {
    {.name = "accept",
     .holds = tables,
     .help = "Findings plausibility.* that do not prevent controller tables, each with the reason.",
     .keys = accepted_finding_keys,
     .former = "may_stand"},
};

constexpr Key campaign_file_keys[] = {
    required_format(),
    {.name = "campaign",
     .holds = table,
     .help = "Customer, place, operator and date.",
     .required = true,
     .missing = "[campaign] with at least an id",
     .keys = campaign_keys},
    {.name = "machine", .holds = table, .help = "The measured machine.", .keys = machine_keys},
    {.name = "instrument",
     .holds = table,
     .help = "The measuring instrument.",
     .keys = instrument_keys},
    {.name = "sensor",
     .holds = tables,
     .help = "A sensor of temperature, pressure or humidity: a separate instrument with its "
             "own calibration.",
     .keys = sensor_keys},
    {.name = "square",
     .holds = tables,
     .help = "A square against whose faces two axes were read.",
     .keys = square_keys},
    {.name = "environment",
     .holds = table,
     .help = "Contributions to the uncertainty other than the instrument, as full ranges "
             "(ISO/TR 230-9).",
     .keys = environment_keys},
    {.name = "certificate",
     .holds = table,
     .help = "Settings and texts of this campaign's certificate.",
     .keys = certificate_of_campaign},
    run_key,
    {.name = "measurement",
     .holds = tables,
     .help = "A file of readings. At least one, unless [run] names analyses and outputs (a "
             "campaign that only plans).",
     .keys = measurement_keys},
    {.name = "model",
     .holds = table,
     .help = "The present error model of the machine.",
     .keys = model_keys},
    {.name = "tables",
     .holds = table,
     .help = "Controller tables from implausible readings.",
     .keys = tables_keys},
    options_key,
};

constexpr Key campaign_toml = {.name = "campaign.toml",
                               .holds = table,
                               .help = "Manifest of a campaign of machine-tool calibration.",
                               .keys = campaign_file_keys};

}  // namespace declared

const Key& campaign_file() { return declared::campaign_toml; }

bool rotary_by_name(std::string_view axis) {
  const Key& axes = *find_key(declared::machine_keys, "axes");
  return !axis.empty() && axes.initials.find(axis.front()) != std::string_view::npos;
}

}  // namespace nonio::config
