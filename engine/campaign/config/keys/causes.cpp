// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Choice priors[] = {{"common"}, {"rare"}, {"very-rare"}};
constexpr Choice columns_needed[] = {{"time_s"}};

constexpr Key cause_keys[] = {
    {"name", into<&Cause::formula, &Formula::name>,
     "Name of the cause, up to 40 of a-z 0-9 -; the effect is name:axis.", required,
     spelled({.letters = "a-z0-9-", .longest = 40},
             "expected up to 40 of a-z 0-9 -; found \"{}\"")},
    {"title", into<&Cause::titles>,
     "The cause in a few words: a text, or texts by language, { en = \"...\", de = \"...\" }.",
     required,
     spelled(language, "expected a text, or texts by language, { en = \"...\", de = \"...\" }")},
    {"axis", chosen<&Cause::rotary>, "Kind of the axes that can have it: linear, rotary.", required,
     axis_kinds},
    {"expression", into<&Cause::formula, &Formula::expression>,
     "The deviation as a formula, \"a*sin(2*_pi*p/P)\".", required},
    {"parameters", checked<check_parameter, &Cause::formula, &Formula::parameters>,
     "The parameters of the expression, 12 at most.",
     missing("[{ name = \"a\", unit = \"um\" }], one at least"),
     wanted("expected 12 parameters at most, found {}"), longest(12), parameter_keys},
    {"is", into<&Cause::is>, "The physics in a sentence or two.", required},
    {"size", into<&Cause::size>, "Its usual size.", required},
    {"appearance", into<&Cause::appearance>, "What it looks like in a plot.", former("looks")},
    {"similar", into<&Cause::similar>, "What looks the same, and what separates the two.",
     former("alike")},
    {"remedy", into<&Cause::remedy>, "The remedy.", required, former("cure")},
    {"compensable", into<&Cause::compensable>, "Whether a table in the control compensates it.",
     otherwise("false")},
    {"prior", into<&Cause::prior>,
     "How often it is the cause: common, rare (1 to 10), very-rare (1 to 100).",
     otherwise("common"), priors},
    {"columns", into<&Cause::columns>,
     "Columns without which it is not searched. Those that the expression uses (K, air, pressure, "
     "humidity) need not be listed.",
     columns_needed},
};

constexpr Key causes_keys[] = {
    format_key,
    {"cause", checked<check_cause, &Causes::all>, "A cause, [[cause]].", cause_keys},
};

constexpr Key causes_toml = {"causes/*.toml", file<Causes>,
                             "Causes that `nonio model explain` searches.", causes_keys};

}  // namespace declared

const Key& causes_file() { return declared::causes_toml; }

}  // namespace nonio::config
