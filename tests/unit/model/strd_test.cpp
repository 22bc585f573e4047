// SPDX-License-Identifier: Apache-2.0
// Yardsticks: the linear least-squares sets of NIST's Statistical Reference Datasets (public
// domain, https://www.itl.nist.gov/div898/strd/lls/lls.shtml) with their certified values. Readings
// and certified values were checked against each other in exact rational arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "nonio/model/fit.h"

namespace nonio::model::strd_test {

namespace {

/// An effect whose columns are given: a set is a zero and these.
Effect given(std::vector<std::vector<double>> columns) {
  Effect e;
  e.info.name = "strd";
  for (std::size_t k = 0; k < columns.size(); ++k)
    e.linear.push_back({"B" + std::to_string(k + 1), ""});
  e.columns = [columns](const Observations&, const Axis&,
                        const std::vector<double>&) -> Expected<Effect::Columns> {
    return columns;
  };
  return e;
}

std::vector<std::vector<double>> powers(const std::vector<double>& x, int degree) {
  std::vector<std::vector<double>> out;
  for (int k = 1; k <= degree; ++k) {
    out.emplace_back();
    for (const double v : x) out.back().push_back(std::pow(v, k));
  }
  return out;
}

struct Certified {
  std::vector<double> value, u;  ///< the zero first
  double s;
};

/// Digits that agree: -log10 of the relative error, absolute where the certified value is 0.
double digits(double found, double wanted) {
  const double error = std::fabs(found - wanted) / (wanted == 0.0 ? 1.0 : std::fabs(wanted));
  return std::isnan(error) ? -99.0 : error == 0.0 ? 15.0 : std::min(15.0, -std::log10(error));
}

double least_digits(const std::vector<double>& y, std::vector<std::vector<double>> columns,
                    const Certified& wanted) {
  Observations o;
  o.lines = {{"1", {1, 0, 0}}};
  o.deviation = y;
  const Effect effect = given(std::move(columns));
  const auto f = fit(o, {{&effect, Axis{.name = "X"}}});
  if (!f) {
    ADD_FAILURE() << f.error().message;
    return 0.0;
  }
  double least = digits(f->zero[0], wanted.value[0]);
  for (std::size_t k = 0; k < f->parameters.size(); ++k) {
    least = std::min(least, digits(f->parameters[k].value, wanted.value[k + 1]));
    least = std::min(least, digits(f->parameters[k].u, wanted.u[k + 1]));
  }
  return std::min(least, digits(f->s, wanted.s));
}

const std::vector<double> wampler_x = [] {
  std::vector<double> x;
  for (int k = 0; k <= 20; ++k) x.push_back(k);
  return x;
}();

std::vector<double> wampler_y(double base, double noise) {
  const double delta[] = {759,   -2048, 2048,  -2048, 2523,  -2048, 2048,
                          -2048, 1838,  -2048, 2048,  -2048, 1838,  -2048,
                          2048,  -2048, 2523,  -2048, 2048,  -2048, 759};
  std::vector<double> y;
  for (const double x : wampler_x) {
    double sum = 0.0;
    for (int k = 0; k <= 5; ++k) sum += std::pow(base, k) * std::pow(x, k);
    y.push_back(sum + noise * delta[y.size()]);
  }
  return y;
}

}  // namespace

TEST(StRD, Norris) {
  const std::vector<double> x = {0.2,   337.4, 118.2, 884.6, 10.1,  226.5, 666.3, 996.3, 448.6,
                                 777.0, 558.2, 0.4,   0.6,   775.5, 666.9, 338.0, 447.5, 11.6,
                                 556.0, 228.1, 995.8, 887.6, 120.2, 0.3,   0.3,   556.8, 339.1,
                                 887.2, 999.0, 779.0, 11.1,  118.3, 229.2, 669.1, 448.9, 0.5};
  const std::vector<double> y = {0.1,   338.8, 118.1, 888.0, 9.2,   228.1, 668.5, 998.5, 449.1,
                                 778.9, 559.2, 0.3,   0.1,   778.1, 668.8, 339.3, 448.9, 10.8,
                                 557.7, 228.3, 998.0, 888.8, 119.6, 0.3,   0.6,   557.6, 339.3,
                                 888.0, 998.5, 778.9, 10.2,  117.6, 228.9, 668.4, 449.2, 0.2};
  EXPECT_GT(least_digits(y, {x},
                         {{-0.262323073774029, 1.00211681802045},
                          {0.232818234301152, 0.429796848199937e-3},
                          0.884796396144373}),
            12.0);
}

TEST(StRD, Longley) {
  const std::vector<double> y = {60323, 61122, 60171, 61187, 63221, 63639, 64989, 63761,
                                 66019, 67857, 68169, 66513, 68655, 69564, 69331, 70551};
  const std::vector<std::vector<double>> x = {
      {83.0, 88.5, 88.2, 89.5, 96.2, 98.1, 99.0, 100.0, 101.2, 104.6, 108.4, 110.8, 112.6, 114.2,
       115.7, 116.9},
      {234289, 259426, 258054, 284599, 328975, 346999, 365385, 363112, 397469, 419180, 442769,
       444546, 482704, 502601, 518173, 554894},
      {2356, 2325, 3682, 3351, 2099, 1932, 1870, 3578, 2904, 2822, 2936, 4681, 3813, 3931, 4806,
       4007},
      {1590, 1456, 1616, 1650, 3099, 3594, 3547, 3350, 3048, 2857, 2798, 2637, 2552, 2514, 2572,
       2827},
      {107608, 108632, 109773, 110929, 112075, 113270, 115094, 116219, 117388, 118734, 120445,
       121950, 123366, 125368, 127852, 130081},
      {1947, 1948, 1949, 1950, 1951, 1952, 1953, 1954, 1955, 1956, 1957, 1958, 1959, 1960, 1961,
       1962}};
  EXPECT_GT(
      least_digits(y, x,
                   {{-3482258.63459582, 15.0618722713733, -0.358191792925910e-1, -2.02022980381683,
                     -1.03322686717359, -0.511041056535807e-1, 1829.15146461355},
                    {890420.383607373, 84.9149257747669, 0.334910077722432e-1, 0.488399681651699,
                     0.214274163161675, 0.226073200069370, 455.478499142212},
                    304.854073561965}),
      10.0);
}

/// A polynomial of degree 10; packages that form normal equations get no digit at all.
TEST(StRD, Filip) {
  const std::vector<double> x = {
      -6.860120914, -4.324130045, -4.358625055, -4.358426747, -6.955852379, -6.661145254,
      -6.355462942, -6.118102026, -7.115148017, -6.815308569, -6.519993057, -6.204119983,
      -5.853871964, -6.109523091, -5.79832982,  -5.482672118, -5.171791386, -4.851705903,
      -4.517126416, -4.143573228, -3.709075441, -3.499489089, -6.300769497, -5.953504836,
      -5.642065153, -5.031376979, -4.680685696, -4.329846955, -3.928486195, -8.56735134,
      -8.363211311, -8.107682739, -7.823908741, -7.522878745, -7.218819279, -6.920818754,
      -6.628932138, -6.323946875, -5.991399828, -8.781464495, -8.663140179, -8.473531488,
      -8.247337057, -7.971428747, -7.676129393, -7.352812702, -7.072065318, -6.774174009,
      -6.478861916, -6.159517513, -6.835647144, -6.53165267,  -6.224098421, -5.910094889,
      -5.598599459, -5.290645224, -4.974284616, -4.64454848,  -4.290560426, -3.885055584,
      -3.408378962, -3.13200249,  -8.726767166, -8.66695597,  -8.511026475, -8.165388579,
      -7.886056648, -7.588043762, -7.283412422, -6.995678626, -6.691862621, -6.392544977,
      -6.067374056, -6.684029655, -6.378719832, -6.065855188, -5.752272167, -5.132414673,
      -4.811352704, -4.098269308, -3.66174277,  -3.2644011};
  const std::vector<double> y = {
      0.8116, 0.9072, 0.9052, 0.9039, 0.8053, 0.8377, 0.8667, 0.8809, 0.7975, 0.8162, 0.8515,
      0.8766, 0.8885, 0.8859, 0.8959, 0.8913, 0.8959, 0.8971, 0.9021, 0.909,  0.9139, 0.9199,
      0.8692, 0.8872, 0.89,   0.891,  0.8977, 0.9035, 0.9078, 0.7675, 0.7705, 0.7713, 0.7736,
      0.7775, 0.7841, 0.7971, 0.8329, 0.8641, 0.8804, 0.7668, 0.7633, 0.7678, 0.7697, 0.77,
      0.7749, 0.7796, 0.7897, 0.8131, 0.8498, 0.8741, 0.8061, 0.846,  0.8751, 0.8856, 0.8919,
      0.8934, 0.894,  0.8957, 0.9047, 0.9129, 0.9209, 0.9219, 0.7739, 0.7681, 0.7665, 0.7703,
      0.7702, 0.7761, 0.7809, 0.7961, 0.8253, 0.8602, 0.8809, 0.8301, 0.8664, 0.8834, 0.8898,
      0.8964, 0.8963, 0.9074, 0.9119, 0.9228};
  EXPECT_GT(
      least_digits(y, powers(x, 10),
                   {{-1467.48961422980, -2772.17959193342, -2316.37108160893, -1127.97394098372,
                     -354.478233703349, -75.1242017393757, -10.8753180355343, -1.06221498588947,
                     -0.670191154593408e-1, -0.246781078275479e-2, -0.402962525080404e-4},
                    {298.084530995537, 559.779865474950, 466.477572127796, 227.204274477751,
                     71.6478660875927, 15.2897178747400, 2.23691159816033, 0.221624321934227,
                     0.142363763154724e-1, 0.535617408889821e-3, 0.896632837373868e-5},
                    0.334801051324544e-2}),
      6.5);
}

TEST(StRD, Wampler1And2AreExact) {
  const std::vector<double> none(6, 0.0);
  EXPECT_GT(least_digits(wampler_y(1.0, 0.0), powers(wampler_x, 5),
                         {std::vector<double>(6, 1.0), none, 0.0}),
            6.5);
  EXPECT_GT(least_digits(wampler_y(0.1, 0.0), powers(wampler_x, 5),
                         {{1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5}, none, 0.0}),
            9.0);
}

TEST(StRD, Wampler3To5) {
  const std::vector<double> ones(6, 1.0);
  const Certified three{ones,
                        {2152.32624678170, 2363.55173469681, 779.343524331583, 101.475507550350,
                         5.64566512170752, 0.112324854679312},
                        2360.14502379268};
  for (const double noise : {1.0, 100.0, 10000.0}) {
    Certified wanted = three;
    for (double& u : wanted.u) u *= noise;
    wanted.s *= noise;
    EXPECT_GT(least_digits(wampler_y(1.0, noise), powers(wampler_x, 5), wanted), noise < 2.0 ? 8.0
                                                                                 : noise < 200.0
                                                                                     ? 8.0
                                                                                     : 6.0)
        << noise;
  }
}

}  // namespace nonio::model::strd_test
