// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/fleet.h"

#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Key effect_keys[] = {
    {"name", into<&Fleet::Effect::name>, "Effect without its axis: \"backlash\".", required},
    {"found", into<&Fleet::Effect::found>, "Ids of the campaigns in which it was found.", required},
    {"median", into<&Fleet::Effect::median>, "Median of its sizes, in `unit`."},
    {"spread", into<&Fleet::Effect::spread>,
     "Half the distance of the quartiles of its sizes, in `unit`."},
    {"unit", into<&Fleet::Effect::unit>, "Unit of the sizes: \"um\", \"um/m\"."},
};

constexpr Key machines_keys[] = {
    {"maker", into<&Fleet::Machines::maker>,
     "Maker of the machines; without maker and model: all machines."},
    {"model", into<&Fleet::Machines::model>, "Model of the machines."},
    {"campaigns", into<&Fleet::Machines::campaigns>,
     "Ids of the campaigns in which effects were searched.", required},
    {"effect", nested<&Fleet::Machines::effects>, "An effect that was found, [[machines.effect]].",
     effect_keys},
};

constexpr Key fleet_file_keys[] = {
    format_key,
    {"counted", day<&Fleet::counted>, "Day of the count.", required},
    {"from", day<&Fleet::from>, "Day of the first campaign."},
    {"until", day<&Fleet::until>, "Day of the last campaign."},
    {"machines", nested<&Fleet::machines>, "Machines of one model, or all, [[machines]].",
     machines_keys},
};

constexpr Key fleet_toml = {"fleet.toml", file<Fleet>,
                            "How often effects were found on the machines of the laboratory.",
                            fleet_file_keys};

}  // namespace declared

const Key& fleet_file() { return declared::fleet_toml; }

}  // namespace nonio::config
