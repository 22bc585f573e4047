// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Words an_asset_or_serial =
    "The machine as `nonio machine list` names it: its asset, or maker and serial with a space "
    "between them.";
template <class Entry>
constexpr Key written_by = {"by", into<&Entry::by>, "Name of the author of this entry.", required};
constexpr Choice event_kinds[] = {{"crash"},      {"repair"},   {"compensation"}, {"moved"},
                                  {"instrument"}, {"software"}, {"other"}};
constexpr Key event_keys[] = {
    {"date", day<&Event::date>, "Day on which it happened.", required},
    {"machine", into<&Event::machine>, an_asset_or_serial, required},
    {"axis", into<&Event::axis>,
     "The axis concerned, as the control names it. Default: the whole machine."},
    {"kind", into<&Event::kind>,
     "Kind of event: crash, repair, compensation (a table was loaded into the control), moved (set "
     "up again), instrument (another one from now on), software, other.",
     required, event_kinds},
    {"text", into<&Event::text>, "Description in the words of a witness.", required},
    {"by", into<&Event::by>, "Name of the author of this entry."},
};

constexpr Key acknowledged_keys[] = {
    {"date", day<&Acknowledgement::date>, "Day of the entry.", required},
    {"finding", into<&Acknowledgement::finding>,
     "Id of the finding, or kind of a line of the worklist.", required},
    {"machine", into<&Acknowledgement::machine>, an_asset_or_serial, required},
    {"axis", into<&Acknowledgement::axis>, "The axis. Default: all axes."},
    {"quantity", into<&Acknowledgement::quantity>, "The quantity, such as B_mean. Default: all."},
    {"until", day<&Acknowledgement::until>,
     "Last day of the acknowledgement; then the finding is new again.", required},
    {"value", into<&Acknowledgement::value>,
     "Value of the quantity on that day, in its unit: the finding is new again if the value "
     "changes by more than U."},
    {"U", into<&Acknowledgement::U>, "Expanded uncertainty (k = 2) of that value.", not_negative},
    written_by<Acknowledgement>,
    {"why", into<&Acknowledgement::why>, "Reason why it is accepted until then.", required},
};

constexpr Key withdrawn_keys[] = {
    {"date", day<&Withdrawal::date>, "Day of the entry.", required},
    {"finding", into<&Withdrawal::finding>, "Finding of the acknowledgement that is withdrawn.",
     required},
    {"machine", into<&Withdrawal::machine>, "The same as in the acknowledgement.", required},
    {"axis", into<&Withdrawal::axis>, "The same as in the acknowledgement."},
    {"quantity", into<&Withdrawal::quantity>, "The same as in the acknowledgement."},
    written_by<Withdrawal>,
    {"why", into<&Withdrawal::why>, "Reason for the withdrawal."},
};

constexpr Key forgotten_keys[] = {
    {"date", day<&Forgotten::date>, "Day of the entry.", required},
    {"campaign", into<&Forgotten::campaign>,
     "Id of a campaign, or another file or folder of the site (machines/S-0042.toml, events.toml), "
     "that was removed on purpose.",
     required,
     spelled({.not_letters = "\\\n\t", .not_first = ". -/", .longest = 200},
             "expected the id of a campaign, or a path below the site (machines/S-0042.toml); "
             "found \"{}\"")},
    written_by<Forgotten>,
    {"why", into<&Forgotten::why>, "Reason for the removal.", required},
};

constexpr Key events_file_keys[] = {
    format_key,
    {"event", checked<check_entry<Event>, &Entries::events>, "Events of a machine, [[event]].",
     event_keys},
};

constexpr Key acknowledged_file_keys[] = {
    format_key,
    {"acknowledged", checked<check_entry<Acknowledgement>, &Entries::acknowledged>,
     "Findings acknowledged by a person, [[acknowledged]].", acknowledged_keys},
    {"withdrawn", checked<check_entry<Withdrawal>, &Entries::withdrawn>,
     "Withdrawals of the acknowledgements above, [[withdrawn]].", withdrawn_keys},
};

constexpr Key forgotten_file_keys[] = {
    format_key,
    {"forgotten", checked<check_entry<Forgotten>, &Entries::forgotten>,
     "What was removed on purpose, [[forgotten]].", forgotten_keys},
};

constexpr Key events_toml = {"events.toml", file<Entries>, "Events of the machines of a site.",
                             events_file_keys};
constexpr Key acknowledged_toml = {"acknowledged.toml", file<Entries>,
                                   "Known findings of the machines of a site, and until when.",
                                   acknowledged_file_keys};

constexpr Key forgotten_toml = {"forgotten.toml", file<Entries>,
                                "Campaigns and other files of a site that were removed on purpose.",
                                forgotten_file_keys};

}  // namespace declared

const Key& events_file() { return declared::events_toml; }
const Key& acknowledged_file() { return declared::acknowledged_toml; }
const Key& forgotten_file() { return declared::forgotten_toml; }

}  // namespace nonio::config
