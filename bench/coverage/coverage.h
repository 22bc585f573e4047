// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "loaded_analysis.h"
#include "nonio/sdk/plugin.h"
#include "shop.h"

namespace nonio::coverage {

/// Shares of results within U of the truth. A campaign's points of a curve count as one trial.
class Tally {
 public:
  void put(const std::string& name, double error, double U);
  void end_of_campaign();

  struct Share {
    double percent = 0.0, half = 0.0;  ///< half width of its 95 % interval
    double worst = 0.0;                ///< largest error of a trial, for the trials without causes
    std::size_t trials = 0;
  };
  std::map<std::string, Share> shares() const;

 private:
  struct Sums {
    double in = 0.0, all = 0.0;  // of the present campaign
    double sum = 0.0, squares = 0.0, worst = 0.0;
    std::size_t campaigns = 0;
  };
  std::map<std::string, Sums> sums_;
};

/// One campaign of a method in a scenario: draws it, evaluates it and puts each result.
using Trial = void (*)(const Scenario&, unsigned seed, double size, Tally&);

struct Method {
  const char* name;
  Trial trial;
  int every = 1;  ///< one in so many campaigns: where they take long
};

/// Results that do not lie in 94 to 96 %, and why.
struct Exception {
  char letter;
  const char* reason;
  const char* methods;    ///< parts of their names, separated by ';'
  const char* scenarios;  ///< the same
  const char* results;    ///< names; "*": all
  bool less = false;      ///< it may also cover less
  bool holds(const Method&, const Scenario&, const std::string& result) const;
};
const std::vector<Exception>& exceptions();

extern const std::vector<Method> axis_methods, line_methods, rotary_methods;

Settings defaults(const Analysis&);
Measurement named(const std::string& id, const std::string& kind, const std::string& axis);
Evaluation evaluated(const Analysis&, const Campaign&, std::size_t measurement,
                     const std::vector<Observations>&, const Settings&);

}  // namespace nonio::coverage
