// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Words an_asset_or_serial =
    "The machine as `nonio machine list` names it: its asset, or maker and serial with a space "
    "between them.";
constexpr Key written_by = {
    .name = "by", .holds = text, .help = "Name of the author of this entry.", .required = true};
constexpr Choice event_kinds[] = {{"crash"},      {"repair"},   {"compensation"}, {"moved"},
                                  {"instrument"}, {"software"}, {"other"}};
constexpr Key event_keys[] = {
    {.name = "date", .holds = date, .help = "Day on which it happened.", .required = true},
    {.name = "machine", .holds = text, .help = an_asset_or_serial, .required = true},
    {"axis", text, "The axis concerned, as the control names it. Default: the whole machine."},
    {.name = "kind",
     .holds = text,
     .help = "Kind of event: crash, repair, compensation (a table was loaded into the control), "
             "moved (set up again), instrument (another one from now on), software, other.",
     .required = true,
     .choices = event_kinds},
    {.name = "text",
     .holds = text,
     .help = "Description in the words of a witness.",
     .required = true},
    {"by", text, "Name of the author of this entry."},
};

constexpr Key acknowledged_keys[] = {
    {.name = "date", .holds = date, .help = "Day of the entry.", .required = true},
    {.name = "finding",
     .holds = text,
     .help = "Id of the finding, or kind of a line of the daily list.",
     .required = true},
    {.name = "machine", .holds = text, .help = an_asset_or_serial, .required = true},
    {"axis", text, "The axis. Default: all axes."},
    {"quantity", text, "The quantity, such as B_mean. Default: all."},
    {.name = "until",
     .holds = date,
     .help = "Last day of the acknowledgement; then the finding is new again.",
     .required = true},
    {"value", number,
     "Value of the quantity on that day, in its unit: the finding is new again if the "
     "value changes by more than U."},
    {.name = "U",
     .holds = number,
     .help = "Expanded uncertainty (k = 2) of that value.",
     .wanted = not_negative,
     .least = 0.0},
    written_by,
    {.name = "why",
     .holds = text,
     .help = "Reason why it is accepted until then.",
     .required = true},
};

constexpr Key withdrawn_keys[] = {
    {.name = "date", .holds = date, .help = "Day of the entry.", .required = true},
    {.name = "finding",
     .holds = text,
     .help = "As the acknowledgement above that is withdrawn has it.",
     .required = true},
    {.name = "machine", .holds = text, .help = "As the acknowledgement has it.", .required = true},
    {"axis", text, "As the acknowledgement has it."},
    {"quantity", text, "As the acknowledgement has it."},
    written_by,
    {"why", text, "Reason why it does not count any more."},
};

constexpr Key forgotten_keys[] = {
    {.name = "date", .holds = date, .help = "Day of the entry.", .required = true},
    {.name = "campaign",
     .holds = text,
     .help = "Id of a campaign, or another file or folder of the site (machines/S-0042.toml, "
             "events.toml), that was removed on purpose.",
     .required = true,
     .wanted = "expected the id of a campaign, or a path below the site (machines/S-0042.toml); "
               "found \"{}\"",
     .text = {.not_letters = "\\\n\t", .not_first = ". -/", .longest = 200}},
    written_by,
    {.name = "why", .holds = text, .help = "Reason for the removal.", .required = true},
};

constexpr Key events_file_keys[] = {
    format_key,
    {.name = "event",
     .holds = tables,
     .help = "Events of a machine, [[event]].",
     .keys = event_keys},
};

constexpr Key acknowledged_file_keys[] = {
    format_key,
    {.name = "acknowledged",
     .holds = tables,
     .help = "Findings acknowledged by a person, [[acknowledged]].",
     .keys = acknowledged_keys},
    {.name = "withdrawn",
     .holds = tables,
     .help = "Acknowledgements above that do not count any more, [[withdrawn]].",
     .keys = withdrawn_keys},
};

constexpr Key forgotten_file_keys[] = {
    format_key,
    {.name = "forgotten",
     .holds = tables,
     .help = "What was removed on purpose, [[forgotten]].",
     .keys = forgotten_keys},
};

constexpr Key events_toml = {.name = "events.toml",
                             .holds = table,
                             .help = "Events of the machines of a site.",
                             .keys = events_file_keys};
constexpr Key acknowledged_toml = {
    .name = "acknowledged.toml",
    .holds = table,
    .help = "Known findings of the machines of a site, and until when.",
    .keys = acknowledged_file_keys};

constexpr Key forgotten_toml = {
    .name = "forgotten.toml",
    .holds = table,
    .help = "Campaigns and other files of a site that were removed on purpose.",
    .keys = forgotten_file_keys};

constexpr Choice roles[] = {{"view"}, {"measure"}, {"approve"}, {"administer"}};
constexpr Key user_keys[] = {
    {.name = "account",
     .holds = text,
     .help = "Account, as the reverse proxy states it or the person types it.",
     .required = true},
    {.name = "name",
     .holds = text,
     .help = "Name of the person, as documents print it.",
     .required = true},
    {.name = "role",
     .holds = text,
     .help = "What the person may do; each role may do what those before it may.",
     .required = true,
     .choices = roles},
    {.name = "password",
     .holds = text,
     .help = "Hash of the password, as `nonio serve SITE --hash-password` prints it.",
     .may_be_secret = true,
     .text = {.letters = "a-zA-Z0-9$=,+/", .begins = "$argon2id$v=19$m="}},
};

constexpr Key users_file_keys[] = {
    format_key,
    {.name = "user",
     .holds = tables,
     .help = "Users of the page of a site, [[user]].",
     .keys = user_keys},
};

constexpr Key users_toml = {.name = "users.toml",
                            .holds = table,
                            .help = "Who may do what on the page of a site.",
                            .keys = users_file_keys};

}  // namespace declared

const Key& users_file() { return declared::users_toml; }
const Key& events_file() { return declared::events_toml; }
const Key& acknowledged_file() { return declared::acknowledged_toml; }
const Key& forgotten_file() { return declared::forgotten_toml; }

}  // namespace nonio::config
