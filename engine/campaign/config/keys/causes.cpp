// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Choice priors[] = {{"common"}, {"rare"}, {"very-rare"}};
constexpr Choice columns_needed[] = {{"time_s"}};

constexpr Key cause_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of the cause, up to 40 of a-z 0-9 -; the effect is name:axis.",
     .required = true,
     .wanted = "expected up to 40 of a-z 0-9 -; found \"{}\"",
     .text = {.letters = "a-z0-9-", .longest = 40}},
    {.name = "title",
     .holds = translations,
     .help =
         "The cause in a few words: a text, or texts by language, { en = \"...\", de = \"...\" }.",
     .required = true,
     .wanted = "expected a text, or texts by language, { en = \"...\", de = \"...\" }",
     .text = language},
    {.name = "axis",
     .holds = text,
     .help = "Kind of the axes that can have it: linear, rotary.",
     .required = true,
     .choices = axis_kinds},
    {.name = "expression",
     .holds = text,
     .help = "The deviation as a formula, \"a*sin(2*_pi*p/P)\".",
     .required = true},
    {.name = "parameters",
     .holds = tables,
     .help = "The parameters of the expression, 12 at most.",
     .required = true,
     .missing = "[{ name = \"a\", unit = \"um\" }], one at least",
     .wanted = "expected 12 parameters at most, found {}",
     .longest_list = 12,
     .keys = parameter_keys},
    {.name = "is", .holds = text, .help = "The physics in a sentence or two.", .required = true},
    {.name = "size", .holds = text, .help = "Its usual size.", .required = true},
    {.name = "appearance",
     .holds = text,
     .help = "What it looks like in a plot.",
     .former = "looks"},
    {.name = "similar",
     .holds = text,
     .help = "What looks the same, and what separates the two.",
     .former = "alike"},
    {.name = "remedy", .holds = text, .help = "The remedy.", .required = true, .former = "cure"},
    {.name = "compensable",
     .holds = flag,
     .help = "Whether a table in the control compensates it.",
     .otherwise = "false"},
    {.name = "prior",
     .holds = text,
     .help = "How often it is the cause: common, rare (1 to 10), very-rare (1 to 100).",
     .otherwise = "common",
     .choices = priors},
    {.name = "columns",
     .holds = texts,
     .help = "Columns without which it is not searched. Those that the expression uses (K, air, "
             "pressure, humidity) need not be listed.",
     .choices = columns_needed},
};

constexpr Key causes_keys[] = {
    format_key,
    {.name = "cause", .holds = tables, .help = "A cause, [[cause]].", .keys = cause_keys},
};

constexpr Key causes_toml = {.name = "causes/*.toml",
                             .holds = table,
                             .help = "Causes that `nonio model explain` searches.",
                             .keys = causes_keys};

}  // namespace declared

const Key& causes_file() { return declared::causes_toml; }

}  // namespace nonio::config
