// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/conditions.h"
#include "campaign/config/keys/machine_of_campaign.h"
#include "campaign/config/keys/measurement.h"

namespace nonio::config {
namespace declared {

constexpr Choice purposes[] = {{"periodic"}, {"acceptance"}, {"after-repair"}, {"check"}};
constexpr Key campaign_keys[] = {
    {"id", into<&Manifest::campaign, &Campaign::id>,
     "Name of the campaign, unique in the site: a-z 0-9 . _ -, at most 100.", required,
     spelled(campaign_id_rule, campaign_id_wanted)},
    {"customer", into<&Manifest::campaign, &Campaign::customer>, "Name of the customer."},
    {"site", into<&Manifest::campaign, &Campaign::site>,
     "Location of the machine: the place where it is installed."},
    {"operator", into<&Manifest::campaign, &Campaign::operator_name>, "Name of the operator."},
    {"customer_address", into<&Manifest::campaign, &Campaign::customer_address>,
     "Address or contact of the customer, for the certificate."},
    {"date", day<&Manifest::campaign, &Campaign::date>,
     "Day of the measurements, or the first of them."},
    {"end_date", day<&Manifest::campaign, &Campaign::end_date>,
     "Last day of the measurements, if there was more than one."},
    {"received", day<&Manifest::campaign, &Campaign::received>,
     "Day on which the item was received, for the certificate."},
    {"purpose", into<&Manifest::purpose>,
     "Reason for the measurements. Checks continue the series of the machine's history, where they "
     "are marked: so it shows what a table did.",
     otherwise("periodic"), purposes},
};

constexpr Choice compensated[] = {choice(false, "readings"), choice(true, "model")};
constexpr Key model_keys[] = {
    {"effects", into<&Manifest::campaign, &Campaign::model>,
     "Effects of the machine's error model, \"kind:axis\"; `nonio model add` and `drop` edit the "
     "list.",
     Named::effect},
    {"compensate", chosen<&Manifest::campaign, &Campaign::compensate_model>,
     "Basis of tables: the means of the readings, or the compensable effects of the model, without "
     "drift and noise.",
     otherwise("readings"), compensated},
    {"formula", checked<check_own_formula, &Manifest::campaign, &Campaign::formulas>,
     "Your own effect, as a formula.", formula_keys},
};

constexpr Key certificate_of_campaign[] = {
    {"deviations", into<&CertificateTexts::deviations>,
     "Additions to the method, deviations from it and exclusions, in addition to those that the "
     "program finds."},
    {"no_other_deviations_by", into<&CertificateTexts::no_other_deviations_by>,
     "The person who states that, apart from the departures listed in the certificate, the method "
     "was followed. Without it no such statement is printed.",
     former("nothing_else_by")},
    {"conditions", into<&CertificateTexts::conditions>,
     "Conditions that influence the results; required if no readings have temperatures."},
    {"opinions", into<&CertificateTexts::opinions>,
     "Opinions and interpretations; the certificate marks them as such."},
    {"amendment", into<&CertificateTexts::amendment>,
     "Reason why an earlier certificate is replaced."},
    {"customer_data", into<&CertificateTexts::customer_data>,
     "Keys of this file with values stated by the customer, [\"machine.serial\"]; the certificate "
     "marks them."},
};

constexpr Key accepted_finding_keys[] = {
    {"finding", into<&AcceptedFinding::finding>,
     "Id of a finding that makes readings implausible, \"plausibility.passes-identical\".",
     missing("expected the id of a finding"),
     spelled({.letters = "a-z.-", .begins = "plausibility."},
             "expected the id of a finding, \"plausibility.passes-identical\"; found \"{}\"")},
    {"reason", into<&AcceptedFinding::reason>,
     "Reason why tables may be written from these readings.",
     missing("expected why a table may be written despite the finding")},
};

constexpr Key tables_keys[] = {
    {"accept", checked<check_accepted, &Manifest::accepted>,
     "Findings plausibility.* that do not prevent controller tables, each with the reason.",
     accepted_finding_keys, former("may_stand")},
};

constexpr auto all_of_certificate = joined(certificate_texts<>, certificate_of_campaign);
constexpr Key campaign_file_keys[] = {
    required_format,
    {"campaign", same<Manifest, check_campaign>, "Customer, place, operator and date.",
     missing("[campaign] with at least an id"), campaign_keys},
    {"machine", checked<restore_axis_order, &Manifest::campaign, &Campaign::machine>,
     "The measured machine.", machine_keys},
    {"instrument", checked<check_instrument, &Manifest::campaign, &Campaign::instrument>,
     "The measuring instrument.", instrument_keys},
    {"sensor", nested<&Manifest::campaign, &Campaign::sensors>,
     "A sensor of temperature, pressure or humidity: a separate instrument with its own "
     "calibration.",
     sensor_keys},
    {"square", checked<check_square, &Manifest::campaign, &Campaign::squares>,
     "A square against whose faces two axes were read.", square_keys},
    {"environment", nested<&Manifest::campaign, &Campaign::environment>,
     "Contributions to the uncertainty other than the instrument, as full ranges (ISO/TR 230-9).",
     environment_keys},
    {"certificate", nested<&Manifest::campaign, &Campaign::certificate>,
     "Settings and texts of this campaign's certificate.", all_of_certificate},
    run_key<Manifest>,
    {"measurement",
     by<read_measurements, Key::Holds::tables, &Manifest::campaign, &Campaign::measurements>,
     "A file of readings. At least one, unless [run] names analyses and outputs (a campaign that "
     "only plans).",
     measurement_keys},
    {"model", same<Manifest>, "The present error model of the machine.", model_keys},
    {"tables", same<Manifest>, "Controller tables from implausible readings.", tables_keys},
    options_key<Manifest>,
};

constexpr Key campaign_toml = {"campaign.toml", file<Manifest>,
                               "Manifest of a campaign of machine-tool calibration.",
                               campaign_file_keys};

}  // namespace declared

const Key& campaign_file() { return declared::campaign_toml; }

bool rotary_by_name(std::string_view axis) {
  const Key& axes = *find_key(declared::machine_keys, "axes");
  return !axis.empty() && axes.initials.find(axis.front()) != std::string_view::npos;
}

}  // namespace nonio::config
